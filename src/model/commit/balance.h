/* balance.h - no energy comes of the pushes of a commit.
 *
 * A push of depth d on a particle of stiffness K adds K d^2 / 2 to the springs, while the
 * velocity that it takes away held m (d / dt)^2 / 2: dt^2 K / m times less. So the energy after
 * a commit is held at or below the larger of what there was before the push, and of what the
 * commit before has left with a hundredth of what was lost since the first touch:
 *   1. the pushes alone, where they keep to it;
 *   2. else the body gives way to them as in an implicit step (response.h), in its velocity by
 *      as much as goes with the way in the step of the method;
 *   3. else a share of it, by bisection; the rest is pushed in later commits. Velocities never
 *      point inwards.
 * At the first touch there was what the state before it had, and what a fall through one step
 * adds, for a body at rest has nothing to lose. Obstacles that move do work beside that. */
#ifndef CS_BALANCE_H
#define CS_BALANCE_H

#include "base/record.h"
#include "model/commit/response.h"
#include "model/contact/obstacle.h"

/* J: of all kinds, and the sum of their sizes, by which rounding is judged. */
struct cs_balance_energy {
    double whole, size;
};

struct cs_balance {
    const struct cs_system *system; /* borrowed */
    struct cs_response response;
    double *move;                    /* (3,n) work */
    double weight;                   /* J */
    double rate;                     /* 1/s, velocity that a response gives for its way */
    struct cs_balance_energy energy; /* that the last commit with a push has left */
    double taken;                    /* J, of kinetic energy by the pushes of this commit */
    double most;          /* J: what there was before anything touched, or was added since */
    bool known, touching; /* energy is that of the state before; most is of this contact */
    uint64_t shortened;   /* commits in which pushes were cut to the energy that was there */
};

/* One commit with a push. */
struct cs_blow {
    double t, dt;
    const struct cs_obstacle *obstacles;
    const double *last;  /* (6,n) the state before the step */
    const double *x, *v; /* (3,n) as the step has left them */
    double *to;          /* (6,n) as the pushes leave them */
    const bool *pushed;  /* (n) particles that are where they have to be: pushed or held */
};

/* Takes the arrays from arena. CS_ERR_MEMORY. */
enum cs_status cs_balance_init(struct cs_balance *balance, struct cs_system *system,
                               struct cs_arena *arena, struct cs_error *error);

/* Corrects blow->to as said above. false: particles are left behind a surface. */
bool cs_balance_hold(struct cs_balance *balance, const struct cs_blow *blow);

/* What it leaves to the next commit, for a checkpoint. */
void cs_balance_record(struct cs_balance *balance, struct cs_record *record);

#endif

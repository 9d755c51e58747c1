/* projection_energy.h - no energy comes of the pushes of a commit.
 *
 * A push of depth d on a particle of stiffness K adds K d^2 / 2 to the springs, while the
 * velocity that it takes away held m (d / dt)^2 / 2: dt^2 K / m times less. So the energy after
 * a commit is held at or below the larger of what there was before the push, and of what the
 * commit before has left with a hundredth of what was lost since the first touch:
 *   1. the pushes alone, where they keep to it;
 *   2. else the body gives way to them as in an implicit step (elastic_response.h), in its
 * velocity by as much as goes with the way in the step of the method;
 *   3. else a share of it, by bisection; the rest is pushed in later commits. Velocities never
 *      point inwards.
 * At the first touch there was what the state before it had, and what a fall through one step
 * adds, for a body at rest has nothing to lose. Obstacles that move do work beside that. */
#ifndef CS_PROJECTION_ENERGY_H
#define CS_PROJECTION_ENERGY_H

#include "base/serialise.h"
#include "model/contact/posed_collider.h"
#include "model/post_step/elastic_response.h"

/* J: of all kinds, and the sum of their sizes, by which rounding is judged. */
struct cs_energy_with_scale {
    double total, scale;
};

struct cs_projection_energy {
    const struct cs_system *system; /* borrowed */
    struct cs_elastic_response elastic_response;
    double *work;                       /* (3,n) work */
    double energy_scale;                /* J */
    double velocity_per_push;           /* 1/s, velocity that a response gives for its way */
    struct cs_energy_with_scale energy; /* that the last commit with a push has left */
    double absorbed;                    /* J, of kinetic energy by the pushes of this commit */
    double energy_limit; /* J: what there was before anything touched, or was added since */
    bool has_last_energy,
        in_contact; /* energy is that of the state before; most is of this contact */
    uint64_t
        n_scaled_commits; /* commits in which pushes were cut to the energy that was there */
};

/* One commit with a push. */
struct cs_projection_step {
    double t, dt;
    const struct cs_posed_collider *colliders;
    const double *before_step; /* (6,n) the state before the step */
    const double *x, *v;       /* (3,n) as the step has left them */
    double *corrected;         /* (6,n) as the pushes leave them */
    const bool *is_pushed; /* (n) particles that are where they have to be: pushed or held */
};

/* Takes the arrays from arena. CS_ERR_MEMORY. */
enum cs_status cs_projection_energy_init(struct cs_projection_energy *balance,
                                         struct cs_system *system, struct cs_arena *arena,
                                         struct cs_error *error);

/* Corrects blow->to as said above. false: particles are left behind a surface. */
bool cs_projection_energy_limit(struct cs_projection_energy *balance,
                                const struct cs_projection_step *blow);

/* What it leaves to the next commit, for a checkpoint. */
void cs_projection_energy_serialise(struct cs_projection_energy *balance,
                                    struct cs_serialiser *record);

#endif

/* stick.h - particles that friction holds on an obstacle at rest: pinned until the load on them
 * leaves the cone of friction.
 *
 * A push after each step cannot hold them by itself: within a step they would fall, the springs
 * would follow, and what a method remembers of the fall would come back in the steps after. So
 * a particle that a commit has brought to rest altogether takes no part in the steps that
 * follow (Baraff, Witkin 1998, sec. 5: constraints), while
 *   N > 0 and |T| <= mu N
 * with N, T the load on it, along the inward normal and across: the force at the end of the
 * step, and what would have moved it in the step if it were free.
 */
#ifndef CS_STICK_H
#define CS_STICK_H

#include "base/record.h"
#include "model/commit/pins.h"
#include "model/contact/obstacle.h"

struct cs_stick {
    struct cs_system *system; /* borrowed */
    struct cs_pins pins;
    uint32_t *on; /* (n) number of the obstacle that it rests on + 1; 0: none */
    bool *held;   /* (n) */
    double *load; /* (3,n) in N */
    uint32_t n;   /* held */
    bool off;     /* the method's model has other forces than those of the system */
};

/* Takes the arrays from arena. CS_ERR_MEMORY. */
enum cs_status cs_stick_init(struct cs_stick *stick, struct cs_system *system,
                             struct cs_arena *arena, struct cs_error *error);

/* Pins the held particles, and unpins them: pinned within steps, free for all that follows a
 * step and all that looks on. */
void cs_stick_pin(struct cs_stick *stick);
void cs_stick_unpin(struct cs_stick *stick);

/* Puts the held particles back to where they were, `last` (3,n), at rest; what had moved them
 * in dt is load. true: one was moved. */
bool cs_stick_restore(struct cs_stick *stick, double dt, const double *last, double *x,
                      double *v);

/* Those whose `on` was set in this commit are not at rest after all. */
void cs_stick_reject(struct cs_stick *stick);

/* Decides at (x, v) at t who is held from now on, of those held and of those whose `on` was set
 * in this commit. f (3,n) is work. true: others than before. */
bool cs_stick_choose(struct cs_stick *stick, const struct cs_obstacle *obstacles, double t,
                     const double *x, const double *v, double *f);

/* Decides it at the start of a run or after an event: of those at rest on a surface. */
void cs_stick_start(struct cs_stick *stick, const struct cs_obstacle *obstacles, double t,
                    const double *x, const double *v, double *f);

/* Nobody is held: the state or the system was changed from outside. */
void cs_stick_forget(struct cs_stick *stick);

/* What it leaves to the next commit, for a checkpoint. */
void cs_stick_record(struct cs_stick *stick, struct cs_record *record);

#endif

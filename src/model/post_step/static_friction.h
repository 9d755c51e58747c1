/* static_friction.h - particles that friction holds on an obstacle at rest: pinned until the
 * load on them leaves the cone of friction.
 *
 * A push after each step cannot hold them by itself: within a step they would fall, the springs
 * would follow, and what a method remembers of the fall would come back in the steps after. So
 * a particle that a commit has brought to rest altogether takes no part in the steps that
 * follow (Baraff, Witkin 1998, sec. 5: constraints), while
 *   N > 0 and |T| <= mu N
 * with N, T the load on it, along the inward normal and across: the force at the end of the
 * step, and what would have moved it in the step if it were free.
 */
#ifndef CS_STATIC_FRICTION_H
#define CS_STATIC_FRICTION_H

#include "base/serialise.h"
#include "model/contact/posed_collider.h"
#include "model/post_step/temporary_pins.h"

struct cs_static_friction {
    struct cs_system *system; /* borrowed */
    struct cs_temporary_pins pins;
    uint32_t *resting_on; /* (n) number of the obstacle that it rests on + 1; 0: none */
    bool *is_sticking;    /* (n) */
    double *load;         /* (3,n) in N */
    uint32_t n_sticking;  /* held */
    bool disabled;        /* the method's model has other forces than those of the system */
};

/* Takes the arrays from arena. CS_ERR_MEMORY. */
enum cs_status cs_static_friction_init(struct cs_static_friction *stick,
                                       struct cs_system *system, struct cs_arena *arena,
                                       struct cs_error *error);

/* Pins the held particles, and unpins them: pinned within steps, free for all that follows a
 * step and all that looks on. */
void cs_static_friction_pin(struct cs_static_friction *stick);
void cs_static_friction_unpin(struct cs_static_friction *stick);

/* Puts the held particles back to where they were, `last` (3,n), at rest; what had moved them
 * in dt is load. true: one was moved. */
bool cs_static_friction_restore(struct cs_static_friction *stick, double dt, const double *last,
                                double *x, double *v);

/* Those whose `on` was set in this commit are not at rest after all. */
void cs_static_friction_reject(struct cs_static_friction *stick);

/* Decides at (x, v) at t who is held from now on, of those held and of those whose `on` was set
 * in this commit. f (3,n) is work. true: others than before. */
bool cs_static_friction_update(struct cs_static_friction *stick,
                               const struct cs_posed_collider *colliders, double t,
                               const double *x, const double *v, double *f);

/* Decides it at the start of a run or after an event: of those at rest on a surface. */
void cs_static_friction_start(struct cs_static_friction *stick,
                              const struct cs_posed_collider *colliders, double t,
                              const double *x, const double *v, double *f);

/* Nobody is held: the state or the system was changed from outside. */
void cs_static_friction_clear(struct cs_static_friction *stick);

/* What it leaves to the next commit, for a checkpoint. */
void cs_static_friction_serialise(struct cs_static_friction *stick,
                                  struct cs_serialiser *record);

#endif

/* blocked_step.h - the last step that was rejected, to report where a method that gives up was
 * stopped, and what would have held there. */
#ifndef CS_BLOCKED_STEP_H
#define CS_BLOCKED_STEP_H

#include "base/text.h"
#include "model/system/particle_system.h"

/* Both ends of the last step that was tested. */
struct cs_blocked_step {
    /* times in s; positions (2,3,n) in m, NULL if the scene does not limit steps */
    double t[2], *x;
    /* it was rejected */
    bool is_set;
};

/* Allocates memory in the arena if the scene limits steps. CS_ERR_MEMORY. */
enum cs_status cs_blocked_step_init(struct cs_blocked_step *blocked,
                                    const struct cs_system *system, struct cs_arena *arena,
                                    struct cs_error *error);

/* Stores a step from x[0] (3,n) at t[0] to x[1] at t[1] with the fraction that methods were
 * given; a fraction of 1 forgets the last one. */
void cs_blocked_step_store(struct cs_blocked_step *blocked, const struct cs_system *system,
                           const double t[2], const double *const x[2], double share);

/* Asks the questions of cs_step_limit_fraction again and appends what rejected the stored step:
 * "; there ... would cross ..." or "; there ... comes to ...", with the distance, the energy
 * that contact takes up there, the energy that comes, and the stiffness or range that would
 * hold it. Appends nothing if no step is stored. */
void cs_blocked_step_print(const struct cs_blocked_step *blocked,
                           const struct cs_system *system, struct cs_text *out);

#endif

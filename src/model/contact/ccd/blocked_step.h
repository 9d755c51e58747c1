/* blocked_step.h - the last step that was rejected for a collision, to report the place where a
 * method that gives up was stopped. */
#ifndef CS_BLOCKED_STEP_H
#define CS_BLOCKED_STEP_H

#include "base/text.h"
#include "model/system/system.h"

/* Both ends of the last step that was tested. */
struct cs_blocked_step {
    /* times in s; positions (2,3,n) in m, NULL if the scene does not limit crossings */
    double t[2], *x;
    /* it was rejected */
    bool is_set;
};

/* Allocates memory in the arena if the scene limits crossings. CS_ERR_MEMORY. */
enum cs_status cs_blocked_step_init(struct cs_blocked_step *blocked,
                                    const struct cs_system *system, struct cs_arena *arena,
                                    struct cs_error *error);

/* Stores a step from x[0] (3,n) at t[0] to x[1] at t[1] with the fraction that methods were
 * given; a fraction of 1 forgets the last one. */
void cs_blocked_step_store(struct cs_blocked_step *blocked, const struct cs_system *system,
                           const double t[2], const double *const x[2], double share);

/* Appends "; ... would cross ..." with the two primitives that meet first in the stored step.
 * Appends nothing if there is none, or the system is too large for a test of all pairs. */
void cs_blocked_step_print(const struct cs_blocked_step *blocked,
                           const struct cs_system *system, struct cs_text *out);

#endif

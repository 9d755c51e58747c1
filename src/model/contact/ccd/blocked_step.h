/* blocked_step.h - the last move that was refused since surfaces would meet, to say where a
 * method that gives up was stopped. */
#ifndef CS_BLOCKED_STEP_H
#define CS_BLOCKED_STEP_H

#include "base/text.h"
#include "model/system/system.h"

struct cs_blocked_step {
    double t[2], *x; /* both ends; x (2,3,n), NULL where crossings limit nothing */
    bool is_set;     /* the last move that was asked about was refused */
};

/* Memory from the arena, where the scene limits crossings. CS_ERR_MEMORY. */
enum cs_status cs_blocked_step_init(struct cs_blocked_step *blocked,
                                    const struct cs_system *system, struct cs_arena *arena,
                                    struct cs_error *error);

/* A move from x0 (3,n) at t0 to x1 at t1, of which methods were told a share. */
void cs_blocked_step_store(struct cs_blocked_step *blocked, const struct cs_system *system,
                           const double t[2], const double *const x[2], double share);

/* Adds "; ... would cross ..." of the two parts that meet first in the move; nothing where
 * there is none, or the system is so large that looking through all pairs takes minutes. */
void cs_blocked_step_print(const struct cs_blocked_step *blocked,
                           const struct cs_system *system, struct cs_text *out);

#endif

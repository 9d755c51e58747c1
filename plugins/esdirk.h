/* esdirk.h - diagonally implicit pairs in Nystrom form, with error control: see esdirk.c. */
#ifndef ESDIRK_H
#define ESDIRK_H

#include "nystrom.h"

/* newton_rtol 0: rtol is relative to the impulse of a stage, as in newton.h. */
struct esdirk_options {
    double rtol, atol, dt_max;
    int64_t max_steps;
    double dt, newton_rtol;
    int64_t iterations;
};

/* The rows; methods without implicit stages have the first ones alone. */
#define ESDIRK_EXPLICIT_ROWS                                                                   \
    ADAPTIVE_ROWS(struct esdirk_options, 1e-4),                                                \
        CS_OPTION(struct esdirk_options, dt, "s", 0, 0, 10,                                    \
                  "step without error control, rtol then being that of the stages; 0: by the " \
                  "error")
#define ESDIRK_ITERATIONS_ROW                                                                  \
    CS_OPTION(struct esdirk_options, iterations, "", 10, 1, 1000,                              \
              "maximum Newton iterations of a stage; then the step is shortened")
#define ESDIRK_ROWS                                                                            \
    ESDIRK_EXPLICIT_ROWS,                                                                      \
        CS_OPTION(struct esdirk_options, newton_rtol, "", 0.05, 1e-14, 1,                      \
                  "residual of a stage, as a velocity, relative to the tolerance"),            \
        ESDIRK_ITERATIONS_ROW

/* The part of the options that adaptive_step.h knows. */
struct adaptive_options esdirk_adaptive_options(const struct esdirk_options *asked);

/* Calls of the descriptor. The first stage of the pair is explicit and at the begin of the
 * step, and no diagonal is negative. */
enum cs_step esdirk_create(const struct cs_host *host, const struct esdirk_options *asked,
                           const struct nystrom_pair *pair, void **out);
enum cs_step esdirk_restart(void *self, double t, const double *x, const double *v);
enum cs_step esdirk_archive(void *self, const struct cs_archive *archive);
void esdirk_stats(const void *self, struct cs_stats *out);

#define ESDIRK_METHOD(rows_)                                                                   \
    .size = sizeof(struct cs_integrator), .fidelity = CS_FIDELITY_ODE,                         \
    .needs = CS_NEED_ENERGY | CS_NEED_SOLVE | CS_NEED_LAGGED_FRICTION, .options = rows_,       \
    .n_options = sizeof rows_ / sizeof rows_[0],                                               \
    .options_size = sizeof(struct esdirk_options), .restart = esdirk_restart,                  \
    .advance = adaptive_step_advance, .stats = esdirk_stats, .save = esdirk_archive,           \
    .load = esdirk_archive

#endif

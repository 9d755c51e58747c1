/* chebyshev_step.h - the common part of methods whose stages lie along the negative real axis:
 * D_j, the difference of stage j from the state at the begin, of which two are kept; and the
 * spectral radius, which decides the number of stages. */
#ifndef CHEBYSHEV_STEP_H
#define CHEBYSHEV_STEP_H

#include "adaptive_step.h"
#include "spectral_radius.h"

/* A method's own struct starts with this. */
struct chebyshev_step {
    struct adaptive_step base;
    struct spectral_radius spectrum;
    double radius;        /* 1/s, at the state */
    double *last, *older; /* (6n) D_(j-1) and D_(j-2) */
    double *a;            /* (3,n) in m/s2 at a stage, at last at the new state */
};

/* Allocates the arrays and takes options; power: that of the local error in h. [create] */
enum cs_step chebyshev_step_init(struct chebyshev_step *self, const struct cs_host *host,
                                 const void *options, int power);

/* Sets the radius at the state, estimated again after a step that was rejected: too few stages
 * blow up. */
void chebyshev_step_find_radius(struct chebyshev_step *self, double t, const double *y);

/* a (3,n) in m/s2 at the stage in base.next, at t. */
void chebyshev_step_evaluate(const struct chebyshev_step *self, double t, double *a);

/* The coefficients of a stage: D_j = last D_(j-1) + older D_(j-2) + new F_(j-1) + old F_0, F
 * the slopes; the last two have h in them. */
struct chebyshev_stage {
    double last, older, new, old;
};

/* The next D_j from a (3,n), the acceleration at the stage before; leaves it in self->last,
 * and its state in base.next. */
void chebyshev_step_take(struct chebyshev_step *self, struct chebyshev_stage of,
                         const double *y, const double *a);

/* Calls of the descriptor. */
enum cs_step chebyshev_step_restart(void *self, double t, const double *x, const double *v);
enum cs_step chebyshev_step_archive(void *self, const struct cs_archive *archive);

#define CHEBYSHEV_METHOD(rows_)                                                                \
    ADAPTIVE_METHOD_OF(struct adaptive_options, rows_, chebyshev_step_restart,                 \
                       chebyshev_step_archive)

#endif

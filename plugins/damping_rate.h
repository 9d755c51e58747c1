/* damping_rate.h - the largest rate at which the dampers within bodies damp, by the power
 * method: bounds by sums over a particle's dampers are far above it, as these have directions.
 *
 * The rates are the eigenvalues of M^-1 D, D = -df/dv of CS_PART_INTERNAL:
 *   q = M^-1 D p,  lambda = |q| / |p|,  p <- q / |q|
 * Estimates are nearly always too small; a fifth is added (Sommeijer, Shampine, Verwer 1998,
 * sec. 3). */
#ifndef DAMPING_RATE_H
#define DAMPING_RATE_H

#include <clothsim/integrator.h>
#include <stdbool.h>

/* Zeroed: nothing is known. */
struct damping_rate {
    double *p, *q;   /* (3,n) the direction; work */
    double estimate; /* 1/s, with what is added; 0: none yet */
    uint64_t age;    /* steps that it was used for */
};

/* Allocates the arrays; false: out of memory, reported. [create] */
bool damping_rate_init(struct damping_rate *self, const struct cs_host *host);

/* Forgets estimate and direction. [restart] */
void damping_rate_restart(struct damping_rate *self, const struct cs_view *view);

/* The rate at (t, x, v) in 1/s: the estimate made some steps ago, or, with `again`, a new one.
 * An estimate starts from the direction of the last one, and costs a jvp a turn. Needs
 * CS_NEED_JVP. [advance] */
double damping_rate_at(struct damping_rate *self, const struct cs_host *host, double t,
                       const double *x, const double *v, bool again);

/* save and load. */
void damping_rate_archive(struct damping_rate *self, const struct cs_host *host,
                          const struct cs_archive *archive);

#endif

/* spectral_radius.h - how far the eigenvalues of the motion at a state reach, for methods whose
 * stages lie along the negative real axis.
 *
 * With bounds omega and delta, roots of z^2 + 2 delta z + omega^2 have moduli of max(2 delta,
 * omega) at most. The bound delta sums over a particle's dampers, which have directions: where
 * it rules, the largest rate of the dampers within bodies is estimated by the power method, and
 * the bound stands for contact alone. With D = -df/dv of CS_PART_INTERNAL:
 *   q = M^-1 D p,  lambda = |q| / |p|,  p <- q / |q|
 * Estimates are nearly always too small; a fifth is added (Sommeijer, Shampine, Verwer 1998,
 * sec. 3). */
#ifndef SPECTRAL_RADIUS_H
#define SPECTRAL_RADIUS_H

#include <clothsim/integrator.h>
#include <stdbool.h>

/* Zeroed: nothing is known. */
struct spectral_radius {
    const struct cs_host *host; /* borrowed */
    double *p, *q;              /* (3,n) the direction; work */
    double omega, delta;        /* 1/s: the bounds at the last state */
    double rate;                /* 1/s: the estimate, with what is added; 0: none yet */
    uint64_t age;               /* steps that it was used for */
};

/* Allocates the arrays; false: out of memory, reported. [create] */
bool spectral_radius_init(struct spectral_radius *self, const struct cs_host *host);

/* Forgets estimate and direction. [restart] */
void spectral_radius_restart(struct spectral_radius *self);

/* The radius at (t, x, v) in 1/s. An estimate is used for some steps, or, with `again`, made
 * again; it starts from the direction of the last one, and costs a jvp a turn. Needs
 * CS_NEED_JVP. [advance] */
double spectral_radius_at(struct spectral_radius *self, double t, const double *x,
                          const double *v, bool again);

/* save and load. */
void spectral_radius_archive(struct spectral_radius *self, const struct cs_archive *archive);

#endif

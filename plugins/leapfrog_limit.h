/* leapfrog_limit.h - the step limit that symplectic Euler and its relatives share. */
#ifndef LEAPFROG_LIMIT_H
#define LEAPFROG_LIMIT_H

#include <clothsim/integrator.h>
#include <math.h>

/* The positive root h of h^2 w^2 + q r h = s, with the frequency w = omega and the damping
 * rate r = 2 delta; HUGE_VAL if both are 0. Symplectic Euler has q = 2, s = 4. The form 2 s /
 * (q r + sqrt(...)) has no cancellation when damping dominates. */
static inline double leapfrog_limit(double omega, double delta, double q, double s) {
    const double w = omega, qr = q * 2 * delta;
    return 2 * s / (qr + sqrt(qr * qr + 4 * s * w * w));
}

#endif

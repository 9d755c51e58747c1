/* leapfrog_limit.h - the step limit that symplectic Euler and its relatives share. */
#ifndef LEAPFROG_LIMIT_H
#define LEAPFROG_LIMIT_H

#include <clothsim/integrator.h>
#include <math.h>

/* Root h of h^2 w^2 + q r h = s with the frequency w = omega and the damping rate r = 2 delta;
 * HUGE_VAL where nothing limits the step. Symplectic Euler: q = 2, s = 4. */
static inline double leapfrog_limit(double omega, double delta, double q, double s) {
    const double w = omega, qr = q * 2 * delta;
    return 2 * s / (qr + sqrt(qr * qr + 4 * s * w * w));
}

#endif

/* leapfrog_limit.h - the step limit that symplectic Euler and its relatives share. */
#ifndef LEAPFROG_LIMIT_H
#define LEAPFROG_LIMIT_H

#include <clothsim/integrator.h>
#include <math.h>

/* Root h of h^2 w^2 + q r h = s, with the view's bounds for the frequency w and the damping
 * rate r; HUGE_VAL where nothing limits the step. Symplectic Euler: q = 2, s = 4. */
static inline double leapfrog_limit(const struct cs_view *view, double q, double s) {
    const double w = view->omega, qr = q * 2 * view->delta;
    return 2 * s / (qr + sqrt(qr * qr + 4 * s * w * w));
}

#endif

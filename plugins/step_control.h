/* step_control.h - the choice of the next step from an error estimate, by a PI controller.
 *
 * With the error e of a step in units of the tolerance and a method whose estimate is of order
 * four (local error h^5), r = e^(1/5) is how many times the step was too long, and
 *   h' = 0.9 h (r_old / r^3)^(1/4)
 * (Gustafsson 1991, with 1/2 and 1/4 for the integral and the proportional part, so that the
 * powers are square roots: they have the same bits everywhere, pow has not).
 */
#ifndef STEP_CONTROL_H
#define STEP_CONTROL_H

#include <math.h>
#include <stdbool.h>

#define STEP_SHRINK 0.2 /* least factor of a step after a rejection */
#define STEP_GROW   5   /* largest factor of a step after a success */
#define STEP_SAFETY 0.9

struct step_control {
    double h;               /* s, the next step to try */
    double last_error_root; /* r of the last accepted step of free length; 0: none */
    bool rejected;          /* the last try was rejected: the next step must not grow */
};

/* e^(1/5) for e in 1e-12..1e12; outside the nearer end is taken. */
static inline double step_fifth_root(double e) {
    e = e < 1e-12 ? 1e-12 : e > 1e12 ? 1e12 : e;
    // e^(3/16) is within a third of it: five Newton steps leave rounding only
    double root = sqrt(sqrt(sqrt(sqrt(e * e * e))));
    for (int k = 0; k < 5; k++)
        root += (e / (root * root * root * root) - root) / 5;
    return root;
}

/* Judges a step of length h with error e in units of the tolerance; true: it is accepted.
 * cut: h was cut to meet a time, so that the step that was planned still holds. */
static inline bool step_control_judge(struct step_control *control, double h, double e,
                                      bool cut) {
    // an infinite or NaN error gives no length: the step shrinks by STEP_SHRINK
    const double root = e < HUGE_VAL ? step_fifth_root(e) : HUGE_VAL;
    if (!(e <= 1)) {
        const double factor = STEP_SAFETY / root;
        control->h = h * (factor > STEP_SHRINK ? factor : STEP_SHRINK);
        control->rejected = true;
        return false;
    }
    const double old = control->last_error_root > 0 ? control->last_error_root : root;
    double factor = STEP_SAFETY * sqrt(sqrt(old / (root * root * root)));
    factor = factor < STEP_SHRINK ? STEP_SHRINK : factor > STEP_GROW ? STEP_GROW : factor;
    if (control->rejected && factor > 1)
        factor = 1;
    control->rejected = false;
    if (cut && control->h > factor * h)
        return true;
    control->h = factor * h;
    control->last_error_root = root;
    return true;
}

#endif

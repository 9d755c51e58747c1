/* step_control.h - the choice of the next step from an error estimate, by a PI controller.
 *
 * With the error e of a step in units of the tolerance, and a local error that grows as h^k,
 * r = e^(1/k) is how many times the step was too long, and
 *   h' = 0.9 h (r_old / r^3)^(1/4)
 * (Gustafsson 1991, with 1/2 and 1/4 for the integral and the proportional part, so that the
 * powers are square roots: they have the same bits everywhere, pow has not).
 */
#ifndef STEP_CONTROL_H
#define STEP_CONTROL_H

#include <clothsim/integrator.h>
#include <math.h>

#define STEP_SHRINK 0.2 /* least factor of a step after a rejection */
#define STEP_GROW   5   /* largest factor of a step after a success */
#define STEP_SAFETY 0.9

struct step_control {
    double h;               /* s, the next step to try */
    double last_error_root; /* r of the last accepted step of free length; 0: none */
    int power;              /* k above */
    bool rejected;          /* the last try was rejected: the next step must not grow */
};

/* The error that a step may have in a number y: absolute + rtol |y|. */
struct tolerance {
    double rtol, length, speed; /* 1; absolute in m and in m/s */
};

/* atol: an absolute one in m and m/s; 0: rtol of the scene's length and speed. */
static inline struct tolerance tolerance_of(const struct cs_host *host, double rtol,
                                            double atol) {
    const bool scales = atol <= 0 && CS_HAS(host, speed_scale);
    const double either = atol > 0 ? atol : rtol;
    return (struct tolerance){rtol, scales ? rtol * host->length_scale : either,
                              scales ? rtol * host->speed_scale : either};
}

/* weight (6n) = 1 / tolerance of the larger of y and z (6n), positions before velocities. */
CS_CLONES static inline void tolerance_weigh(const struct tolerance *tolerance, size_t n3,
                                             const double *restrict y, const double *restrict z,
                                             double *restrict weight) {
    const double rtol = tolerance->rtol;
    for (size_t half = 0; half < 2; half++) {
        const double absolute = half ? tolerance->speed : tolerance->length;
        for (size_t i = half * n3; i < (half + 1) * n3; i++) {
            const double begin = fabs(y[i]), end = fabs(z[i]);
            weight[i] = 1 / (absolute + rtol * (begin > end ? begin : end));
        }
    }
}

/* e^(1/power) for e in 1e-12..1e12 and a power of 2 to 12; outside the nearer end is taken. */
static inline double step_root(double e, int power) {
    e = e < 1e-12 ? 1e-12 : e > 1e12 ? 1e12 : e;
    // a product of e^(1/2), e^(1/4), ... e^(1/64): 1/power in binary, cut after six digits
    double digit = e, rest = 1, root = 1;
    for (int k = 0; k < 6; k++) {
        digit = sqrt(digit);
        rest *= 2;
        if (rest >= power) {
            root *= digit;
            rest -= power;
        }
    }
    // e^(1/64) is at most 1.54: six Newton steps leave rounding only
    for (int k = 0; k < 6; k++) {
        double slope = 1;
        for (int j = 1; j < power; j++)
            slope *= root;
        root += (e / slope - root) / power;
    }
    return root;
}

/* Judges a step of length h with error e in units of the tolerance; true: it is accepted.
 * cut: h was cut to meet a time, so that the step that was planned still holds. */
static inline bool step_control_judge(struct step_control *control, double h, double e,
                                      bool cut) {
    // an infinite or NaN error gives no length: the step shrinks by STEP_SHRINK
    const double root = e < HUGE_VAL ? step_root(e, control->power) : HUGE_VAL;
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

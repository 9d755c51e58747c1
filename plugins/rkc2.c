/* rkc2.c - the explicit Runge-Kutta-Chebyshev method of order 2 with error control, for
 * springs whose damping limits the step.
 *
 * Its s stages reach 0.653 (s^2 - 1) along the negative real axis, where strong dampers have
 * their eigenvalues: s evaluations take a step s / 3 times as long as s steps of Euler would.
 * With w0 = 1 + (2/13) / s^2, w1 = T_s'(w0) / T_s''(w0), b_j = T_j''(w0) / T_j'(w0)^2,
 * b_0 = b_1 = b_2, and D_j the difference of stage j from the state y at the begin:
 *   D_0 = 0,  D_1 = b_1 w1 h F_0,
 *   D_j = 2 w0 b_j/b_(j-1) D_(j-1) - b_j/b_(j-2) D_(j-2)
 *         + 2 w1 b_j/b_(j-1) h (F_(j-1) - (1 - b_(j-1) T_(j-1)(w0)) F_0)
 * F_j is F at y + D_j and at t + w1 T_j''/T_j' h. The error of y + D_s is
 * (2/5) h (F_0 + F_s) - (4/5) D_s, which falls as h^3.
 *
 * s follows from the step and from the spectral radius at the state.
 *
 * Source: Sommeijer, Shampine, Verwer 1998. */
#include "chebyshev_step.h"

#include <clothsim/clones.h>

enum { STAGES_MAX = 250 };
#define REACH   0.65 /* of s stages on the real axis, divided by s^2 - 1; a little below */
#define DAMPING (2.0 / 13)

/* T_j, T_j' and T_j'' at w0, for j and j - 1; T is Chebyshev's polynomial. */
struct chebyshev {
    double value[2], first[2], second[2];
};

static void chebyshev_next(struct chebyshev *t, double w0) {
    const struct chebyshev old = *t;
    t->value[0] = 2 * w0 * old.value[0] - old.value[1];
    t->first[0] = 2 * old.value[0] + 2 * w0 * old.first[0] - old.first[1];
    t->second[0] = 4 * old.first[0] + 2 * w0 * old.second[0] - old.second[1];
    t->value[1] = old.value[0];
    t->first[1] = old.first[0];
    t->second[1] = old.second[0];
}

/* j = 1 */
static struct chebyshev chebyshev_first(double w0) {
    return (struct chebyshev){{w0, 1}, {1, 0}, {0, 0}};
}

/* The stages of a step; leaves the new state in base.next and D_s in self->last. */
static void take_stages(struct chebyshev_step *self, double t, double h, int stages,
                        const double *y) {
    const double w0 = 1 + DAMPING / ((double)stages * stages);
    struct chebyshev at = chebyshev_first(w0);
    for (int j = 2; j <= stages; j++)
        chebyshev_next(&at, w0);
    const double w1 = at.first[0] / at.second[0], b2 = 1 / (4 * w0 * w0);
    double b[3] = {b2, b2, b2}; /* b_j, b_(j-1), b_(j-2) */
    at = chebyshev_first(w0);
    for (size_t k = 0; k < self->base.length; k++)
        self->last[k] = self->older[k] = 0;
    chebyshev_step_take(self, (struct chebyshev_stage){0, 0, b2 * w1 * h, 0}, y,
                        self->base.slope);
    double node = w1 / (4 * w0 * w0); /* c_1 = c_2 / T_2'(w0), c_2 = w1 / w0 */
    for (int j = 2; j <= stages; j++) {
        const double rest = 1 - b[1] * at.value[0];
        chebyshev_step_evaluate(self, t + node * h, self->a);
        chebyshev_next(&at, w0);
        b[0] = at.second[0] / (at.first[0] * at.first[0]);
        const double slope = 2 * w1 * b[0] / b[1] * h;
        chebyshev_step_take(
            self,
            (struct chebyshev_stage){2 * w0 * b[0] / b[1], -b[0] / b[2], slope, -rest * slope},
            y, self->a);
        node = w1 * at.second[0] / at.first[0];
        b[2] = b[1];
        b[1] = b[0];
    }
}

CS_CLONES static void error_row(size_t n, double h, const double *restrict f0,
                                const double *restrict f1, double *restrict error) {
    for (size_t i = 0; i < n; i++)
        error[i] = 0.4 * h * (f0[i] + f1[i]) - 0.8 * error[i];
}

static enum cs_step attempt(struct adaptive_step *base, double t, double h, const double *y,
                            double *error) {
    struct chebyshev_step *self = (struct chebyshev_step *)base;
    const size_t half = base->length / 2;
    const double stages = 1 + floor(sqrt(1 + h * self->radius / REACH));
    take_stages(self, t, h, stages < 2 ? 2 : (int)stages, y);
    chebyshev_step_evaluate(self, t + h, self->a);
    error_row(half, h, y + half, base->next + half, self->last);
    error_row(half, h, base->slope, self->a, self->last + half);
    adaptive_step_weigh(base, y, base->next);
    *error = adaptive_step_norm(base, self->last);
    return CS_STEP_OK;
}

/* The step that the most stages reach, in s. */
static double limit(struct adaptive_step *base, double t, const double *y) {
    struct chebyshev_step *self = (struct chebyshev_step *)base;
    const double most = STAGES_MAX - 1;
    chebyshev_step_find_radius(self, t, y);
    return self->radius > 0 ? REACH * (most * most - 1) / self->radius : HUGE_VAL;
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    struct chebyshev_step *self = host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->base.attempt = attempt;
    self->base.limit = limit;
    return chebyshev_step_init(self, host, options, 3);
}

static const struct cs_option rows[] = {ADAPTIVE_ROWS(struct adaptive_options, 1e-4)};

/* the error of a step falls as h^3, and with it that of the run as rtol^(2/3) */
static const char *const below_tolerance[] = {"solution", "tolerance", NULL};

static const struct cs_integrator rkc2 = {
    CHEBYSHEV_METHOD(rows),
    .name = "rkc2",
    .summary = "explicit Chebyshev stages, order 2 with error control: for strong damping",
    .source = "Sommeijer, Shampine, Verwer 1998",
    .order = 2,
    .order_damped = 2,
    .traits = CS_ADAPTIVE,
    .needs = CS_NEED_JVP,
    .fails = below_tolerance,
    .create = create,
};

static const struct cs_integrator *const integrators[] = {&rkc2};

CS_EXPORT const struct cs_module clothsim_module = {
    .abi = CS_ABI,
    .size = sizeof(struct cs_integrator),
    .n = sizeof integrators / sizeof integrators[0],
    .integrators = integrators,
};

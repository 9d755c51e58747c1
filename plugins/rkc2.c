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
#include "adaptive_step.h"
#include "parallel.h"
#include "spectral_radius.h"

enum { STAGES_MAX = 250 };
#define REACH   0.65 /* of s stages on the real axis, divided by s^2 - 1; a little below */
#define DAMPING (2.0 / 13)

struct rkc2 {
    struct adaptive_step base;
    struct spectral_radius spectrum;
    double radius;        /* 1/s, at the state */
    double *last, *older; /* (6n) D_(j-1) and D_(j-2) */
    double *a;            /* (3,n) in m/s2 at a stage, at last at the new state */
};

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

/* The coefficients of a stage: D_j = last D_(j-1) + older D_(j-2) + h (new F_(j-1) + old F_0).
 */
struct stage {
    double last, older, new, old;
};

/* One row of the state: positions with the velocities as slopes, and velocities. */
struct row {
    size_t count;
    struct stage of; /* with h in new and old */
    const double *x0, *v0, *a0, *a;
    double *x, *v;         /* of the stage */
    double *dx[2], *dv[2]; /* D_(j-1), and D_(j-2), which becomes D_j */
};

CS_CLONES static void stage_row(const struct row *row) {
    const struct stage of = row->of;
    const double *restrict x0 = row->x0, *restrict v0 = row->v0;
    const double *restrict a0 = row->a0, *restrict a = row->a;
    const double *restrict dx = row->dx[0], *restrict dv = row->dv[0];
    double *restrict x = row->x, *restrict v = row->v;
    double *restrict ex = row->dx[1], *restrict ev = row->dv[1];
    for (size_t i = 0; i < row->count; i++) {
        ex[i] = of.last * dx[i] + of.older * ex[i] + of.new *(v0[i] + dv[i]) + of.old *v0[i];
        ev[i] = of.last * dv[i] + of.older * ev[i] + of.new *a[i] + of.old *a0[i];
        x[i] = x0[i] + ex[i];
        v[i] = v0[i] + ev[i];
    }
}

/* The arguments of a stage on the host's threads. */
struct job {
    const struct rkc2 *self;
    struct stage of;
    const double *y, *a;
};

static void stage_part(void *arg, size_t begin, size_t end) {
    const struct job *job = arg;
    const struct rkc2 *self = job->self;
    const size_t v = self->base.length / 2 + begin;
    stage_row(&(struct row){.count = end - begin,
                            .of = job->of,
                            .x0 = job->y + begin,
                            .v0 = job->y + v,
                            .a0 = self->base.slope + begin,
                            .a = job->a + begin,
                            .x = self->base.next + begin,
                            .v = self->base.next + v,
                            .dx = {self->last + begin, self->older + begin},
                            .dv = {self->last + v, self->older + v}});
}

/* The next D_j from a (3,n), the acceleration at the stage before; leaves it in self->last,
 * and its state in base.next. */
static void take_stage(struct rkc2 *self, struct stage of, const double *y, const double *a) {
    struct job job = {self, of, y, a};
    parallel_for(self->base.host, self->base.length / 2, stage_part, &job);
    double *swapped = self->last;
    self->last = self->older;
    self->older = swapped;
}

/* Evaluates the acceleration at the last stage, at t. */
static void evaluate(struct rkc2 *self, double t) {
    const double *x = self->base.next;
    adaptive_step_evaluate(&self->base, t, x, x + self->base.length / 2, self->a);
}

/* The stages of a step; leaves the new state in base.next and D_s in self->last. */
static void take_stages(struct rkc2 *self, double t, double h, int stages, const double *y) {
    const double w0 = 1 + DAMPING / ((double)stages * stages);
    struct chebyshev at = chebyshev_first(w0);
    for (int j = 2; j <= stages; j++)
        chebyshev_next(&at, w0);
    const double w1 = at.first[0] / at.second[0], b2 = 1 / (4 * w0 * w0);
    double b[3] = {b2, b2, b2}; /* b_j, b_(j-1), b_(j-2) */
    at = chebyshev_first(w0);
    for (size_t k = 0; k < self->base.length; k++)
        self->last[k] = self->older[k] = 0;
    take_stage(self, (struct stage){0, 0, b2 * w1 * h, 0}, y, self->base.slope);
    double node = w1 / (4 * w0 * w0); /* c_1 = c_2 / T_2'(w0), c_2 = w1 / w0 */
    for (int j = 2; j <= stages; j++) {
        const double rest = 1 - b[1] * at.value[0];
        evaluate(self, t + node * h);
        chebyshev_next(&at, w0);
        b[0] = at.second[0] / (at.first[0] * at.first[0]);
        const double slope = 2 * w1 * b[0] / b[1] * h;
        take_stage(self,
                   (struct stage){2 * w0 * b[0] / b[1], -b[0] / b[2], slope, -rest * slope}, y,
                   self->a);
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
    struct rkc2 *self = (struct rkc2 *)base;
    const size_t half = base->length / 2;
    const double stages = 1 + floor(sqrt(1 + h * self->radius / REACH));
    take_stages(self, t, h, stages < 2 ? 2 : (int)stages, y);
    evaluate(self, t + h);
    error_row(half, h, y + half, base->next + half, self->last);
    error_row(half, h, base->slope, self->a, self->last + half);
    adaptive_step_weigh(base, y, base->next);
    *error = adaptive_step_norm(base, self->last);
    return CS_STEP_OK;
}

/* The last evaluation is at the new state. */
static bool accept(struct adaptive_step *base) {
    struct rkc2 *self = (struct rkc2 *)base;
    double *old = base->slope;
    base->slope = self->a;
    self->a = old;
    return true;
}

/* The step that the most stages reach, in s; sets the radius at the state. It is estimated
 * again after a step that was rejected, as too few stages blow up. */
static double limit(struct adaptive_step *base, double t, const double *y) {
    struct rkc2 *self = (struct rkc2 *)base;
    const double most = STAGES_MAX - 1;
    self->radius =
        spectral_radius_at(&self->spectrum, t, y, y + base->length / 2, base->control.rejected);
    return self->radius > 0 ? REACH * (most * most - 1) / self->radius : HUGE_VAL;
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    struct rkc2 *self = host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->base.attempt = attempt;
    self->base.accept = accept;
    self->base.limit = limit;
    if (!spectral_radius_init(&self->spectrum, host))
        return CS_STEP_FAIL;
    if (adaptive_step_init(&self->base, host, options, 3) != CS_STEP_OK)
        return CS_STEP_FAIL;
    double **const arrays[] = {&self->last, &self->older, &self->a};
    for (int k = 0; k < 3; k++)
        if (!(*arrays[k] =
                  (double *)host->alloc(host->ctx, self->base.length * sizeof(double))))
            return CS_STEP_FAIL;
    return CS_STEP_OK;
}

static enum cs_step restart(void *object, double t, const double *x, const double *v) {
    struct rkc2 *self = object;
    spectral_radius_restart(&self->spectrum);
    return adaptive_step_restart(object, t, x, v);
}

static enum cs_step archive(void *object, const struct cs_archive *archive) {
    struct rkc2 *self = object;
    spectral_radius_archive(&self->spectrum, archive);
    return adaptive_step_archive(object, archive);
}

static const struct cs_option rows[] = {ADAPTIVE_ROWS(struct adaptive_options, 1e-4)};

/* the error of a step falls as h^3, and with it that of the run as rtol^(2/3) */
static const char *const below_tolerance[] = {"solution", "tolerance", "contact-order", NULL};

static const struct cs_integrator rkc2 = {
    ADAPTIVE_METHOD_OF(struct adaptive_options, rows, restart, archive),
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

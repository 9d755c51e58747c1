/* rock4.c - the explicit Runge-Kutta-Chebyshev method of order 4 with error control, for
 * springs whose damping limits the step, and small errors.
 *
 * Its s stages reach 0.24 to 0.35 s^2 along the negative real axis, and their stability
 * polynomial is at most 0.95 there, away from 0. It is
 *   R(z) = w(x) P_n(x) / w(a),  x = a + z/d,  n = s - 4,
 * w of degree 4 with complex zeros, and P_j orthogonal on -1 < x < 1 with the weight
 * w^2 / sqrt(1 - x^2) and P_j(a) = 1:
 *   P_(j+1) = ((x - A) P_j - C P_(j-1)) / B,  B = a - A - C.
 * The first n stages follow this recurrence. With D_j the difference of stage j from the state
 * at the begin, q = (a - A) / B, and F_j the slope at stage j, at t + c_j h:
 *   D_0 = 0,  D_(j+1) = q D_j + (1 - q) D_(j-1) + h / (d B) F_j
 *   c_0 = 0,  c_(j+1) = q c_j + (1 - q) c_(j-1) + 1 / (d B)
 * Four stages with coefficients of their own follow, whose stability polynomial is w / w(a):
 * with them the whole has order 4. One of them is at up to t + 1.016 h. The error is a sum of
 * D_n and of h times their slopes, which falls as h^4 and is bounded in stiff modes. The slope
 * at the new state is the first of the next step.
 *
 * A, B and C follow from w and a by Stieltjes' procedure: integrals with that weight are sums
 * over the s + 1 zeros of a Chebyshev polynomial.
 *
 * s follows from the step and from the spectral radius at the state.
 * The last stages multiply rounding errors in modes near the end of the interval by w / w(a),
 * which grows as s^8. Hence the largest s.
 *
 * Source: Abdulle 2002, for the polynomials and the order of the stages. The coefficients of
 * the last stages and of the error are from tools/make_rock4.py, which says why. */
#include "rock4_table.h"

#include "chebyshev_step.h"

#include <string.h>

/* The longest step over that of the fastest oscillation. Every degree is stable for |z| < 3 to
 * the left of the imaginary axis. The bound omega is larger than the frequencies; 6 is tuned on
 * drum, swing and self_compare, where the error control finds the rest. */
#define OSCILLATION 6.0

enum { LAST = 4, GRID = ROCK4_STAGES + 1 };

/* D_(j+1) = last D_j + (1 - last) D_(j-1) + rate h F_j, F_j at t + node h. */
struct stage {
    double last, rate, node;
};

/* Zeros of a Chebyshev polynomial, their weights, and two orthogonal polynomials there. */
struct grid {
    int count;
    double x[GRID], weight[GRID], now[GRID], before[GRID];
};

struct rock4 {
    struct chebyshev_step common;
    const struct rock4_degree *degree; /* that the stages are of; NULL at first */
    struct stage stages[ROCK4_STAGES];
    double node; /* of the state after them */
    struct grid grid;
    double *slope[LAST]; /* (6n) of the last four stages: velocities and accelerations */
};

/* The sine of x in -pi/2..pi/2, by its series: the same bits everywhere. */
static double sine(double x) {
    double term = x, sum = x;
    for (int k = 2; k <= 24; k += 2) {
        term *= -x * x / (k * (k + 1));
        sum += term;
    }
    return sum;
}

static double square(double x) {
    return x * x;
}

/* The zeros and w^2 at them; P_0 = 1. zeros: real and imaginary parts of those of w, in x. */
static void grid_init(struct grid *grid, int count, const double zeros[4]) {
    const double pi = 3.14159265358979324;
    grid->count = count;
    for (int k = 0; k < count; k++) {
        const double x = sine(pi * (count - 1 - 2 * k) / (2 * count));
        grid->x[k] = x;
        grid->weight[k] = square((square(x - zeros[0]) + square(zeros[1])) *
                                 (square(x - zeros[2]) + square(zeros[3])));
        grid->now[k] = 1;
        grid->before[k] = 0;
    }
}

/* <P, P>, and A in *shift. */
static double grid_integrate(const struct grid *grid, double *shift) {
    double size = 0, moment = 0;
    for (int k = 0; k < grid->count; k++) {
        const double part = grid->weight[k] * square(grid->now[k]);
        size += part;
        moment += grid->x[k] * part;
    }
    *shift = moment / size;
    return size;
}

static void grid_next(struct grid *grid, double shift, double b, double c) {
    for (int k = 0; k < grid->count; k++) {
        const double now = grid->now[k];
        grid->now[k] = ((grid->x[k] - shift) * now - c * grid->before[k]) / b;
        grid->before[k] = now;
    }
}

/* The stages of the recurrence for a degree. */
static void set_degree(struct rock4 *self, const struct rock4_degree *degree) {
    const double d = (degree->reach - degree->begin) / 2, a = 1 + degree->begin / d;
    const double *z = degree->zeros;
    const double zeros[] = {a + z[0] / d, z[1] / d, a + z[2] / d, z[3] / d};
    grid_init(&self->grid, degree->stages + 1, zeros);
    // C is 0 at first, and the stage before the first has no weight
    double b = 0, size = 1, node = 0, older = 0;
    for (int j = 0; j < degree->stages - LAST; j++) {
        double shift, before = size;
        size = grid_integrate(&self->grid, &shift);
        const double c = b * size / before;
        b = a - shift - c;
        grid_next(&self->grid, shift, b, c);
        const struct stage stage = {(a - shift) / b, 1 / (d * b), node};
        self->stages[j] = stage;
        node = stage.last * node + (1 - stage.last) * older + stage.rate;
        older = stage.node;
    }
    self->node = node;
    self->degree = degree;
}

/* The stages of the recurrence; leaves the state after them in base.next, and its difference
 * from y in self->common.last. */
static void take_stages(struct rock4 *self, double t, double h, const double *y) {
    struct chebyshev_step *common = &self->common;
    memset(common->last, 0, common->base.length * sizeof *common->last);
    memset(common->older, 0, common->base.length * sizeof *common->older);
    for (int j = 0; j < self->degree->stages - LAST; j++) {
        const struct stage *stage = self->stages + j;
        if (j > 0)
            chebyshev_step_evaluate(common, t + stage->node * h, common->a);
        chebyshev_step_take(
            common, (struct chebyshev_stage){stage->last, 1 - stage->last, h * stage->rate, 0},
            y, j > 0 ? common->a : common->base.slope);
    }
}

/* The last stages; leaves the new state in base.next, and its acceleration in self->a. */
static void finish(struct rock4 *self, double t, double h, const double *y) {
    const struct cs_vector_kernels *vector = self->common.base.host->vector;
    const size_t half = self->common.base.length / 2;
    const double *factors = self->degree->factors;
    double *next = self->common.base.next;
    for (int i = 0; i < LAST; i++) {
        double node = self->node;
        for (int j = 0; j < i; j++)
            node += factors[j];
        chebyshev_step_evaluate(&self->common, t + node * h, self->slope[i] + half);
        memcpy(self->slope[i], next + half, half * sizeof *self->slope[i]);
        // the next row: of the stage that follows, or of the step
        factors += i;
        vector->linear_sum(2 * half, 1, y, 1, self->common.last, next);
        for (int j = 0; j <= i; j++)
            vector->linear_sum(2 * half, 1, next, h * factors[j], self->slope[j], next);
    }
    chebyshev_step_evaluate(&self->common, t + h, self->common.a);
}

static double error_of(struct rock4 *self, double h, const double *y) {
    struct adaptive_step *base = &self->common.base;
    const double *factors = self->degree->error;
    base->host->vector->linear_sum(base->length, factors[0], self->common.last, h * factors[1],
                                   self->slope[0], base->error);
    for (int j = 1; j < LAST; j++)
        base->host->vector->linear_sum(base->length, 1, base->error, h * factors[1 + j],
                                       self->slope[j], base->error);
    adaptive_step_weigh(base, y, base->next);
    return adaptive_step_norm(base, base->error);
}

static enum cs_step attempt(struct adaptive_step *base, double t, double h, const double *y,
                            double *error) {
    struct rock4 *self = (struct rock4 *)base;
    int k = 0;
    while (k < ROCK4_DEGREES - 1 && rock4_degrees[k].reach < h * self->common.radius)
        k++;
    if (self->degree != rock4_degrees + k)
        set_degree(self, rock4_degrees + k);
    take_stages(self, t, h, y);
    finish(self, t, h, y);
    *error = error_of(self, h, y);
    return CS_STEP_OK;
}

/* The step that the most stages reach, in s, or that oscillations allow; sets the radius at the
 * state, estimated again after a step that was rejected. With damping that grows as the square
 * of the frequency, as that of springs, the eigenvalues that are not real lie on a circle
 * through 0 of radius omega^2 / (2 delta); the bounds are too large by about one factor. */
static double limit(struct adaptive_step *base, double t, const double *y) {
    struct rock4 *self = (struct rock4 *)base;
    const struct spectral_radius *spectrum = &self->common.spectrum;
    chebyshev_step_find_radius(&self->common, t, y);
    if (!(self->common.radius > 0))
        return HUGE_VAL;
    const double omega = spectrum->omega, damping = 2 * spectrum->delta;
    const double real = rock4_degrees[ROCK4_DEGREES - 1].reach / self->common.radius;
    const double fastest = damping > omega ? omega * omega / damping : omega;
    return real * fastest < OSCILLATION ? real : OSCILLATION / fastest;
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    struct rock4 *self = host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->common.base.attempt = attempt;
    self->common.base.limit = limit;
    if (chebyshev_step_init(&self->common, host, options, 4) != CS_STEP_OK)
        return CS_STEP_FAIL;
    for (int k = 0; k < LAST; k++) {
        self->slope[k] = host->alloc(host->ctx, self->common.base.length * sizeof(double));
        if (!self->slope[k])
            return CS_STEP_FAIL;
    }
    return CS_STEP_OK;
}

static const struct cs_option rows[] = {ADAPTIVE_ROWS(struct adaptive_options, 1e-4)};

static const struct cs_integrator rock4 = {
    CHEBYSHEV_METHOD(rows),
    .name = "rock4",
    .summary = "explicit Chebyshev stages, order 4 with error control: for strong damping, at "
               "errors below 1e-5",
    .source = "Abdulle 2002",
    .order = 4,
    .order_damped = 4,
    .traits = CS_ADAPTIVE,
    .needs = CS_NEED_JVP,
    .create = create,
};

static const struct cs_integrator *const integrators[] = {&rock4};

CS_EXPORT const struct cs_module clothsim_module = {
    .abi = CS_ABI,
    .size = sizeof(struct cs_integrator),
    .n = sizeof integrators / sizeof integrators[0],
    .integrators = integrators,
};

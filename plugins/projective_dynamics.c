/* Implicit Euler by quasi-Newton steps on one constant matrix.
 *
 * The step minimises G(x) = |x - y|_M^2 / 2 + h^2 E(x), y the position that the outer forces
 * alone lead to. An iteration of fast-mass-spring is x -= A^-1 G'(x) with A = M + h D + h^2 L,
 * the constant matrix: a quasi-Newton step. Here it is the start of L-BFGS (Liu, Bouaziz, Kavan
 * 2017) with the last PAIRS changes s of x and z of G' within the
 * step: q = -G';  newest to oldest: a_j = s_j.q / s_j.z_j, q -= a_j z_j d = A^-1 q;  oldest to
 * newest: d += s_j (a_j - z_j.d / s_j.z_j) Then x += e d with e = 1, shortened until the slope
 * of G along d has not turned into as large a rise. The slope decides and not G, since axial
 * dampers have no potential. The memory is dropped where d does not descend. Dampers and drag
 * are implicit, as in fast_mass_spring.c.
 */
#include "local_global.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Pairs of the memory: those of the paper, where more gained nothing. */
enum { PAIRS = 5, SHORTENINGS = 12 };

/* A step may overshoot to this fraction of the slope that it began with. */
#define OVERSHOOT 0.9

/* Times its rounding that a change of G' must exceed to tell a curvature. */
#define CLEAR_OF_ROUNDING 100

static const struct cs_option rows[] = {
    FIXED_STEP_DT_BY_ERROR(struct local_global_options),
    CS_OPTION(struct local_global_options, iterations, "", 10, 1, 1e6,
              "quasi-Newton iterations per step, each with a solve"),
};

struct quasi_newton {
    struct local_global base;
    double *residual, *next; /* (3,n) -G' in kg m at x, and after the step */
    double *u;               /* (3,n) x - y in m: without the rounding of x */
    double *direction;       /* (3,n) d in m */
    double mass;             /* kg, of the free particles */
    double *s[PAIRS], *z[PAIRS], curvature[PAIRS]; /* s_j.z_j */
    uint32_t n_pairs, newest;
};

static double dot(const struct quasi_newton *self, const double *a, const double *b) {
    const struct cs_host *host = self->base.loop.host;
    return host->vector->dot(3 * (size_t)host->view->n, a, b);
}

/* a += factor b */
static void add(const struct quasi_newton *self, double factor, const double *b, double *a) {
    const struct cs_host *host = self->base.loop.host;
    host->vector->linear_sum(3 * (size_t)host->view->n, 1, a, factor, b, a);
}

/* x = y + u, and there r = -G'(x) = h^2 f(x) - M u */
static void find_residual(struct quasi_newton *self, double *x, double *r) {
    struct local_global *base = &self->base;
    const struct cs_view *view = base->loop.host->view;
    base->loop.host->vector->linear_sum(3 * (size_t)view->n, 1, base->y, 1, self->u, x);
    local_global_pull(base, x, x);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0, k = c * view->n; i < view->n; i++, k++)
            r[k] = base->b[k] - view->mass[i] * self->u[k];
    base->pulls++;
}

/* The j-th pair, 0 the newest. */
static uint32_t pair(const struct quasi_newton *self, uint32_t j) {
    return (self->newest + PAIRS - j) % PAIRS;
}

/* The direction d by the two loops. */
static enum cs_step find_direction(struct quasi_newton *self) {
    struct local_global *base = &self->base;
    const size_t bytes = 3 * sizeof(double) * base->loop.host->view->n;
    double a[PAIRS];
    const double *u;
    memcpy(base->b, self->residual, bytes);
    for (uint32_t j = 0; j < self->n_pairs; j++) {
        const uint32_t k = pair(self, j);
        a[j] = dot(self, self->s[k], base->b) / self->curvature[k];
        add(self, -a[j], self->z[k], base->b);
    }
    const enum cs_step status = constant_matrix_solve(&base->matrix, base->b, &u);
    if (status != CS_STEP_OK)
        return status;
    memcpy(self->direction, u, bytes);
    for (uint32_t j = self->n_pairs; j-- > 0;) {
        const uint32_t k = pair(self, j);
        add(self, a[j] - dot(self, self->z[k], self->direction) / self->curvature[k],
            self->s[k], self->direction);
    }
    base->passes++;
    return CS_STEP_OK;
}

/* Moves x along d, and leaves -G' there in next. Returns the length e. */
static double move(struct quasi_newton *self, double slope, double *x) {
    double length = 1;
    add(self, 1, self->direction, self->u);
    for (int k = 0; k < SHORTENINGS; k++) {
        find_residual(self, x, self->next);
        const double turned = dot(self, self->direction, self->next);
        if (!(turned < -OVERSHOOT * slope) || k + 1 == SHORTENINGS)
            break;
        // where the slope would be 0 if it fell evenly, within bounds
        const double share = fmin(fmax(slope / (slope - turned), 0.1), 0.5);
        add(self, (share - 1) * length, self->direction, self->u);
        length *= share;
    }
    return length;
}

/* Sum of w_i a_i^2 over the particles' vectors a (3,n). */
static double weighted_square(size_t n, const double *w, const double *a) {
    double sum = 0;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            sum += w[i] * a[c * n + i] * a[c * n + i];
    return sum;
}

/* True if a residual r, or a change of it, is no larger than `times` its rounding, as in
 * newton.h: |r|^2 = sum r_i^2 / m_i against 4 eps sqrt(m) ((h^2 omega^2 + 2 h delta) max|x| +
 * max|u|). */
static bool is_rounding(const struct quasi_newton *self, double times, const double *x,
                        const double *r) {
    const struct cs_host *host = self->base.loop.host;
    const struct cs_view *view = host->view;
    const size_t values = 3 * (size_t)view->n;
    const double h = self->base.matrix.h,
                 rate = h * (h * view->omega * view->omega + 2 * view->delta),
                 length = rate * host->vector->max_norm(values, x) +
                          host->vector->max_norm(values, self->u),
                 floor = 4 * DBL_EPSILON * times * length;
    return weighted_square(view->n, view->inv_mass, r) <= floor * floor * self->mass;
}

/* Remembers the step just taken, unless its curvature is below a tenth of what masses alone
 * give, or its change of G' is rounding: directions would be far too long. */
static void remember(struct quasi_newton *self, double length, const double *x) {
    const struct cs_host *host = self->base.loop.host;
    const size_t n = host->view->n, values = 3 * n;
    const uint32_t k = (self->newest + 1) % PAIRS;
    host->vector->linear_sum(values, length, self->direction, 0, self->direction, self->s[k]);
    host->vector->linear_sum(values, 1, self->residual, -1, self->next, self->z[k]);
    self->curvature[k] = dot(self, self->s[k], self->z[k]);
    if (!(self->curvature[k] > 0.1 * weighted_square(n, host->view->mass, self->s[k])) ||
        is_rounding(self, CLEAR_OF_ROUNDING, x, self->z[k]))
        return;
    self->newest = k;
    self->n_pairs += self->n_pairs < PAIRS;
}

static enum cs_step step(struct fixed_step *loop, double t, double h, double *x, double *v) {
    struct quasi_newton *self = (struct quasi_newton *)loop;
    struct local_global *base = &self->base;
    enum cs_step status = local_global_begin(base, t, h, x, v);
    self->n_pairs = 0;
    memset(self->u, 0, 3 * sizeof *x * loop->host->view->n);
    if (status == CS_STEP_OK)
        find_residual(self, x, self->residual);
    for (int64_t i = 0; i < base->iterations && status == CS_STEP_OK; i++) {
        if (is_rounding(self, 1, x, self->residual))
            break;
        status = find_direction(self);
        const double slope = dot(self, self->direction, self->residual);
        if (!(slope > 0) && self->n_pairs == 0)
            break; // numbers that are not finite
        if (!(slope > 0)) {
            self->n_pairs = 0;
            continue;
        }
        remember(self, move(self, slope, x), x);
        double *kept = self->residual;
        self->residual = self->next;
        self->next = kept;
    }
    for (size_t k = 0; k < 3 * (size_t)loop->host->view->n; k++)
        v[k] += self->u[k] / base->matrix.h;
    return status;
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const size_t bytes = 3 * sizeof(double) * (size_t)host->view->n;
    struct quasi_newton *self = *out = host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    const enum cs_step status = local_global_init(&self->base, host, options, step);
    if (status != CS_STEP_OK)
        return status;
    for (size_t k = 0; k < PAIRS; k++)
        if (!(self->s[k] = host->alloc(host->ctx, bytes)) ||
            !(self->z[k] = host->alloc(host->ctx, bytes)))
            return CS_STEP_FAIL;
    if (!(self->residual = host->alloc(host->ctx, bytes)) ||
        !(self->next = host->alloc(host->ctx, bytes)) ||
        !(self->u = host->alloc(host->ctx, bytes)) ||
        !(self->direction = host->alloc(host->ctx, bytes)))
        return CS_STEP_FAIL;
    for (size_t i = 0; i < host->view->n; i++)
        self->mass += host->view->inv_mass[i] > 0 ? host->view->mass[i] : 0;
    return CS_STEP_OK;
}

static void stats(const void *object, struct cs_stats *out) {
    const struct local_global *base = object;
    fixed_step_stats(object, out);
    out->newton = base->passes;
    if (CS_HAS(out, sweeps))
        out->sweeps = base->pulls + base->passes; // the springs, and the solves
}

const struct cs_integrator projective_dynamics = {
    .size = sizeof(struct cs_integrator),
    .name = "projective-dynamics",
    .summary =
        "implicit Euler by L-BFGS on one constant matrix: the solver of projective dynamics, "
        "to the end in fewer iterations than fast-mass-spring",
    .source = "Liu, Bouaziz, Kavan 2017",
    .order = 1,
    .order_damped = 1,
    .needs = CS_NEED_SPRINGS,
    .traits = CS_IMPLICIT | CS_LIBRARY_BITS | CS_EXPLICIT_OUTER,
    .fidelity = CS_FIDELITY_IMPLICIT_EULER,
    .fails = local_global_fails,
    .options = rows,
    .n_options = sizeof rows / sizeof rows[0],
    .options_size = sizeof(struct local_global_options),
    .create = create,
    .restart = local_global_restart,
    .advance = local_global_advance,
    .stats = stats,
    .destroy = local_global_destroy,
    .save = local_global_save,
    .load = local_global_load,
    .library = LOCAL_GLOBAL_LIBRARY,
};

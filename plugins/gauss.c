/* gauss.c - Gauss's collocation methods of order 4, 6 and 8, for results of many digits.
 *
 * For y = (x, v), y' = F(t, y), with s stages at Gauss's nodes c_i in (0, 1):
 *   y_i = y + h sum_j a_ij F(t + c_j h, y_j),   y' = y + h sum_j b_j F(t + c_j h, y_j)
 *   a_ij = integral of l_j from 0 to c_i, b_j from 0 to 1, l_j Lagrange's polynomials of the
 * c_i of order 2 s, A-stable, symmetric, symplectic (Hairer, Lubich, Wanner 2006, sec. II.1.3).
 *
 * The stages are found one after the other, in sweeps. With A = L U, L lower triangular and the
 * diagonal of U one, a sweep solves
 *   y_i = y + h sum_j (a_ij - l_ij) F_j(old) + h sum_{j<=i} l_ij F_j(new)
 * each of which is one equation of newton.h (Houwen, Swart 1997), until the
 * velocities of the stages stand still. The first sweep starts from the polynomial of the step
 * before.
 */
#include "collocation.h"
#include "newton_methods.h"

#include <math.h>
#include <string.h>

/* The stages are converged to this fraction of the rounding bound, because the remaining
 * errors accumulate over many steps. */
#define NOISE_SHARE 0.0625

struct gauss_options {
    NEWTON_FIELDS;
    int64_t order;
};

static const struct cs_option rows[] = {
    FIXED_STEP_DT_BY_ERROR(struct gauss_options),
    CS_OPTION(struct gauss_options, rtol, "", 1e-10, 1e-14, 0.1,
              "residual of a stage and change of the last sweep, relative to the impulse"),
    CS_OPTION(struct gauss_options, iterations, "", 50, 1, 1000,
              "maximum Newton iterations, and sweeps; then the step is halved, up to 12 times"),
    CS_OPTION(struct gauss_options, order, "", 4, 4, 8, "4, 6 or 8: twice the stages"),
};

/* Velocity or acceleration of each stage, and what the running sweep changed of it: (3,n). */
struct slopes {
    double *now[COLLOCATION_STAGES], *change[COLLOCATION_STAGES];
};

struct method {
    struct newton_method base;
    struct collocation table;
    struct slopes v, k;  /* m/s, m/s2 */
    double *xb, *ub, *u; /* (3,n): the equation of a stage */
};

/* from (x, v) at t to t + h */
struct way {
    double t, h;
    const double *x, *v;
};

/* z = y + h sum of a_j k_j over the stages, in their order */
static void combine(const struct method *self, const double *y, double h, const double *a,
                    double *const *k, double *z) {
    const struct cs_host *host = self->base.base.fixed.host;
    const size_t n3 = 3 * (size_t)host->view->n;
    memcpy(z, y, n3 * sizeof *z);
    for (size_t j = 0; j < self->table.stages; j++)
        host->vector->linear_sum(n3, 1, z, h * a[j], k[j], z);
}

/* Stages for the first sweep: accelerations extrapolated from the polynomial of the last
 * step, or 0 without history. */
static void predict_stages(struct method *self, double h, const double *v) {
    const size_t n3 = 3 * (size_t)self->base.base.fixed.host->view->n, s = self->table.stages;
    const bool fresh = step_halving_is_fresh(&self->base.base, h);
    double *const *k = self->k.now, *const *next = self->k.change;
    for (size_t i = 0; i < s; i++) {
        memset(next[i], 0, n3 * sizeof **next);
        if (!fresh)
            combine(self, next[i], 1, self->table.extrapolate[i], k, next[i]);
    }
    for (size_t i = 0; i < s; i++)
        memcpy(k[i], next[i], n3 * sizeof **k);
    for (size_t i = 0; i < s; i++)
        combine(self, v, h, self->table.a[i], k, self->v.now[i]);
}

/* The known terms of stage i, with a_ij on the stages as they are. Those before i are new
 * already: their change since the last sweep is corrected by l_ij - a_ij, so that it counts
 * with l_ij. */
static void set_known_terms(const struct method *self, size_t i, double h, const double *y,
                            const struct slopes *slopes, double *known) {
    const struct collocation *table = &self->table;
    double share[COLLOCATION_STAGES], left[COLLOCATION_STAGES] = {0};
    for (size_t j = 0; j < table->stages; j++) {
        share[j] = table->a[i][j] - (j == i ? table->crout_factor[i][i] : 0);
        left[j] = j < i ? table->crout_factor[i][j] - table->a[i][j] : 0;
    }
    combine(self, y, h, share, slopes->now, known);
    combine(self, known, h, left, slopes->change, known);
}

/* sum of m z^2 */
static double mass_norm_squared(const struct cs_view *view, const double *z) {
    const size_t n = view->n;
    double sum = 0;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            sum += view->mass[i] * z[c * n + i] * z[c * n + i];
    return sum;
}

/* The result of a sweep in sqrt(J), the largest over the stages: change and impulse, and the
 * rounding floor. */
struct sweep {
    double change, impulse, noise;
};

/* Stores the solution u of stage i: velocity, acceleration (u - ub)/s, and their changes. */
static void renew(struct method *self, size_t i, double h, struct sweep *sweep) {
    const struct cs_host *host = self->base.base.fixed.host;
    const size_t n3 = 3 * (size_t)host->view->n;
    const double s = h * self->table.crout_factor[i][i];
    for (size_t c = 0; c < n3; c++) {
        const double k = (self->u[c] - self->ub[c]) / s;
        self->k.change[i][c] = k - self->k.now[i][c];
        self->v.change[i][c] = self->u[c] - self->v.now[i][c];
        self->k.now[i][c] = k;
        self->v.now[i][c] = self->u[c];
    }
    sweep->change = fmax(sweep->change, sqrt(mass_norm_squared(host->view, self->v.change[i])));
    sweep->impulse =
        fmax(sweep->impulse, h * sqrt(mass_norm_squared(host->view, self->k.now[i])));
}

/* One sweep over the stages; *accepted is false if a stage did not converge. */
static enum cs_step sweep_once(struct method *self, const struct way *way, struct sweep *sweep,
                               bool *accepted) {
    struct newton *newton = &self->base.newton;
    const size_t bytes = 3 * sizeof *self->u * newton->host->view->n;
    const double h = way->h;
    *sweep = (struct sweep){0};
    for (size_t i = 0; i < self->table.stages; i++) {
        const double s = h * self->table.crout_factor[i][i];
        const struct newton_stage stage = {.t = way->t + self->table.node[i] * h,
                                           .s = s,
                                           .gx = s,
                                           .gv = 1,
                                           .xb = self->xb,
                                           .ub = self->ub,
                                           .c = self->table.node[i] * h,
                                           .x0 = way->x,
                                           .v0 = way->v};
        set_known_terms(self, i, h, way->x, &self->v, self->xb);
        set_known_terms(self, i, h, way->v, &self->k, self->ub);
        memcpy(self->u, self->v.now[i], bytes);
        const enum cs_step status = newton_solve(newton, &stage, self->u, accepted);
        if (status != CS_STEP_OK || !*accepted)
            return status;
        renew(self, i, h, sweep);
        sweep->noise = fmax(sweep->noise, newton_rounding_floor(newton, &stage, self->u));
    }
    return CS_STEP_OK;
}

static enum cs_step step(struct step_halving *object, double t, double h, double *x, double *v,
                         bool *accepted) {
    struct method *self = (struct method *)object;
    const struct newton *newton = &self->base.newton;
    const struct way way = {.t = t, .h = h, .x = x, .v = v};
    struct sweep sweep;
    bool settled = false;
    predict_stages(self, h, v);
    for (int64_t k = 0; k < newton->iterations && !settled; k++) {
        const enum cs_step status = sweep_once(self, &way, &sweep, accepted);
        if (status != CS_STEP_OK || !*accepted)
            return status;
        settled =
            sweep.change <= newton->rtol * sweep.impulse + newton->residual_floor * sweep.noise;
    }
    *accepted = settled;
    if (settled) {
        combine(self, x, h, self->table.weight, self->v.now, x);
        combine(self, v, h, self->table.weight, self->k.now, v);
    }
    return CS_STEP_OK;
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const struct gauss_options *asked = options;
    struct newton_method *base = newton_method_create(host, sizeof(struct method), asked->dt,
                                                      asked->rtol, asked->iterations, step);
    if (!(*out = base))
        return CS_STEP_FAIL;
    if (asked->order % 2)
        return host->fail(host->ctx, "order = %lld, expected 4, 6 or 8",
                          (long long)asked->order);
    struct method *self = (struct method *)base;
    self->base.newton.residual_floor = NOISE_SHARE;
    collocation_make(&self->table, (size_t)asked->order / 2);
    for (size_t i = 0; i < self->table.stages; i++) {
        double **const arrays[] = {self->v.now + i, self->v.change + i, self->k.now + i,
                                   self->k.change + i};
        if (step_halving_alloc(host, arrays, 4) != CS_STEP_OK)
            return CS_STEP_FAIL;
    }
    double **const arrays[] = {&self->xb, &self->ub, &self->u};
    return step_halving_alloc(host, arrays, 3);
}

static enum cs_step archive(void *object, const struct cs_archive *archive) {
    struct method *self = object;
    for (size_t i = 0; i < self->table.stages; i++)
        archive->reals(archive->ctx, self->k.now[i],
                       3 * (size_t)self->base.base.fixed.host->view->n);
    return step_halving_archive(self, archive);
}

static const char *const orders[] = {"order=6", "order=8", NULL};

const struct cs_integrator gauss = {
    STEP_HALVING_METHOD(struct gauss_options, rows, archive),
    .name = "gauss",
    .summary =
        "Gauss's collocation with 2, 3 or 4 stages by Newton: symplectic, many digits; makes "
        "energy at long steps where springs are pressed hard",
    .source = "Hairer, Lubich, Wanner 2006, sec. II.1.3; Houwen, Swart 1997",
    .order = 4,
    .order_damped = 4,
    .needs = CS_NEED_ENERGY | CS_NEED_SOLVE | CS_NEED_LAGGED_FRICTION,
    .traits = CS_IMPLICIT | CS_SYMPLECTIC,
    .create = create,
    .variants = orders,
};

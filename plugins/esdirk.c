/* esdirk.c - the diagonally implicit pair 4(3) of six stages with error control, L-stable.
 *
 * In Nystrom form (nystrom.h) stage i has the equation of newton.h with g = h/4:
 *   M (u - ub) = g f(t + c_i h, xb + g u, u),   k_i = (u - ub) / g
 *   ub = v + h sum_j a_ij k_j,  xb = x + (c_i - 1/4) h v + h^2 sum_jl a_ij a_jl k_l,  j < i
 * The first stage is explicit: its k is that of the last stage of the step before, which stands
 * at the new state. Taken from u it has no error that stiff springs enlarge, other than f(u).
 *
 * Newton starts at the k of a polynomial in time through the latest stages, those of the step
 * before too, and ends at a residual below newton_rtol of the tolerance.
 *
 * Coefficients: the implicit part of ARK4(3)6L[2]SA, Kennedy, Carpenter 2003. */
#include "newton_methods.h"
#include "nystrom.h"

#include <string.h>

enum { STAGES = 6, PAST = 3, POINTS = 3 };

/* Tries in a row in which a linear solve failed, before the run fails. */
enum { FAILED_SOLVES_MAX = 8 };

// clang-format off
static const double nodes[STAGES] = {0, 0.5, 0.332, 0.62, 0.85, 1};
static const double table[STAGES][NYSTROM_STAGES] = {
    {0},
    {1.0 / 4, 1.0 / 4},
    {8611.0 / 62500, -1743.0 / 31250, 1.0 / 4},
    {5012029.0 / 34652500, -654441.0 / 2922500, 174375.0 / 388108, 1.0 / 4},
    {15267082809.0 / 155376265600, -71443401.0 / 120774400, 730878875.0 / 902184768,
     2285395.0 / 8070912, 1.0 / 4},
    {82889.0 / 524892, 0, 15625.0 / 83664, 69875.0 / 102672, -2260.0 / 8211, 1.0 / 4},
};
static const double order_3[STAGES] = {
    4586570599.0 / 29645900160, 0, 178811875.0 / 945068544, 814220225.0 / 1159782912,
    -3700637.0 / 11593932, 61727.0 / 225920};
// clang-format on

/* Part of the rounding bound that stages are solved to: their errors add up. */
#define NOISE_SHARE 0.0625

struct esdirk_options {
    double rtol, atol, dt_max;
    int64_t max_steps;
    double dt, newton_rtol;
    int64_t iterations;
};

static const struct cs_option rows[] = {
    ADAPTIVE_ROWS(struct esdirk_options, 1e-4),
    CS_OPTION(
        struct esdirk_options, dt, "s", 0, 0, 10,
        "step without error control, rtol then being that of the stages; 0: by the error"),
    CS_OPTION(struct esdirk_options, newton_rtol, "", 0.05, 1e-14, 1,
              "residual of a stage, as a velocity, relative to the tolerance"),
    CS_OPTION(struct esdirk_options, iterations, "", 10, 1, 1000,
              "maximum Newton iterations of a stage; then the step is shortened"),
};

struct esdirk {
    struct adaptive_step base;
    struct newton newton;
    uint64_t failed_solves; /* tries in a row that ended by a linear solve that failed */
    struct nystrom_sum known[STAGES], difference;
    double *k[STAGES];  /* (3,n) in m/s2 each; the first is base.slope */
    double *past[PAST]; /* (3,n): k of stages 3 to 5 of the last accepted step */
    double past_h;      /* s, its length; 0: there is none */
    double tried_h;     /* s, of the last try */
    double *start;      /* (6n): (xb, ub) of a stage */
    double *u;          /* (3,n) */
};

/* A point of the polynomial that Newton starts from: time in steps from t, and k there. */
struct point {
    double time;
    const double *k;
};

/* The POINTS latest stages that are known before stage i; returns how many there are. */
static int latest_points(const struct esdirk *self, int i, double h, struct point *points) {
    struct point all[PAST + STAGES];
    int n = 0;
    for (int j = 0; j < PAST && self->past_h > 0; j++)
        all[n++] = (struct point){(nodes[2 + j] - 1) * self->past_h / h, self->past[j]};
    for (int j = 0; j < i; j++)
        all[n++] = (struct point){nodes[j], self->k[j]};
    const int first = n > POINTS ? n - POINTS : 0;
    for (int j = first; j < n; j++)
        points[j - first] = all[j];
    return n - first;
}

/* Lagrange's weight of point j at a time. */
static double weight_at(const struct point *points, int n, int j, double time) {
    double weight = 1;
    for (int l = 0; l < n; l++)
        if (l != j)
            weight *= (time - points[l].time) / (points[j].time - points[l].time);
    return weight;
}

/* u = ub + g k, k from the polynomial at the time of stage i. */
static void predict(struct esdirk *self, int i, double h, const double *ub) {
    const size_t n3 = self->base.length / 2;
    struct point points[POINTS];
    const int n = latest_points(self, i, h, points);
    for (int j = 0; j < n; j++)
        self->base.host->vector->linear_sum(n3, h / 4 * weight_at(points, n, j, nodes[i]),
                                            points[j].k, 1, j ? self->u : ub, self->u);
}

/* Solves stage i of a step of h from y at t: leaves X in newton.x, the velocity in self->u and
 * the acceleration in self->k[i]. */
static enum cs_step solve_stage(struct esdirk *self, int i, double t, double h, const double *y,
                                bool *converged) {
    const size_t n3 = self->base.length / 2;
    const double g = h / 4;
    const double *xb = self->start, *ub = xb + n3;
    nystrom_combine(self->base.host, self->known + i, self->k, h, y, self->start);
    predict(self, i, h, ub);
    const struct newton_stage stage = {.t = t + nodes[i] * h,
                                       .s = g,
                                       .gx = g,
                                       .gv = 1,
                                       .xb = xb,
                                       .ub = ub,
                                       .c = nodes[i] * h,
                                       .x0 = y,
                                       .v0 = y + n3};
    // a start that is good enough takes no solve, and says nothing of them
    const uint64_t solves = self->newton.converged;
    const enum cs_step status = newton_solve(&self->newton, &stage, self->u, converged);
    if (self->newton.linear_failed)
        self->failed_solves++;
    else if (self->newton.converged > solves)
        self->failed_solves = 0;
    self->base.host->vector->linear_sum(n3, 1 / g, self->u, -1 / g, ub, self->k[i]);
    return status;
}

static enum cs_step attempt(struct adaptive_step *base, double t, double h, const double *y,
                            double *error) {
    struct esdirk *self = (struct esdirk *)base;
    const size_t n3 = base->length / 2;
    for (int i = 1; i < STAGES; i++) {
        bool converged = false;
        const enum cs_step status = solve_stage(self, i, t, h, y, &converged);
        if (status != CS_STEP_OK)
            return status;
        if (self->failed_solves > FAILED_SOLVES_MAX)
            return base->host->fail(base->host->ctx,
                                    "the linear solver fails in a step of %.3g s at t = %.9g s",
                                    h, t);
        if (!converged)
            return CS_STEP_OK;
    }
    // stiffly accurate: the last stage is the new state
    memcpy(base->next, self->newton.x, n3 * sizeof *y);
    memcpy(base->next + n3, self->u, n3 * sizeof *y);
    adaptive_step_weigh(base, y, base->next);
    nystrom_combine(base->host, &self->difference, self->k, h, NULL, base->error);
    *error = adaptive_step_norm(base, base->error);
    if (self->base.fixed && isfinite(*error))
        *error = 0;
    self->tried_h = h;
    return CS_STEP_OK;
}

static void swap(double **a, double **b) {
    double *const old = *a;
    *a = *b;
    *b = old;
}

/* The last stage is the first of the next step. */
static bool accept(struct adaptive_step *base) {
    struct esdirk *self = (struct esdirk *)base;
    for (int j = 0; j < PAST; j++)
        swap(self->past + j, self->k + 2 + j);
    swap(self->k, self->k + STAGES - 1);
    base->slope = self->k[0];
    self->past_h = self->tried_h;
    return true;
}

/* s, the longest step past frames if dt_max does not say: solves of longer ones take more
 * iterations than there are steps less. With 0.1 s swing took 3961 passes over the forces at a
 * tolerance of 1e-2, with 1/30 s it takes 2965. */
#define PAST_FRAMES (1.0 / 30)

/* s: half a radian of the fastest mode after a change of the state, by contact that is no force
 * or at the start; else any, or PAST_FRAMES. Stages of a longer step would follow forces that
 * the next change takes away: a box of springs on a slope crept by 1.6 mm a second. */
static double limit(struct adaptive_step *base, double t, const double *y) {
    (void)t, (void)y;
    const struct esdirk *self = (const struct esdirk *)base;
    const double omega = base->host->view->omega;
    if ((base->changed || !(self->past_h > 0)) && omega > 0)
        return 0.5 / omega;
    return base->ends && !(base->asked.dt_max > 0) ? PAST_FRAMES : HUGE_VAL;
}

/* The sums that a step takes. */
static void make_sums(struct esdirk *self) {
    double before[STAGES] = {0}, difference[STAGES];
    for (int i = 1; i < STAGES; i++) {
        memcpy(before, table[i], (size_t)i * sizeof *before);
        self->known[i] = nystrom_sum_of(STAGES, table, before, NULL);
        self->known[i].node = nodes[i] - 0.25;
    }
    for (int j = 0; j < STAGES; j++)
        difference[j] = table[STAGES - 1][j] - order_3[j];
    self->difference = nystrom_sum_of(STAGES, table, difference, NULL);
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const struct esdirk_options *asked = options;
    const struct adaptive_options adaptive = {
        asked->rtol, asked->atol, asked->dt > 0 ? asked->dt : asked->dt_max, asked->max_steps};
    struct esdirk *self = host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->base.attempt = attempt;
    self->base.accept = accept;
    self->base.limit = limit;
    self->base.fixed = asked->dt > 0;
    make_sums(self);
    // stages end by the tolerance of the step, not by their own impulse
    if (adaptive_step_init(&self->base, host, &adaptive, 4) != CS_STEP_OK ||
        newton_init(&self->newton, host, 0, asked->iterations) != CS_STEP_OK)
        return CS_STEP_FAIL;
    self->newton.absolute =
        asked->newton_rtol * self->base.tolerance.speed * sqrt(self->newton.mass);
    self->newton.residual_floor = NOISE_SHARE;
    self->k[0] = self->base.slope;
    double **const arrays[] = {self->k + 1,    self->k + 2,    self->k + 3,
                               self->k + 4,    self->k + 5,    self->past,
                               self->past + 1, self->past + 2, &self->u};
    self->start = (double *)host->alloc(host->ctx, self->base.length * sizeof(double));
    return self->start ? step_halving_alloc(host, arrays, 9) : CS_STEP_FAIL;
}

static enum cs_step restart(void *object, double t, const double *x, const double *v) {
    ((struct esdirk *)object)->past_h = 0;
    return adaptive_step_restart(object, t, x, v);
}

static void stats(const void *object, struct cs_stats *out) {
    adaptive_step_stats(object, out);
    out->newton = ((const struct esdirk *)object)->newton.converged;
}

static enum cs_step archive(void *object, const struct cs_archive *archive) {
    struct esdirk *self = object;
    archive->integers(archive->ctx, &self->newton.converged, 1);
    archive->integers(archive->ctx, &self->failed_solves, 1);
    archive->reals(archive->ctx, &self->past_h, 1);
    for (int j = 0; j < PAST; j++)
        archive->reals(archive->ctx, self->past[j], self->base.length / 2);
    return adaptive_step_archive(object, archive);
}

const struct cs_integrator esdirk = {
    .size = sizeof(struct cs_integrator),
    .name = "esdirk",
    .summary = "implicit pair 4(3) by Newton with error control, L-stable: ark-dirk at less "
               "than half its work where dampers rule",
    .source = "Kennedy, Carpenter 2003",
    .order = 4,
    .order_damped = 4,
    .needs = CS_NEED_ENERGY | CS_NEED_SOLVE | CS_NEED_LAGGED_FRICTION,
    .traits = CS_IMPLICIT | CS_ADAPTIVE,
    .fidelity = CS_FIDELITY_ODE,
    .options = rows,
    .n_options = sizeof rows / sizeof rows[0],
    .options_size = sizeof(struct esdirk_options),
    .create = create,
    .restart = restart,
    .advance = adaptive_step_advance,
    .stats = stats,
    .save = archive,
    .load = archive,
};

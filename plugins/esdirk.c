/* esdirk.c - diagonally implicit pairs with error control, and that of orders 4(3) with six
 * stages, L-stable.
 *
 * In Nystrom form (nystrom.h) stage i has the equation of newton.h with g = a_ii h:
 *   M (u - ub) = g f(t + c_i h, xb + g u, u),   k_i = (u - ub) / g
 *   ub = v + h sum_j a_ij k_j,  xb = x + (c_i - a_ii) h v + h^2 sum_jl a_ij a_jl k_l,  j < i
 * The first stage is explicit: its k is that of the last stage of the step before, which stands
 * at the new state. Taken from u it has no error that stiff springs enlarge, other than f(u).
 * Other stages with a_ii = 0 cost an evaluation.
 *
 * Newton starts at the k of a polynomial in time through the latest stages, those of the step
 * before too, and ends at a residual below newton_rtol of the tolerance.
 *
 * Coefficients: the implicit part of ARK4(3)6L[2]SA, Kennedy, Carpenter 2003. */
#include "esdirk.h"
#include "newton_methods.h"

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
// b minus that of the method of order 3
static const double difference[STAGES] = {
    82889.0 / 524892 - 4586570599.0 / 29645900160, 0, 15625.0 / 83664 - 178811875.0 / 945068544,
    69875.0 / 102672 - 814220225.0 / 1159782912, -2260.0 / 8211 - -3700637.0 / 11593932,
    1.0 / 4 - 61727.0 / 225920};
// clang-format on
static const struct nystrom_pair pair_43 = {
    .stages = STAGES, .power = 4, .nodes = nodes, .table = table, .difference = difference};

/* Part of the rounding bound that stages are solved to: their errors add up. */
#define NOISE_SHARE 0.0625

static const struct cs_option rows[] = {ESDIRK_ROWS};

struct esdirk {
    struct adaptive_step base;
    struct newton newton;
    uint64_t failed_solves; /* tries in a row that ended by a linear solve that failed */
    const struct nystrom_pair *pair;
    struct nystrom_sum known[NYSTROM_STAGES], difference;
    double *k[NYSTROM_STAGES]; /* (3,n) in m/s2 each; the first is base.slope */
    /* (3,n): k of the stages of the last accepted step from first_past on, but for the last */
    double *past[PAST];
    int first_past;
    double past_h;  /* s, its length; 0: there is none */
    double tried_h; /* s, of the last try */
    double *start;  /* (6n): (xb, ub) of a stage */
    double *u;      /* (3,n) */
};

/* A point of the polynomial that Newton starts from: time in steps from t, and k there. */
struct point {
    double time;
    const double *k;
};

/* Adds a point before those that are there, unless one has its time. */
static void add_point(struct point *points, int *n, struct point point) {
    for (int j = POINTS - *n; j < POINTS; j++)
        if (fabs(points[j].time - point.time) < 1e-6)
            return;
    if (*n < POINTS)
        points[POINTS - ++*n] = point;
}

/* The POINTS latest stages that are known before stage i, at the end of the array; returns how
 * many there are. */
static int latest_points(const struct esdirk *self, int i, double h, struct point *points) {
    const double *times = self->pair->nodes;
    int n = 0;
    while (i-- > 0)
        add_point(points, &n, (struct point){times[i], self->k[i]});
    for (int j = self->pair->stages - 1; self->past_h > 0 && --j >= self->first_past;)
        add_point(points, &n,
                  (struct point){(times[j] - 1) * self->past_h / h,
                                 self->past[j - self->first_past]});
    return n;
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
    const double g = self->pair->table[i][i] * h, node = self->pair->nodes[i];
    struct point all[POINTS];
    const int n = latest_points(self, i, h, all);
    const struct point *points = all + POINTS - n;
    for (int j = 0; j < n; j++)
        self->base.host->vector->linear_sum(n3, g * weight_at(points, n, j, node), points[j].k,
                                            1, j ? self->u : ub, self->u);
}

/* Solves stage i of a step of h from y at t: leaves X in newton.x, the velocity in self->u and
 * the acceleration in self->k[i]. */
static enum cs_step solve_stage(struct esdirk *self, int i, double t, double h, const double *y,
                                bool *converged) {
    const size_t n3 = self->base.length / 2;
    const double g = self->pair->table[i][i] * h, c = self->pair->nodes[i] * h;
    const double *xb = self->start, *ub = xb + n3;
    nystrom_combine(self->base.host, self->known + i, self->k, h, y, self->start);
    predict(self, i, h, ub);
    const struct newton_stage stage = {.t = t + c,
                                       .s = g,
                                       .gx = g,
                                       .gv = 1,
                                       .xb = xb,
                                       .ub = ub,
                                       .c = c,
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
    const struct nystrom_pair *pair = self->pair;
    const int last = pair->stages - 1;
    for (int i = 1; i <= last; i++) {
        bool converged = false;
        if (!(pair->table[i][i] > 0)) {
            nystrom_combine(base->host, self->known + i, self->k, h, y, base->next);
            adaptive_step_evaluate(base, t + pair->nodes[i] * h, base->next, base->next + n3,
                                   self->k[i]);
            continue;
        }
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
    // the last stage is the new state
    if (pair->table[last][last] > 0) {
        memcpy(base->next, self->newton.x, n3 * sizeof *y);
        memcpy(base->next + n3, self->u, n3 * sizeof *y);
    }
    *error = 0;
    if (self->difference.terms) {
        adaptive_step_weigh(base, y, base->next);
        nystrom_combine(base->host, &self->difference, self->k, h, NULL, base->error);
        *error = adaptive_step_norm(base, base->error);
    }
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
    const int last = self->pair->stages - 1;
    for (int j = self->first_past; j < last; j++)
        swap(self->past + (j - self->first_past), self->k + j);
    swap(self->k, self->k + last);
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
    const struct nystrom_pair *pair = self->pair;
    double before[NYSTROM_STAGES] = {0};
    for (int i = 1; i < pair->stages; i++) {
        memcpy(before, pair->table[i], (size_t)i * sizeof *before);
        self->known[i] = nystrom_sum_of(pair->stages, pair->table, before, NULL);
        self->known[i].node = pair->nodes[i] - pair->table[i][i];
    }
    self->difference = nystrom_sum_of(pair->stages, pair->table, pair->difference, NULL);
}

struct adaptive_options esdirk_adaptive_options(const struct esdirk_options *asked) {
    return (struct adaptive_options){.rtol = asked->rtol,
                                     .atol = asked->atol,
                                     .dt_max = asked->dt > 0 ? asked->dt : asked->dt_max,
                                     .max_steps = asked->max_steps,
                                     .fixed = asked->dt > 0};
}

static enum cs_step alloc_arrays(struct esdirk *self) {
    const struct cs_host *host = self->base.host;
    self->k[0] = self->base.slope;
    self->start = host->alloc(host->ctx, self->base.length * sizeof(double));
    double **arrays[NYSTROM_STAGES + PAST] = {&self->u};
    size_t n = 1;
    for (int i = 1; i < self->pair->stages; i++)
        arrays[n++] = self->k + i;
    for (int j = 0; j < PAST; j++)
        arrays[n++] = self->past + j;
    return self->start ? step_halving_alloc(host, arrays, n) : CS_STEP_FAIL;
}

enum cs_step esdirk_create(const struct cs_host *host, const struct esdirk_options *asked,
                           const struct nystrom_pair *pair, void **out) {
    const struct adaptive_options adaptive = esdirk_adaptive_options(asked);
    struct esdirk *self = host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->base.attempt = attempt;
    self->base.accept = accept;
    self->base.limit = limit;
    self->pair = pair;
    self->first_past = pair->stages > PAST + 2 ? pair->stages - 1 - PAST : 1;
    make_sums(self);
    // stages of pairs end by the tolerance of the step, not by their own impulse
    const double rtol = asked->newton_rtol > 0 ? 0 : asked->rtol;
    if (adaptive_step_init(&self->base, host, &adaptive, pair->power) != CS_STEP_OK ||
        newton_init(&self->newton, host, rtol, asked->iterations) != CS_STEP_OK)
        return CS_STEP_FAIL;
    self->newton.absolute =
        asked->newton_rtol * self->base.tolerance.speed * sqrt(self->newton.mass);
    self->newton.residual_floor = NOISE_SHARE;
    return alloc_arrays(self);
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    return esdirk_create(host, options, &pair_43, out);
}

enum cs_step esdirk_restart(void *object, double t, const double *x, const double *v) {
    ((struct esdirk *)object)->past_h = 0;
    return adaptive_step_restart(object, t, x, v);
}

void esdirk_stats(const void *object, struct cs_stats *out) {
    adaptive_step_stats(object, out);
    out->newton = ((const struct esdirk *)object)->newton.converged;
}

enum cs_step esdirk_archive(void *object, const struct cs_archive *archive) {
    struct esdirk *self = object;
    archive->integers(archive->ctx, &self->newton.converged, 1);
    archive->integers(archive->ctx, &self->failed_solves, 1);
    archive->reals(archive->ctx, &self->past_h, 1);
    for (int j = 0; j < PAST; j++)
        archive->reals(archive->ctx, self->past[j], self->base.length / 2);
    return adaptive_step_archive(object, archive);
}

const struct cs_integrator esdirk = {
    ESDIRK_METHOD(rows),
    .name = "esdirk",
    .summary = "implicit pair 4(3) by Newton with error control, L-stable: ark-dirk at less "
               "than half its work where dampers rule",
    .source = "Kennedy, Carpenter 2003",
    .order = 4,
    .order_damped = 4,
    .traits = CS_IMPLICIT | CS_ADAPTIVE,
    .create = create,
};

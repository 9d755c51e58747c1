/* nystrom.c - stages and errors of explicit pairs in Nystrom form, and the choice of order.
 *
 * A step of h with s stages costs s / h evaluations per second of motion, and the cheaper order
 * is taken (Hairer, Norsett, Wanner 1993, sec. II.9, on extrapolation). Let B be the longest
 * step that contact, dt_max and the frame allow. If the errors of both pairs allow B, dopri5
 * needs half of the stages of dop853. The errors E5 and E3 of dop853 fall as h^6 and h^4, and
 * predict that of dopri5, which falls as h^5:
 *   e = LOWER_ERROR sqrt(E5 E3)
 * Steps of dopri5 were 1.03 to 1.5 times shorter than e predicts, and up to 3 times where
 * stability limits them (drum, swing, hang, contact_compare, self_compare). Therefore e never
 * chooses between two steps that are both shorter than B.
 * - From 8 to 5: the errors of both pairs allow B.
 * - From 5 to 8: the error allows less than BOUND_USED B. The first step of order 8 is twice as
 *   long as the last one, which is break-even.
 * Both pairs end with the slope at the new state: a change of order costs no evaluation. */
#include "nystrom.h"
#include "parallel.h"

#include <string.h>

enum { BLOCK = 512 };

/* A pair and its sums. */
struct pair_sums {
    const struct nystrom_pair *pair;
    struct nystrom_sum stage[NYSTROM_STAGES], difference, lower_order;
};

struct nystrom {
    struct adaptive_step base;
    struct pair_sums own, lower; /* lower.pair is NULL: the order is fixed */
    const struct pair_sums *taken;
    double h, error, lower_error; /* s, of the last try, and its errors by both pairs */
    double *f[NYSTROM_STAGES];    /* (3,n) in m/s2 each; the first is base.slope */
};

/* Sums that are 0 by the order conditions come out as rounding: below this they count as 0. */
#define ROUNDING 1e-14

/* The error of dopri5 over sqrt(E5 E3): on y' = z y they are 8.08e-4 z^5 and, with E5 and E3 of
 * 1.35e-5 z^6 and 4.20e-3 z^4, 2.38e-4 z^5. */
#define LOWER_ERROR 3.4

/* Break-even is 1/2. But the bound of contact grows until it refuses a step: on average less
 * passes. Chosen on contact_compare among 1/4, 1/3, 2/5 and 1/2. */
#define BOUND_USED (1.0 / 3)

struct nystrom_sum nystrom_sum_of(int stages, const double (*table)[NYSTROM_STAGES],
                                  const double *b, const double *nodes) {
    struct nystrom_sum sum = {0};
    for (int j = 0; j < stages; j++) {
        double position = nodes ? b[j] * (1 - nodes[j]) : 0;
        for (int i = j; i < stages && !nodes; i++)
            position += b[i] * table[i][j];
        if (fabs(b[j]) < ROUNDING && fabs(position) < ROUNDING)
            continue;
        sum.stage[sum.terms] = j;
        sum.velocity[sum.terms] = b[j];
        sum.position[sum.terms++] = position;
    }
    return sum;
}

/* One evaluation of a sum over all numbers: z = y + drift (v, 0) + h^2 and h times the sums of
 * f; without y, the sums alone. */
struct combination {
    int terms;
    size_t half; /* 3n */
    const double *f[NYSTROM_STAGES];
    double velocity[NYSTROM_STAGES], position[NYSTROM_STAGES], drift;
    const double *y;
    double *z;
};

/* Adds terms j to j + 3 to `count` numbers at `at`: four at once, which loads and stores the
 * sums a quarter as often. */
CS_CLONES static void add_four(const struct combination *of, int j, size_t at, size_t count) {
    const double *p = of->position + j, *q = of->velocity + j;
    const double *restrict a = of->f[j] + at, *restrict b = of->f[j + 1] + at;
    const double *restrict c = of->f[j + 2] + at, *restrict d = of->f[j + 3] + at;
    const double p0 = p[0], p1 = p[1], p2 = p[2], p3 = p[3];
    const double q0 = q[0], q1 = q[1], q2 = q[2], q3 = q[3];
    double *restrict x = of->z + at, *restrict v = of->z + of->half + at;
    for (size_t i = 0; i < count; i++) {
        x[i] = x[i] + p0 * a[i] + p1 * b[i] + p2 * c[i] + p3 * d[i];
        v[i] = v[i] + q0 * a[i] + q1 * b[i] + q2 * c[i] + q3 * d[i];
    }
}

/* Adds term j. */
CS_CLONES static void add_one(const struct combination *of, int j, size_t at, size_t count) {
    const double p = of->position[j], q = of->velocity[j], *restrict f = of->f[j] + at;
    double *restrict x = of->z + at, *restrict v = of->z + of->half + at;
    for (size_t i = 0; i < count; i++) {
        x[i] += p * f[i];
        v[i] += q * f[i];
    }
}

/* Adds the state at the begin of the step and its free motion. */
CS_CLONES static void add_state(const struct combination *of, size_t at, size_t count) {
    const double drift = of->drift;
    const double *restrict x0 = of->y + at, *restrict v0 = of->y + of->half + at;
    double *restrict x = of->z + at, *restrict v = of->z + of->half + at;
    for (size_t i = 0; i < count; i++) {
        x[i] = x0[i] + drift * v0[i] + x[i];
        v[i] += v0[i];
    }
}

/* The numbers [begin, end) of positions and velocities, in blocks that stay in the cache. */
static void combine_part(void *arg, size_t begin, size_t end) {
    const struct combination *of = arg;
    for (size_t at = begin; at < end; at += BLOCK) {
        const size_t count = end - at < BLOCK ? end - at : BLOCK;
        memset(of->z + at, 0, count * sizeof *of->z);
        memset(of->z + of->half + at, 0, count * sizeof *of->z);
        int j = 0;
        for (; j + 4 <= of->terms; j += 4)
            add_four(of, j, at, count);
        for (; j < of->terms; j++)
            add_one(of, j, at, count);
        if (of->y)
            add_state(of, at, count);
    }
}

void nystrom_combine(const struct cs_host *host, const struct nystrom_sum *sum,
                     double *const *f, double h, const double *y, double *z) {
    struct combination of = {.terms = sum->terms,
                             .half = 3 * (size_t)host->view->n,
                             .drift = sum->node * h,
                             .y = y,
                             .z = z};
    for (int j = 0; j < sum->terms; j++) {
        of.f[j] = f[sum->stage[j]];
        of.position[j] = h * h * sum->position[j];
        of.velocity[j] = h * sum->velocity[j];
    }
    parallel_for(host, of.half, combine_part, &of);
}

/* The error of a step of h in units of the tolerance. With an error of lower order E3 beside
 * E5 it is E5 E5 / sqrt(E5^2 + E3^2 / 100), of higher order than both
 * (Hairer, Norsett, Wanner 1993, sec. II.10, eq. 10.17). */
static double error_of(struct nystrom *self, double h, const double *y) {
    struct adaptive_step *base = &self->base;
    const struct pair_sums *sums = self->taken;
    self->lower_error = 0;
    if (!sums->difference.terms)
        return 0;
    adaptive_step_weigh(base, y, base->next);
    nystrom_combine(base->host, &sums->difference, self->f, h, NULL, base->error);
    const double error = adaptive_step_norm(base, base->error);
    if (!sums->pair->lower_order || !(error > 0))
        return error;
    nystrom_combine(base->host, &sums->lower_order, self->f, h, NULL, base->error);
    const double lower = adaptive_step_norm(base, base->error);
    self->lower_error = LOWER_ERROR * sqrt(error * lower);
    return error * (error / sqrt(error * error + 0.01 * lower * lower));
}

static enum cs_step attempt(struct adaptive_step *base, double t, double h, const double *y,
                            double *error) {
    struct nystrom *self = (struct nystrom *)base;
    const struct pair_sums *sums = self->taken;
    for (int i = 1; i < sums->pair->stages; i++) {
        nystrom_combine(base->host, sums->stage + i, self->f, h, y, base->next);
        adaptive_step_evaluate(base, t + sums->pair->nodes[i] * h, base->next,
                               base->next + base->length / 2, self->f[i]);
    }
    self->h = h;
    self->error = *error = error_of(self, h, y);
    return CS_STEP_OK;
}

/* Continues with a pair and a step of h in s. */
static void take(struct nystrom *self, const struct pair_sums *sums, double h) {
    self->taken = sums;
    self->base.control = (struct step_control){.h = h, .power = sums->pair->power};
}

/* The step in s that an error of the last try allows a pair. */
static double reach(const struct nystrom *self, double error, const struct pair_sums *sums) {
    return STEP_SAFETY * self->h / step_root(error, sums->pair->power);
}

/* [after an accepted step] See the head of this file. */
static void choose_order(struct nystrom *self) {
    const double bound = self->base.bound;
    const double reached = reach(self, self->error, self->taken);
    if (self->taken == &self->lower) {
        if (reached < BOUND_USED * bound)
            take(self, &self->own, 2 * self->base.control.h);
    } else if (reached >= bound) {
        const double lower = reach(self, self->lower_error, &self->lower);
        if (lower >= bound)
            take(self, &self->lower, lower);
    }
}

/* The last stage is the first of the next step. */
static bool accept(struct adaptive_step *base) {
    struct nystrom *self = (struct nystrom *)base;
    double **last = self->f + self->taken->pair->stages - 1;
    base->slope = *last;
    *last = self->f[0];
    self->f[0] = base->slope;
    if (self->lower.pair)
        choose_order(self);
    return true;
}

struct nystrom_sum nystrom_stage(const struct nystrom_pair *pair, int i) {
    struct nystrom_sum sum =
        nystrom_sum_of(pair->stages, pair->table, pair->table[i],
                       i < pair->stages - 1 || pair->by_table ? NULL : pair->nodes);
    sum.node = pair->nodes[i];
    return sum;
}

static void sum_up(struct pair_sums *sums, const struct nystrom_pair *pair) {
    sums->pair = pair;
    for (int i = 1; i < pair->stages; i++)
        sums->stage[i] = nystrom_stage(pair, i);
    sums->difference = nystrom_sum_of(pair->stages, pair->table, pair->difference, NULL);
    if (pair->lower_order)
        sums->lower_order = nystrom_sum_of(pair->stages, pair->table, pair->lower_order, NULL);
}

enum cs_step nystrom_create(const struct cs_host *host, const void *options,
                            const struct nystrom_pair *pair, const struct nystrom_pair *lower,
                            void **out) {
    struct nystrom *self = host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    sum_up(&self->own, pair);
    if (lower)
        sum_up(&self->lower, lower);
    self->taken = &self->own;
    self->base.attempt = attempt;
    self->base.accept = accept;
    if (adaptive_step_init(&self->base, host, options, pair->power) != CS_STEP_OK)
        return CS_STEP_FAIL;
    self->f[0] = self->base.slope;
    for (int i = 1; i < pair->stages; i++)
        if (!(self->f[i] = host->alloc(host->ctx, self->base.length / 2 * sizeof(double))))
            return CS_STEP_FAIL;
    return CS_STEP_OK;
}

enum cs_step nystrom_restart(void *object, double t, const double *x, const double *v) {
    struct nystrom *self = object;
    take(self, &self->own, 0);
    return adaptive_step_restart(object, t, x, v);
}

enum cs_step nystrom_archive(void *object, const struct cs_archive *archive) {
    struct nystrom *self = object;
    uint64_t lower = self->taken == &self->lower;
    archive->integers(archive->ctx, &lower, 1);
    self->taken = lower && self->lower.pair ? &self->lower : &self->own;
    self->base.control.power = self->taken->pair->power;
    return adaptive_step_archive(object, archive);
}

/* symmetric_multistep.c - the explicit symmetric multistep method of order 8, with one
 * evaluation a step, for motion without contact and events.
 *
 *   x_(n+1) = 2 x_n - 2 x_(n-1) + x_(n-2) + x_(n-4) - 2 x_(n-5) + 2 x_(n-6) - x_(n-7)
 *             + h^2 sum_(j=0..6) b_j a_(n-j)
 * Its coefficients are the same backwards: it has no damping of its own, and the energy of
 * oscillations does not drift. Taken as
 *   s_(n+1) = -s_(n-1) - s_(n-2) - s_(n-3) - s_(n-5) + h^2 sum b_j a_(n-j),
 *   d_(n+1) = d_n + s_(n+1),  x_(n+1) = x_n + d_(n+1)
 * with the second differences s, a step adds rounding of d and not of x (Quinlan, Tremaine
 * 1990, sec. 3). The velocity is the result alone, no part of the recursion:
 *   v_n = d_n / h + h sum_(j=0..7) c_j a_(n-j)
 * c by the condition that it is exact where a is a polynomial of degree 7.
 *
 * Damping needs a velocity before a_(n+1) is known:
 *   u_(n+1) = (d_(n+1) - sum_(k=0..5) g_k s_(n+1-k)) / h + h sum_(j=0..6) p_j a_(n-j)
 * exact where a is a polynomial of degree 4, so that the order is 6 with damping. The six other
 * roots z of the characteristic polynomial are on the unit circle. Damping moves each by the
 * factor 1 - 2 h delta q(z) U(z), U the response of u and q that of x, to first order in
 * h delta. By the nearest formula, s_(n+1) = s_n = .. = 0 in u, one of them grows as
 * exp(0.2 delta t), however short h is. g is chosen for q U of 0, 0.0124 and 0.0228 at the
 * three pairs. p has two free numbers, which were chosen by trial: all roots decay for
 * h w < 0.62 and h delta < 0.059, at 60 by 63 values of them.
 *
 * Seven steps of dop853 start it. Without damping a mode of frequency w is stable for
 * h w < 0.71, by the roots of the characteristic polynomial; modes whose frequencies meet those
 * of its other roots can be driven by them below that (Quinlan 1999; measured in
 * docs/fronts.md). */
#include "fixed_step.h"
#include "high_order_methods.h"
#include "parallel.h"

enum { STARTS = 7, SLOPES = 8, DIFFERENCES = 6, BLOCK = 256 };
/* see above: of h w without damping, of h w and h delta with it */
#define LIMIT         0.71
#define LIMIT_DAMPED  0.62
#define LIMIT_DAMPING 0.059

static const double ahead[STARTS] = {17671.0 / 12096,  -23622.0 / 12096, 61449.0 / 12096,
                                     -50516.0 / 12096, 61449.0 / 12096,  -23622.0 / 12096,
                                     17671.0 / 12096};
static const double speed[SLOPES] = {
    416173.0 / 1814400,  950684.0 / 1814400, -1025097.0 / 1814400, 1059430.0 / 1814400,
    -768805.0 / 1814400, 362112.0 / 1814400, -99359.0 / 1814400,   12062.0 / 1814400};
/* g and p above */
static const double bend[DIFFERENCES] = {0.8289559647951861, 0.9066940974843753,
                                         0.6579119295903737, 0.45334704874218756,
                                         0.2823030135373744, 0.2823030135373751};
static const double foresee[STARTS] = {
    2.20366443386215,      0.006835075216090697, -0.48470627420696943, 2.20887590919536,
    -0.007984902720724052, -0.2488572898452964,  0.23368811618537097};

struct symmetric_options {
    double dt;
};

static const struct cs_option rows[] = {
    CS_OPTION(struct symmetric_options, dt, "s", 0, 0, 10,
              "maximum step; 0: 0.9 of the stability limit, estimated at rest"),
};

struct symmetric {
    struct fixed_step fixed; /* first: the loop's functions take it for the whole */
    uint64_t known;          /* steps since the start, STARTS at most */
    double h;                /* s, of these steps */
    double *a[SLOPES];       /* (3,n) in m/s2 each, at this step and those before */
    double *s[DIFFERENCES];  /* (3,n) in m each, the newest first */
    double *d;               /* (3,n) in m: the last displacement */
    /* of the starting steps */
    struct nystrom_sum stage[NYSTROM_STAGES];
    double *f[NYSTROM_STAGES]; /* (3,n) in m/s2 each; the first is a[0] */
    double *next;              /* (6n) */
};

/* Moves the last of n arrays to the front. */
static void roll(double **arrays, int n) {
    double *const last = arrays[n - 1];
    for (int j = n - 1; j > 0; j--)
        arrays[j] = arrays[j - 1];
    arrays[0] = last;
}

/* Arrays of one pass over particles. */
struct pass {
    const struct symmetric *self;
    double h, *x, *v;
};

/* sum = the weighted accelerations of the positions, in two loops of a few arrays each: a loop
 * over all of them has too many to be proved apart, and runs one number at a time. */
CS_CLONES static void sum_ahead(double *const *a, size_t at, size_t count, double *sum) {
    const double *restrict a0 = a[0] + at, *restrict a1 = a[1] + at, *restrict a2 = a[2] + at;
    const double *restrict a3 = a[3] + at, *restrict a4 = a[4] + at, *restrict a5 = a[5] + at;
    const double *restrict a6 = a[6] + at;
    for (size_t i = 0; i < count; i++)
        sum[i] = ahead[0] * (a0[i] + a6[i]) + ahead[1] * (a1[i] + a5[i]);
    for (size_t i = 0; i < count; i++)
        sum[i] = sum[i] + ahead[2] * (a2[i] + a4[i]) + ahead[3] * a3[i];
}

/* v = the velocity that damping sees at the new state, from its differences and the
 * accelerations before. */
CS_CLONES static void foresee_row(const struct pass *of, size_t at, size_t count) {
    const double h = of->h, inv_h = 1 / h;
    double *const *s = of->self->s, *const *a = of->self->a;
    const double *restrict s0 = s[0] + at, *restrict s1 = s[1] + at, *restrict s2 = s[2] + at;
    const double *restrict s3 = s[3] + at, *restrict s4 = s[4] + at, *restrict s5 = s[5] + at;
    const double *restrict a0 = a[0] + at, *restrict a1 = a[1] + at, *restrict a2 = a[2] + at;
    const double *restrict a3 = a[3] + at, *restrict a4 = a[4] + at, *restrict a5 = a[5] + at;
    const double *restrict a6 = a[6] + at, *restrict d = of->self->d + at;
    double *restrict v = of->v + at;
    double slope[BLOCK], sum[BLOCK];
    for (size_t i = 0; i < count; i++)
        slope[i] = d[i] - (bend[0] * s0[i] + bend[1] * s1[i] + bend[2] * s2[i]);
    for (size_t i = 0; i < count; i++)
        slope[i] = slope[i] - (bend[3] * s3[i] + bend[4] * s4[i] + bend[5] * s5[i]);
    for (size_t i = 0; i < count; i++)
        sum[i] = foresee[0] * a0[i] + foresee[1] * a1[i] + foresee[2] * a2[i];
    for (size_t i = 0; i < count; i++)
        sum[i] = sum[i] + foresee[3] * a3[i] + foresee[4] * a4[i] + foresee[5] * a5[i] +
                 foresee[6] * a6[i];
    for (size_t i = 0; i < count; i++)
        v[i] = inv_h * slope[i] + h * sum[i];
}

/* The positions after a step; s[0] is the oldest difference before, the new one after. */
CS_CLONES static void move_row(const struct pass *of, size_t at, size_t count) {
    const double h2 = of->h * of->h;
    double *const *s = of->self->s;
    const double *restrict s1 = s[2] + at, *restrict s2 = s[3] + at, *restrict s3 = s[4] + at;
    double *restrict new = s[0] + at, *restrict d = of->self->d + at, *restrict x = of->x + at;
    double sum[BLOCK];
    sum_ahead(of->self->a, at, count, sum);
    for (size_t i = 0; i < count; i++)
        new[i] = h2 *sum[i] - (s1[i] + s2[i] + s3[i] + new[i]);
    for (size_t i = 0; i < count; i++) {
        d[i] += new[i];
        x[i] += d[i];
    }
}

/* A velocity is foreseen only for forces that depend on it: those have a part of delta. */
static void move_part(void *arg, size_t begin, size_t end) {
    const struct pass *of = arg;
    const bool damped = of->self->fixed.host->view->delta > 0;
    for (size_t at = begin; at < end; at += BLOCK) {
        const size_t count = end - at < BLOCK ? end - at : BLOCK;
        move_row(of, at, count);
        if (damped)
            foresee_row(of, at, count);
    }
}

/* sum = the weighted accelerations of the velocities. */
CS_CLONES static void sum_speed(double *const *a, size_t at, size_t count, double *sum) {
    const double *restrict a0 = a[0] + at, *restrict a1 = a[1] + at, *restrict a2 = a[2] + at;
    const double *restrict a3 = a[3] + at, *restrict a4 = a[4] + at, *restrict a5 = a[5] + at;
    const double *restrict a6 = a[6] + at, *restrict a7 = a[7] + at;
    for (size_t i = 0; i < count; i++)
        sum[i] = speed[0] * a0[i] + speed[1] * a1[i] + speed[2] * a2[i] + speed[3] * a3[i];
    for (size_t i = 0; i < count; i++)
        sum[i] =
            sum[i] + speed[4] * a4[i] + speed[5] * a5[i] + speed[6] * a6[i] + speed[7] * a7[i];
}

/* a[0], which holds the force, over the masses, and the velocities. */
CS_CLONES static void speed_row(const struct pass *of, size_t at, size_t count,
                                const double *restrict inv_mass) {
    const double h = of->h, inv_h = 1 / h;
    double *restrict a0 = of->self->a[0] + at, *restrict v = of->v + at;
    const double *restrict d = of->self->d + at;
    double sum[BLOCK];
    for (size_t i = 0; i < count; i++)
        a0[i] *= inv_mass[i];
    sum_speed(of->self->a, at, count, sum);
    for (size_t i = 0; i < count; i++)
        v[i] = inv_h * d[i] + h * sum[i];
}

static void speed_part(void *arg, size_t begin, size_t end) {
    const struct pass *of = arg;
    const struct cs_view *view = of->self->fixed.host->view;
    for (size_t c = 0; c < 3; c++)
        for (size_t at = begin; at < end; at += BLOCK)
            speed_row(of, c * view->n + at, end - at < BLOCK ? end - at : BLOCK,
                      view->inv_mass + at);
}

/* a (3,n) in m/s2 */
static void evaluate(struct symmetric *self, double t, const double *x, const double *v,
                     double *a) {
    const struct cs_host *host = self->fixed.host;
    const size_t n = host->view->n;
    host->force(host->ctx, t, x, v, CS_PART_ALL, a);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            a[c * n + i] *= host->view->inv_mass[i];
}

/* A step of dop853, whose displacement is not the difference of two rounded positions. */
static void take_start_step(struct symmetric *self, double t, double h, double *x, double *v) {
    const struct nystrom_pair *pair = &dop853_pair;
    const struct cs_host *host = self->fixed.host;
    const size_t n3 = 3 * (size_t)host->view->n;
    const int last = pair->stages - 1;
    // the inner stages; the last one is a result, and evaluated at the end
    self->f[0] = self->a[0];
    for (int i = 1; i < last; i++) {
        nystrom_combine(host, self->stage + i, self->f, h, x, self->next);
        evaluate(self, t + pair->nodes[i] * h, self->next, self->next + n3, self->f[i]);
    }
    nystrom_combine(host, self->stage + last, self->f, h, NULL, self->next);
    roll(self->s, DIFFERENCES);
    for (size_t i = 0; i < n3; i++) {
        const double moved = h * v[i] + self->next[i];
        self->s[0][i] = moved - self->d[i];
        self->d[i] = moved;
        x[i] += moved;
        v[i] += self->next[n3 + i];
    }
    roll(self->a, SLOPES);
    evaluate(self, t + h, x, v, self->a[0]);
    self->known++;
}

static void take_step(struct symmetric *self, double t, double h, double *x, double *v) {
    const struct cs_host *host = self->fixed.host;
    const size_t n = host->view->n;
    struct pass pass = {self, h, x, v};
    roll(self->s, DIFFERENCES);
    parallel_for(host, 3 * n, move_part, &pass);
    roll(self->a, SLOPES);
    host->force(host->ctx, t + h, x, v, CS_PART_ALL, self->a[0]);
    parallel_for(host, n, speed_part, &pass);
}

static enum cs_step step(struct fixed_step *loop, double t, double h, double *x, double *v) {
    struct symmetric *self = (struct symmetric *)loop;
    // the lengths of frames differ by rounding
    if (loop->history_void || fabs(h - self->h) > 1e-9 * h) {
        evaluate(self, t, x, v, self->a[0]);
        self->known = 0;
        self->h = h;
    }
    if (self->known < STARTS)
        take_start_step(self, t, h, x, v);
    else
        take_step(self, t, h, x, v);
    return CS_STEP_OK;
}

/* Allocates n arrays (3,n) and sets where. */
static bool take_arrays(const struct cs_host *host, double **arrays, int n) {
    for (int j = 0; j < n; j++)
        if (!(arrays[j] = host->alloc(host->ctx, 3 * sizeof(double) * (size_t)host->view->n)))
            return false;
    return true;
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const double dt = ((const struct symmetric_options *)options)->dt;
    const double omega = host->view->omega, delta = host->view->delta;
    struct symmetric *self = host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->fixed = fixed_step_of(host, dt, step);
    self->fixed.history_void = true;
    if (dt <= 0 && omega > 0) {
        self->fixed.dt = 0.9 * (delta > 0 ? LIMIT_DAMPED : LIMIT) / omega;
        if (self->fixed.dt * delta > 0.9 * LIMIT_DAMPING)
            self->fixed.dt = 0.9 * LIMIT_DAMPING / delta;
        host->note(host->ctx, "dt automatic: at most %.6g s (omega %.6g 1/s, delta %.6g 1/s)",
                   self->fixed.dt, omega, delta);
    }
    // dop853's first stage is at hand, and its last one is no array
    for (int i = 1; i < dop853_pair.stages; i++)
        self->stage[i] = nystrom_stage(&dop853_pair, i);
    self->next = host->alloc(host->ctx, 6 * sizeof(double) * (size_t)host->view->n);
    return self->next && take_arrays(host, self->a, SLOPES) &&
                   take_arrays(host, self->s, DIFFERENCES) && take_arrays(host, &self->d, 1) &&
                   take_arrays(host, self->f + 1, dop853_pair.stages - 2)
               ? CS_STEP_OK
               : CS_STEP_FAIL;
}

static enum cs_step archive(void *object, const struct cs_archive *archive) {
    struct symmetric *self = object;
    const size_t n3 = 3 * (size_t)self->fixed.host->view->n;
    archive->integers(archive->ctx, &self->known, 1);
    archive->reals(archive->ctx, &self->h, 1);
    for (int j = 0; j < SLOPES; j++)
        archive->reals(archive->ctx, self->a[j], n3);
    for (int j = 0; j < DIFFERENCES; j++)
        archive->reals(archive->ctx, self->s[j], n3);
    archive->reals(archive->ctx, self->d, n3);
    return fixed_step_archive(object, archive);
}

const struct cs_integrator symmetric_multistep = {
    .size = sizeof(struct cs_integrator),
    .name = "symmetric-multistep",
    .summary = "order 8 with one evaluation a step, for motion without contact and events: "
               "below 1e-4 without damping, 1e-8 with little",
    .source = "Quinlan, Tremaine 1990",
    .order = 8,
    .order_damped = 6,
    .traits = CS_MULTISTEP | CS_SMOOTH_ONLY,
    .fidelity = CS_FIDELITY_ODE,
    .options = rows,
    .n_options = sizeof rows / sizeof rows[0],
    .options_size = sizeof(struct symmetric_options),
    .create = create,
    .restart = fixed_step_restart,
    .advance = fixed_step_advance,
    .stats = fixed_step_stats,
    .save = archive,
    .load = archive,
};

/* composition.c - symplectic compositions of kicks and drifts, of order 4 and 6, for motion
 * without damping.
 *
 * With a = f(t, x, v) / m, a step is
 *   v += b_1 h a,  x += a_1 h v,  v += b_2 h a,  ...  x += a_(s-1) h v,  v += b_s h a
 * with a at the present x, and at t + (a_1 + ... + a_k) h. The last a is the first one of the
 * next step: s - 1 evaluations a step. Without damping a does not depend on v, and the step has
 * the order of its coefficients. With it a kick sees the velocity predicted for its middle by
 * the a before, which leaves order 2.
 *
 * A mode of frequency w is stable for h w < z, z by trial of the 2x2 matrix of a step. */
#include "fixed_step.h"
#include "leapfrog_limit.h"
#include "parallel.h"

#include <math.h>

enum { KICKS = 12 };

/* One set of coefficients. */
struct sequence {
    int kicks;             /* s */
    double kick[KICKS];    /* b_1 .. b_s */
    double drift[KICKS];   /* a_1 .. a_(s-1), then 0 */
    double limit, damping; /* z and q of limit() */
};

struct composition_options {
    double dt;
    int32_t method;
};

static const char *const methods[] = {"blanes-moan", "calvo-sanz-serna", "vefrl", NULL};
static const char *const variants[] = {"method=calvo-sanz-serna", "method=vefrl", NULL};

/* In the order of `methods`. */
static const struct sequence sequences[] = {
    /* order 6: Blanes, Moan 2002 (11 stages) */
    {.kicks = 12,
     .kick = {0.0414649985182624, 0.198128671918067, -0.0400061921041533, 0.0752539843015807,
              -0.0115113874206879, 0.2366699247869311, 0.2366699247869311, -0.0115113874206879,
              0.0752539843015807, -0.0400061921041533, 0.198128671918067, 0.0414649985182624},
     .drift = {0.123229775946271, 0.290553797799558, -0.127049212625417, -0.246331761062075,
               0.357208872795928, 0.20477705429147, 0.357208872795928, -0.246331761062075,
               -0.127049212625417, 0.290553797799558, 0.123229775946271},
     .limit = 9,
     .damping = 1},
    /* order 4, not symmetric: Calvo et al. 1993 */
    {.kicks = 5,
     .kick = {0.061758858135626325, 0.33897802655364334, 0.61479130717558371,
              -0.14054801465937337, 0.12501982279452613},
     .drift = {0.20517766154229387, 0.40302128160421459, -0.12092087633891008,
               0.51272193319240162},
     .limit = 3,
     .damping = 1.3},
    /* order 4: Omelyan, Mryglod, Folk 2002 (velocity extended Forest-Ruth-like) */
    {.kicks = 5,
     .kick = {0.164498651557576, 1.235692651138917, -1.800382605392986, 1.235692651138917,
              0.164498651557576},
     .drift = {0.5209433391039899, -0.02094333910398989, -0.02094333910398989,
               0.5209433391039899},
     .limit = 3.4,
     .damping = 6},
};

static const struct cs_option rows[] = {
    CS_OPTION(struct composition_options, dt, "s", 0, 0, 10,
              "maximum step; 0: 0.9 of the stability limit, estimated at rest"),
    CS_OPTION_CHOICE(struct composition_options, method, methods, 0,
                     "order 6 with 11 evaluations; order 4 with 4; order 4 with 4"),
};

struct composition {
    struct fixed_step fixed; /* first: the loop's functions take it for the whole */
    struct sequence of;
    double *f;         /* (3,n) in N of the last evaluation */
    double *predicted; /* (3,n) velocities that the next evaluation sees */
};

/* One stage of all particles by the force at hand: the kick, the drift, and the velocity
 * predicted for the next kick. Lengths in s. */
struct stage {
    const struct composition *self;
    double *x, *v;
    double kick, drift, ahead;
};

CS_CLONES static void stage_row(const struct stage *of, size_t at, size_t count,
                                const double *restrict inv_mass) {
    const double kick = of->kick, drift = of->drift, ahead = of->ahead;
    const double *restrict f = of->self->f + at;
    double *restrict x = of->x + at, *restrict v = of->v + at;
    double *restrict predicted = of->self->predicted + at;
    for (size_t i = 0; i < count; i++) {
        const double a = f[i] * inv_mass[i];
        v[i] += kick * a;
        x[i] += drift * v[i];
        predicted[i] = v[i] + ahead * a;
    }
}

static void stage_part(void *arg, size_t begin, size_t end) {
    const struct stage *of = arg;
    const struct cs_view *view = of->self->fixed.host->view;
    for (size_t c = 0; c < 3; c++)
        stage_row(of, c * view->n + begin, end - begin, view->inv_mass + begin);
}

static void evaluate(struct composition *self, double t, const double *x, const double *v) {
    const struct cs_host *host = self->fixed.host;
    host->force(host->ctx, t, x, v, CS_PART_ALL, self->f);
}

/* How far ahead of kick k the next evaluation predicts the velocity, as a fraction of h: half
 * of the next kick. The last kick goes on in the first of the next step. */
static double half_of_next(const struct sequence *of, int k) {
    const int next = k + 1, last = of->kicks - 1;
    if (k == last)
        return 0;
    return (of->kick[next] + (next == last ? of->kick[0] : 0)) / 2;
}

static enum cs_step step(struct fixed_step *loop, double t, double h, double *x, double *v) {
    struct composition *self = (struct composition *)loop;
    const struct sequence *of = &self->of;
    if (loop->history_void)
        evaluate(self, t, x, v);
    double node = 0;
    for (int k = 0; k < of->kicks; k++) {
        struct stage stage = {
            self, x, v, of->kick[k] * h, of->drift[k] * h, half_of_next(of, k) * h};
        parallel_for(loop->host, loop->host->view->n, stage_part, &stage);
        // the drifts add up to 1, but for rounding
        node = k + 2 < of->kicks ? node + of->drift[k] : 1;
        if (k + 1 < of->kicks)
            evaluate(self, t + node * h, x, self->predicted);
    }
    return CS_STEP_OK;
}

/* The longest stable step in s: the root h of (2 h omega / z)^2 + q r h = 4, with the damping
 * rate r = 2 delta. z and q are chosen so that it is at most 1.02 times the limit of a step's
 * matrix at damping ratios of 0 to 50. */
static double limit(const struct fixed_step *loop, double omega, double delta) {
    const struct sequence *of = &((const struct composition *)(const void *)loop)->of;
    return leapfrog_limit(2 * omega / of->limit, delta, of->damping, 4);
}

/* dt, as explicit.c chooses it. */
static void choose_dt(struct composition *self) {
    const struct cs_host *host = self->fixed.host;
    const struct cs_view *view = host->view;
    self->fixed.dt = 0.9 * limit(&self->fixed, view->omega, view->delta);
    host->note(host->ctx, "dt automatic: at most %.6g s (omega %.6g 1/s, delta %.6g 1/s)",
               self->fixed.dt, view->omega, view->delta);
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const struct composition_options *asked = options;
    const size_t bytes = 3 * sizeof(double) * (size_t)host->view->n;
    struct composition *self = host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->fixed = fixed_step_of(host, asked->dt, step);
    self->fixed.history_void = true;
    self->fixed.checks_free_motion = true;
    self->of = sequences[asked->method];
    if (asked->dt <= 0)
        choose_dt(self);
    if (!(self->f = host->alloc(host->ctx, bytes)) ||
        !(self->predicted = host->alloc(host->ctx, bytes)))
        return CS_STEP_FAIL;
    return fixed_step_guard(&self->fixed, asked->dt > 0 ? NULL : limit);
}

static enum cs_step archive(void *object, const struct cs_archive *archive) {
    struct composition *self = object;
    archive->reals(archive->ctx, self->f, 3 * (size_t)self->fixed.host->view->n);
    return fixed_step_archive(object, archive);
}

static const struct cs_integrator composition = {
    .size = sizeof(struct cs_integrator),
    .name = "composition",
    .summary = "symplectic, order 6 or 4: for motion without damping at errors below 1e-3",
    .source = "Blanes, Moan 2002; Calvo et al. 1993; Omelyan, Mryglod, Folk 2002",
    .order = 6,
    .order_damped = 2,
    .traits = CS_SYMPLECTIC,
    .fidelity = CS_FIDELITY_ODE,
    .options = rows,
    .n_options = sizeof rows / sizeof rows[0],
    .options_size = sizeof(struct composition_options),
    .create = create,
    .restart = fixed_step_restart,
    .advance = fixed_step_advance,
    .stats = fixed_step_stats,
    .save = archive,
    .load = archive,
    .variants = variants,
};

static const struct cs_integrator *const integrators[] = {&composition};

CS_EXPORT const struct cs_module clothsim_module = {
    .abi = CS_ABI,
    .size = sizeof(struct cs_integrator),
    .n = sizeof integrators / sizeof integrators[0],
    .integrators = integrators,
};

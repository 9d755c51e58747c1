/* composition.c - symplectic compositions of kicks and drifts, of order 4 and 6, for motion
 * without damping.
 *
 * With a = f(t, x, v) / m, a step is
 *   v += b_1 h a,  x += a_1 h v,  v += b_2 h a,  ...  x += a_(s-1) h v,  v += b_s h a
 * with a at the present x, and at t + (a_1 + ... + a_k) h. The last a is the first one of the
 * next step: s - 1 evaluations a step. Without damping a does not depend on v, and the step has
 * the order of its coefficients. With it a kick sees the velocity that the a before predicts.
 *
 * With damping=quadrature kick k sees v_0 + h sum w_j a_j instead, over the a of this step so
 * far and those of the step before. The w of least norm integrate polynomials exactly up to the
 * time of the kick. The x at kicks are off by h^2 e_j a + h^3 g_j a' + ..,  e_j = sum_(i<j) b_i
 * (c_j - c_i) - c_j^2 / 2, g_j = sum_(i<j) b_i (c_j - c_i) c_i - c_j^3 / 6,  c the times of
 * kicks, which would leave order 3: the w also make sum w_j e_j 0, at order 6 sum w_j c_j e_j
 * and sum w_j g_j too. With damping that gives order 4, and 5 for order 6. The first step is
 * repeated with weights over its own a, until these have that order. */
#include "composition_sequences.h"
#include "fixed_step.h"
#include "kick_drift.h"
#include "leapfrog_limit.h"
#include "parallel.h"
#include "quadrature_weights.h"

#include <math.h>
#include <string.h>

enum { BLOCK = 256 };

struct composition_options {
    double dt;
    int32_t method, damping;
};

static const char *const dampings[] = {"predicted", "quadrature", NULL};
static const char *const variants[] = {"method=calvo-sanz-serna", "method=vefrl",
                                       "damping=quadrature",
                                       "method=calvo-sanz-serna,damping=quadrature", NULL};

static const struct cs_option rows[] = {
    CS_OPTION(struct composition_options, dt, "s", 0, 0, 10,
              "maximum step; 0: 0.9 of the stability limit, estimated at rest"),
    CS_OPTION_CHOICE(struct composition_options, method, methods, 0,
                     "order 6 with 11 evaluations; order 4 with 4; order 4 with 4"),
    CS_OPTION_CHOICE(struct composition_options, damping, dampings, 0,
                     "order 2 with damping; order 5, or 4 of order 4, at shorter steps"),
};

struct composition {
    struct fixed_step fixed; /* first: the loop's functions take it for the whole */
    struct sequence of;
    /* (3,n) in N of each evaluation; without quadrature all are one array */
    double *f[KICKS];
    double *predicted; /* (3,n) velocities that the next evaluation sees */

    /* with quadrature */
    bool quadrature;
    double h;                           /* s, of the last step */
    double *older[KICKS];               /* (3,n) in N of the step before */
    double *start[2], *trial[2];        /* (3,n) x and v before a step, and in a repetition */
    double weights[KICKS][2 * KICKS];   /* of f, then of older */
    double first_weights[KICKS][KICKS]; /* of f, in a repeated step */
};

/* The velocity that a kick sees by quadrature: the forces with a weight, and these in s. */
struct quadrature {
    const struct composition *self;
    uint32_t n;
    const double *f[2 * KICKS];
    double weights[2 * KICKS];
};

CS_CLONES static void add_weighted(size_t count, double weight, const double *restrict f,
                                   double *restrict sum) {
    for (size_t i = 0; i < count; i++)
        sum[i] += weight * f[i];
}

static void see_row(const struct quadrature *of, size_t at, size_t count,
                    const double *inv_mass) {
    double sum[BLOCK] = {0};
    for (uint32_t j = 0; j < of->n; j++)
        add_weighted(count, of->weights[j], of->f[j] + at, sum);
    for (size_t i = 0; i < count; i++)
        of->self->predicted[at + i] = of->self->start[1][at + i] + sum[i] * inv_mass[i];
}

static void see_part(void *arg, size_t begin, size_t end) {
    const struct quadrature *of = arg;
    const struct cs_view *view = of->self->fixed.host->view;
    for (size_t c = 0; c < 3; c++)
        for (size_t at = begin; at < end; at += BLOCK)
            see_row(of, c * view->n + at, end - at < BLOCK ? end - at : BLOCK,
                    view->inv_mass + at);
}

static void add_force(struct quadrature *sum, double weight, const double *f) {
    if (weight != 0) {
        sum->f[sum->n] = f;
        sum->weights[sum->n++] = weight;
    }
}

static void evaluate(struct composition *self, double t, const double *x, const double *v,
                     double *f) {
    const struct cs_host *host = self->fixed.host;
    host->force(host->ctx, t, x, v, CS_PART_ALL, f);
}

/* How far ahead of kick k the next evaluation predicts the velocity, as a fraction of h: half
 * of the next kick. The last kick goes on in the first of the next step. */
static double half_of_next(const struct sequence *of, int k) {
    const int next = k + 1, last = of->kicks - 1;
    if (k == last)
        return 0;
    return (of->kick[next] + (next == last ? of->kick[0] : 0)) / 2;
}

/* The time of the kick after k, as a fraction of h: the drifts add up to 1, but for rounding.
 */
static double next_node(const struct sequence *of, int k, double node) {
    return k + 2 < of->kicks ? node + of->drift[k] : 1;
}

/* Kick k of a step, and the drift after it. */
static void take_stage(struct composition *self, int k, double h, double *x, double *v) {
    const struct sequence *of = &self->of;
    kick_drift((struct kick_drift){self->fixed.host, self->f[k], x, v, self->predicted,
                                   of->kick[k] * h, of->drift[k] * h, half_of_next(of, k) * h});
}

/* A step whose kicks see predicted velocities, with the force at its begin at hand. */
static void take_predicted(struct composition *self, double t, double h, double *x, double *v) {
    const struct sequence *of = &self->of;
    double node = 0;
    for (int k = 0; k < of->kicks; k++) {
        take_stage(self, k, h, x, v);
        node = next_node(of, k, node);
        if (k + 1 < of->kicks)
            evaluate(self, t + node * h, x, self->predicted, self->f[k + 1]);
    }
}

/* A step whose kicks see velocities by quadrature. repeated: over forces of this step alone,
 * which a former try of it has left; else with those of the step before. The force at the begin
 * is at hand. */
static void take_by_quadrature(struct composition *self, double t, double h, bool repeated,
                               double *x, double *v) {
    const struct sequence *of = &self->of;
    double node = 0;
    for (int k = 0; k < of->kicks; k++) {
        if (k > 0) {
            struct quadrature sum = {.self = self};
            for (int j = 0; j < of->kicks; j++)
                add_force(&sum, h * (repeated ? self->first_weights[k] : self->weights[k])[j],
                          self->f[j]);
            for (int j = 0; j < of->kicks && !repeated; j++)
                add_force(&sum, h * self->weights[k][KICKS + j], self->older[j]);
            parallel_for(self->fixed.host, self->fixed.host->view->n, see_part, &sum);
            evaluate(self, t + node * h, x, self->predicted, self->f[k]);
        }
        take_stage(self, k, h, x, v);
        node = next_node(of, k, node);
    }
}

static void copy_state(const struct composition *self, double *const to[2], const double *x,
                       const double *v) {
    const size_t bytes = 3 * sizeof *x * self->fixed.host->view->n;
    memcpy(to[0], x, bytes);
    memcpy(to[1], v, bytes);
}

/* The first step, or one after a change of the state, repeated from the same state: each
 * repetition makes the velocities that kicks see right to one more order. */
static void take_first(struct composition *self, double t, double h, double *x, double *v) {
    copy_state(self, self->trial, x, v);
    take_predicted(self, t, h, self->trial[0], self->trial[1]);
    for (int pass = 0; pass < self->of.degrees; pass++) {
        copy_state(self, self->trial, x, v);
        take_by_quadrature(self, t, h, true, self->trial[0], self->trial[1]);
    }
    double *const state[2] = {x, v};
    copy_state(self, state, self->trial[0], self->trial[1]);
}

/* Makes the forces of the last step those of the step before; its last one is at the begin of
 * this step. */
static void keep_forces(struct composition *self) {
    for (int k = 0; k < self->of.kicks; k++) {
        double *const kept = self->older[k];
        self->older[k] = self->f[k];
        self->f[k] = kept;
    }
    memcpy(self->f[0], self->older[self->of.kicks - 1],
           3 * sizeof(double) * self->fixed.host->view->n);
}

static enum cs_step step(struct fixed_step *loop, double t, double h, double *x, double *v) {
    struct composition *self = (struct composition *)loop;
    // the lengths of frames differ by rounding
    const bool follows =
        self->quadrature && !loop->history_void && fabs(h - self->h) <= 1e-9 * h;
    if (loop->history_void)
        evaluate(self, t, x, v, self->f[0]);
    else if (self->quadrature)
        keep_forces(self);
    if (self->quadrature)
        copy_state(self, self->start, x, v);
    if (follows)
        take_by_quadrature(self, t, h, false, x, v);
    else if (self->quadrature && loop->history_void)
        take_first(self, t, h, x, v);
    else
        take_predicted(self, t, h, x, v);
    self->h = h;
    return CS_STEP_OK;
}

/* A kick at time t of its step, as a node at t + shift; e and g above, about time 0. */
static struct quadrature_node node_at(const struct sequence *of, const double *times, int k,
                                      double shift) {
    const double t = times[k], at = t + shift;
    struct quadrature_node node = {{1}};
    double e = -t * t / 2, g = -t * t * t / 6;
    for (int i = 0; i < k; i++) {
        e += of->kick[i] * (t - times[i]);
        g += of->kick[i] * (t - times[i]) * times[i];
    }
    for (int r = 1; r < of->degrees; r++)
        node.row[r] = node.row[r - 1] * at;
    const double errors[] = {e, at * e, g + shift * e};
    for (int r = of->degrees; r < of->conditions; r++)
        node.row[r] = errors[r - of->degrees];
    return node;
}

/* Sets the weights of the quadrature. The last force of the step before is the first of this
 * one, and counts once. */
static void set_weights(struct composition *self) {
    const struct sequence *of = &self->of;
    const int s = of->kicks;
    double times[KICKS] = {0}, weights[QUADRATURE_NODES];
    struct quadrature_node own[KICKS], nodes[QUADRATURE_NODES];
    for (int k = 0; k + 1 < s; k++)
        times[k + 1] = next_node(of, k, times[k]);
    for (int k = 0; k < s; k++)
        own[k] = node_at(of, times, k, 0);
    for (int k = 1; k < s; k++) {
        memcpy(nodes, own, (size_t)k * sizeof *own);
        for (int j = 0; j + 1 < s; j++)
            nodes[k + j] = node_at(of, times, j, -1);
        quadrature_weights(k + s - 1, nodes, of->degrees, of->conditions, times[k], weights);
        memcpy(self->weights[k], weights, (size_t)k * sizeof *weights);
        memcpy(self->weights[k] + KICKS, weights + k, (size_t)(s - 1) * sizeof *weights);
        quadrature_weights(s, own, of->degrees, of->conditions, times[k],
                           self->first_weights[k]);
    }
}

/* The longest stable step in s: the root h of (2 h omega / z)^2 + q r h = 4, with the damping
 * rate r = 2 delta. z and q are chosen so that it is at most 1.02 times the limit of a step's
 * matrix at damping ratios of 0 to 50. */
static double limit(const struct fixed_step *loop, double omega, double delta) {
    const struct composition *self = (const struct composition *)(const void *)loop;
    const struct sequence *of = &self->of;
    const int by = self->quadrature;
    return leapfrog_limit(2 * omega / of->limit[by], delta, of->damping[by], 4);
}

/* dt, as explicit.c chooses it. */
static void choose_dt(struct composition *self) {
    const struct cs_host *host = self->fixed.host;
    const struct cs_view *view = host->view;
    self->fixed.dt = 0.9 * limit(&self->fixed, view->omega, view->delta);
    host->note(host->ctx, "dt automatic: at most %.6g s (omega %.6g 1/s, delta %.6g 1/s)",
               self->fixed.dt, view->omega, view->delta);
}

/* Allocates the forces of the evaluations, and what quadrature needs. */
static bool take_memory(struct composition *self) {
    const struct cs_host *host = self->fixed.host;
    const size_t bytes = 3 * sizeof(double) * (size_t)host->view->n;
    bool taken = (self->predicted = host->alloc(host->ctx, bytes));
    for (int k = 0; k < self->of.kicks && taken; k++)
        if (k == 0 || self->quadrature)
            taken = (self->f[k] = host->alloc(host->ctx, bytes));
        else
            self->f[k] = self->f[0];
    for (int k = 0; k < self->of.kicks && taken && self->quadrature; k++)
        taken = (self->older[k] = host->alloc(host->ctx, bytes));
    for (int k = 0; k < 2 && taken && self->quadrature; k++)
        taken = (self->start[k] = host->alloc(host->ctx, bytes)) &&
                (self->trial[k] = host->alloc(host->ctx, bytes));
    return taken;
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const struct composition_options *asked = options;
    struct composition *self = host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->fixed = fixed_step_of(host, asked->dt, step);
    self->fixed.history_void = true;
    self->fixed.free_motion = 1;
    self->of = sequences[asked->method];
    self->quadrature = asked->damping == 1;
    if (self->quadrature)
        set_weights(self);
    if (asked->dt <= 0)
        choose_dt(self);
    return take_memory(self) ? fixed_step_guard(&self->fixed, asked->dt > 0 ? NULL : limit)
                             : CS_STEP_FAIL;
}

static enum cs_step archive(void *object, const struct cs_archive *archive) {
    struct composition *self = object;
    const size_t n3 = 3 * (size_t)self->fixed.host->view->n;
    for (int k = 0; k < (self->quadrature ? self->of.kicks : 1); k++)
        archive->reals(archive->ctx, self->f[k], n3);
    if (self->quadrature)
        archive->reals(archive->ctx, &self->h, 1);
    return fixed_step_archive(object, archive);
}

static uint32_t order_of(const void *options, bool damped) {
    const struct composition_options *asked = options;
    return sequences[asked->method].order[damped ? 1 + asked->damping : 0];
}

static const struct cs_integrator composition = {
    .size = sizeof(struct cs_integrator),
    .name = "composition",
    .summary = "symplectic, order 6 or 4: for motion without damping at errors below 1e-3;"
               " with weak dampers, damping=quadrature at 1e-6 to 1e-8",
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
    .order_of = order_of,
};

static const struct cs_integrator *const integrators[] = {&composition};

CS_EXPORT const struct cs_module clothsim_module = {
    .abi = CS_ABI,
    .size = sizeof(struct cs_integrator),
    .n = sizeof integrators / sizeof integrators[0],
    .integrators = integrators,
};

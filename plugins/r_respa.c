/* r_respa.c - velocity Verlet with two steps: what holds a body together (springs, membranes
 * and bending, their dampers) at the short one, all other forces at the long one.
 *
 * With a_s = f_s / m of the slow forces (contact, air, gravity) and a_f of the fast ones, a
 * step of h is
 *   v += h/2 a_s(t)
 *   `ratio` times, with d = h/ratio:  v += d/2 a_f,  x += d v,  v += d/2 a_f(x, v + d/2 a_f)
 *   v += h/2 a_s(t + h, x, v + h/2 a_s)
 * Forces that depend on the velocity see a predicted one, as in velocity-verlet. a_f is
 * evaluated again after each slow kick, because dampers feel it: ratio + 1 fast evaluations
 * and one slow a step. It pays where contact costs several times the fast forces (Tuckerman,
 * Berne, Martyna 1992).
 *
 * The slow kicks are a drive of period h, and meet modes of the fast forces at h w = pi: there
 * no ratio makes the step stable. */
#include "fixed_step.h"
#include "kick_drift.h"
#include "leapfrog_limit.h"

struct respa_options {
    double dt;
    int64_t ratio;
};

static const struct cs_option rows[] = {
    CS_OPTION(struct respa_options, dt, "s", 0, 0, 10,
              "maximum step of the slow forces; 0: 0.9 of the stability limit, estimated at "
              "rest"),
    CS_OPTION(struct respa_options, ratio, "", 4, 1, 1000,
              "steps of springs, membranes and dampers per step of the slow forces"),
};

struct respa {
    struct fixed_step fixed; /* first: the loop's functions take it for the whole */
    int64_t ratio;
    double *slow, *fast; /* (3,n) in N at the last evaluation */
    double *predicted;   /* (3,n) velocities that the next evaluation sees */
};

/* A pass over the particles, with the host and the prediction of the method. */
static void move(const struct respa *self, struct kick_drift of) {
    of.host = self->fixed.host;
    of.predicted = self->predicted;
    kick_drift(of);
}

/* The fast steps from t to t + h. */
static void take_fast_steps(struct respa *self, double t, double h, double *x, double *v) {
    const struct cs_host *host = self->fixed.host;
    const double d = h / (double)self->ratio;
    host->force(host->ctx, t, x, v, CS_PART_INTERNAL, self->fast);
    for (int64_t k = 1; k <= self->ratio; k++) {
        move(self,
             (struct kick_drift){
                 .f = self->fast, .x = x, .v = v, .kick = d / 2, .drift = d, .ahead = d / 2});
        host->force(host->ctx, t + (double)k * d, x, self->predicted, CS_PART_INTERNAL,
                    self->fast);
        move(self, (struct kick_drift){.f = self->fast, .x = x, .v = v, .kick = d / 2});
    }
}

static enum cs_step step(struct fixed_step *loop, double t, double h, double *x, double *v) {
    struct respa *self = (struct respa *)loop;
    const struct cs_host *host = loop->host;
    if (loop->history_void)
        host->force(host->ctx, t, x, v, CS_PART_OUTER, self->slow);
    move(self, (struct kick_drift){.f = self->slow, .x = x, .v = v, .kick = h / 2});
    take_fast_steps(self, t, h, x, v);
    move(self, (struct kick_drift){.f = self->slow, .x = x, .v = v, .ahead = h / 2});
    host->force(host->ctx, t + h, x, self->predicted, CS_PART_OUTER, self->slow);
    move(self, (struct kick_drift){.f = self->slow, .x = x, .v = v, .kick = h / 2});
    return CS_STEP_OK;
}

/* The limit of velocity-verlet, in s. Without contact longer steps are stable too, up to h w =
 * pi, but those that meet an obstacle in motion end too deep inside. */
static double limit(const struct fixed_step *loop, double omega, double delta) {
    (void)loop;
    return leapfrog_limit(omega, delta, 4, 4);
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const struct respa_options *asked = options;
    const struct cs_view *view = host->view;
    struct respa *self = host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    // the first slow force comes with the first step
    self->fixed = fixed_step_of(host, asked->dt, step);
    self->fixed.history_void = true;
    self->ratio = asked->ratio;
    if (asked->dt <= 0 && (view->omega > 0 || view->delta > 0)) {
        self->fixed.dt = 0.9 * limit(&self->fixed, view->omega, view->delta);
        host->note(host->ctx, "dt automatic: at most %.6g s (omega %.6g 1/s, delta %.6g 1/s)",
                   self->fixed.dt, view->omega, view->delta);
    }
    double **const arrays[] = {&self->slow, &self->fast, &self->predicted};
    for (int k = 0; k < 3; k++)
        if (!(*arrays[k] = host->alloc(host->ctx, 3 * sizeof(double) * (size_t)view->n)))
            return CS_STEP_FAIL;
    return fixed_step_guard(&self->fixed, asked->dt > 0 ? NULL : limit);
}

static enum cs_step archive(void *object, const struct cs_archive *archive) {
    struct respa *self = object;
    archive->reals(archive->ctx, self->slow, 3 * (size_t)self->fixed.host->view->n);
    return fixed_step_archive(object, archive);
}

static const struct cs_integrator r_respa = {
    .size = sizeof(struct cs_integrator),
    .name = "r-respa",
    .summary = "Verlet with short steps for springs and membranes, long ones for contact and "
               "air: where contact costs more than the springs, at errors near 1e-3",
    .source = "Tuckerman, Berne, Martyna 1992",
    .order = 2,
    .order_damped = 2,
    .fidelity = CS_FIDELITY_ODE,
    .options = rows,
    .n_options = sizeof rows / sizeof rows[0],
    .options_size = sizeof(struct respa_options),
    .create = create,
    .restart = fixed_step_restart,
    .advance = fixed_step_advance,
    .stats = fixed_step_stats,
    .save = archive,
    .load = archive,
};

static const struct cs_integrator *const integrators[] = {&r_respa};

CS_EXPORT const struct cs_module clothsim_module = {
    .abi = CS_ABI,
    .size = sizeof(struct cs_integrator),
    .n = sizeof integrators / sizeof integrators[0],
    .integrators = integrators,
};

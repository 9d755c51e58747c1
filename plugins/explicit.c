/* explicit.c - explicit methods: their options, step limits and descriptors.
 *
 * Step limits for x'' + r x' + w^2 x = 0. The automatic dt is 0.9 of them, with bounds for w
 * and r that hold at rest:
 *   explicit-euler    h < r/w^2, and 4/(r + sqrt(r^2 - 4 w^2)) where overdamped
 *   averaged-euler    h < 2 r/w^2, and h < 2/r
 *   rk4               h |l| < RK4_REACH for both roots l, which are at most max(w, r)
 *   the others        h^2 w^2 + q r h < s with s = 4 (4 - 2 l with loss l) and q = 2, but 4 for
 *                     velocity-verlet, whose damping sees a predicted velocity
 *
 * Derivation. A step maps (x, v) by a 2x2 matrix with trace T and determinant D. Both its
 * eigenvalues lie inside the unit circle if D < 1, 1 + T + D > 0 and 1 - T + D > 0. The last
 * is h^2 w^2 > 0 in these three cases:
 *   explicit-euler    T = 2 - r h, D = 1 - r h + h^2 w^2. D < 1 is the first limit, and the
 *                     second is |1 + h l| < 1 for the larger real root l
 *   averaged-euler    T = 2 - r h - h^2 w^2/2, D = 1 - r h + h^2 w^2/2: D < 1 is h < 2 r/w^2,
 *                     1 + T + D = 4 - 2 r h
 *   symplectic-euler  T = 2 - r h - h^2 w^2, D = 1 - r h: 1 + T + D = 4 - 2 r h - h^2 w^2 */
#include "explicit_steps.h"
#include "leapfrog_limit.h"

struct explicit_options {
    double dt;
};

struct lossy_options {
    double dt, loss;
};

#define DT_HELP "0.9 of the stability limit, estimated at rest"

static const struct cs_option explicit_rows[] = {
    FIXED_STEP_DT(struct explicit_options, DT_HELP),
};

static const struct cs_option lossy_rows[] = {
    FIXED_STEP_DT(struct lossy_options, DT_HELP),
    CS_OPTION(struct lossy_options, loss, "", 0, 0, 0.999,
              "fraction of the motion lost in every step; 0.01 in the flag thesis; any value "
              "above 0 is a drag that grows as dt shrinks"),
};

/* The largest stable step in s of each method, with bounds omega on the frequency and delta on
 * half the damping rate. */
typedef double step_limit(const struct fixed_step *loop, double omega, double delta);

/* The limits of the head comment. Without frequency only damping counts. */
static double explicit_euler_limit(const struct fixed_step *loop, double w, double delta) {
    (void)loop;
    const double r = 2 * delta;
    if (w <= 0)
        return 2 / r;
    return r < 2 * w ? r / (w * w) : 4 / (r + sqrt(r * r - 4 * w * w));
}

static double averaged_euler_limit(const struct fixed_step *loop, double w, double delta) {
    (void)loop;
    const double r = 2 * delta;
    return w > r ? 2 * r / (w * w) : 2 / r;
}

static double symplectic_euler_limit(const struct fixed_step *loop, double w, double delta) {
    (void)loop;
    return leapfrog_limit(w, delta, 2, 4);
}

static double velocity_verlet_limit(const struct fixed_step *loop, double w, double delta) {
    (void)loop;
    return leapfrog_limit(w, delta, 4, 4);
}

static double position_verlet_limit(const struct fixed_step *loop, double w, double delta) {
    return leapfrog_limit(
        w, delta, 2,
        4 - 2 * ((const struct explicit_method *)(const void *)loop)->velocity_loss);
}

/* Radius of the half disc in the left half plane that lies in rk4's stability region: the
 * region reaches 2.83 along the imaginary axis and 2.78 along the real one, and least, 2.615,
 * in between. */
#define RK4_REACH 2.6

static double rk4_limit(const struct fixed_step *loop, double w, double delta) {
    (void)loop;
    const double r = 2 * delta;
    return RK4_REACH / (w > r ? w : r);
}

/* The automatic dt: 0.9 of the limit at rest. If nothing limits it, by error; if no
 * step is stable, that of symplectic Euler. Noted in the report. */
static void choose_dt(struct fixed_step *loop, double limit) {
    const struct cs_host *host = loop->host;
    const struct cs_view *view = host->view;
    loop->dt_automatic = true;
    loop->dt = 0.9 * limit;
    if (view->omega <= 0 && view->delta <= 0) {
        loop->dt = HUGE_VAL;
        host->note(host->ctx, "dt automatic: by error (no springs or dampers limit it)");
    } else if (limit <= 0) {
        loop->dt = 0.9 * symplectic_euler_limit(loop, view->omega, view->delta);
        host->note(host->ctx,
                   "dt automatic: no step is stable without damping; %.6g s is the limit of "
                   "symplectic-euler",
                   loop->dt);
    } else
        host->note(host->ctx, "dt automatic: at most %.6g s (omega %.6g 1/s, delta %.6g 1/s)",
                   loop->dt, view->omega, view->delta);
}

/* Allocates a method with n_arrays arrays (3,n): the force, and n_arrays - 1 of history.
 * limit is the stability limit, which also watches contact if dt is automatic. */
static enum cs_step create(const struct cs_host *host, const struct lossy_options *asked,
                           step_limit *limit, fixed_step_callback *step, int n_arrays,
                           void **out) {
    const size_t bytes = 3 * sizeof(double) * (size_t)host->view->n;
    struct explicit_method *self = host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->fixed = fixed_step_of(host, asked->dt, step);
    self->fixed.history_void = true;
    self->velocity_loss = asked->loss;
    if (!(self->a = host->alloc(host->ctx, bytes)))
        return CS_STEP_FAIL;
    self->n_history = (size_t)n_arrays - 1;
    if (n_arrays > 1 && !(self->history = host->alloc(host->ctx, bytes * self->n_history)))
        return CS_STEP_FAIL;
    if (asked->dt <= 0)
        choose_dt(&self->fixed, limit(&self->fixed, host->view->omega, host->view->delta));
    // without damping some methods have no stable step: then symplectic-euler's, as choose_dt
    const bool stable = limit(&self->fixed, host->view->omega, host->view->delta) > 0;
    self->fixed.free_motion = step == step_rk4 ? 1 : 0;
    return fixed_step_guard(&self->fixed, asked->dt > 0 ? NULL
                                          : stable      ? limit
                                                        : symplectic_euler_limit);
}

/* create for a method whose options are explicit_rows. */
static enum cs_step create_lossless(const struct cs_host *host, const void *options,
                                    step_limit *limit, fixed_step_callback *step, int n_arrays,
                                    void **self) {
    const struct lossy_options asked = {.dt = ((const struct explicit_options *)options)->dt};
    return create(host, &asked, limit, step, n_arrays, self);
}

static enum cs_step create_explicit_euler(const struct cs_host *host, const void *options,
                                          void **self) {
    return create_lossless(host, options, explicit_euler_limit, step_explicit_euler, 1, self);
}

static enum cs_step create_symplectic_euler(const struct cs_host *host, const void *options,
                                            void **self) {
    return create_lossless(host, options, symplectic_euler_limit, step_symplectic_euler, 1,
                           self);
}

static enum cs_step create_averaged_euler(const struct cs_host *host, const void *options,
                                          void **self) {
    return create_lossless(host, options, averaged_euler_limit, step_averaged_euler, 1, self);
}

static enum cs_step create_velocity_verlet(const struct cs_host *host, const void *options,
                                           void **self) {
    return create_lossless(host, options, velocity_verlet_limit, step_velocity_verlet, 2, self);
}

static enum cs_step create_position_verlet(const struct cs_host *host, const void *options,
                                           void **self) {
    return create(host, options, position_verlet_limit, step_position_verlet, 3, self);
}

static enum cs_step create_rk4(const struct cs_host *host, const void *options, void **self) {
    return create_lossless(host, options, rk4_limit, step_rk4, 5, self);
}

/* save and load of the Verlet methods, which store an evaluation, or a half step, from step
 * to step. */
static enum cs_step verlet_archive(void *object, const struct cs_archive *archive) {
    struct explicit_method *self = object;
    const size_t n3 = 3 * (size_t)self->fixed.host->view->n;
    archive->reals(archive->ctx, &self->h, 1);
    archive->reals(archive->ctx, self->a, n3);
    archive->reals(archive->ctx, self->history, n3); // not what a refusal takes back
    return fixed_step_archive(self, archive);
}

#define EXPLICIT(struct_, rows_, archive_)                                                     \
    .size = sizeof(struct cs_integrator), .options = rows_,                                    \
    .n_options = sizeof rows_ / sizeof rows_[0], .options_size = sizeof(struct_),              \
    .fidelity = CS_FIDELITY_ODE, .advance = fixed_step_advance, .stats = fixed_step_stats,     \
    .save = archive_, .load = archive_

/* without damping the eigenvalues of a step lie outside the unit circle */
static const char *const gains_energy[] = {"energy", "contact-energy", "restitution", NULL};

/* The output v is computed with the old acceleration, because the new one belongs to the next
 * step. The method is symplectic and symmetric in (x - x_old)/h, not in this v. */
static const char *const late_velocity[] = {"angular-momentum", "reversible", NULL};

static const struct cs_integrator explicit_euler = {
    EXPLICIT(struct explicit_options, explicit_rows, fixed_step_archive),
    .name = "explicit-euler",
    .summary = "forward Euler: unstable unless damping is strong relative to dt",
    .source = "Euler 1768; cloth thesis, eq. 5.15",
    .order = 1,
    .order_damped = 1,
    .fails = gains_energy,
    .create = create_explicit_euler,
    .restart = fixed_step_restart,
};

static const struct cs_integrator symplectic_euler = {
    EXPLICIT(struct explicit_options, explicit_rows, fixed_step_archive),
    .name = "symplectic-euler",
    .summary = "velocity first, then position with the new velocity",
    .source = "flag thesis; Hairer, Lubich, Wanner 2006, sec. I.1.2",
    .order = 1,
    .order_damped = 1,
    .traits = CS_SYMPLECTIC,
    .create = create_symplectic_euler,
    .restart = fixed_step_restart,
};

static const struct cs_integrator averaged_euler = {
    EXPLICIT(struct explicit_options, explicit_rows, fixed_step_archive),
    .name = "averaged-euler",
    .summary = "forward Euler whose position moves by the mean of old and new velocity",
    .source = "cloth article",
    .order = 1,
    .order_damped = 1,
    .fails = gains_energy,
    .create = create_averaged_euler,
    .restart = fixed_step_restart,
};

static const struct cs_integrator velocity_verlet = {
    EXPLICIT(struct explicit_options, explicit_rows, verlet_archive),
    .name = "velocity-verlet",
    .summary = "kick, drift, kick; damping sees a predicted velocity",
    .source = "Swope et al. 1982; Hairer, Lubich, Wanner 2003",
    .order = 2,
    .order_damped = 2,
    .traits = CS_SYMPLECTIC,
    .create = create_velocity_verlet,
    .restart = fixed_step_restart,
};

static const struct cs_integrator position_verlet = {
    EXPLICIT(struct lossy_options, lossy_rows, verlet_archive),
    .name = "position-verlet",
    .summary = "two-step Verlet on positions, with a loss; damping sees the last half step",
    .source = "Verlet 1967; flag thesis",
    .order = 2,
    .order_damped = 1,
    .traits = CS_MULTISTEP | CS_SYMPLECTIC,
    .fails = late_velocity,
    .create = create_position_verlet,
    .restart = restart_position_verlet,
};

static const struct cs_integrator rk4 = {
    EXPLICIT(struct explicit_options, explicit_rows, fixed_step_archive),
    .name = "rk4",
    .summary = "the classical Runge-Kutta method: four evaluations per step",
    .source = "Kutta 1901; Hairer, Norsett, Wanner 1993, sec. II.1",
    .order = 4,
    .order_damped = 4,
    .create = create_rk4,
    .restart = fixed_step_restart,
};

static const struct cs_integrator *const integrators[] = {
    &explicit_euler,  &symplectic_euler, &averaged_euler,
    &velocity_verlet, &position_verlet,  &rk4,
};

CS_EXPORT const struct cs_module clothsim_module = {
    .abi = CS_ABI,
    .size = sizeof(struct cs_integrator),
    .n = sizeof integrators / sizeof integrators[0],
    .integrators = integrators,
};

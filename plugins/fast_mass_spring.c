/* Implicit Euler by local/global steps with a constant matrix.
 *
 * A spring's energy is the least over p with |p| = L of k/2 |x_b - x_a - p|^2. In turn,
 * `iterations` times over, from the place y = x + h v + h^2 f/m that the outer forces alone
 * lead to:
 *   local    p = L n with n the direction of the spring
 *   global   (M + h D + h^2 L) u = sum over springs of h^2 k (p - (y_b - y_a)) + dampers,
 *            x = y + u
 * (Liu et al. 2013, for u instead of x, so that free flight leaves no rounding). Neither half
 * can raise the incremental potential, and where both leave x as it is, x is the implicit Euler
 * step. Then v = (x' - x)/h.
 *
 * Dampers and drag are implicit too. Relative dampers and drag are in the matrix. An axial
 * damper is there as if it were relative, and its part across the spring is given back from the
 * last x: h c (I - n n^T)((x_b - x_a) - (x_b - x_a)_old), which is the same kind of projection.
 * All other forces are those that the state at the start of the step has at its end.
 */
#include "constant_matrix.h"
#include "fixed_step.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* The forces that neither the springs nor the matrix contain. */
#define EXPLICIT_PARTS (CS_PART_OUTER & ~CS_PART_DRAG)

struct local_global_options {
    double dt;
    int64_t iterations;
};

static const struct cs_option rows[] = {
    CS_OPTION(struct local_global_options, dt, "s", 0, 0, 10,
              "maximum step; 0: one step per frame"),
    CS_OPTION(struct local_global_options, iterations, "", 10, 1, 1e6,
              "iterations per step, each with a local and a global solve"),
};

struct local_global {
    struct fixed_step loop; /* first: the loop's functions take it for the whole */
    int64_t iterations;
    struct constant_matrix matrix;
    double *f;       /* (3,n) in N: outer forces */
    double *old;     /* (3,n) in m: where the step began */
    double *y;       /* (3,n) in m */
    double *b;       /* (4,n) in kg m: right-hand side; the last row is 0 */
    uint64_t passes; /* local and global halves */
};

/* d = x_b - x_a of the ends of a spring. */
static void difference(size_t n, const uint32_t ends[2], const double *x, double d[3]) {
    for (size_t c = 0; c < 3; c++)
        d[c] = x[c * n + ends[1]] - x[c * n + ends[0]];
}

/* The pull of spring s on its second end, in kg m: h^2 k (L n - e_y), and of its damper - h c
 * (e_y - e_old). An axial damper gets h c (I - n n^T)(e - e_old) back. The first end gets the
 * opposite. */
static void spring_impulse(const struct local_global *self, size_t s, const double *x,
                           double pull[3]) {
    const struct cs_view *view = self->loop.host->view;
    const size_t n = view->n;
    const uint32_t *ends = view->ends + 2 * s;
    const double h = self->matrix.h, hc = h * view->damping[s];
    const double h2k = h * h * view->stiffness[s];
    double e[3], e_y[3], e_old[3], squared = DBL_MIN, along = 0;
    difference(n, ends, x, e);
    difference(n, ends, self->y, e_y);
    difference(n, ends, self->old, e_old);
    for (int c = 0; c < 3; c++)
        squared += e[c] * e[c];
    // two particles in one place have no direction: n is 0
    const double inverse = 1 / sqrt(squared);
    for (int c = 0; c < 3; c++)
        along += e[c] * inverse * (e[c] - e_old[c]);
    for (int c = 0; c < 3; c++) {
        const double unit = e[c] * inverse;
        pull[c] = h2k * (view->length[s] * unit - e_y[c]) - hc * (e_y[c] - e_old[c]);
        if (view->axial[s])
            pull[c] += hc * (e[c] - e_old[c] - along * unit);
    }
}

/* The local half: the whole right-hand side at x, with 0 for pinned particles. */
static void fill_rhs(struct local_global *self, const double *x) {
    const struct cs_view *view = self->loop.host->view;
    const size_t n = view->n;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0, k = c * n; i < n; i++, k++)
            self->b[k] = -self->matrix.h * self->matrix.drag[i] * (self->y[k] - self->old[k]);
    for (size_t s = 0; s < view->n_springs; s++) {
        double pull[3];
        spring_impulse(self, s, x, pull);
        for (size_t c = 0; c < 3; c++) {
            self->b[c * n + view->ends[2 * s]] -= pull[c];
            self->b[c * n + view->ends[2 * s + 1]] += pull[c];
        }
    }
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            if (view->inv_mass[i] <= 0)
                self->b[c * n + i] = 0;
}

static enum cs_step step(struct fixed_step *loop, double t, double step_length, double *x,
                         double *v) {
    struct local_global *self = (struct local_global *)loop;
    const struct cs_host *host = loop->host;
    const size_t n = host->view->n;
    // implicit in time: what ramps change, springs too, is as at the end of the step
    host->force(host->ctx, t + step_length, x, v, EXPLICIT_PARTS, self->f);
    enum cs_step status = constant_matrix_prepare(&self->matrix, t, step_length);
    if (status != CS_STEP_OK)
        return status;
    const double h = self->matrix.h;
    memcpy(self->old, x, 3 * n * sizeof *x);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0, k = c * n; i < n; i++, k++) {
            v[k] += h * self->f[k] * host->view->inv_mass[i];
            self->y[k] = x[k] += h * v[k];
        }

    const double *u = self->b;
    for (int64_t i = 0; i < self->iterations; i++) {
        fill_rhs(self, x);
        status = constant_matrix_solve(&self->matrix, self->b, &u);
        if (status != CS_STEP_OK)
            return status;
        for (size_t k = 0; k < 3 * n; k++)
            x[k] = self->y[k] + u[k];
        self->passes++;
    }
    for (size_t k = 0; k < 3 * n; k++)
        v[k] += u[k] / h;
    return CS_STEP_OK;
}

static enum cs_step restart(void *object, double t, const double *x, const double *v) {
    constant_matrix_restart(&((struct local_global *)object)->matrix);
    return fixed_step_restart(object, t, x, v);
}

static enum cs_step advance(void *object, double t0, double t1, double *x, double *v) {
    struct local_global *self = object;
    constant_matrix_read_drag(&self->matrix, t0, t1, x, self->b, self->f);
    return fixed_step_advance(object, t0, t1, x, v);
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const struct local_global_options *asked = options;
    const size_t bytes = 3 * sizeof(double) * (size_t)host->view->n;
    struct local_global *self = host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->loop = fixed_step_of(host, asked->dt, step);
    self->iterations = asked->iterations;
    if (!(self->f = host->alloc(host->ctx, bytes)) ||
        !(self->old = host->alloc(host->ctx, bytes)) ||
        !(self->y = host->alloc(host->ctx, bytes)) ||
        !(self->b = host->alloc(host->ctx, bytes / 3 * 4)))
        return CS_STEP_FAIL;
    if (constant_matrix_init(&self->matrix, host) != CS_STEP_OK)
        return CS_STEP_FAIL;
    return fixed_step_guard(&self->loop, NULL);
}

static void stats(const void *object, struct cs_stats *out) {
    fixed_step_stats(object, out);
    out->newton = ((const struct local_global *)object)->passes;
    if (CS_HAS(out, sweeps))
        out->sweeps = 2 * out->newton; // the right-hand side, and the solve
}

static void destroy(void *object) {
    constant_matrix_finish(&((struct local_global *)object)->matrix);
}

static enum cs_step save(void *object, const struct cs_archive *archive) {
    struct local_global *self = object;
    constant_matrix_archive(&self->matrix, archive);
    archive->integers(archive->ctx, &self->passes, 1);
    return fixed_step_archive(self, archive);
}

static enum cs_step load(void *object, const struct cs_archive *archive) {
    struct local_global *self = object;
    const enum cs_step status = constant_matrix_load(&self->matrix, archive);
    archive->integers(archive->ctx, &self->passes, 1);
    return status == CS_STEP_OK ? fixed_step_archive(self, archive) : status;
}

/* a number of the preprocessor as a text */
#define TEXT_OF(number) #number
#define TEXT(number)    TEXT_OF(number)

static const struct cs_integrator fast_mass_spring = {
    .size = sizeof(struct cs_integrator),
    .name = "fast-mass-spring",
    .summary = "implicit Euler by local projections and one constant matrix, factored once",
    .source = "Liu, Bargteil, O'Brien, Kavan 2013",
    .order = 1,
    .order_damped = 1,
    .needs = CS_NEED_SPRINGS,
    .traits = CS_IMPLICIT | CS_LIBRARY_BITS | CS_EXPLICIT_OUTER,
    .fidelity = CS_FIDELITY_IMPLICIT_EULER,
    .options = rows,
    .n_options = sizeof rows / sizeof rows[0],
    .options_size = sizeof(struct local_global_options),
    .create = create,
    .restart = restart,
    .advance = advance,
    .stats = stats,
    .destroy = destroy,
    .save = save,
    .load = load,
    .library = "CHOLMOD " TEXT(CHOLMOD_MAIN_VERSION) "." TEXT(CHOLMOD_SUB_VERSION) "." TEXT(
        CHOLMOD_SUBSUB_VERSION),
};

static const struct cs_integrator *const integrators[] = {&fast_mass_spring};

CS_EXPORT const struct cs_module clothsim_module = {
    .abi = CS_ABI,
    .size = sizeof(struct cs_integrator),
    .n = sizeof integrators / sizeof integrators[0],
    .integrators = integrators,
};

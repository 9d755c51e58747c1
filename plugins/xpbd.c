/* xpbd.c - extended position based dynamics: springs as constraints with compliance.
 *
 * With h the step, y = x + h v + h^2 f/m the position that the outer forces alone lead to, and
 * for a spring of stiffness k and rest length L, unit direction n, C = |x_b - x_a| - L and
 * compliance a = 1/(k h^2), the springs in turn, `iterations` times over, from x = y and l = 0:
 *   dl = (-C - a l - g n.(d - d_old)) / ((1 + g) (w_a + w_b) + a),   g = c/(k h)
 *   l += dl, x_b += w_b dl n, x_a -= w_a dl n,   w the inverse masses
 * (Macklin et al. 2016, eq. 18 and 26; d = x_b - x_a, c the axial damping). Then
 * v = (x' - x)/h. Relative damping is a constraint d = d_old of compliance 1/(c h) beside the
 * spring. Outer forces, drag too, are those at the start of the step.
 *
 * Contact by force comes after the springs in each pass, particle by particle: with its force F
 * at x and at the velocity (x - x_old)/h, its part B of an implicit step's matrix and the
 * impulse p that it has given so far,
 *   dx = (m + B)^-1 (h h F - p), p += m dx, x += dx,
 * a Newton step for p = h h F. For a force along one direction that is a constraint of
 * compliance 1/(k h^2) with k the law's stiffness; friction and damping come along as functions
 * of x.
 *
 * An error of the passes is energy: ten passes over a sheet of 32 x 32 in a step of 1/60 s let
 * it stretch by 130 %, with a hundred times the energy that it has, whatever g. Short substeps
 * leave less of it than passes of the same number (Macklin et al. 2019); `substeps` 0 chooses
 * them by the springs.
 *
 * As the iterations grow the result settles, but not on implicit Euler: the directions that the
 * multipliers l belong to are those at which they were found. The difference vanishes with h.
 * Mode pbd forgets the multipliers after every iteration, so that each corrects the same
 * fraction (w_a + w_b) / (w_a + w_b + a) of what is left (Mueller et al. 2007, eq. 10 and 11,
 * with that fraction as k): springs become stiffer with each iteration, and nothing converges.
 * Contact keeps its impulses in either mode.
 */
#include "fixed_step.h"
#include "spring_groups.h"

#include <clothsim/small.h>
#include <math.h>
#include <string.h>

/* The parts that contact by force consists of, in scenes that have it. */
#define CONTACT (CS_PART_POTENTIAL | CS_PART_DISSIPATIVE)

/* Largest h omega of chosen substeps, with omega the bound on the angular frequency. By trial
 * with one pass: at 2 shipped scenes without contact by force gain at most a fifth of the
 * energy that they have; at 4 some gain more than that, and at 8 many do. */
#define RESOLVED 2.0

enum mode { XPBD, PBD };
static const char *const modes[] = {"xpbd", "pbd", NULL};

struct xpbd_options {
    double dt;
    int64_t iterations, substeps;
    int32_t mode;
};

static const struct cs_option rows[] = {
    FIXED_STEP_DT_BY_ERROR(struct xpbd_options),
    CS_OPTION(struct xpbd_options, iterations, "", 10, 1, 1e6,
              "passes over the springs in a step"),
    CS_OPTION(struct xpbd_options, substeps, "", 1, 0, 1e6,
              "equal substeps of each step of dt, each with all its iterations: many substeps "
              "with one iteration beat one substep with many (Macklin et al. 2019); 0: as many "
              "as the springs need, so that energy does not grow with one iteration"),
    CS_OPTION_CHOICE(struct xpbd_options, mode, modes, XPBD,
                     "xpbd keeps the multipliers over the iterations of a step; pbd forgets "
                     "them, so that stiffness grows with the iterations"),
};

struct xpbd {
    struct fixed_step loop; /* first: the loop's functions take it for the whole */
    int64_t iterations, substeps;
    bool forgets; /* mode pbd */
    double *f;    /* (3,n) in N: outer forces */
    double *old;  /* (3,n) in m: where the step began */
    struct spring_groups springs;
    const struct spring_sweeps *sweeps;
    uint64_t passes; /* over the springs */

    /* in scenes with contact by force, else NULL */
    double *impulse; /* (3,n) p in kg m */
    double *blocks;  /* (6,n) B in kg */
    double *speed;   /* (3,n) in m/s */
};

/* One Newton step of each particle towards p = h h F, at the end t of the step. Uses self->f
 * as scratch. */
static void touch(struct xpbd *self, double t, double h, double *x) {
    const struct cs_host *host = self->loop.host;
    const size_t n = host->view->n;
    for (size_t k = 0; k < 3 * n; k++)
        self->speed[k] = (x[k] - self->old[k]) / h;
    host->force(host->ctx, t, x, self->speed, CONTACT, self->f);
    host->contact_blocks(host->ctx, t, x, self->speed, h, self->blocks);
    for (size_t i = 0; i < n; i++) {
        const double mass = host->view->mass[i];
        double b[6], r[3], dx[3];
        cs_sym3_read(n, self->blocks, i, b);
        b[0] += mass, b[3] += mass, b[5] += mass;
        // what is not finite is left for the blow-up test
        if (host->view->inv_mass[i] == 0 || !cs_sym3_invert(b, b))
            continue;
        for (size_t c = 0; c < 3; c++)
            r[c] = h * h * self->f[c * n + i] - self->impulse[c * n + i];
        cs_sym3_mul(b, r, dx);
        for (size_t c = 0; c < 3; c++) {
            self->impulse[c * n + i] += mass * dx[c];
            x[c * n + i] += dx[c];
        }
    }
}

static enum cs_step step(struct fixed_step *loop, double t, double h, double *x, double *v) {
    struct xpbd *self = (struct xpbd *)loop;
    const struct cs_host *host = loop->host;
    const size_t n = host->view->n;
    const uint32_t outer = self->impulse ? CS_PART_OUTER & ~CONTACT : CS_PART_OUTER;
    host->force(host->ctx, t, x, v, outer, self->f);
    memcpy(self->old, x, 3 * n * sizeof *x);
    // ramps change them with the time of the force above
    spring_groups_read_constants(&self->springs, host->view, h);
    spring_groups_gather(&self->springs, host->view, x);
    self->sweeps->note_old(&self->springs);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0, k = c * n; i < n; i++, k++) {
            v[k] += h * self->f[k] * host->view->inv_mass[i];
            x[k] += h * v[k];
        }

    if (self->impulse)
        memset(self->impulse, 0, 3 * n * sizeof *x);
    spring_groups_gather(&self->springs, host->view, x);
    for (int64_t i = 0; i < self->iterations; i++) {
        self->sweeps->sweep(&self->springs, i == 0 || self->forgets);
        self->passes++;
        if (!self->impulse)
            continue;
        spring_groups_scatter(&self->springs, host->view, x);
        touch(self, t + h, h, x);
        spring_groups_gather(&self->springs, host->view, x);
    }
    spring_groups_scatter(&self->springs, host->view, x);
    // (x - old) / h by what the springs moved, so that free flight keeps every bit of v
    for (size_t k = 0; k < 3 * n; k++)
        v[k] += (x[k] - (self->old[k] + h * v[k])) / h;
    return CS_STEP_OK;
}

/* Length in s of the equal substeps of a step of h. */
static double substep_of(const struct xpbd *self, double h) {
    const double needed = ceil(h * self->loop.host->view->omega / RESOLVED);
    return h / (self->substeps > 0 ? (double)self->substeps : fmax(needed, 1));
}

/* The loop with each of its steps cut into equal parts. */
static enum cs_step advance(void *object, double t0, double t1, double *x, double *v) {
    struct xpbd *self = object;
    const double dt = self->loop.dt;
    const bool automatic = self->loop.dt_automatic;
    double n;
    enum cs_step status = fixed_step_count(&self->loop, t1 - t0, &n);
    if (status != CS_STEP_OK)
        return status;
    // the reduced dt is noted once above, and substeps are no reduction
    self->loop.dt = substep_of(self, (t1 - t0) / n);
    self->loop.dt_automatic = true;
    status = fixed_step_advance(self, t0, t1, x, v);
    self->loop.dt = dt;
    self->loop.dt_automatic = automatic;
    return status;
}

/* Allocates the arrays of contact by force; the host offers contact_blocks only in such
 * scenes. */
static enum cs_step take_contact(struct xpbd *self, size_t vectors) {
    const struct cs_host *host = self->loop.host;
    if (!CS_HAS(host, contact_blocks) || !host->contact_blocks)
        return CS_STEP_OK;
    if (!(self->impulse = host->alloc(host->ctx, vectors)) ||
        !(self->blocks = host->alloc(host->ctx, 2 * vectors)) ||
        !(self->speed = host->alloc(host->ctx, vectors)))
        return CS_STEP_FAIL;
    return CS_STEP_OK;
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const struct xpbd_options *asked = options;
    const struct cs_view *view = host->view;
    const size_t vectors = 3 * sizeof(double) * (size_t)view->n;
    struct xpbd *self = host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->loop = fixed_step_of(host, asked->dt, step);
    self->iterations = asked->iterations;
    self->substeps = asked->substeps;
    self->sweeps = spring_sweeps();
    self->forgets = asked->mode == PBD;
    if (!(self->f = host->alloc(host->ctx, vectors)) ||
        !(self->old = host->alloc(host->ctx, vectors)) ||
        spring_groups_init(&self->springs, host) != CS_STEP_OK)
        return CS_STEP_FAIL;
    if (take_contact(self, vectors) != CS_STEP_OK)
        return CS_STEP_FAIL;
    self->loop.free_motion = 1;
    return fixed_step_guard(&self->loop, NULL);
}

static void stats(const void *object, struct cs_stats *out) {
    fixed_step_stats(object, out);
    out->newton = ((const struct xpbd *)object)->passes;
    if (CS_HAS(out, sweeps))
        out->sweeps = out->newton;
}

static enum cs_step archive(void *object, const struct cs_archive *archive) {
    archive->integers(archive->ctx, &((struct xpbd *)object)->passes, 1);
    return fixed_step_archive(object, archive);
}

static const struct cs_integrator xpbd = {
    .size = sizeof(struct cs_integrator),
    .name = "xpbd",
    .summary =
        "springs as constraints, one after the other; cheap, damps, settles beside implicit "
        "Euler; its default makes energy on some scenes, substeps=0,iterations=1 little",
    .source = "Macklin, Mueller, Chentanez 2016; small steps: Macklin et al. 2019; pbd: "
              "Mueller et al. 2007",
    .order = 1,
    .order_damped = 1,
    .needs = CS_NEED_SPRINGS,
    .traits = CS_IMPLICIT | CS_MAKES_ENERGY,
    .fidelity = CS_FIDELITY_CONSISTENT,
    .options = rows,
    .n_options = sizeof rows / sizeof rows[0],
    .options_size = sizeof(struct xpbd_options),
    .create = create,
    .restart = fixed_step_restart,
    .advance = advance,
    .stats = stats,
    .save = archive,
    .load = archive,
};

static const struct cs_integrator *const integrators[] = {&xpbd};

CS_EXPORT const struct cs_module clothsim_module = {
    .abi = CS_ABI,
    .size = sizeof(struct cs_integrator),
    .n = sizeof integrators / sizeof integrators[0],
    .integrators = integrators,
};

/* vbd.c - vertex block descent: implicit Euler, particle by particle; and augmented vertex
 * block descent, whose passes see springs of which none is stiff (augmented_springs.h).
 *
 * With h the step and y = x + h v + h^2 f/m the position that the outer forces alone lead to, a
 * step of implicit Euler minimises G(z) = |z - y|_M^2 / 2 + h^2 E(z). A pass visits the
 * particles, colour by colour, and moves each one by a Newton step of G in its own three
 * coordinates, with all others where they are (Chen et al. 2024, eq. 8): (m + h^2 K_ii + h D_ii
 * + B) dz = m (y - z) + h^2 F + h^2 sum over its springs of -k (1 - L/r) d - c/h (d - d_old)
 * with d = z_i - z_j, r = |d|, and n n^T (d - d_old) in place of d - d_old for an axial damper.
 * K_ii leaves out the transverse part k (1 - L/r) (I - n n^T) of a compressed spring, so that
 * the block is positive definite. Then v = (z - x)/h. As the passes grow z becomes the implicit
 * Euler step; dampers are implicit too, and outer forces those at the begin of the step.
 *
 * No spring joins two particles of one colour, so that those of one are independent: eight of
 * them are done at once in vectors (a group), groups by all threads, to the same bits.
 *
 * Contact by force is linearised before each pass at the state z_p: F = F_p and h^2 F changes
 * by -B (z - z_p), with the host's contact blocks B. It follows its own law at the end.
 *
 * Chebyshev's semi-iterative method (Wang 2015) accelerates the passes: for an estimate rho of
 * their rate of convergence, z_{k+1} = w (pass(z_k) - z_{k-1}) + z_{k-1}, with w from 1,
 * 2/(2 - rho^2), 4/(4 - rho^2 w), ... Particles in contact are left out of it, as their blocks
 * change from pass to pass.
 */
#include "augmented_springs.h"
#include "fixed_step.h"
#include "parallel.h"
#include "vertex_groups.h"

#include <clothsim/small.h>
#include <float.h>
#include <math.h>
#include <string.h>

/* The parts that contact by force consists of, in scenes that have it. */
#define CONTACT (CS_PART_POTENTIAL | CS_PART_DISSIPATIVE)

struct vbd_options {
    double dt, rho;
    int64_t iterations;
};

static const struct cs_option rows[] = {
    FIXED_STEP_DT_BY_ERROR(struct vbd_options),
    CS_OPTION(struct vbd_options, iterations, "", 10, 1, 1e6,
              "passes over the particles in a step"),
    CS_OPTION(struct vbd_options, rho, "", 0, 0, 0.9999,
              "rate of convergence of the passes that Chebyshev's acceleration takes as known: "
              "0 is none; too large a rate makes energy"),
};

struct avbd_options {
    double dt, penalty, beta, gamma, penalty_max;
    int64_t iterations;
};

static const struct cs_option avbd_rows[] = {
    FIXED_STEP_DT_BY_ERROR(struct avbd_options),
    CS_OPTION(struct avbd_options, iterations, "", 10, 1, 1e6,
              "passes over the particles in a step"),
    CS_OPTION(struct avbd_options, penalty, "", 3, 1e-3, 1e6,
              "least stiffness that a spring counts with, in masses over dt^2"),
    CS_OPTION(struct avbd_options, beta, "", 100, 0, 1e9,
              "growth of that stiffness in a pass, times a spring's error over its length"),
    CS_OPTION(struct avbd_options, gamma, "", 0.9, 0, 1,
              "part of that stiffness that the next step starts with"),
    CS_OPTION(struct avbd_options, penalty_max, "", 100, 1e-3, 1e9,
              "greatest stiffness that a spring counts with, in masses over dt^2"),
};

struct vbd {
    struct fixed_step loop; /* first: the loop's functions take it for the whole */
    int64_t iterations;
    double rho, h;
    struct vertex_groups groups;
    struct augmented_springs *augmented; /* of avbd; NULL: vbd */
    uint32_t first_group;                /* of the colour at work */
    double *x;                           /* (3,n) in m: the present z */
    double *f;                           /* (3,n) in N: outer forces, then those of contact */
    double *old, *y; /* (3,n) in m: begin of the step, and where outer forces alone lead */
    double *last, *before_last; /* (3,n) in m: z before the pass, and before the one before */
    double *blocks, *speed;     /* (6,n) B in kg, (3,n) in m/s; NULL: no contact by force */
    uint64_t passes;
};

/* Some particles of p (3,n). */
CS_INLINE void read_items(size_t n, const double *p, const uint32_t *item,
                          double to[3][LANES]) {
    for (size_t c = 0; c < 3; c++, p += n)
        for (size_t l = 0; l < LANES; l++)
            to[c][l] = p[item[l]];
}

/* Adds a slot's springs to the blocks a (6) and right-hand sides b (3) of a group that is at z,
 * and was at `old` when the step began. */
CS_INLINE void add_slot(const struct vbd *self, const struct spring_slot *slot,
                        double z[3][LANES], double old[3][LANES], double a[6][LANES],
                        double b[3][LANES]) {
    const size_t n = self->loop.host->view->n;
    double d[3][LANES], e[3][LANES];
    read_items(n, self->x, slot->other, d);
    read_items(n, self->old, slot->other, e);
    CS_INDEPENDENT
    for (size_t l = 0; l < LANES; l++) {
        const double dx = z[0][l] - d[0][l], dy = z[1][l] - d[1][l], dz = z[2][l] - d[2][l];
        const double ex = dx - (old[0][l] - e[0][l]), ey = dy - (old[1][l] - e[1][l]),
                     ez = dz - (old[2][l] - e[2][l]);
        // two particles in one place have no direction: u is 0
        const double inverse = 1 / sqrt(dx * dx + dy * dy + dz * dz + DBL_MIN);
        const double ux = dx * inverse, uy = dy * inverse, uz = dz * inverse;
        const double k = slot->stiffness[l], c = slot->relative[l];
        const double stretch = 1 - slot->length[l] * inverse;
        // without a branch, for vectors
        const double across = k * (0.5 * (stretch + fabs(stretch)));
        const double along = ux * ex + uy * ey + uz * ez;
        const double normal = k - across + slot->axial[l], transverse = across + c;
        const double pull = k * (1 / inverse - slot->length[l]) + slot->axial[l] * along;
        b[0][l] -= pull * ux + c * ex;
        b[1][l] -= pull * uy + c * ey;
        b[2][l] -= pull * uz + c * ez;
        a[0][l] += transverse + normal * ux * ux;
        a[1][l] += normal * ux * uy;
        a[2][l] += normal * ux * uz;
        a[3][l] += transverse + normal * uy * uy;
        a[4][l] += normal * uy * uz;
        a[5][l] += transverse + normal * uz * uz;
    }
}

/* Adds contact at the state z_p before the pass. */
CS_INLINE void add_contact(const struct vbd *self, const uint32_t *item, double a[6][LANES],
                           double b[3][LANES]) {
    const size_t n = self->loop.host->view->n;
    for (size_t l = 0; l < LANES; l++) {
        double block[6], moved[3], held[3];
        cs_sym3_read(n, self->blocks, item[l], block);
        for (size_t c = 0; c < 3; c++)
            moved[c] = self->x[c * n + item[l]] - self->last[c * n + item[l]];
        cs_sym3_mul(block, moved, held);
        for (size_t c = 0; c < 3; c++)
            b[c][l] += self->h * self->h * self->f[c * n + item[l]] - held[c];
        for (size_t c = 0; c < 6; c++)
            a[c][l] += block[c];
    }
}

/* One Newton step of each particle of a group. */
CS_INLINE void move_group(struct vbd *self, size_t group) {
    const struct cs_view *view = self->loop.host->view;
    const size_t n = view->n;
    const uint32_t *item = self->groups.item + group * LANES;
    double a[6][LANES] = {{0}}, b[3][LANES], z[3][LANES], old[3][LANES];
    read_items(n, self->x, item, z);
    read_items(n, self->old, item, old);
    for (size_t l = 0; l < LANES; l++) {
        const double mass = view->mass[item[l]];
        a[0][l] = a[3][l] = a[5][l] = mass;
        for (size_t c = 0; c < 3; c++)
            b[c][l] = mass * (self->y[c * n + item[l]] - z[c][l]);
    }
    for (size_t s = self->groups.slot_begin[group]; s < self->groups.slot_begin[group + 1]; s++)
        add_slot(self, self->groups.slots + s, z, old, a, b);
    if (self->blocks)
        add_contact(self, item, a, b);
    CS_INDEPENDENT
    for (size_t l = 0; l < LANES; l++) {
        const double block[6] = {a[0][l], a[1][l], a[2][l], a[3][l], a[4][l], a[5][l]};
        const double r[3] = {b[0][l], b[1][l], b[2][l]};
        double cofactors[6], dz[3];
        const double inverse =
            (double)(view->inv_mass[item[l]] > 0) / cs_sym3_cofactors(block, cofactors);
        cs_sym3_mul(cofactors, r, dz);
        for (size_t c = 0; c < 3; c++)
            b[c][l] = z[c][l] + inverse * dz[c];
    }
    // after all were read, since a particle may fill several lanes
    for (size_t l = 0; l < LANES; l++)
        cs_vec3_write(n, self->x, item[l], (const double[3]){b[0][l], b[1][l], b[2][l]});
}

CS_CLONES static void move_groups(void *arg, size_t begin, size_t end) {
    struct vbd *self = arg;
    for (size_t group = begin; group < end; group++)
        move_group(self, self->first_group + group);
}

/* z = w (z - z_{k-1}) + z_{k-1} for particles without contact. */
static void accelerate(struct vbd *self, double weight) {
    const size_t n = self->loop.host->view->n;
    for (size_t i = 0; i < n; i++) {
        double held = 0;
        for (size_t c = 0; c < 6 && self->blocks; c++)
            held += fabs(self->blocks[c * n + i]);
        for (size_t k = i; k < 3 * n && !(held > 0); k += n)
            self->x[k] = weight * (self->x[k] - self->before_last[k]) + self->before_last[k];
    }
}

/* F and B at z, at the end t of the step. */
static void find_contact(struct vbd *self, double t) {
    const struct cs_host *host = self->loop.host;
    for (size_t k = 0; k < 3 * (size_t)host->view->n; k++)
        self->speed[k] = (self->x[k] - self->old[k]) / self->h;
    host->force(host->ctx, t, self->x, self->speed, CONTACT, self->f);
    host->contact_blocks(host->ctx, t, self->x, self->speed, self->h, self->blocks);
}

/* One pass over all colours. */
static void sweep(struct vbd *self, double t) {
    const struct cs_host *host = self->loop.host;
    double *kept = self->before_last;
    self->before_last = self->last;
    self->last = kept;
    memcpy(self->last, self->x, 3 * sizeof *self->x * host->view->n);
    if (self->blocks)
        find_contact(self, t);
    for (size_t colour = 0; colour < host->view->n_colours; colour++) {
        self->first_group = self->groups.colour_begin[colour];
        parallel_for(host, self->groups.colour_begin[colour + 1] - self->first_group,
                     move_groups, self);
    }
    self->passes++;
}

/* The springs that the first pass of a step of h sees, or the one after `passed`. */
static void read_springs(struct vbd *self, double h, bool passed) {
    const struct cs_view *view = self->loop.host->view;
    struct augmented_springs *augmented = self->augmented;
    if (augmented && passed)
        augmented_springs_update(augmented, view, h, self->x);
    else if (augmented)
        augmented_springs_begin(augmented, view, h);
    if (augmented || !passed)
        vertex_groups_read_springs(&self->groups, view,
                                   augmented ? augmented->stiffness : view->stiffness,
                                   augmented ? augmented->length : view->length, h);
}

static enum cs_step step(struct fixed_step *loop, double t, double h, double *x, double *v) {
    struct vbd *self = (struct vbd *)loop;
    const struct cs_host *host = loop->host;
    const size_t n = host->view->n;
    const uint32_t outer = self->blocks ? CS_PART_OUTER & ~CONTACT : CS_PART_OUTER;
    host->force(host->ctx, t, x, v, outer, self->f);
    memcpy(self->old, x, 3 * n * sizeof *x);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0, k = c * n; i < n; i++, k++) {
            v[k] += h * self->f[k] * host->view->inv_mass[i];
            self->y[k] = x[k] += h * v[k];
        }
    self->h = h;
    self->x = x;
    read_springs(self, h, false);
    double weight = 1;
    for (int64_t k = 0; k < self->iterations; k++) {
        sweep(self, t + h);
        read_springs(self, h, true);
        weight =
            k == 0 ? 1 : (k == 1 ? 2 : 4) / ((k == 1 ? 2 : 4) - self->rho * self->rho * weight);
        if (k > 0 && self->rho > 0)
            accelerate(self, weight);
    }
    // (x - old) / h by what the passes moved, so that free flight keeps every bit of v
    for (size_t k = 0; k < 3 * n; k++)
        v[k] += (x[k] - self->y[k]) / h;
    return CS_STEP_OK;
}

/* The part of create that both methods share, in *out. */
static enum cs_step create_passes(const struct cs_host *host, double dt, int64_t iterations,
                                  struct vbd **out) {
    const size_t bytes = 3 * sizeof(double) * (size_t)host->view->n;
    struct vbd *self = host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->loop = fixed_step_of(host, dt, step);
    self->loop.free_motion = 1;
    self->iterations = iterations;
    double **const arrays[] = {&self->f, &self->old, &self->y, &self->last, &self->before_last};
    for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
        if (!(*arrays[k] = host->alloc(host->ctx, bytes)))
            return CS_STEP_FAIL;
    if (CS_HAS(host, contact_blocks) && host->contact_blocks &&
        (!(self->blocks = host->alloc(host->ctx, 2 * bytes)) ||
         !(self->speed = host->alloc(host->ctx, bytes))))
        return CS_STEP_FAIL;
    const enum cs_step status = vertex_groups_init(&self->groups, host);
    return status == CS_STEP_OK ? fixed_step_guard(&self->loop, NULL) : status;
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const struct vbd_options *asked = options;
    const enum cs_step status =
        create_passes(host, asked->dt, asked->iterations, (struct vbd **)out);
    if (status == CS_STEP_OK)
        ((struct vbd *)*out)->rho = asked->rho;
    return status;
}

static enum cs_step create_augmented(const struct cs_host *host, const void *options,
                                     void **out) {
    const struct avbd_options *asked = options;
    const enum cs_step status =
        create_passes(host, asked->dt, asked->iterations, (struct vbd **)out);
    if (status != CS_STEP_OK)
        return status;
    struct augmented_springs *augmented = host->alloc(host->ctx, sizeof *augmented);
    if (!augmented)
        return CS_STEP_FAIL;
    ((struct vbd *)*out)->augmented = augmented;
    augmented->beta = asked->beta;
    augmented->gamma = asked->gamma;
    augmented->start = asked->penalty;
    augmented->most = fmax(asked->penalty, asked->penalty_max);
    return augmented_springs_init(augmented, host);
}

static enum cs_step restart(void *object, double t, const double *x, const double *v) {
    struct vbd *self = object;
    if (self->augmented)
        augmented_springs_restart(self->augmented, self->loop.host->view);
    return fixed_step_restart(self, t, x, v);
}

static void stats(const void *object, struct cs_stats *out) {
    fixed_step_stats(object, out);
    out->newton = ((const struct vbd *)object)->passes;
    if (CS_HAS(out, sweeps))
        out->sweeps = 2 * out->newton; // each spring is seen from both its ends
}

static enum cs_step archive(void *object, const struct cs_archive *archive) {
    struct vbd *self = object;
    archive->integers(archive->ctx, &self->passes, 1);
    if (self->augmented)
        augmented_springs_archive(self->augmented, self->loop.host->view, archive);
    return fixed_step_archive(object, archive);
}

/* The part of the descriptor that both methods share. */
#define VERTEX_BLOCK_DESCENT(options_, rows_, create_)                                         \
    .size = sizeof(struct cs_integrator), .order = 1, .order_damped = 1,                       \
    .needs = CS_NEED_SPRINGS | CS_NEED_COLOURS, .traits = CS_IMPLICIT,                         \
    .fidelity = CS_FIDELITY_IMPLICIT_EULER, .options = (rows_),                                \
    .n_options = sizeof(rows_) / sizeof(rows_)[0], .options_size = sizeof(options_),           \
    .create = (create_), .restart = restart, .advance = fixed_step_advance, .stats = stats,    \
    .save = archive, .load = archive

static const struct cs_integrator vbd = {
    VERTEX_BLOCK_DESCENT(struct vbd_options, rows, create),
    .name = "vbd",
    .summary =
        "implicit Euler by blocks of one particle, colour by colour; cheap passes that damp, "
        "and leave momentum to the last of them",
    .source = "Chen, Liu, Yang, Yuksel 2024 (vertex block descent); acceleration: Wang 2015",
};

static const struct cs_integrator avbd = {
    VERTEX_BLOCK_DESCENT(struct avbd_options, avbd_rows, create_augmented),
    .name = "avbd",
    .summary =
        "vbd with an augmented Lagrangian: its passes reach implicit Euler where springs "
        "are stiff, or far stiffer than others",
    .source = "Giles, Diaz, Yuksel 2025 (augmented vertex block descent)",
};

static const struct cs_integrator *const integrators[] = {&vbd, &avbd};

CS_EXPORT const struct cs_module clothsim_module = {
    .abi = CS_ABI,
    .size = sizeof(struct cs_integrator),
    .n = sizeof integrators / sizeof integrators[0],
    .integrators = integrators,
};

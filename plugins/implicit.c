/* implicit.c - implicit Euler methods that solve one linear system per step.
 *
 * With K = df/dx, D = df/dv of CS_PART_LINEARISED at (x, v), and step h:
 *
 *   implicit-linearised  (M - h D - h^2 K) dv = h (f + h K (v - w))          the whole system
 *
 *   implicit-block       (m I - h D_ii - h^2 K_ii) dv_i = h (f_i + h K_ii v_i)  each particle
 *
 * and then v' = v + dv, x' = x + h v'. The first is Baraff and Witkin 1998 (cloth thesis, eq.
 * 5.20); it is one Newton step of implicit Euler. w is the velocity of the obstacles in contact
 * (host->euler_setup). The second is the cloth thesis's shortcut (sec. 5.3, end): K_ii v_i
 * treats a particle that moves with its neighbours as if they stood still, which is a drag of
 * size h K_ii. It is stable because it is nearly frozen, and approaches the equation of motion
 * only as h K h / m goes to 0.
 */
#include "fixed_step.h"

#include <clothsim/small.h>

enum { PIECE = 64 }; /* particles whose blocks are solved together */

static const char *const hessians[] = {"clamped", "exact", NULL};

struct linearised_options {
    double dt, rtol;
    int32_t hessian;
};

static const struct cs_option linearised_rows[] = {
    FIXED_STEP_DT_BY_ERROR(struct linearised_options),
    CS_OPTION(struct linearised_options, rtol, "", 1e-3, 1e-15, 0.5,
              "relative residual of the linear solve"),
    CS_OPTION_CHOICE(struct linearised_options, hessian, hessians, 0,
                     "clamped drops the transverse part of compressed springs (Teran et al. "
                     "2005); exact keeps it where the matrix stays definite"),
};

struct block_options {
    double dt;
};

static const struct cs_option block_rows[] = {
    FIXED_STEP_DT_BY_ERROR(struct block_options),
};

struct linearised {
    struct fixed_step loop; /* first: the loop's functions take it for the whole */
    double rtol;
    uint32_t flags;   /* of euler_setup */
    double *b;        /* (3,n) in N s: the right-hand side */
    double *dv;       /* (3,n) in m/s */
    double *external; /* (3,n) in N: CS_PART_FREE_FALL at the last restart */
};

struct block {
    struct fixed_step loop;
    double *f;         /* (3,n) in N */
    double *kxx, *dvv; /* (6,n) in N/m and N s/m, one after the other */
};

/* An array of some doubles per particle; NULL if out of memory. */
static void *take(const struct cs_host *host, size_t doubles_a_particle) {
    return host->alloc(host->ctx, doubles_a_particle * sizeof(double) * host->view->n);
}

/* Starts the solver's iteration. Free fall, dv = h g, is the one motion that every residual
 * tolerance would spoil visibly; where gravity is most of b it is the better start than 0. */
static void start_solve(struct linearised *self, double h) {
    const struct cs_view *view = self->loop.host->view;
    const size_t n = view->n;
    double rest = 0, whole = 0;
    for (size_t i = 0; i < 3 * n; i++) {
        const double left = self->b[i] - h * self->external[i];
        rest += left * left;
        whole += self->b[i] * self->b[i];
    }
    const bool falls = rest < whole / 4;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            self->dv[c * n + i] = falls ? h * self->external[c * n + i] * view->inv_mass[i] : 0;
}

/* v += dv, x += h v with the new v. */
CS_CLONES static void move(size_t n, double h, const double *dv, double *x, double *v) {
    for (size_t i = 0; i < 3 * n; i++) {
        v[i] += dv[i];
        x[i] += h * v[i];
    }
}

static enum cs_step step_linearised(struct fixed_step *loop, double t, double h, double *x,
                                    double *v) {
    struct linearised *self = (struct linearised *)loop;
    const struct cs_host *host = loop->host;
    enum cs_step status = host->euler_setup(host->ctx, t, h, x, v, self->flags, self->b);
    if (status != CS_STEP_OK)
        return status;
    start_solve(self, h);
    status = host->solve(host->ctx, self->b, self->rtol, self->dv);
    if (status != CS_STEP_OK)
        return status;
    move(host->view->n, h, self->dv, x, v);
    if (host->euler_finish)
        host->euler_finish(host->ctx, x, v);
    return CS_STEP_OK;
}

static enum cs_step restart_linearised(void *object, double t, const double *x,
                                       const double *v) {
    struct linearised *self = object;
    const struct cs_host *host = self->loop.host;
    host->force(host->ctx, t, x, v, CS_PART_FREE_FALL, self->external);
    return CS_STEP_OK;
}

/* The matrix of particle i, m I - h D_ii - h^2 K_ii. */
CS_INLINE void block_of(const struct block *self, size_t i, double h, const double k[6],
                        double a[6]) {
    const struct cs_view *view = self->loop.host->view;
    double d[6];
    cs_sym3_read(view->n, self->dvv, i, d);
    for (int c = 0; c < 6; c++)
        a[c] = -h * d[c] - h * h * k[c];
    a[0] += view->mass[i], a[3] += view->mass[i], a[5] += view->mass[i];
}

/* dv of some particles from `first` on. No particle is treated apart, and dv lies where no
 * other pointer leads, so that the loop vectorises. false: a block is singular. */
CS_INLINE bool solve_piece(const struct block *self, size_t first, size_t count, double h,
                           const double *v, double dv[3][PIECE]) {
    const size_t n = self->loop.host->view->n;
    double determinant[PIECE];
    for (size_t i = 0; i < count; i++) {
        double k[6], a[6], f[3], vi[3], kv[3], b[3], out[3];
        cs_sym3_read(n, self->kxx, first + i, k);
        block_of(self, first + i, h, k, a);
        cs_vec3_read(n, self->f, first + i, f);
        cs_vec3_read(n, v, first + i, vi);
        cs_sym3_mul(k, vi, kv);
        for (int c = 0; c < 3; c++)
            b[c] = h * (f[c] + h * kv[c]);
        determinant[i] = cs_sym3_invert_any(a, a);
        cs_sym3_mul(a, b, out);
        for (int c = 0; c < 3; c++)
            dv[c][i] = out[c];
    }
    /* tested apart, so that the loop above has no branch */
    bool regular = true;
    for (size_t i = 0; i < count; i++)
        regular &= cs_sym3_is_regular(determinant[i]);
    return regular;
}

/* dv of every particle, over its force; false: a block is singular. */
CS_CLONES static bool solve_blocks(struct block *self, double h, const double *v) {
    const struct cs_view *view = self->loop.host->view;
    const size_t n = view->n;
    bool regular = true;
    for (size_t start = 0; start < n; start += PIECE) {
        double dv[3][PIECE];
        const size_t count = n - start < PIECE ? n - start : PIECE;
        regular &= solve_piece(self, start, count, h, v, dv);
        // a pinned particle keeps its zero force as dv
        for (size_t c = 0; c < 3; c++)
            for (size_t i = 0; i < count; i++)
                self->f[c * n + start + i] = view->inv_mass[start + i] > 0 ? dv[c][i] : 0;
    }
    return regular;
}

/* The first free particle with a singular block, or n. */
static size_t find_singular(const struct block *self, double h) {
    const struct cs_view *view = self->loop.host->view;
    for (size_t i = 0; i < view->n; i++) {
        double k[6], a[6];
        cs_sym3_read(view->n, self->kxx, i, k);
        block_of(self, i, h, k, a);
        if (view->inv_mass[i] > 0 && !cs_sym3_invert(a, a))
            return i;
    }
    return view->n;
}

static enum cs_step step_block(struct fixed_step *loop, double t, double h, double *x,
                               double *v) {
    struct block *self = (struct block *)loop;
    const struct cs_host *host = loop->host;
    if (CS_HAS(host, force_diagonal)) {
        host->force_diagonal(host->ctx, t, x, v, self->f, self->kxx);
    } else {
        host->force(host->ctx, t, x, v, CS_PART_ALL, self->f);
        host->diagonal(host->ctx, t, x, v, self->kxx, self->dvv);
    }
    if (!solve_blocks(self, h, v)) {
        const size_t i = find_singular(self, h);
        if (i < host->view->n)
            return host->fail(host->ctx, "the block of particle %zu is singular at t = %g s", i,
                              t);
    }
    move(host->view->n, h, self->f, x, v);
    return CS_STEP_OK;
}

static enum cs_step create_linearised(const struct cs_host *host, const void *options,
                                      void **out) {
    const struct linearised_options *asked = options;
    struct linearised *self = host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->loop = fixed_step_of(host, asked->dt, step_linearised);
    self->rtol = asked->rtol;
    self->flags = asked->hessian == 0 ? CS_SOLVE_PSD : 0;
    if (!(self->b = take(host, 3)) || !(self->dv = take(host, 3)) ||
        !(self->external = take(host, 3)))
        return CS_STEP_FAIL;
    if (!CS_HAS(host, euler_finish))
        return host->fail(host->ctx, "the host is older than this module: no euler_finish");
    return fixed_step_guard(&self->loop, NULL);
}

static enum cs_step create_block(const struct cs_host *host, const void *options, void **out) {
    const struct block_options *asked = options;
    struct block *self = host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->loop = fixed_step_of(host, asked->dt, step_block);
    if (!(self->f = take(host, 3)) || !(self->kxx = take(host, 12)))
        return CS_STEP_FAIL;
    self->dvv = self->kxx + 6 * (size_t)host->view->n;
    return fixed_step_guard(&self->loop, NULL);
}

static enum cs_step archive_linearised(void *object, const struct cs_archive *archive) {
    struct linearised *self = object;
    archive->reals(archive->ctx, self->external, 3 * (size_t)self->loop.host->view->n);
    return fixed_step_archive(self, archive);
}

static const struct cs_integrator implicit_linearised = {
    .size = sizeof(struct cs_integrator),
    .name = "implicit-linearised",
    .summary =
        "one linear solve of the whole system per step; damps; stable at large steps, but "
        "not where springs are pressed hard",
    .source = "Baraff, Witkin 1998; cloth thesis, eq. 5.20",
    .order = 1,
    .order_damped = 1,
    .needs = CS_NEED_SOLVE | CS_NEED_REBOUNDS,
    .traits = CS_IMPLICIT,
    .options = linearised_rows,
    .n_options = sizeof linearised_rows / sizeof linearised_rows[0],
    .options_size = sizeof(struct linearised_options),
    .create = create_linearised,
    .restart = restart_linearised,
    .advance = fixed_step_advance,
    .stats = fixed_step_stats,
    .save = archive_linearised,
    .load = archive_linearised,
};

/* h K_ii v drags a falling or sliding sheet as a whole: it is not internal to a pair of
 * particles */
static const char *const false_drag[] = {"free-fall", "translation", "momentum", NULL};

static const struct cs_integrator implicit_block = {
    .size = sizeof(struct cs_integrator),
    .name = "implicit-block",
    .summary = "the cloth thesis's shortcut, one 3x3 block per particle: spurious drag, falls "
               "too slowly; its default step makes energy on some scenes",
    .source = "cloth thesis, sec. 5.3",
    .order = 1,
    .order_damped = 1,
    .needs = CS_NEED_DIAGONAL,
    .traits = CS_IMPLICIT | CS_NOT_GALILEAN | CS_MAKES_ENERGY,
    .fidelity = CS_FIDELITY_CONSISTENT,
    .fails = false_drag,
    .options = block_rows,
    .n_options = sizeof block_rows / sizeof block_rows[0],
    .options_size = sizeof(struct block_options),
    .create = create_block,
    .restart = fixed_step_restart,
    .advance = fixed_step_advance,
    .stats = fixed_step_stats,
    .save = fixed_step_archive,
    .load = fixed_step_archive,
};

static const struct cs_integrator *const integrators[] = {&implicit_linearised,
                                                          &implicit_block};

CS_EXPORT const struct cs_module clothsim_module = {
    .abi = CS_ABI,
    .size = sizeof(struct cs_integrator),
    .n = sizeof integrators / sizeof integrators[0],
    .integrators = integrators,
};

/* ros2.c - Rosenbrock method of two stages with one matrix: two linear solves per step.
 *
 * For y = (x, v), y' = F(t, y), J about dF/dy at (t, y), g = (1 - 1/sqrt 2) h:
 *   (I - g J) k1 = F(t, y)
 *   (I - g J) k2 = F(t + h, y + h k1) - 2 k1
 *   y' = y + h (3/2 k1 + 1/2 k2)
 * L-stable, and of order 2 with any J (Verwer et al. 1999), so that J may be the clamped one.
 * Rows of x eliminated, with A = M - g D - g^2 K:
 *   A kv = bv + g K bx,   kx = bx + g kv,   (bx, M^-1 bv) the right-hand side
 * and g^2 K p = M p - g D p - A p, so that it is the K of A: the exact one of a nearly closed
 * spring would be huge here and clamped there. With w = kv + bx/g that is
 *   A w = bv + M bx/g - D bx,
 * without a product with A; where obstacles or held particles move, K bx is needed by itself,
 * and kv, which is 0 where w is not, is solved for.
 *
 * Obstacles that move make F depend on t. With t as one more variable of y, whose k are 1 and
 * -1, the right-hand sides get g dF/dt and -g dF/dt; for contact that is K (v - w) in place of
 * K v, with w the velocity of the obstacle's surface (host->euler_setup).
 *
 * A step is refused and halved if it moves the ends of a spring against each other by more than
 * half its length, in a stage or as a whole: the linearisation has no relation to large
 * rotations. So is one whose stage passes over contact.
 *
 * For rates far above 1/h the first stage multiplies by 1 - h/g = -2.4. The second undoes that
 * for the forces in J. The slope of friction by its load is not in J: friction under the
 * loads of such a state created energy. Where friction acts and a step does not resolve all
 * rates, g is (1 + 1/sqrt 2) h, of the same order and L-stable too, with 1 - h/g = 0.41.
 * Nor is the turn of springs within a step in J. A sheet of particles of 1e-9 kg on springs of
 * 100 N/m, damped or not, gains energy at 1e-4 to 2e-3 s. A residual of 1e-12 or the exact
 * matrix changes nothing. It is stable at 5e-5 s, and with the larger g at 5e-4 and 2e-3 s.
 */
#include "newton_methods.h"

#include <math.h>
#include <string.h>

/* Lengths of a step over which the motion without forces is judged. The second stage takes the
 * force at the end of that motion for all of the step: one that came just inside of contact,
 * where its energy is below what the host refuses, got an impulse of up to 8 times its
 * momentum, and an impact kept 0.26 of its energy. So the first step that ends inside must be
 * short. Of 150 phases at 1 to 20 m/s all keep 0.98 to 1.01 with 1.1, 0.996 to 1.006 with 1.25.
 */
#define FREE_MOTION 1.25

struct ros2_options {
    double dt, rtol;
};

static const struct cs_option rows[] = {
    FIXED_STEP_DT_BY_ERROR(struct ros2_options),
    CS_OPTION(struct ros2_options, rtol, "", 1e-6, 1e-15, 0.5,
              "relative residual of the linear solves"),
};

struct method {
    struct step_halving base;
    double rtol;
    double *k1, *k2; /* (3,n) in m/s2: kv of both stages, M^-1 b before */
    double *bx, *b;  /* (3,n) right-hand side */
    double *xn, *vn; /* (3,n) state of the second stage, then of the step's end */
    double *drift;   /* (3,n) in N: g dF/dt by obstacles that move; NULL: none does */
    bool for_kv;     /* kv is solved for in this step, not w */
};

static bool held_particles_move(const struct cs_view *view, const double *v) {
    const size_t n = view->n;
    bool move = false;
    for (size_t i = 0; i < n; i++)
        move |= !(view->inv_mass[i] > 0) && (v[i] != 0 || v[n + i] != 0 || v[2 * n + i] != 0);
    return move;
}

/* b += M bx/g - D bx, less A bx/g for kv, which leaves b + g K bx; work: (3,n) */
static void add_stiffness(struct method *self, double t, double g, const double *x,
                          const double *v, double *work) {
    const struct cs_host *host = self->base.fixed.host;
    const struct cs_view *view = host->view;
    const size_t n = view->n;
    host->jvp(host->ctx, t, x, v, CS_PART_LINEARISED, NULL, self->bx, work);
    host->vector->linear_sum(3 * n, 1, self->b, -1, work, self->b);
    if (self->for_kv) {
        host->matrix_product(host->ctx, self->bx, work);
        host->vector->linear_sum(3 * n, 1, self->b, -1 / g, work, self->b);
    }
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            self->b[c * n + i] += view->mass[i] * self->bx[c * n + i] / g;
}

/* A at the step's begin, and the drift: the right-hand side of a step of implicit Euler of
 * length g holds it, beside what add_stiffness finds without the obstacles' motion. */
static enum cs_step set_up(struct method *self, double t, double g, const double *x,
                           const double *v) {
    const struct cs_host *host = self->base.fixed.host;
    if (!self->drift)
        return host->solve_setup(host->ctx, t, x, v, 1, -g, -g * g, CS_SOLVE_PSD);
    return host->euler_setup(host->ctx, t, g, x, v, CS_SOLVE_PSD | CS_SOLVE_TANGENT,
                             self->drift);
}

/* b += drift, which holds g (f + g K (v - w)) before, with b = f + g K v */
static void add_drift(struct method *self, double g) {
    for (size_t k = 0; self->drift && k < 3 * (size_t)self->base.fixed.host->view->n; k++) {
        self->drift[k] = self->drift[k] / g - self->b[k];
        self->b[k] += self->drift[k];
    }
}

/* kv from A kv = b, or from A w = b, started from a free fall: M^-1 b. */
static enum cs_step solve(struct method *self, double g, double *kv) {
    const struct cs_host *host = self->base.fixed.host;
    const struct cs_view *view = host->view;
    for (size_t c = 0, k = 0; c < 3; c++)
        for (size_t i = 0; i < view->n; i++, k++)
            kv[k] = view->inv_mass[i] * self->b[k];
    const enum cs_step status = host->solve(host->ctx, self->b, self->rtol, kv);
    for (size_t c = 0, k = 0; c < 3 && !self->for_kv; c++)
        for (size_t i = 0; i < view->n; i++, k++)
            kv[k] -= view->inv_mass[i] > 0 ? self->bx[k] / g : 0;
    return status;
}

/* True if friction or damping by contact acts at a state, and h omega > 1 there: the step
 * does not resolve all rates. */
static bool has_unresolved_friction(struct method *self, double t, double h, const double *x,
                                    const double *v) {
    const struct cs_host *host = self->base.fixed.host;
    double omega, delta;
    // no move of this scene is judged: it has no contact by force either
    if (!self->base.fixed.is_guarded)
        return false;
    host->force(host->ctx, t, x, v, CS_PART_DISSIPATIVE, self->b);
    if (!(host->vector->max_norm(3 * (size_t)host->view->n, self->b) > 0))
        return false;
    host->bounds_at(host->ctx, t, x, v, &omega, &delta);
    return h * omega > 1;
}

/* A step, and which g it has. */
struct span {
    double t, h, g;
    bool narrow; /* the smaller g: not to be used where friction is not resolved */
    bool rubs;   /* friction was not resolved, and the step was not taken */
};

/* Takes a step with span->g. *accepted stays false if the step is refused, or if the smaller g
 * meets unresolved friction (span->rubs); x and v are unchanged then. */
static enum cs_step take(struct method *self, struct span *span, double *x, double *v,
                         bool *accepted) {
    struct step_halving *base = &self->base;
    const double t = span->t, h = span->h, g = span->g;
    const struct cs_host *host = base->fixed.host;
    const struct cs_view *view = host->view;
    const size_t n = view->n;
    double *k1 = self->k1, *k2 = self->k2, *bx = self->bx, *b = self->b;
    self->for_kv = self->drift || held_particles_move(view, v);
    enum cs_step status = set_up(self, t, g, x, v);
    if (status != CS_STEP_OK)
        return status;

    /* first stage: the right-hand side is (v, f/m) */
    host->force(host->ctx, t, x, v, CS_PART_ALL, b);
    memcpy(bx, v, 3 * n * sizeof *v);
    add_stiffness(self, t, g, x, v, k1);
    add_drift(self, g);
    if ((status = solve(self, g, k1)) != CS_STEP_OK)
        return status;
    for (size_t k = 0; k < 3 * n; k++) {
        self->xn[k] = x[k] + h * (v[k] + g * k1[k]);
        self->vn[k] = v[k] + h * k1[k];
    }
    if ((base->refused_by_rotation = springs_rotated_far(view, x, self->xn)))
        return CS_STEP_OK;
    if ((span->rubs =
             span->narrow && has_unresolved_friction(self, t + h, h, self->xn, self->vn)))
        return CS_STEP_OK;
    if (base->fixed.is_guarded &&
        (base->fixed.refused_by_contact =
             host->max_step_fraction(host->ctx, t, x, t + h, self->xn) < 1))
        return CS_STEP_OK;

    /* second stage: F(t + h, y + h k1) - 2 k1, where kx of the first is v + g k1 */
    host->force(host->ctx, t + h, self->xn, self->vn, CS_PART_ALL, b);
    for (size_t c = 0, k = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++, k++) {
            b[k] -= 2 * view->mass[i] * k1[k];
            bx[k] = self->vn[k] - 2 * (v[k] + g * k1[k]);
        }
    add_stiffness(self, t, g, x, v, k2);
    for (size_t k = 0; self->drift && k < 3 * n; k++)
        b[k] -= self->drift[k];
    if ((status = solve(self, g, k2)) != CS_STEP_OK)
        return status;
    /* kx = bx + g kv in either stage */
    for (size_t k = 0; k < 3 * n; k++) {
        self->xn[k] = x[k] + h * (1.5 * (v[k] + g * k1[k]) + 0.5 * (bx[k] + g * k2[k]));
        self->vn[k] = v[k] + h * (1.5 * k1[k] + 0.5 * k2[k]);
    }
    if ((base->refused_by_rotation = springs_rotated_far(view, x, self->xn)))
        return CS_STEP_OK;
    memcpy(x, self->xn, 3 * n * sizeof *x);
    memcpy(v, self->vn, 3 * n * sizeof *v);
    *accepted = true;
    return CS_STEP_OK;
}

/* The smaller g first, unless friction acts unresolved at the start; else, or if the first
 * stage meets it, the larger g. */
static enum cs_step step(struct step_halving *base, double t, double h, double *x, double *v,
                         bool *accepted) {
    struct method *self = (struct method *)base;
    struct span span = {t, h, (1 - 1 / sqrt(2)) * h, .narrow = true};
    span.rubs = has_unresolved_friction(self, t, h, x, v);
    if (!span.rubs) {
        const enum cs_step status = take(self, &span, x, v, accepted);
        if (status != CS_STEP_OK || !span.rubs)
            return status;
    }
    span = (struct span){t, h, (1 + 1 / sqrt(2)) * h, .narrow = false};
    return take(self, &span, x, v, accepted);
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const struct ros2_options *asked = options;
    struct step_halving *base =
        step_halving_create(host, sizeof(struct method), asked->dt, step);
    if (!(*out = base))
        return CS_STEP_FAIL;
    struct method *self = (struct method *)base;
    base->fixed.free_motion = FREE_MOTION;
    self->rtol = asked->rtol;
    double **const arrays[] = {&self->k1, &self->k2, &self->bx,   &self->b,
                               &self->xn, &self->vn, &self->drift};
    // obstacles are in the view if they move; only a force of theirs is in the matrix
    const bool drifts = host->view->n_colliders && CS_HAS(host, euler_setup) &&
                        CS_HAS(host, contact_blocks) && host->contact_blocks;
    return step_halving_alloc(host, arrays, drifts ? 7 : 6);
}

const struct cs_integrator ros2 = {
    STEP_HALVING_METHOD(struct ros2_options, rows, step_halving_archive),
    .name = "ros2",
    .summary = "Rosenbrock method: two linear solves with one matrix, L-stable, no Newton; "
               "throws what slips to and fro where a step is long against friction, and gains "
               "energy where tiny masses turn springs within a step",
    .source = "Verwer et al. 1999",
    .order = 2,
    .order_damped = 2,
    .needs = CS_NEED_JVP | CS_NEED_SOLVE | CS_NEED_SPRINGS,
    .traits = CS_IMPLICIT,
    .create = create,
};

/* shape_matching.c - bodies that are drawn back to their shape instead of held by springs.
 *
 * A step of length h, with particles of mass m, their positions q at time 0 and all forces f,
 * those of other bodies' springs too:
 *
 *     v += h f/m,  x += h v                                   (symplectic Euler)
 *     A_pq = sum w (x - x_cm) (q - q_cm)^T,  A = A_pq A_qq^-1  (over each cluster)
 *     R: the rotation nearest to A_pq                         (shape_rotation.h)
 *     g = (beta A/cbrt(det A) + (1 - beta) R) (q - q_cm) + x_cm
 *     d = alpha (g - x),  x += d,  v += d/h
 *
 * (Mueller et al. 2005, eq. 3 to 12, in the order of the soft-body thesis, sec. 2: the goals
 * are those of the positions after the free step.) That order is an implicit Euler step of
 * springs between particles and their goals, 1/(1 + (k/m) h^2) = 1 - alpha. The alpha of a step
 * alpha_step therefore becomes alpha_h = alpha h^2 / ((1 - alpha) alpha_step^2 + alpha h^2) in
 * one of h, with the same stiffness k = m alpha/((1 - alpha) alpha_step^2).
 *
 * A particle in several clusters has w = m/their number in each and takes the mean of its
 * d. Then d has no momentum and, about x, no angular momentum: A_pq R^T is symmetric. A pinned
 * particle weighs HEAVY times all free ones of its cluster, since one of its own mass would be
 * no hold against the weight of many. Where the body is flat from the start (A_qq without
 * inverse) A is R across it. Of a body that is squashed below an eighth of its volume, beta
 * falls with the volume: it is drawn to its rigid shape, and out of its mirror image.
 */
#include "fixed_step.h"
#include "leapfrog_limit.h"
#include "shape_rotation.h"

#include <string.h>

#define HEAVY 1000

enum rotation { POLAR, UNROOTED_PQ, UNROOTED_LINEAR };
static const char *const rotations[] = {"polar", "unrooted-pq", "unrooted-linear", NULL};

struct shape_options {
    double dt;
    int32_t rotation;
};

static const struct cs_option rows[] = {
    FIXED_STEP_DT(
        struct shape_options,
        "0.9 of the stability limit of springs and drag, estimated at rest, or 1/60 s "
        "without them"),
    CS_OPTION_CHOICE(
        struct shape_options, rotation, rotations, POLAR,
        "polar: the rotation nearest to A_pq; the others omit the square root of the polar "
        "decomposition, as the soft-body thesis, sec. 2.1, considers possible: B (B^T B)^-1 "
        "with B = A_pq or the linear transformation A; only to show the effect"),
};

/* The constants of a cluster, from the positions at time 0 and the pins, and its last
 * rotation. */
struct cluster {
    double weight;     /* kg */
    double centre[3];  /* m, of the positions at time 0 */
    double inverse[9]; /* 1/(kg m2), of A_qq */
    double null[9];    /* projector on the directions in which the cluster is flat */
    double size;       /* kg m2, trace of A_qq */
    double turn[4];    /* the last rotation, as a quaternion */
};

struct shape {
    struct fixed_step loop; /* first: the loop's functions take it for the whole */
    int32_t rotation;
    double *f;      /* (3,n) in N; then d of the particles in m */
    double *held;   /* (n) 1/clusters that hold the particle; 0: none */
    double *weight; /* kg, one an item of the clusters */
    struct cluster *clusters;
};

/* Component c of the particle of a cluster item. */
static double coordinate(const struct cs_view *view, const double *x, size_t c, uint32_t item) {
    return x[c * view->n + view->cluster_items[item]];
}

/* The weighted mean of the positions x of a cluster. */
static void find_centre(const struct shape *self, uint32_t k, const double *x,
                        double centre[3]) {
    const struct cs_view *view = self->loop.host->view;
    const uint32_t begin = view->cluster_begin[k], end = view->cluster_begin[k + 1];
    for (size_t c = 0; c < 3; c++) {
        // relative to its first particle: large coordinates do not cancel
        const double origin = coordinate(view, x, c, begin);
        double sum = 0;
        for (uint32_t item = begin; item < end; item++)
            sum += self->weight[item] * (coordinate(view, x, c, item) - origin);
        centre[c] = origin + sum / self->clusters[k].weight;
    }
}

/* moments = sum of w (x - centre) (q - q_cm)^T: A_pq for positions x, A_qq for those at time
 * 0. */
static void find_moments(const struct shape *self, uint32_t k, const double *x,
                         const double centre[3], double moments[9]) {
    const struct cs_view *view = self->loop.host->view;
    const struct cluster *cluster = self->clusters + k;
    memset(moments, 0, 9 * sizeof *moments);
    for (uint32_t item = view->cluster_begin[k]; item < view->cluster_begin[k + 1]; item++)
        for (size_t j = 0; j < 3; j++) {
            const double q = self->weight[item] *
                             (coordinate(view, view->start, j, item) - cluster->centre[j]);
            for (size_t i = 0; i < 3; i++)
                moments[3 * i + j] += (coordinate(view, x, i, item) - centre[i]) * q;
        }
}

/* The options other than polar: b (b^T b)^-1 instead of b (b^T b)^-1/2, which is no rotation
 * unless b is one. */
static void leave_out_root(const struct shape *self, const double a_pq[9], const double a[9],
                           double r[9]) {
    if (self->rotation != POLAR)
        shape_inverse_transposed(self->rotation == UNROOTED_PQ ? a_pq : a, r);
}

/* t maps q - q_cm to goal - x_cm: beta A/cbrt(det A) + (1 - beta) R, with beta reduced below
 * an eighth of the volume. turn: the cluster's last rotation, which becomes the new one. */
static void find_transformation(const struct shape *self, uint32_t k, const double a_pq[9],
                                double turn[4], double t[9]) {
    const struct cluster *cluster = self->clusters + k;
    const double beta = self->loop.host->view->cluster_beta[k];
    double a[9], across[9];
    shape_rotation(a_pq, cluster->size, turn, t);
    if (beta == 0 && self->rotation == POLAR)
        return;
    shape_product(a_pq, cluster->inverse, a);
    shape_product(t, cluster->null, across);
    for (int i = 0; i < 9; i++)
        a[i] += across[i];
    leave_out_root(self, a_pq, a, t);
    const double volume = shape_determinant(a), least = 0.125;
    const double share = volume >= least ? beta : volume > 0 ? beta * volume / least : 0;
    const double scale = share / shape_cube_root(volume >= least ? volume : least);
    for (int i = 0; i < 9; i++)
        t[i] = scale * a[i] + (1 - share) * t[i];
}

/* Adds alpha times the displacement of each particle of a cluster to its goal to d (3,n). */
static void add_goal_displacements(const struct shape *self, uint32_t k, double alpha,
                                   const double *x, double turn[4], double *d) {
    const struct cs_view *view = self->loop.host->view;
    const double *rest = self->clusters[k].centre;
    double centre[3], a_pq[9], t[9];
    find_centre(self, k, x, centre);
    find_moments(self, k, x, centre, a_pq);
    find_transformation(self, k, a_pq, turn, t);
    for (uint32_t item = view->cluster_begin[k]; item < view->cluster_begin[k + 1]; item++) {
        const uint32_t particle = view->cluster_items[item];
        /* a particle in several clusters takes the mean of their pulls */
        const double share = alpha * self->held[particle];
        double q[3];
        for (size_t j = 0; j < 3; j++)
            q[j] = coordinate(view, view->start, j, item) - rest[j];
        for (size_t i = 0; i < 3; i++) {
            const double goal = t[3 * i] * q[0] + t[3 * i + 1] * q[1] + t[3 * i + 2] * q[2];
            d[i * view->n + particle] +=
                share * (goal - (coordinate(view, x, i, item) - centre[i]));
        }
    }
}

/* alpha of a step of h, for the stiffness that the cluster's alpha means in cluster_step. If
 * alpha holds for any step, the reference is the step before it was cut: parts that moved as
 * far as the whole step would never pass contact. */
static double alpha_of(const struct shape *self, uint32_t k, double h) {
    const struct cs_view *view = self->loop.host->view;
    const double alpha = view->cluster_alpha[k], own = view->cluster_step[k];
    const uint32_t cuts = self->loop.subdivision.depth;
    if (own == 0 && cuts == 0)
        return alpha;
    const double step = own > 0 ? own : h * (double)(1u << cuts);
    const double stiff = alpha * h * h, soft = (1 - alpha) * step * step;
    return stiff > 0 ? stiff / (soft + stiff) : 0;
}

/* Moves the particles that a cluster holds towards their goals, and their velocities with
 * them; pinned particles stay. */
static void match(struct shape *self, double h, double *x, double *v) {
    const struct cs_view *view = self->loop.host->view;
    double *d = self->f;
    memset(d, 0, 3 * sizeof *d * view->n);
    for (uint32_t k = 0; k < view->n_clusters; k++)
        add_goal_displacements(self, k, alpha_of(self, k, h), x, self->clusters[k].turn, d);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0, at = c * view->n; i < view->n; i++, at++)
            if (self->held[i] > 0 && view->inv_mass[i] > 0) {
                x[at] += d[at];
                v[at] += d[at] / h;
            }
}

static enum cs_step step(struct fixed_step *loop, double t, double h, double *x, double *v) {
    struct shape *self = (struct shape *)loop;
    const struct cs_host *host = loop->host;
    const size_t n = host->view->n;
    host->force(host->ctx, t, x, v, CS_PART_ALL, self->f);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0, k = c * n; i < n; i++, k++) {
            v[k] += h * (self->f[k] * host->view->inv_mass[i]);
            x[k] += h * v[k];
        }
    match(self, h, x, v);
    return CS_STEP_OK;
}

/* Sets the weights of a cluster's items and their sum. Pinned ones together weigh HEAVY times
 * the free ones. */
static void set_weights(struct shape *self, uint32_t k) {
    const struct cs_view *view = self->loop.host->view;
    const uint32_t begin = view->cluster_begin[k], end = view->cluster_begin[k + 1];
    double free = 0, pinned = 0;
    for (uint32_t item = begin; item < end; item++) {
        const uint32_t i = view->cluster_items[item];
        self->weight[item] = view->mass[i] * self->held[i];
        *(view->inv_mass[i] > 0 ? &free : &pinned) += self->weight[item];
    }
    const double factor = free > 0 && pinned > 0 ? HEAVY * free / pinned : 1;
    for (uint32_t item = begin; item < end; item++)
        if (!(view->inv_mass[view->cluster_items[item]] > 0))
            self->weight[item] *= factor;
    self->clusters[k].weight = free + factor * pinned;
}

/* Recomputes the constants of all clusters, as the pins may have changed. The last rotations
 * stay: positions alone do not show from which side a body became a line. */
static enum cs_step restart(void *object, double t, const double *x, const double *v) {
    struct shape *self = object;
    const struct cs_view *view = self->loop.host->view;
    for (uint32_t k = 0; k < view->n_clusters; k++) {
        struct cluster *cluster = self->clusters + k;
        double a_qq[9];
        set_weights(self, k);
        find_centre(self, k, view->start, cluster->centre);
        find_moments(self, k, view->start, cluster->centre, a_qq);
        shape_pseudo_inverse(a_qq, cluster->inverse, cluster->null);
        cluster->size = a_qq[0] + a_qq[4] + a_qq[8];
    }
    return fixed_step_restart(self, t, x, v);
}

/* g = the positions that alpha = 1 would give the particles at x. Works on copies of the
 * rotations: the run does not change. */
static void goals(const void *object, const double *x, double *g) {
    const struct shape *self = object;
    const struct cs_view *view = self->loop.host->view;
    memset(g, 0, 3 * sizeof *g * view->n);
    for (uint32_t k = 0; k < view->n_clusters; k++) {
        double turn[4];
        memcpy(turn, self->clusters[k].turn, sizeof turn);
        add_goal_displacements(self, k, 1, x, turn, g);
    }
    for (size_t i = 0; i < 3 * (size_t)view->n; i++)
        g[i] += x[i];
}

/* The stability limit of symplectic Euler, which moves particles under springs and drag. */
static double limit_of(const struct fixed_step *loop, double omega, double delta) {
    (void)loop;
    return leapfrog_limit(omega, delta, 2, 4);
}

/* s: a step where nothing limits it, as alpha and beta are usually meant for. */
#define UNLIMITED_DT (1 / 60.0)

static void choose_dt(struct fixed_step *loop, double dt) {
    const double limit = limit_of(loop, loop->host->view->omega, loop->host->view->delta);
    loop->dt_automatic = dt <= 0;
    loop->dt = dt > 0 ? dt : limit < HUGE_VAL ? 0.9 * limit : UNLIMITED_DT;
    if (loop->dt_automatic && limit < HUGE_VAL)
        loop->host->note(loop->host->ctx, "dt automatic: at most %.6g s, for springs and drag",
                         loop->dt);
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const struct shape_options *asked = options;
    const struct cs_view *view = host->view;
    struct shape *self = host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->loop = fixed_step_of(host, asked->dt, step);
    self->rotation = asked->rotation;
    choose_dt(&self->loop, asked->dt);
    if (view->n_clusters == 0)
        return host->fail(host->ctx, "no body has a shape to match");
    const uint32_t n_items = view->cluster_begin[view->n_clusters];
    if (!(self->f = host->alloc(host->ctx, 3 * sizeof(double) * view->n)) ||
        !(self->held = host->alloc(host->ctx, sizeof(double) * view->n)) ||
        !(self->weight = host->alloc(host->ctx, sizeof(double) * n_items)) ||
        !(self->clusters = host->alloc(host->ctx, sizeof(struct cluster) * view->n_clusters)))
        return CS_STEP_FAIL;
    /* the number of its clusters first, then 1 over it: its weight in each of them */
    for (uint32_t item = 0; item < n_items; item++)
        self->held[view->cluster_items[item]]++;
    for (size_t i = 0; i < view->n; i++)
        self->held[i] = self->held[i] > 0 ? 1 / self->held[i] : 0;
    /* no rotation yet */
    for (uint32_t k = 0; k < view->n_clusters; k++)
        self->clusters[k].turn[3] = 1;
    return fixed_step_guard(&self->loop, limit_of);
}

static enum cs_step archive(void *object, const struct cs_archive *archive) {
    struct shape *self = object;
    for (uint32_t k = 0; k < self->loop.host->view->n_clusters; k++)
        archive->reals(archive->ctx, self->clusters[k].turn, 4);
    return fixed_step_archive(self, archive);
}

static const struct cs_integrator shape_matching = {
    .size = sizeof(struct cs_integrator),
    .name = "shape-matching",
    .summary =
        "bodies pulled back to their shape, other particles by symplectic Euler; another "
        "model, which cannot blow up by its stiffness",
    .source = "Mueller, Heidelberger, Teschner, Gross 2005; rotation: Horn 1987",
    .order = 1,
    .order_damped = 1,
    .needs = CS_NEED_CLUSTERS,
    .traits = 0,
    .fidelity = CS_FIDELITY_OTHER,
    .options = rows,
    .n_options = sizeof rows / sizeof rows[0],
    .options_size = sizeof(struct shape_options),
    .create = create,
    .restart = restart,
    .advance = fixed_step_advance,
    .stats = fixed_step_stats,
    .goals = goals,
    .save = archive,
    .load = archive,
};

static const struct cs_integrator *const integrators[] = {&shape_matching};

CS_EXPORT const struct cs_module clothsim_module = {
    .abi = CS_ABI,
    .size = sizeof(struct cs_integrator),
    .n = sizeof integrators / sizeof integrators[0],
    .integrators = integrators,
};

/* term_seams.c - the force of seams (system/seams.h).
 *
 * For d = x_p - x_q, e = v_p - v_q, l = |d|, u = d / l, on p, and on the particles of q times
 * -w: L = 0:  f = -k d - c e             linear; c acts on the whole relative velocity L > 0:
 * f = -(k (l - L) + c u.e) u A damper along d alone has no limit as l goes to 0, which is where
 * a stitch without length rests. Each stitch adds to A of the solver w_i w_j S, between each
 * two of its particles, with S = -ck k ((1 - L/l) (I - u u^T) + u u^T) - cd c u u^T      (I for
 * u u^T if L = 0) where 1 - L/l is not below 0 in a clamped A. The preconditioner knows the
 * diagonal blocks. */
#include "model/force/term.h"
#include "model/system/seams.h"

#include "base/vec3.h"
#include "scene/body_pairs.h"

#include <math.h>

static struct cs_plan_row plan_seams(const struct cs_scene *scene) {
    const bool sews = cs_scene_sews(scene, false);
    return (struct cs_plan_row){.built = sews, .reason = sews ? "the scene has seams" : NULL};
}

/* The length of d, and its direction: up for length 0. */
static double direction_of(const double d[3], double u[3]) {
    const double l = sqrt(cs_vec3_dot(d, d));
    for (int c = 0; c < 3; c++)
        u[c] = l > 0 ? d[c] / l : c == 1;
    return l;
}

/* A stitch with the constants of the chosen parts: a part that is not chosen has 0. */
static struct cs_stitch chosen(const struct cs_seams *seams, uint32_t s, uint32_t parts) {
    struct cs_stitch stitch = seams->stitches[s];
    const bool whole = !seams->broken[s];
    stitch.stiffness *= whole && parts & CS_PART_POTENTIAL;
    stitch.damping *= whole && parts & CS_PART_DISSIPATIVE;
    return stitch;
}

/* f = force on p in N. */
static void find_force(const struct cs_stitch *stitch, const double d[3], const double e[3],
                       double f[3]) {
    const double k = stitch->stiffness, damping = stitch->damping;
    double u[3];
    const double l = direction_of(d, u);
    const double pull = k * (l - stitch->length) + damping * cs_vec3_dot(u, e);
    for (int c = 0; c < 3; c++)
        f[c] = stitch->length > 0 ? -pull * u[c] : -k * d[c] - damping * e[c];
}

/* df = change of the force on p by dd and de, exact. */
static void find_change(const struct cs_stitch *stitch, const double d[3], const double e[3],
                        const double dd[3], const double de[3], double df[3]) {
    const double k = stitch->stiffness, damping = stitch->damping;
    double u[3], du[3];
    const double l = direction_of(d, u), along = cs_vec3_dot(u, dd);
    for (int c = 0; c < 3; c++)
        du[c] = l > 0 ? (dd[c] - along * u[c]) / l : 0;
    const double pull = k * (l - stitch->length) + damping * cs_vec3_dot(u, e);
    const double change = k * along + damping * (cs_vec3_dot(du, e) + cs_vec3_dot(u, de));
    for (int c = 0; c < 3; c++)
        df[c] =
            stitch->length > 0 ? -change * u[c] - pull * du[c] : -k * dd[c] - damping * de[c];
}

/* The forces on p of all stitches, or their changes if a direction is given. */
static void prepare(const struct cs_system *system, const struct cs_eval *at) {
    struct cs_seams *seams = system->seams;
    const size_t n = system->view.n;
    for (uint32_t s = 0; s < seams->n; s++) {
        // a broken stitch has the constants 0, thus no force
        const struct cs_stitch stitch = chosen(seams, s, at->parts);
        double d[3], e[3], dd[3] = {0}, de[3] = {0}, *to = seams->forces + 3 * (size_t)s;
        cs_stitch_difference(&stitch, n, at->x, d);
        cs_stitch_difference(&stitch, n, at->v, e);
        if (at->dx)
            cs_stitch_difference(&stitch, n, at->dx, dd);
        if (at->dv)
            cs_stitch_difference(&stitch, n, at->dv, de);
        if (at->dx || at->dv)
            find_change(&stitch, d, e, dd, de, to);
        else
            find_force(&stitch, d, e, to);
    }
}

/* f += weights times the stored forces at a block, in the order of the stitches. */
static void add_seams(const struct cs_system *system, const struct cs_eval *at, double *f) {
    const struct cs_seams *seams = system->seams;
    const size_t n = system->view.n;
    uint32_t low = 0;
    for (uint32_t high = seams->n_ends; low < high;) {
        const uint32_t middle = low + (high - low) / 2;
        if (seams->ends[middle].particle < at->block->begin)
            low = middle + 1;
        else
            high = middle;
    }
    for (; low < seams->n_ends && seams->ends[low].particle < at->block->end; low++) {
        const struct cs_stitch_end *end = seams->ends + low;
        for (size_t c = 0; c < 3; c++)
            f[c * n + end->particle] +=
                end->weight * seams->forces[3 * (size_t)end->stitch + c];
    }
}

static double energy(const struct cs_system *system, const struct cs_eval *at) {
    const struct cs_seams *seams = system->seams;
    double sum = 0;
    for (uint32_t s = 0; s < seams->n; s++) {
        const struct cs_stitch *stitch = seams->stitches + s;
        double d[3];
        cs_stitch_difference(stitch, system->view.n, at->x, d);
        const double more = sqrt(cs_vec3_dot(d, d)) - stitch->length;
        sum += seams->broken[s] ? 0 : 0.5 * stitch->stiffness * more * more;
    }
    return sum;
}

/* S of a stitch by places and by velocities: xx, xy, xz, yy, yz, zz. */
static void find_blocks(const struct cs_stitch *stitch, const struct cs_matrix *matrix,
                        const double d[3], double by_place[6], double by_velocity[6]) {
    double u[3];
    const double l = direction_of(d, u);
    const bool slack = stitch->length > 0;
    double across = slack ? (l > 0 ? 1 - stitch->length / l : 0) : 1;
    if (matrix->psd && across < 0)
        across = 0;
    for (int m = 0; m < 6; m++) {
        const int r = cs_sym3_row[m], s = cs_sym3_column[m];
        const double one = r == s, uu = u[r] * u[s];
        by_place[m] = -matrix->ck * stitch->stiffness * (across * (one - uu) + uu);
        by_velocity[m] = -matrix->cd * stitch->damping * (slack ? uu : one);
    }
}

/* The blocks of stitch s at the matrix's state. */
static void blocks_of(const struct cs_system *system, const struct cs_matrix *matrix,
                      uint32_t s, double out[12]) {
    const struct cs_stitch stitch = chosen(system->seams, s, CS_PART_ALL);
    double d[3];
    cs_stitch_difference(&stitch, system->view.n, matrix->x, d);
    find_blocks(&stitch, matrix, d, out, out + 6);
}

static void prepare_matrix(const struct cs_system *system, const struct cs_matrix *matrix,
                           bool kept) {
    system->seams->is_kept = kept;
    for (uint32_t s = 0; kept && s < system->seams->n; s++)
        blocks_of(system, matrix, s, system->seams->blocks + 12 * (size_t)s);
}

/* The diagonal blocks w_i^2 S; alone and as an upper bound of all entries 2 |w_i| S, because
 * |sum w p|^2 <= sum |w| sum |w| |p|^2, and sum |w| = 2. */
static void add_blocks(const struct cs_system *system, const struct cs_matrix *matrix,
                       size_t begin, size_t end, double *blocks) {
    const struct cs_seams *seams = system->seams;
    for (uint32_t e = 0; e < seams->n_ends; e++) {
        const struct cs_stitch_end *at = seams->ends + e;
        double both[12];
        if (at->particle < begin || at->particle >= end)
            continue;
        blocks_of(system, matrix, at->stitch, both);
        const double factor =
            matrix->bound && !seams->is_kept ? 2 * fabs(at->weight) : at->weight * at->weight;
        for (size_t m = 0; m < 6; m++)
            blocks[m * system->view.n + at->particle] += factor * (both[m] + both[6 + m]);
    }
}

/* y += w_i S (sum w_j p_j), at every particle i of every stitch; without the sum's own term if
 * apart. both: S by places and velocities, else by places alone. */
static void add_products(const struct cs_system *system, const double *p, bool both, bool apart,
                         double *y) {
    const struct cs_seams *seams = system->seams;
    const size_t n = system->view.n;
    for (uint32_t s = 0; s < seams->n; s++) {
        const struct cs_stitch *stitch = seams->stitches + s;
        double sum[6], d[3], out[3];
        for (size_t m = 0; m < 6; m++)
            sum[m] = seams->blocks[12 * (size_t)s + m] +
                     (both ? seams->blocks[12 * (size_t)s + 6 + m] : 0);
        cs_stitch_difference(stitch, n, p, d);
        // the diagonal blocks are elsewhere: each particle leaves itself out of the sum
        for (uint32_t k = 0; k < stitch->n; k++) {
            double rest[3];
            for (size_t c = 0; c < 3; c++)
                rest[c] = d[c] - (apart ? stitch->weight[k] * p[c * n + stitch->at[k]] : 0);
            cs_sym3_multiply(sum, rest, out);
            for (size_t c = 0; c < 3; c++)
                y[c * n + stitch->at[k]] += stitch->weight[k] * out[c];
        }
    }
}

static void add_matrix_product(const struct cs_system *system, const double *p, double *y) {
    add_products(system, p, true, true, y);
}

static void add_approach(const struct cs_system *system, const struct cs_matrix *matrix,
                         double *y) {
    add_products(system, matrix->v, false, false, y);
}

/* Rows of a stitch sum to w_i (w_0 + ... ) k = 2 w_i k. */
static void add_bound(const struct cs_system *system, const struct cs_gershgorin *sums) {
    const struct cs_seams *seams = system->seams;
    for (uint32_t e = 0; e < seams->n_ends; e++) {
        const struct cs_stitch_end *end = seams->ends + e;
        sums->stiffness[end->particle] +=
            2 * fabs(end->weight) * seams->stitches[end->stitch].stiffness;
        sums->damping[end->particle] +=
            2 * fabs(end->weight) * seams->stitches[end->stitch].damping;
    }
}

const struct cs_term cs_term_seams = {
    .name = "seams",
    .part_bits = CS_PART_POTENTIAL | CS_PART_DISSIPATIVE,
    .plan = plan_seams,
    .build = cs_seams_build,
    .prepare = prepare,
    .add_force = add_seams,
    .add_jvp = add_seams,
    .energy = energy,
    .energy_kind = CS_ENERGY_ELASTIC,
    .energy_column = "other",
    .work_column = "dampers",
    .prepare_matrix = prepare_matrix,
    .add_blocks = add_blocks,
    .add_matrix_product = add_matrix_product,
    .add_approach = add_approach,
    .add_bound = add_bound,
};

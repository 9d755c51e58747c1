/* Distances by cases (Ericson 2005, sec. 5.1), and additive advance along a move (Li et al.
 * 2021). */
#include "model/contact/ccd/accd.h"

#include "base/pool.h"
#include "base/vec3.h"
#include "model/contact/narrow_phase/contact_pairs.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* fraction of the safe advance per iteration, so that a tenth of the distance stays for
 * rounding */
#define ADVANCE 0.9

/* fraction of the first distance at which the search ends */
#define LEFT 0.1

/* largest number of iterations; the fraction reached is still safe */
enum { TURNS_MAX = 1000 };

static void subtract(const double a[3], const double b[3], double out[3]) {
    for (int c = 0; c < 3; c++)
        out[c] = a[c] - b[c];
}

static double clamp(double t) {
    return t > 0 ? fmin(t, 1) : 0;
}

/* |w + s u - t v|^2 in m2 */
static double squared_at(const double w[3], double s, const double u[3], double t,
                         const double v[3]) {
    double sum = 0;
    for (int c = 0; c < 3; c++) {
        const double r = w[c] + s * u[c] - t * v[c];
        sum += r * r;
    }
    return sum;
}

/* squared distance of p from the segment a b; from a if it has no length */
static double from_segment(const double p[3], const double a[3], const double b[3]) {
    double u[3], w[3];
    subtract(b, a, u);
    subtract(p, a, w);
    const double uu = cs_vec3_dot(u, u);
    return squared_at(w, 0, u, uu > 0 ? clamp(cs_vec3_dot(u, w) / uu) : 0, u);
}

/* Squared distance of p[0] from its triangle: that of the foot if it is inside, else the least
 * distance from an edge. */
static double from_triangle(const double p[4][3]) {
    double u[3], v[3], w[3];
    subtract(p[2], p[1], u);
    subtract(p[3], p[1], v);
    subtract(p[0], p[1], w);
    const double uu = cs_vec3_dot(u, u), uv = cs_vec3_dot(u, v), vv = cs_vec3_dot(v, v);
    const double uw = cs_vec3_dot(u, w), vw = cs_vec3_dot(v, w);
    const double det = uu * vv - uv * uv, s = vv * uw - uv * vw, t = uu * vw - uv * uw;
    if (det > 0 && s >= 0 && t >= 0 && s + t <= det)
        return squared_at(w, -s / det, u, t / det, v);
    return fmin(from_segment(p[0], p[1], p[2]),
                fmin(from_segment(p[0], p[2], p[3]), from_segment(p[0], p[3], p[1])));
}

/* Squared distance of two edges: from the point of the first line nearest to the second,
 * clamped, and from each end to the other edge. Cross products keep their accuracy for small
 * angles, where the determinant of dot products cancels. */
static double between_edges(const double p[4][3]) {
    double u[3], v[3], w[3], normal[3], across[3];
    subtract(p[1], p[0], u);
    subtract(p[3], p[2], v);
    subtract(p[0], p[2], w);
    cs_vec3_cross(u, v, normal);
    cs_vec3_cross(v, w, across);
    const double square = cs_vec3_dot(normal, normal);
    double inner = DBL_MAX;
    if (square > 0) {
        const double s = clamp(cs_vec3_dot(across, normal) / square);
        double q[3];
        for (int c = 0; c < 3; c++)
            q[c] = p[0][c] + s * u[c];
        inner = from_segment(q, p[2], p[3]);
    }
    const double first = fmin(from_segment(p[0], p[2], p[3]), from_segment(p[1], p[2], p[3]));
    const double second = fmin(from_segment(p[2], p[0], p[1]), from_segment(p[3], p[0], p[1]));
    return fmin(inner, fmin(first, second));
}

double cs_exact_distance_squared(enum cs_primitive_pair_kind kind, const double p[4][3]) {
    return kind == CS_PRIMITIVE_POINT_TRIANGLE ? from_triangle(p) : between_edges(p);
}

/* Takes the mean off the moves; returns the bound l of the relative motion of both sides. */
static double relative_move(enum cs_primitive_pair_kind kind, const double moves[4][3],
                            double rest[4][3]) {
    double mean[3] = {0, 0, 0}, length[4];
    for (int k = 0; k < 4; k++)
        for (int c = 0; c < 3; c++)
            mean[c] += 0.25 * moves[k][c];
    for (int k = 0; k < 4; k++) {
        subtract(moves[k], mean, rest[k]);
        length[k] = sqrt(cs_vec3_dot(rest[k], rest[k]));
    }
    const double other = fmax(length[2], length[3]);
    return kind == CS_PRIMITIVE_POINT_TRIANGLE ? length[0] + fmax(length[1], other)
                                               : fmax(length[0], length[1]) + other;
}

/* Two quick exits precede the loop: no relative motion, and a first distance that exceeds the
 * whole relative motion. Each advance is safe by itself, so an early end is safe too. */
double cs_accd_safe_fraction(enum cs_primitive_pair_kind kind, const double p[4][3],
                             const double moves[4][3], double most) {
    double rest[4][3], at[4][3], share = 0;
    const double move = relative_move(kind, moves, rest);
    if (!(move > 0 && move <= DBL_MAX))
        return most;
    const double start = sqrt(cs_exact_distance_squared(kind, p));
    if (start > move + CS_ACCD_DISTANCE_MIN)
        return most;
    if (!(start > CS_ACCD_DISTANCE_MIN))
        return 0;
    double gap = start;
    for (int turn = 0; turn < TURNS_MAX; turn++) {
        share += ADVANCE * gap / move;
        if (share >= most)
            return most;
        for (int k = 0; k < 4; k++)
            for (int c = 0; c < 3; c++)
                at[k][c] = p[k][c] + share * rest[k][c];
        gap = sqrt(cs_exact_distance_squared(kind, (const double(*)[3])at));
        if (!(gap > LEFT * start))
            break;
    }
    return share;
}

/* ACCD over the candidates of contact, in about a fifth of the time of a search by the tree.
 *
 * A list that covers the step holds all pairs that come within their range on the way, and
 * pairs that meet are among them (CS_CANDIDATES_ACCD_LIMIT). */

/* Returns whether contact is defined between all pairs, colliders with each other excepted. */
static bool all_bodies_collide(const struct cs_body_pair_table *meetings, uint32_t n_bodies) {
    bool all = true;
    for (uint32_t a = 0; a < n_bodies; a++)
        for (uint32_t b = 0; b < meetings->n_bodies; b++)
            all = all && cs_body_pair_params_of(meetings, a, b)->range > 0;
    return all;
}

bool cs_accd_candidates_suffice(const struct cs_system *system, bool apart, const double *x0,
                                const double *x1) {
    struct cs_pairs *pairs = system->pairs;
    return pairs &&
           (apart || all_bodies_collide(&pairs->body_pairs, system->scene->bodies.n)) &&
           cs_candidates_max_motion(&pairs->candidates, x0, x1) <= CS_CANDIDATES_ACCD_LIMIT &&
           cs_candidates_cover_step(&pairs->candidates, x0, x1);
}

/* pairs per call of the swept-box filter */
enum { SOME = 256 };

struct job {
    struct cs_pairs *pairs;
};

/* Returns whether a body is a single particle, which has no surface to pass through. */
static bool is_alone(const struct cs_surfaces *surfaces, uint32_t body) {
    return surfaces->first_edge[body] == surfaces->first_edge[body + 1];
}

/* Puts that edge first that crossings.c has first: the rounding of the distance depends on it.
 */
static void order_edges(const struct cs_candidates *search, uint32_t edges[2]) {
    const struct cs_surfaces *surfaces = search->system->surfaces;
    const size_t first = 2 * (size_t)edges[0], second = 2 * (size_t)edges[1];
    const uint32_t *body = search->body, e = edges[0];
    if (body[surfaces->edges[first]] != body[surfaces->edges[second]] ||
        surfaces->edge_triangles[first] <= surfaces->edge_triangles[second])
        return;
    edges[0] = edges[1];
    edges[1] = e;
}

/* Fraction of one pair, at most `most`. */
static double fraction_of(const struct job *job, enum cs_pair_kind stencil,
                          const uint32_t pair[2], double most) {
    const struct cs_candidates *search = &job->pairs->candidates;
    const struct cs_surfaces *surfaces = search->system->surfaces;
    const bool edges = stencil == CS_PAIR_EDGE_EDGE;
    uint32_t items[2] = {pair[0], pair[1]}, at[4];
    double p[4][3], moves[4][3];
    if (edges)
        order_edges(search, items);
    else if (is_alone(surfaces, search->body[pair[0]]))
        return most;
    cs_candidate_vertices(surfaces, stencil, items, at);
    for (size_t k = 0; k < 4; k++) {
        const double *move = job->pairs->point_motion[at[k]].values;
        memcpy(p[k], move + CS_POINT_MOVE_FROM, sizeof p[k]);
        memcpy(moves[k], move + CS_POINT_MOVE_BY, sizeof moves[k]);
    }
    return cs_accd_safe_fraction(edges ? CS_PRIMITIVE_EDGE_EDGE : CS_PRIMITIVE_POINT_TRIANGLE,
                                 (const double(*)[3])p, (const double(*)[3])moves, most);
}

/* Fraction of one chunk: the minimum over the pairs whose swept boxes meet. */
static void share_chunk(void *arg, uint32_t number) {
    const struct job *job = arg;
    struct cs_candidate_chunk *chunk = job->pairs->candidates.chunks + number;
    struct cs_moving_pairs items = {.surfaces = job->pairs->system->surfaces,
                                    .edges = chunk->kind == CS_PAIR_EDGE_EDGE};
    uint32_t some[SOME][2];
    chunk->result = 1;
    for (size_t p = 0; p < chunk->n; p += SOME) {
        items.items = chunk->pairs + 2 * p;
        items.n = chunk->n - p < SOME ? chunk->n - p : SOME;
        const size_t n = cs_point_motion_filter(job->pairs->point_motion, &items,
                                                CS_ACCD_DISTANCE_MIN, some[0]);
        for (size_t k = 0; k < n; k++)
            chunk->result = fraction_of(job, chunk->kind, some[k], chunk->result);
    }
}

double cs_accd_candidates_safe_fraction(const struct cs_system *system, const double *x0,
                                        const double *x1) {
    struct cs_candidates *search = &system->pairs->candidates;
    struct job job = {system->pairs};
    cs_point_motion_set(system, x0, x1, system->pairs->point_motion);
    double share = 1;
    cs_pool_run(search->n_chunks, share_chunk, &job);
    for (uint32_t l = 0; l < search->n_chunks; l++)
        share = fmin(share, search->chunks[l].result);
    return share;
}

/* Adjacency of the triangles of surfaces, and the weights of their vertices. */
#include "model/contact/narrow_phase/feature_weights.h"

#include <math.h>
#include <string.h>

/* Inclusion-exclusion weights of faces, edges and vertices (formula: mesh_feature.h).
 *
 * For the foot q of a point in the plane of its triangle, each query adds to the energy of the
 * mesh its own part of
 *
 *   sum of triangles psi - sum of inner edges psi + sum of inner vertices psi
 *
 * - the plane counts 1 if q is inside the triangle;
 * - the nearest of those edges that q is beyond counts 1, in place of the triangle;
 * - each inner edge counts -1/2, because both its triangles measure it;
 * - each inner vertex counts vertex_share, which its triangles add up to 1.
 *
 * An edge counts as the vertex at its end where q projects beyond that end: it has its
 * distance. Equal features of a point are merged over its triangles. */

/* Index of a feature: the plane, RIM + k for edge k, CORNER + k for vertex k, k = 0, 1, 2. */
enum { LANES = 8, PLANE = 0, RIM = 1, CORNER = 4 };

/* Eight queries and their distances. Edge k runs from vertex k to vertex k + 1. */
struct lanes {
    /* points in m; range of the features in m; blend radius e in m */
    double p[4][3][LANES], range[LANES], bend[LANES];
    /* barycentric coordinates of the foot: below 0 beyond the edge opposite */
    double l[3][LANES];
    /* of edges: projection t of the foot as in struct cs_mesh_feature */
    double t[3][LANES], zeta[3][LANES];
    /* of edges: squared distance of the point in m2 */
    double leg[3][LANES];
    /* m: squared distance of the foot from the feature in m2; square: d^2 in m2 */
    double m[CS_FEATURES_PER_TRIANGLE][LANES], square[CS_FEATURES_PER_TRIANGLE][LANES];
};

/* --- in lanes --- */

/* Measures edge k and vertex k, its first end. Both have the height of the plane in common: d^2
 * = h^2 + f(m) with m = squared distance - h^2. */
CS_INLINE void measure_rim(struct lanes *restrict at, int i, int k, double height,
                           double p[4][3]) {
    const double least = CS_PAIR_DISTANCE_MIN * CS_PAIR_DISTANCE_MIN;
    struct cs_mesh_feature rim;
    rim.kind = (struct cs_feature_kind){1, 1, at->bend[i]};
    double *u = rim.plane.u, *w = rim.plane.w;
    CS_UNROLLED
    for (int c = 0; c < 3; c++) {
        u[c] = p[1 + (k + 1) % 3][c] - p[1 + k][c];
        w[c] = p[0][c] - p[1 + k][c];
    }
    rim.plane.a = cs_vec3_dot(u, u);
    cs_mesh_feature_clamp(&rim);
    double leg[3];
    CS_UNROLLED
    for (int c = 0; c < 3; c++)
        leg[c] = w[c] - rim.zeta * u[c];
    at->t[k][i] = rim.t;
    at->leg[k][i] = cs_vec3_dot(leg, leg);
    at->m[RIM + k][i] = at->leg[k][i] - height;
    at->m[CORNER + k][i] = cs_vec3_dot(w, w) - height;
    at->square[RIM + k][i] = height + cs_mesh_feature_blend(&rim, at->m[RIM + k][i]) + least;
    at->square[CORNER + k][i] =
        height + cs_mesh_feature_blend(&rim, at->m[CORNER + k][i]) + least;
}

/* Measures the plane, then the three edges with their vertices. The loop over edges is unrolled
 * by hand. */
CS_INLINE void measure_lane(struct lanes *restrict at, int i) {
    double p[4][3], foot[3];
    struct cs_pair_distance plane;
    CS_UNROLLED
    for (int k = 0; k < 12; k++)
        p[k / 3][k % 3] = at->p[k / 3][k % 3][i];
    cs_pair_distance_frame(&plane, CS_PAIR_POINT_TRIANGLE, 0, p);
    const double *l = plane.unclamped;
    CS_UNROLLED
    for (int c = 0; c < 3; c++)
        foot[c] = plane.w[c] - l[0] * plane.u[c] - l[1] * plane.v[c];
    const double height = cs_vec3_dot(foot, foot);
    at->l[0][i] = 1 - l[0] - l[1];
    at->l[1][i] = l[0];
    at->l[2][i] = l[1];
    at->m[PLANE][i] = 0;
    at->square[PLANE][i] = height + CS_PAIR_DISTANCE_MIN * CS_PAIR_DISTANCE_MIN;
    measure_rim(at, i, 0, height, p);
    measure_rim(at, i, 1, height, p);
    measure_rim(at, i, 2, height, p);
}

CS_CLONES static void measure(struct lanes *restrict at) {
    for (int i = 0; i < LANES; i++)
        measure_lane(at, i);
}

/* --- one by one --- */

/* The query at work; the weights are collected in `count` and `alone` by feature. */
struct finding {
    const struct cs_feature_weights *weights;
    const struct cs_feature_query *pair;
    const struct lanes *at;
    int lane;
    const struct cs_feature_positions *x;
    double count[CS_FEATURES_PER_TRIANGLE], alone[CS_FEATURES_PER_TRIANGLE];
};

/* m, component `at` of all positions; that of one state has its bits. */
static double position(const struct cs_feature_positions *x, size_t at) {
    return x->from[at] + x->fraction * (x->to[at] - x->from[at]);
}

/* Returns whether an edge joins two points: a point does not feel the vertices next to it. */
static bool are_joined(const struct cs_feature_weights *features, uint32_t a, uint32_t b) {
    const uint32_t low = a < b ? a : b, high = a < b ? b : a;
    bool joined = false;
    for (uint32_t e = features->vertex_edges[low]; e < features->vertex_edges[low + 1]; e++)
        joined = joined || features->surfaces->edges[2 * (size_t)e + 1] == high;
    return joined;
}

/* Returns whether d^2 of a feature is below the square of the range of features. */
static bool is_in_range(const struct finding *on, int feature) {
    const double range = on->at->range[on->lane];
    return on->at->square[feature][on->lane] < range * range;
}

/* The feature of edge k: a vertex if the foot projects beyond an end, else the edge. */
static int facet_of_rim(const struct finding *on, int k) {
    const double t = on->at->t[k][on->lane];
    if (t <= 0)
        return CORNER + k;
    return t >= 1 ? CORNER + (k + 1) % 3 : RIM + k;
}

/* Returns whether the foot is beyond edge k for the neighbour across it too, as over a ridge.
 * With u along the edge, v to the far vertex and w to the point, this holds if the component of
 * w at right angles to u points away from v:
 *
 *   (w - u (w.u)/u.u) . (v - u (v.u)/u.u) < 0  <=>  (w.v)(u.u) < (w.u)(u.v) */
static bool is_convex_edge(const struct finding *on, int k, uint32_t across) {
    double u[3], v[3], w[3];
    for (size_t c = 0; c < 3; c++) {
        const double a = on->at->p[1 + k][c][on->lane];
        u[c] = on->at->p[1 + (k + 1) % 3][c][on->lane] - a;
        v[c] = position(on->x, c * on->weights->surfaces->n_points + across) - a;
        w[c] = on->at->p[0][c][on->lane] - a;
    }
    return cs_vec3_dot(w, v) * cs_vec3_dot(u, u) < cs_vec3_dot(w, u) * cs_vec3_dot(u, v);
}

/* Far vertex of the neighbour across edge k; CS_NO_POINT at a border, and if it is the point
 * itself: its own triangles are left out of the pairs, so the edge is a border to it. */
static uint32_t across_rim(const struct finding *on, int k) {
    const uint32_t *across = on->weights->opposite_vertex + 3 * (size_t)on->pair->triangle;
    const uint32_t to = across[(k + 2) % 3];
    return to == on->pair->points[0] ? CS_NO_POINT : to;
}

/* Weight of a nearest edge in a positive semi-definite matrix, where nothing is subtracted. At
 * a border it is 1. Beyond a valley or a flat edge it is 0: the foot is not beyond it for the
 * neighbour, which counts the point. Over a ridge both triangles count half of the edge; its
 * end counts vertex_share in each triangle. */
static double count_alone(const struct finding *on, int k) {
    const double t = on->at->t[k][on->lane];
    const uint32_t across = across_rim(on, k);
    const double share =
        on->weights->vertex_share[on->pair->points[1 + (t < 0 ? k : (k + 1) % 3)]];
    if (across == CS_NO_POINT)
        return 1;
    if (!is_convex_edge(on, k, across))
        return 0;
    return (t < 0 || t > 1) && share > 0 ? share : 0.5;
}

/* Edges: subtracts half of each inner edge in range, and adds the nearest edge that the foot is
 * beyond in place of the triangle. */
static void count_rims(struct finding *on) {
    const struct lanes *at = on->at;
    int nearest = -1;
    for (int k = 0; k < 3; k++) {
        const bool inner = across_rim(on, k) != CS_NO_POINT;
        const bool beyond = at->l[(k + 2) % 3][on->lane] < 0;
        const int feature = facet_of_rim(on, k);
        if (!(inner || beyond) || !is_in_range(on, feature))
            continue;
        on->count[feature] -= inner ? 0.5 : 0;
        if (beyond && (nearest < 0 || at->leg[k][on->lane] < at->leg[nearest][on->lane]))
            nearest = k;
    }
    if (nearest < 0)
        return;
    const int feature = facet_of_rim(on, nearest);
    on->count[feature] += 1;
    // beyond a vertex both its edges are as near, and rounding would choose: the larger counts
    for (int k = 0; k < 3; k++)
        if (at->l[(k + 2) % 3][on->lane] < 0 && facet_of_rim(on, k) == feature)
            on->alone[feature] = fmax(on->alone[feature], count_alone(on, k));
}

/* Vertices in range count vertex_share, except those next to the point. */
static void count_corners(struct finding *on) {
    for (int k = 0; k < 3; k++) {
        const uint32_t corner = on->pair->points[1 + k];
        const double share = on->weights->vertex_share[corner];
        if (is_in_range(on, CORNER + k) && share != 0 &&
            !(on->pair->same_body && are_joined(on->weights, on->pair->points[0], corner)))
            on->count[CORNER + k] += share;
    }
}

/* The plane counts 1 if the foot is inside the triangle and the plane is in range. */
static void count_plane(struct finding *on) {
    bool inside = is_in_range(on, PLANE);
    for (int k = 0; k < 3; k++)
        inside = inside && on->at->l[k][on->lane] >= 0;
    on->count[PLANE] = on->alone[PLANE] = inside;
}

/* Moves the weights of features with f(m) = 0 to the plane, whose distance they have. Over a
 * flat mesh the weights of a shared edge then cancel within one feature. */
static void flatten(struct finding *on) {
    const double bend = on->at->bend[on->lane];
    for (int feature = RIM; feature < CS_FEATURES_PER_TRIANGLE; feature++)
        if (on->at->m[feature][on->lane] <= CS_FEATURE_BLEND_START * bend * bend) {
            on->count[PLANE] += on->count[feature];
            on->alone[PLANE] += on->alone[feature];
            on->count[feature] = on->alone[feature] = 0;
        }
}

/* Marks a feature that is shared: at m >= e^2 is f(m) = m, so d^2 = h^2 + m is the squared
 * distance from the edge or vertex, whatever triangle it was measured in. */
static void name_whole(const struct finding *on, int feature, struct cs_weighted_feature *use) {
    const double bend = on->at->bend[on->lane];
    const uint32_t a = use->points[1], b = use->points[2];
    use->shared_feature[0] = use->shared_feature[1] = CS_NO_POINT;
    if (feature == PLANE || on->at->m[feature][on->lane] < bend * bend)
        return;
    use->shared_feature[0] = feature >= CORNER || a < b ? a : b;
    use->shared_feature[1] = feature >= CORNER ? CS_NO_POINT : a < b ? b : a;
}

/* Writes one feature, with the vertices of its triangle rotated to begin at it. */
static void fill(const struct finding *on, int feature, struct cs_weighted_feature *use) {
    const int first = feature == PLANE ? 0 : (feature - RIM) % 3;
    use->points[0] = on->pair->points[0];
    for (int k = 0; k < 3; k++)
        use->points[1 + k] = on->pair->points[1 + (first + k) % 3];
    use->d = sqrt(on->at->square[feature][on->lane]);
    use->weight = on->count[feature];
    use->psd_weight = on->alone[feature];
    use->kind = (struct cs_feature_kind){feature >= RIM && feature < CORNER, feature != PLANE,
                                         on->at->bend[on->lane]};
    name_whole(on, feature, use);
}

/* Writes the features of one query whose weight is not 0. */
static uint32_t find_weighted(struct finding *on, struct cs_weighted_feature *features) {
    uint32_t n = 0;
    memset(on->count, 0, sizeof on->count);
    memset(on->alone, 0, sizeof on->alone);
    count_plane(on);
    count_rims(on);
    count_corners(on);
    flatten(on);
    for (int feature = PLANE; feature < CS_FEATURES_PER_TRIANGLE; feature++)
        if (on->count[feature] != 0 || on->alone[feature] != 0)
            fill(on, feature, features + n++);
    return n;
}

/* Loads n queries. Unused lanes repeat the last: what they held may be slow to compute with. */
static void read(const struct cs_feature_weights *features,
                 const struct cs_feature_query *pairs, uint32_t n,
                 const struct cs_feature_positions *x, struct lanes *at) {
    const size_t n_points = features->surfaces->n_points;
    for (uint32_t i = 0; i < LANES; i++) {
        const struct cs_feature_query *pair = pairs + (i < n ? i : n - 1);
        at->range[i] = CS_FEATURE_RANGE_RATIO * pair->range;
        at->bend[i] = CS_FEATURE_BLEND_RADIUS * pair->range;
        for (size_t k = 0; k < 4; k++)
            for (size_t c = 0; c < 3; c++)
                at->p[k][c][i] = position(x, c * n_points + pair->points[k]);
    }
}

/* In three passes over at most CS_FEATURE_QUERY_PAIRS queries: load lanes, measure, select. */
uint32_t cs_feature_weights_find_between(const struct cs_feature_weights *features,
                                         const struct cs_feature_query *pairs, uint32_t n,
                                         const struct cs_feature_positions *x,
                                         struct cs_weighted_feature *uses) {
    struct lanes at[CS_FEATURE_QUERY_PAIRS / LANES];
    struct finding on = {.weights = features, .x = x};
    uint32_t found = 0;
    // all lanes are written first: a vector load right after scalar stores there would stall
    for (uint32_t k = 0; k < n; k += LANES)
        read(features, pairs + k, n - k < LANES ? n - k : LANES, x, at + k / LANES);
    for (uint32_t k = 0; k < n; k += LANES)
        measure(at + k / LANES);
    for (uint32_t k = 0; k < n; k++) {
        on.pair = pairs + k;
        on.at = at + k / LANES, on.lane = (int)(k % LANES);
        found += find_weighted(&on, uses + found);
    }
    return found;
}

/* --- a point's --- */

/* Returns whether two features are the same edge or vertex. */
static bool are_same(const struct cs_weighted_feature *a, const struct cs_weighted_feature *b) {
    return a->shared_feature[0] == b->shared_feature[0] &&
           a->shared_feature[1] == b->shared_feature[1];
}

/* Each new feature is compared with those before it: a point has few. Features that depend on
 * the plane of their triangle (CS_NO_POINT) are never merged. */
uint32_t cs_feature_weights_join(struct cs_weighted_feature *features, uint32_t n,
                                 uint32_t more) {
    for (uint32_t end = n + more, k = n; k < end; k++) {
        uint32_t same = features[k].shared_feature[0] == CS_NO_POINT ? n : 0;
        while (same < n && !are_same(features + same, features + k))
            same++;
        if (same == n) {
            features[n++] = features[k];
            continue;
        }
        features[same].weight += features[k].weight;
        features[same].psd_weight += features[k].psd_weight;
    }
    return n;
}

/* index 0..2 of the vertex of a triangle that is not on the edge */
static uint32_t corner_opposite(const uint32_t *corners, const uint32_t *edge) {
    uint32_t k = 0;
    while (k < 2 && (corners[k] == edge[0] || corners[k] == edge[1]))
        k++;
    return k;
}

/* Weights of the vertices. Triangles count +1, inner edges -1: for a sum of 1 the vertex must
 * count 1 - triangles + inner edges. That is 1 inside a surface, where both numbers are equal,
 * and 0 at its border. Each of its triangles measures an equal fraction. */
static void share_corners(struct cs_feature_weights *features, const uint32_t *inner) {
    const struct cs_surfaces *s = features->surfaces;
    for (size_t c = 0; c < 3 * (size_t)s->n_triangles; c++)
        features->vertex_share[s->triangles[c]] += 1;
    for (uint32_t i = 0; i < s->n_points; i++)
        if (features->vertex_share[i] > 0)
            features->vertex_share[i] =
                (1 - features->vertex_share[i] + inner[i]) / features->vertex_share[i];
}

/* Sets the opposite vertices; counts inner edges of each point, and edges of each first end. */
static void cross_edges(struct cs_feature_weights *features, uint32_t *inner) {
    const struct cs_surfaces *s = features->surfaces;
    for (size_t c = 0; c < 3 * (size_t)s->n_triangles; c++)
        features->opposite_vertex[c] = CS_NO_POINT;
    for (size_t e = 0; e < s->n_edges; e++) {
        const uint32_t *edge = s->edges + 2 * e, *owner = s->edge_triangles + 2 * e;
        features->vertex_edges[edge[0] + 1]++;
        if (owner[1] == CS_NO_TRIANGLE)
            continue;
        const uint32_t *first = s->triangles + 3 * (size_t)owner[0];
        const uint32_t *second = s->triangles + 3 * (size_t)owner[1];
        const uint32_t k = corner_opposite(first, edge), l = corner_opposite(second, edge);
        features->opposite_vertex[3 * (size_t)owner[0] + k] = second[l];
        features->opposite_vertex[3 * (size_t)owner[1] + l] = first[k];
        inner[edge[0]]++;
        inner[edge[1]]++;
    }
}

/* vertex_edges is built by counting into place i + 1 and summing: edges are sorted by their
 * first end. `inner` stays in the arena, unused afterwards. */
enum cs_status cs_feature_weights_init(struct cs_feature_weights *features,
                                       const struct cs_surfaces *surfaces,
                                       struct cs_arena *arena, struct cs_error *error) {
    const size_t corners = 3 * (size_t)surfaces->n_triangles, n = surfaces->n_points;
    *features = (struct cs_feature_weights){.surfaces = surfaces};
    CS_ARENA_ARRAY(arena, features->opposite_vertex, corners, error);
    CS_ARENA_ARRAY(arena, features->vertex_share, n, error);
    CS_ARENA_ARRAY(arena, features->vertex_edges, n + 1, error);
    uint32_t *inner = cs_arena_alloc_array(arena, n, sizeof *inner, error);
    if (error->status)
        return error->status;
    cross_edges(features, inner);
    for (size_t i = 0; i < n; i++)
        features->vertex_edges[i + 1] += features->vertex_edges[i];
    share_corners(features, inner);
    return CS_OK;
}

/* Adjacency of the triangles of surfaces, and the weights of their vertices. */
#include "model/contact/narrow_phase/feature_weights.h"

/* index 0..2 of the vertex of a triangle that is not on the edge */
static uint32_t corner_opposite(const uint32_t *corners, const uint32_t *edge) {
    uint32_t k = 0;
    while (k < 2 && (corners[k] == edge[0] || corners[k] == edge[1]))
        k++;
    return k;
}

/* Weights of the vertices. For inclusion and exclusion to give 1 at a vertex, triangles count
 * +1, inner edges -1, and so the vertex must count 1 - triangles + inner edges. That is 1
 * inside a surface, where both numbers are equal, and 0 at its border. Each of its triangles
 * measures an equal fraction. */
static void share_corners(struct cs_feature_weights *features, const uint32_t *inner) {
    const struct cs_surfaces *s = features->surfaces;
    for (size_t c = 0; c < 3 * (size_t)s->n_triangles; c++)
        features->vertex_share[s->triangles[c]] += 1;
    for (uint32_t i = 0; i < s->n_points; i++)
        if (features->vertex_share[i] > 0)
            features->vertex_share[i] =
                (1 - features->vertex_share[i] + inner[i]) / features->vertex_share[i];
}

/* Sets the opposite vertices, and counts the inner edges of each point and the edges of each
 * first end. An edge with one triangle is at the border. */
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
    features->opposite_vertex =
        cs_arena_alloc_array(arena, corners, sizeof *features->opposite_vertex, error);
    features->vertex_share =
        cs_arena_alloc_array(arena, n, sizeof *features->vertex_share, error);
    features->vertex_edges =
        cs_arena_alloc_array(arena, n + 1, sizeof *features->vertex_edges, error);
    uint32_t *inner = cs_arena_alloc_array(arena, n, sizeof *inner, error);
    if (error->status)
        return error->status;
    cross_edges(features, inner);
    for (size_t i = 0; i < n; i++)
        features->vertex_edges[i + 1] += features->vertex_edges[i];
    share_corners(features, inner);
    return CS_OK;
}

/* How the triangles of surfaces hang together. */
#include "model/pair/facets.h"

static uint32_t corner_opposite(const uint32_t *corners, const uint32_t *edge) {
    uint32_t k = 0;
    while (k < 2 && (corners[k] == edge[0] || corners[k] == edge[1]))
        k++;
    return k;
}

/* Of a corner whose fan of triangles is cut by its inner rims: 1 - triangles + rims of it are
 * left to be counted, so that all count 1. */
static void share_corners(struct cs_facets *facets, const uint32_t *inner) {
    const struct cs_surfaces *s = facets->surfaces;
    for (size_t c = 0; c < 3 * (size_t)s->n_triangles; c++)
        facets->share[s->triangles[c]] += 1;
    for (uint32_t i = 0; i < s->n_points; i++)
        if (facets->share[i] > 0)
            facets->share[i] = (1 - facets->share[i] + inner[i]) / facets->share[i];
}

static void cross_edges(struct cs_facets *facets, uint32_t *inner) {
    const struct cs_surfaces *s = facets->surfaces;
    for (size_t c = 0; c < 3 * (size_t)s->n_triangles; c++)
        facets->across[c] = CS_NO_POINT;
    for (size_t e = 0; e < s->n_edges; e++) {
        const uint32_t *edge = s->edges + 2 * e, *owner = s->owners + 2 * e;
        facets->started[edge[0] + 1]++;
        if (owner[1] == CS_NO_TRIANGLE)
            continue;
        const uint32_t *first = s->triangles + 3 * (size_t)owner[0];
        const uint32_t *second = s->triangles + 3 * (size_t)owner[1];
        const uint32_t k = corner_opposite(first, edge), l = corner_opposite(second, edge);
        facets->across[3 * (size_t)owner[0] + k] = second[l];
        facets->across[3 * (size_t)owner[1] + l] = first[k];
        inner[edge[0]]++;
        inner[edge[1]]++;
    }
}

enum cs_status cs_facets_init(struct cs_facets *facets, const struct cs_surfaces *surfaces,
                              struct cs_arena *arena, struct cs_error *error) {
    const size_t corners = 3 * (size_t)surfaces->n_triangles, n = surfaces->n_points;
    *facets = (struct cs_facets){.surfaces = surfaces};
    facets->across = cs_arena_take_n(arena, corners, sizeof *facets->across, error);
    facets->share = cs_arena_take_n(arena, n, sizeof *facets->share, error);
    facets->started = cs_arena_take_n(arena, n + 1, sizeof *facets->started, error);
    uint32_t *inner = cs_arena_take_n(arena, n, sizeof *inner, error);
    if (error->status)
        return error->status;
    cross_edges(facets, inner);
    for (size_t i = 0; i < n; i++)
        facets->started[i + 1] += facets->started[i];
    share_corners(facets, inner);
    return CS_OK;
}

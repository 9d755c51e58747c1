/* Assigns edges and points to their representative triangles, and updates the boxes of parts.
 */
#include "model/contact/ccd/representative_triangles.h"

#include "base/vector.h"
#include "model/contact/surface_points.h"

#include <stdlib.h>

/* Returns whether an edge has no triangle, as in a rope: it is a part itself. */
static bool is_loose(const struct cs_surfaces *surfaces, uint32_t e) {
    return surfaces->edge_triangles[2 * (size_t)e] == CS_NO_TRIANGLE;
}

/* Temporary numbers of parts while they are assigned. */
struct numbering {
    uint32_t *first;        /* (bodies + 1) parts of a body */
    uint32_t *of_triangles; /* (triangles) */
    uint32_t *of_edges;     /* (edges): the owner */
};

/* Numbers the parts of a body from `part` on, its triangles and then its loose edges, and
 * returns the next number. An edge is owned by its first triangle. */
static uint32_t number_body(const struct cs_surfaces *surfaces, uint32_t body, uint32_t part,
                            struct cs_representative_triangles *parts,
                            struct numbering *numbering) {
    numbering->first[body] = part;
    for (uint32_t t = surfaces->first_triangle[body]; t < surfaces->first_triangle[body + 1];
         t++) {
        numbering->of_triangles[t] = part;
        parts->bodies[part] = body;
        parts->triangles[part++] = t;
    }
    for (uint32_t e = surfaces->first_edge[body]; e < surfaces->first_edge[body + 1]; e++) {
        if (!is_loose(surfaces, e)) {
            numbering->of_edges[e] =
                numbering->of_triangles[surfaces->edge_triangles[2 * (size_t)e]];
            continue;
        }
        numbering->of_edges[e] = part;
        parts->bodies[part] = body;
        parts->triangles[part++] = CS_NO_TRIANGLE;
    }
    return part;
}

/* Lists the items of each of n owners by counting: item i is in the list of owners[i], in
 * ascending order. `first` must be 0 at the call. */
static void list_owned(const uint32_t *owners, uint32_t n_items, uint32_t n, uint32_t *first,
                       uint32_t *items) {
    for (uint32_t i = 0; i < n_items; i++)
        if (owners[i] != CS_NO_TRIANGLE)
            first[owners[i] + 1]++;
    for (uint32_t k = 0; k < n; k++)
        first[k + 1] += first[k];
    // Filling advances first[owner + 1] from the begin of its list to the end.
    for (uint32_t k = n; k > 0; k--)
        first[k] = first[k - 1];
    first[0] = 0;
    for (uint32_t i = 0; i < n_items; i++)
        if (owners[i] != CS_NO_TRIANGLE)
            items[first[owners[i] + 1]++] = i;
}

/* Particles of a part, two or three; returns their number. */
static uint32_t corners_of(const struct cs_representative_triangles *parts, uint32_t part,
                           uint32_t corners[3]) {
    const uint32_t t = parts->triangles[part];
    const bool loose = t == CS_NO_TRIANGLE;
    const uint32_t *from = loose
                               ? cs_edge_vertices(parts, parts->edges[parts->first_edge[part]])
                               : cs_triangle_vertices(parts, t);
    const uint32_t n = loose ? 2 : 3;
    for (uint32_t k = 0; k < n; k++)
        corners[k] = from[k];
    return n;
}

/* Gives each point to the first part that contains it. A particle without edges has no owner.
 */
static void own_points(struct cs_representative_triangles *parts, uint32_t *owners) {
    for (uint32_t i = 0; i < parts->n_points; i++)
        owners[i] = CS_NO_TRIANGLE;
    for (uint32_t part = 0; part < parts->n; part++) {
        uint32_t corners[3];
        for (uint32_t k = corners_of(parts, part, corners); k-- > 0;)
            if (owners[corners[k]] == CS_NO_TRIANGLE)
                owners[corners[k]] = part;
    }
    list_owned(owners, parts->n_points, parts->n, parts->first_point, parts->points);
}

/* Centres of the parts (n, 3) at x: the mean of their particles. */
static void find_centres(const struct cs_representative_triangles *parts, const double *x,
                         double *centres) {
    const size_t n = parts->n_points;
    for (uint32_t part = 0; part < parts->n; part++) {
        uint32_t corners[3];
        const uint32_t count = corners_of(parts, part, corners);
        for (size_t c = 0; c < 3; c++) {
            double sum = 0;
            for (uint32_t k = 0; k < count; k++)
                sum += x[c * n + corners[k]];
            centres[3 * (size_t)part + c] = sum / count;
        }
    }
}

/* number of edges without a triangle */
static uint32_t count_loose(const struct cs_surfaces *surfaces) {
    uint32_t n = 0;
    for (uint32_t e = 0; e < surfaces->n_edges; e++)
        n += is_loose(surfaces, e);
    return n;
}

static void alloc_arrays(struct cs_representative_triangles *parts, struct cs_arena *arena,
                         struct cs_error *error) {
    const size_t n = parts->n, word = sizeof(uint32_t);
    parts->triangles = cs_arena_alloc_array(arena, n, word, error);
    parts->bodies = cs_arena_alloc_array(arena, n, word, error);
    parts->first_edge = cs_arena_alloc_array(arena, n + 1, word, error);
    parts->edges = cs_arena_alloc_array(arena, parts->surfaces->n_edges, word, error);
    parts->first_point = cs_arena_alloc_array(arena, n + 1, word, error);
    parts->points = cs_arena_alloc_array(arena, parts->n_points, word, error);
}

/* Assigns everything after allocation. `work` holds bodies + 1, triangles, and the larger of
 * edges and points, as words. */
static void fill(struct cs_representative_triangles *parts, const struct cs_system *system,
                 double *centres, uint32_t *work, struct cs_arena *arena,
                 struct cs_error *error) {
    const struct cs_surfaces *surfaces = parts->surfaces;
    struct numbering numbering = {.first = work,
                                  .of_triangles = work + surfaces->n_bodies + 1,
                                  .of_edges =
                                      work + surfaces->n_bodies + 1 + surfaces->n_triangles};
    uint32_t part = 0;
    for (uint32_t b = 0; b < surfaces->n_bodies; b++)
        part = number_body(surfaces, b, part, parts, &numbering);
    numbering.first[surfaces->n_bodies] = part;
    list_owned(numbering.of_edges, surfaces->n_edges, parts->n, parts->first_edge,
               parts->edges);
    own_points(parts, numbering.of_edges);
    find_centres(parts, cs_surface_points_positions(system, CS_POINTS_BEGIN, 0, system->start),
                 centres);
    cs_bvh_init(&parts->bvh, centres, numbering.first, surfaces->n_bodies, arena, error);
}

enum cs_status cs_representative_triangles_build(struct cs_system *system,
                                                 struct cs_representative_triangles *parts,
                                                 struct cs_error *error) {
    if (cs_surface_points_build(system, error))
        return error->status;
    const struct cs_surfaces *surfaces = system->surfaces;
    const uint32_t n = surfaces->n_points;
    *parts =
        (struct cs_representative_triangles){.surfaces = surfaces,
                                             .n = surfaces->n_triangles + count_loose(surfaces),
                                             .n_points = n};
    const size_t most = surfaces->n_edges > n ? surfaces->n_edges : n;
    uint32_t *work =
        calloc(surfaces->n_bodies + 1 + surfaces->n_triangles + most, sizeof *work);
    double *centres = calloc(3 * (size_t)parts->n + 1, sizeof *centres);
    if (!work || !centres)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for %u parts of surfaces", parts->n);
    alloc_arrays(parts, &system->arena, error);
    if (!error->status)
        fill(parts, system, centres, work, &system->arena, error);
    free(centres);
    free(work);
    return error->status;
}

/* One update of boxes. */
struct placing {
    struct cs_representative_triangles *parts;
    const double *x0, *x1;
};

/* Swept boxes of the parts [begin, end). */
static void place_parts(void *arg, size_t begin, size_t end) {
    const struct placing *placing = arg;
    for (size_t part = begin; part < end; part++) {
        struct cs_swept_aabb swept_box = cs_swept_aabb_empty();
        uint32_t corners[3];
        for (uint32_t k = corners_of(placing->parts, (uint32_t)part, corners); k-- > 0;)
            cs_swept_aabb_add_point(&swept_box, placing->parts->n_points, corners[k],
                                    placing->x0, placing->x1);
        placing->parts->bvh.boxes[part] = swept_box;
    }
}

/* Sets the boxes of parts in parallel, then refits the tree. */
void cs_representative_triangles_update(struct cs_representative_triangles *parts,
                                        const double *x0, const double *x1, double reach) {
    struct placing placing = {parts, x0, x1};
    cs_vector_parallel_for(parts->n, place_parts, &placing);
    cs_bvh_update(&parts->bvh, reach);
}

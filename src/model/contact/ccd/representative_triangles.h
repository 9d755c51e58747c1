/* representative_triangles.h - the surfaces of a system as parts that may meet: triangles, and
 * edges of ropes.
 *
 * A part has the edges and points that no part before it has, so that each pair of an edge and
 * a triangle, of two edges, or of a point and a triangle belongs to one pair of parts: that of
 * their owners, or of the owner and the triangle itself. */
#ifndef CS_REPRESENTATIVE_TRIANGLES_H
#define CS_REPRESENTATIVE_TRIANGLES_H

#include "model/contact/broad_phase/bvh.h"
#include "model/system/surfaces.h"

struct cs_representative_triangles {
    const struct cs_surfaces *surfaces; /* borrowed from the system */
    uint32_t n, n_points;
    uint32_t *triangles;            /* (n); CS_NO_TRIANGLE: an edge of a rope */
    uint32_t *bodies;               /* (n) */
    uint32_t *first_edge, *edges;   /* (n + 1), (n_edges): its own, ascending */
    uint32_t *first_point, *points; /* (n + 1), (n_points): its own, ascending */
    struct cs_bvh bvh;              /* over the parts */
};

/* Makes the parts of all bodies and obstacles, as they start, in the system's arena, and its
 * surfaces where they are not there. CS_ERR_MEMORY. */
enum cs_status cs_representative_triangles_build(struct cs_system *system,
                                                 struct cs_representative_triangles *parts,
                                                 struct cs_error *error);

/* Sets where the parts are during the move from x0 to x1 (3,n_points); x1 NULL: they stay at
 * x0. Then cs_bvh_visit over parts->tree has all pairs that may come as near as reach. */
void cs_representative_triangles_update(struct cs_representative_triangles *parts,
                                        const double *x0, const double *x1, double reach);

/* Particles of edge e, and of triangle t. */
static inline const uint32_t *cs_edge_vertices(const struct cs_representative_triangles *parts,
                                               uint32_t e) {
    return parts->surfaces->edges + 2 * (size_t)e;
}
static inline const uint32_t *
cs_triangle_vertices(const struct cs_representative_triangles *parts, uint32_t t) {
    return parts->surfaces->triangles + 3 * (size_t)t;
}

#endif

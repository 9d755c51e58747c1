/* representative_triangles.h - the surfaces of a system as parts (triangles, and edges of
 * ropes) that own their edges and points, so that each pair of primitives is tested once.
 *
 * An edge or a point belongs to several triangles. Each is owned by one, the representative
 * triangle (Curtis et al. 2008): an edge by its first triangle, a point by the first part that
 * has it. A pair of an edge and a triangle, of two edges, or of a point and a triangle then
 * belongs to exactly one pair of parts: that of the owners, or of the owner and the triangle.
 * If two primitives meet, so do the boxes of their owners, because a part contains what it
 * owns. One tree over the parts thus finds all kinds of pairs. */
#ifndef CS_REPRESENTATIVE_TRIANGLES_H
#define CS_REPRESENTATIVE_TRIANGLES_H

#include "model/contact/broad_phase/bvh.h"
#include "model/system/surfaces.h"

/* Parts of all surfaces, numbered body by body, triangles before edges of ropes. */
struct cs_representative_triangles {
    const struct cs_surfaces *surfaces; /* borrowed from the system */
    uint32_t n, n_points;
    /* (n) triangle of a part; CS_NO_TRIANGLE: it is an edge of a rope */
    uint32_t *triangles;
    /* (n) body of a part */
    uint32_t *bodies;
    /* (n + 1), (n_edges): part k owns edges[first_edge[k]] to edges[first_edge[k + 1] - 1] */
    uint32_t *first_edge, *edges;
    /* (n + 1), (n_points): likewise its points */
    uint32_t *first_point, *points;
    struct cs_bvh bvh; /* over the parts */
};

/* Builds the parts of all bodies and colliders as they start, and the surfaces if they are
 * missing, in the system's arena. CS_ERR_MEMORY. */
enum cs_status cs_representative_triangles_build(struct cs_system *system,
                                                 struct cs_representative_triangles *parts,
                                                 struct cs_error *error);

/* Sets the swept boxes of the parts for the move from x0 to x1 (3,n_points) and updates the
 * tree with `reach` in m; x1 NULL: no motion. cs_bvh_visit over parts->bvh then has all pairs.
 */
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

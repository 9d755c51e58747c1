/* surfaces.h - triangles and unique edges of all bodies, and of colliders that are meshes.
 *
 * Grids and meshes alike, in the order of the bodies, colliders last. Points of colliders are
 * numbered after the particles. An edge shared by two triangles is there once. A row of
 * particles has edges alone, a single particle nothing. Inner springs of a network are no
 * edges. */
#ifndef CS_SURFACES_H
#define CS_SURFACES_H

#include "model/system/system.h"

/* Marks a missing triangle at a border edge. */
#define CS_NO_TRIANGLE UINT32_MAX

/* The surfaces of a system, built once. Bodies here are the surfaces of scene/body_pairs.h:
 * bodies and then colliders. Points below view.n are the system's particles. The system's arena
 * owns the arrays. */
struct cs_surfaces {
    uint32_t n_bodies, n_points, n_triangles, n_edges;
    uint32_t *triangles; /* (n_triangles, 3) as cs_face_corners turns them */
    uint32_t *edges;     /* (n_edges, 2) first < second, ascending within a body */
    uint32_t *
        edge_triangles; /* (n_edges, 2) triangles at an edge, ascending; CS_NO_TRIANGLE: none */
    uint32_t *first_point, *first_triangle, *first_edge; /* (n_bodies + 1) of each body */
};

/* Builds system->surfaces; does nothing if it exists. Returns CS_ERR_MEMORY if out of memory.
 */
enum cs_status cs_surfaces_build(struct cs_system *system, struct cs_error *error);

/* Appends "particle 312 (body 0, column 24, row 4)", or "vertex 5 of colliders[1]". */
void cs_surfaces_print_point(const struct cs_system *system, uint32_t point,
                             struct cs_text *out);

/* Returns the body of a point, triangle or edge: binary search in first_point, first_triangle
 * or first_edge. */
static inline uint32_t cs_surfaces_body(const uint32_t *first, uint32_t n_bodies,
                                        uint32_t item) {
    uint32_t low = 0;
    for (uint32_t high = n_bodies; high - low > 1;) {
        const uint32_t middle = low + (high - low) / 2;
        if (first[middle] <= item)
            low = middle;
        else
            high = middle;
    }
    return low;
}

#endif

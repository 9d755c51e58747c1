/* surfaces.h - triangles and unique edges of all bodies, and of colliders that are meshes.
 *
 * Grids and meshes alike, in the order of the bodies, colliders last. Points of colliders are
 * numbered after the particles. An edge shared by two triangles is there once. A row of
 * particles has edges alone, a single particle nothing. Inner springs of a network are no
 * edges. */
#ifndef CS_SURFACES_H
#define CS_SURFACES_H

#include "mesh/trimesh.h"
#include "model/system/particle_system.h"

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

/* Finds the edge between two points, which must exist, among the sorted edges [first, end). */
uint32_t cs_edge_find(const uint32_t *edges, uint32_t first, uint32_t end, uint32_t a,
                      uint32_t b);

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

/* Triangles of a body, for grids and meshes alike. */

/* Number of triangles. A grid has two per cell; a single row or column of particles has none.
 */
static inline uint32_t cs_faces_count(const struct cs_body_range *body) {
    if (body->mesh)
        return body->mesh->n_triangles;
    return body->columns > 1 && body->rows > 1 ? 2 * (body->columns - 1) * (body->rows - 1) : 0;
}

/* Vertices of triangle t as particles of the body, from 0: counter-clockwise seen from +z for a
 * hanging cloth, from outside for a mesh. A cell's two triangles share the diagonal from top
 * right to bottom left. */
static inline void cs_face_corners(const struct cs_body_range *body, uint32_t t,
                                   uint32_t corners[3]) {
    if (body->mesh) {
        for (size_t k = 0; k < 3; k++)
            corners[k] = body->mesh->triangles[3 * (size_t)t + k];
        return;
    }
    const uint32_t cell = t / 2, wide = body->columns - 1;
    const uint32_t top = cell / wide * body->columns + cell % wide, below = top + body->columns;
    corners[0] = top + t % 2;
    corners[1] = below;
    corners[2] = t % 2 ? below + 1 : top + 1;
}

#endif

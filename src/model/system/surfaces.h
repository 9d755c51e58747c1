/* surfaces.h - what all bodies of a system are made of outside: triangles and edges.
 *
 * Grids and meshes alike, in the order of the bodies; what a grid's cells share is there once.
 * A row of particles has edges alone, a single particle nothing. Inner springs of a network are
 * no edges.
 */
#ifndef CS_SURFACES_H
#define CS_SURFACES_H

#include "model/system/system.h"

#define CS_NO_TRIANGLE UINT32_MAX

/* Numbers of particles are those of the system. */
struct cs_surfaces {
    uint32_t n_bodies, n_triangles, n_edges;
    uint32_t *triangles; /* (n_triangles, 3) as cs_face_corners turns them */
    uint32_t *edges;     /* (n_edges, 2) first < second, ascending within a body */
    uint32_t *owners; /* (n_edges, 2) triangles at an edge, ascending; CS_NO_TRIANGLE: none */
    uint32_t *first_triangle, *first_edge; /* (n_bodies + 1) of each body */
};

/* Takes and fills system->surfaces; does nothing where it is there. CS_ERR_MEMORY. */
enum cs_status cs_surfaces_build(struct cs_system *system, struct cs_error *error);

/* Triangles and edges of a body of a scene. */
void cs_surfaces_count(const struct cs_body *body, size_t *n_triangles, size_t *n_edges);

/* Bytes that it takes, for a plan; triangles and edges as a scene's bodies have them. */
size_t cs_surfaces_bytes(const struct cs_scene *scene);

/* The body of a particle, triangle or edge: `first` is bodies' first particles, first_triangle
 * or first_edge, with one more at the end. */
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

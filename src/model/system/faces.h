/* faces.h - triangles of a body, for grids and meshes alike. */
#ifndef CS_FACES_H
#define CS_FACES_H

#include "mesh/trimesh.h"
#include "model/system/system.h"

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

/* mesh.h - a body's particles as vertices and triangles; independent of the renderer. */
#ifndef CS_DRAW_MESH_H
#define CS_DRAW_MESH_H

#include "base/arena.h"
#include "draw/render.h"

/* A vertex: position in m, unit normal, value of the look (0..1, or slope of a fold). */
struct cs_vertex {
    float position[3], normal[3], value;
};

/* The drawn mesh of a body. A grid has two triangles per cell, counter-clockwise seen from +z
 * for a hanging cloth; a mesh has its own. Normally there is one vertex per particle, shared by
 * its triangles. Split: three vertices per triangle, for one normal per triangle (flat),
 * normals that end at the edges of a box (creased), texture coordinates of corners, or marks of
 * triangles. */
struct cs_mesh {
    struct cs_body_range range; /* particles of the body, copied */
    bool flat_shading, has_creases, split_vertices;
    uint32_t first_triangle;     /* of the body among the system's */
    const struct cs_list *faces; /* of its material, if they are drawn; else NULL */
    bool has_curvature;          /* values are slopes of folds (cs_mesh_update) */
    double curvature_radius;     /* m: radius around a vertex in which folds take light away */
    uint32_t n_vertices, n_indices;
    struct cs_vertex *vertices; /* (n_vertices), owned by the arena like the others */
    uint32_t *indices;          /* (n_indices) particles of the body, three per triangle */
    double *normals;            /* (count, 3) sums; creased: (n_indices, 3) */
    double *neighbour_sums; /* (count, 4) sums of vectors to neighbours and of their squares */
    double *face_normals;   /* (triangles, 3) as long as twice the area; NULL unless creased */
    uint8_t *box_faces;     /* (triangles) 0..5, side of the box; NULL likewise */
};

/* Makes the mesh of a body for its material and the scene's look; memory from the arena.
 * textured: texture coordinates will be needed. CS_ERR_MEMORY. */
enum cs_status cs_mesh_init(struct cs_mesh *mesh, const struct cs_system *system, uint32_t body,
                            bool textured, struct cs_arena *arena, struct cs_error *error);

/* Fills the vertices from a frame of n particles. The value is one of:
 *   - the frame's value, scaled to 0..1 over its range; marks of triangles: 0 or 1;
 *   - with has_curvature, the slope of the walls of a groove as curved as the surface, at the
 *     radius: above 0 if the front is the inside. Ambient light in such a groove's middle is
 *     1 / sqrt(1 + value^2), its view factor to the sky between straight walls.
 * A smooth normal is the sum of the normals of its triangles, weighted by area; on a box only
 * of those on the same side. Positions that are not finite, or far off after a blow-up, are
 * drawn at a bound. */
void cs_mesh_update(struct cs_mesh *mesh, uint32_t n, const struct cs_frame *frame);

/* Fills texture coordinates (n_vertices, 2). On a grid they run from 0 at the top left to
 * `repeat`. A mesh has its own times `repeat`, or else those of a picture projected onto its
 * front (+z). */
void cs_mesh_uv(const struct cs_mesh *mesh, const double repeat[2], float *uv);

/* Gives position i of x (3,n) as it is drawn: finite, and within 10^5 m. */
void cs_mesh_position(uint32_t n, const double *x, uint32_t i, double place[3]);

#endif

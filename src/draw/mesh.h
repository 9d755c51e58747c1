/* mesh.h - a grid of particles as vertices and triangles. No OpenGL here. */
#ifndef CS_DRAW_MESH_H
#define CS_DRAW_MESH_H

#include "base/arena.h"
#include "model/system.h"

#include <stdbool.h>

struct cs_vertex {
    float place[3], normal[3], value;
};

/* Two triangles a cell, counter-clockwise seen from +z for a hanging cloth. With smooth normals
 * a vertex a particle and shared by its triangles; flat: three vertices a triangle of their
 * own. */
struct cs_mesh {
    struct cs_body_range range;
    bool flat;
    uint32_t n_vertices, n_indices;
    struct cs_vertex *vertices; /* (n_vertices), owned by the arena like the others */
    uint32_t *indices;          /* (n_indices) particles of the body, three a triangle */
    double *normals;            /* (count, 3) work */
};

enum cs_status cs_mesh_init(struct cs_mesh *mesh, const struct cs_body_range *range, bool flat,
                            struct cs_arena *arena, struct cs_error *error);

/* Fills the vertices from x (3,n); values (n) or NULL become 0..1 between the ends of range.
 * A smooth normal is the sum of the normals of its triangles, each as long as the triangle is
 * large. Positions that are not finite, or far off after a blow-up, are drawn at a bound. */
void cs_mesh_update(struct cs_mesh *mesh, uint32_t n, const double *x, const double *values,
                    const double range[2]);

/* Texture coordinates (n_vertices, 2) from 0 at the top left to `repeat`. */
void cs_mesh_uv(const struct cs_mesh *mesh, const double repeat[2], float *uv);

/* Position i of x (3,n) as it is drawn. */
void cs_mesh_place(uint32_t n, const double *x, uint32_t i, double place[3]);

#endif

/* mesh.h - a body's particles as vertices and triangles. No OpenGL here. */
#ifndef CS_DRAW_MESH_H
#define CS_DRAW_MESH_H

#include "base/arena.h"
#include "draw/render.h"

#include <stdbool.h>

struct cs_vertex {
    float position[3], normal[3], value;
};

/* A grid has two triangles a cell, counter-clockwise seen from +z for a hanging cloth; a mesh
 * has its own. A vertex a particle, shared by its triangles; split: three vertices a triangle
 * of their own, for one normal a triangle (flat), normals that end at the edges of a box
 * (creased), texture coordinates of corners, or marks of triangles. */
struct cs_mesh {
    struct cs_body_range range;
    bool flat_shading, has_creases, split_vertices;
    uint32_t first_triangle; /* of the body among the system's */
    bool has_curvature;      /* values of vertices tell how deep in a fold they lie */
    double curvature_radius; /* m: how far around a vertex folds take light away */
    uint32_t n_vertices, n_indices;
    struct cs_vertex *vertices; /* (n_vertices), owned by the arena like the others */
    uint32_t *indices;          /* (n_indices) particles of the body, three a triangle */
    double *normals;            /* (count, 3) work; creased: (n_indices, 3) */
    double *neighbour_sums;     /* (count, 4) work: ways to neighbours, and their squares */
    double *face_normals;       /* (triangles, 3) normals, work; NULL unless creased */
    uint8_t *box_faces;         /* (triangles) of the box; NULL likewise */
};

/* Of a body, as its material and the scene's look have it. textured: texture coordinates will
 * be asked for. */
enum cs_status cs_mesh_init(struct cs_mesh *mesh, const struct cs_system *system, uint32_t body,
                            bool textured, struct cs_arena *arena, struct cs_error *error);

/* Fills the vertices from a frame of n particles; its values become 0..1 between the ends of
 * their range, or the marks of triangles 0 and 1. Where folds are wanted the value is the slope
 * of the walls of a groove as curved as the surface, at its reach: above 0 where the front is
 * the inside. Of the ambient light 1 / sqrt(1 + value^2) comes to the middle of such a groove,
 * its view factor to the sky between straight walls.
 * A smooth normal is the sum of the normals of its triangles, each as long as the triangle is
 * large; on a box of those on the same side of it. Positions that are not finite, or far off
 * after a blow-up, are drawn at a bound. */
void cs_mesh_update(struct cs_mesh *mesh, uint32_t n, const struct cs_frame *frame);

/* Texture coordinates (n_vertices, 2): of a grid from 0 at the top left to `repeat`; of a mesh
 * its own times `repeat`, or where it has none, as if the picture lay on its front (+z). */
void cs_mesh_uv(const struct cs_mesh *mesh, const double repeat[2], float *uv);

/* Position i of x (3,n) as it is drawn. */
void cs_mesh_position(uint32_t n, const double *x, uint32_t i, double place[3]);

#endif

/* collider_mesh.h - the colliders of a scene as triangles; independent of the renderer. */
#ifndef CS_DRAW_COLLIDER_MESH_H
#define CS_DRAW_COLLIDER_MESH_H

#include "draw/ground.h"
#include "draw/mesh.h"
#include "model/contact/posed_collider.h"

/* One collider as it is drawn. */
struct cs_solid {
    struct cs_posed_collider collider; /* pose of the last frame */
    struct cs_trimesh mesh;            /* in its own frame; of shapes without a core */
    double *normals; /* (n_triangles, 3, 3) of the corners; NULL: flat triangles */
    uint32_t n;      /* vertices, three per triangle, none shared; 0: not visible */
};

/* All colliders of a scene. */
struct cs_collider_geometry {
    uint32_t n; /* colliders of the scene, and the ground behind them if it is drawn */
    const struct cs_ground *ground; /* borrowed */
    double cell;                    /* m: largest cell of the cloth that lies on them */
    struct cs_solid *of;            /* (n), owned by the arena */
    struct cs_vertex *vertices;     /* output of cs_solids_fill, room for the largest of them */
};

/* Allocates for the colliders at the start (scene->colliders.n) and a ground. CS_ERR_MEMORY.
 */
enum cs_status cs_collider_geometry_init(struct cs_collider_geometry *geometries,
                                         const struct cs_system *system,
                                         const struct cs_posed_collider *colliders,
                                         const struct cs_ground *ground, struct cs_arena *arena,
                                         struct cs_error *error);

/* Takes poses of all colliders and the ground; returns true if any has moved. */
bool cs_collider_geometry_move(struct cs_collider_geometry *geometries,
                               const struct cs_posed_collider *now);

/* Fills the style of a collider or the ground. */
void cs_collider_geometry_style(const struct cs_collider_geometry *geometries, uint32_t i,
                                struct cs_surface_style *style);

/* Fills `vertices` with a visible collider in world coordinates, counter-clockwise seen from
 * outside. The square of a plane lies a little below its position, or it would show through
 * cloth on it. A sphere is filled as far as it is visible from eye (collider_mesh.h). */
void cs_solids_fill(const struct cs_collider_geometry *geometries, uint32_t i,
                    const float eye[4]);

/* The visible side of a sphere as triangles, computed without sines. */
enum {
    CS_SPHERE_CAP_STACKS = 16,  /* rings from the middle to the outline */
    CS_SPHERE_CAP_SECTORS = 64, /* corners of the inner rings */
    CS_SPHERE_CAP_OUTLINE =
        256, /* corners of the outline: chords lie 0.008 % of the radius inside */
    // a fan in the middle, strips, and one between a ring and the finer outline
    CS_SPHERE_CAP_VERTICES =
        3 * CS_SPHERE_CAP_SECTORS *
        (1 + 2 * (CS_SPHERE_CAP_STACKS - 2) + CS_SPHERE_CAP_OUTLINE / CS_SPHERE_CAP_SECTORS + 1)
};

#endif

/* collider_mesh.h - the colliders of a scene as triangles, where they are. No OpenGL here. */
#ifndef CS_DRAW_COLLIDER_MESH_H
#define CS_DRAW_COLLIDER_MESH_H

#include "draw/mesh.h"
#include "model/contact/posed_collider.h"

/* One collider as it is drawn. */
struct cs_solid {
    struct cs_posed_collider at;
    struct cs_trimesh mesh; /* of shapes that are drawn by their triangles */
    uint32_t n;             /* vertices, three a triangle, none shared; 0: it is not visible */
};

struct cs_collider_geometry {
    uint32_t n;                 /* colliders of the scene */
    double cell;                /* m: how coarse the cloth is that lies on them */
    struct cs_solid *of;        /* (n), the arena's */
    struct cs_vertex *vertices; /* work: room for the largest of them */
};

/* obstacles (scene->colliders.n): at the start. CS_ERR_MEMORY. */
enum cs_status cs_collider_geometry_init(struct cs_collider_geometry *solids,
                                         const struct cs_system *system,
                                         const struct cs_posed_collider *colliders,
                                         struct cs_arena *arena, struct cs_error *error);

/* Takes where a collider is now; true if it has moved. */
bool cs_solid_move(struct cs_solid *solid, const struct cs_posed_collider *now);

/* Fills the work with the vertices of a visible collider, in the world's coordinates,
 * counter-clockwise seen from outside. The square of a plane lies a little below its place, or
 * it would show through cloth on it. Of a sphere they cover what is seen from eye
 * (sphere_cap.h). */
void cs_solids_fill(const struct cs_collider_geometry *solids, uint32_t i, const float eye[4]);

#endif

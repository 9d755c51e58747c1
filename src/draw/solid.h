/* solid.h - the colliders of a scene as triangles, where they are. No OpenGL here. */
#ifndef CS_DRAW_SOLID_H
#define CS_DRAW_SOLID_H

#include "draw/mesh.h"
#include "model/contact/obstacle.h"

/* One collider as it is drawn. */
struct cs_solid {
    struct cs_obstacle at;
    struct cs_trimesh mesh; /* of shapes that are drawn by their triangles */
    uint32_t n;             /* vertices, three a triangle, none shared; 0: it is not visible */
};

struct cs_solids {
    uint32_t n;                 /* colliders of the scene */
    double cell;                /* m: how coarse the cloth is that lies on them */
    struct cs_solid *of;        /* (n), the arena's */
    struct cs_vertex *vertices; /* work: room for the largest of them */
};

/* obstacles (scene->colliders.n): at the start. CS_ERR_MEMORY. */
enum cs_status cs_solids_init(struct cs_solids *solids, const struct cs_system *system,
                              const struct cs_obstacle *obstacles, struct cs_arena *arena,
                              struct cs_error *error);

/* Takes where a collider is now; true if it has moved. */
bool cs_solid_move(struct cs_solid *solid, const struct cs_obstacle *now);

/* Fills the work with the vertices of a visible collider, in the world's coordinates,
 * counter-clockwise seen from outside. The square of a plane lies a little below its place, or
 * it would show through cloth on it. Of a sphere they cover what is seen from eye (ball.h). */
void cs_solids_fill(const struct cs_solids *solids, uint32_t i, const float eye[4]);

#endif

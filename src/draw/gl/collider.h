/* collider.h - colliders drawn through OpenGL. */
#ifndef CS_DRAW_COLLIDER_H
#define CS_DRAW_COLLIDER_H

#include "draw/collider_mesh.h"
#include "draw/gl/surface.h"
#include "draw/view.h"

/* Geometry and buffers of all colliders. */
struct cs_gl_colliders {
    struct cs_collider_geometry solids;
    struct cs_surface *surfaces; /* (n) as seen from the camera */
    struct cs_surface *shadows;  /* (n) as seen from the light */
    const struct cs_view_block *view;
};

/* Makes the buffers from the colliders' poses at the start (scene->colliders.n). view is
 * borrowed, for camera and light. CS_ERR_MEMORY. */
enum cs_status cs_gl_colliders_init(struct cs_gl_colliders *colliders,
                                    const struct cs_system *system,
                                    const struct cs_view_block *view,
                                    const struct cs_posed_collider *obstacles,
                                    struct cs_arena *arena, struct cs_error *error);

/* Uploads those that have moved; seen_anew: the camera has moved, and all are uploaded. */
void cs_gl_colliders_move(struct cs_gl_colliders *colliders,
                          const struct cs_posed_collider *obstacles, bool seen_anew);

/* Draws the visible ones with the given program. */
void cs_gl_colliders_draw(const struct cs_gl_colliders *colliders,
                          const struct cs_surface_program *program);
/* Draws all but planes into the shadow map, whose program is in use. */
void cs_gl_colliders_draw_shadow(const struct cs_gl_colliders *colliders);

#endif

/* collider.h - colliders as they are drawn. */
#ifndef CS_DRAW_COLLIDER_H
#define CS_DRAW_COLLIDER_H

#include "draw/collider_mesh.h"
#include "draw/gl/surface.h"
#include "draw/view.h"

struct cs_gl_colliders {
    struct cs_collider_geometry solids;
    struct cs_surface *surfaces; /* (n) as the camera sees them */
    struct cs_surface *shadows;  /* (n) as the light does */
    const struct cs_view_block *view;
};

/* obstacles (scene->colliders.n): where they are at the start; view is borrowed, for camera and
 * light */
enum cs_status cs_gl_colliders_init(struct cs_gl_colliders *colliders,
                                    const struct cs_system *system,
                                    const struct cs_view_block *view,
                                    const struct cs_posed_collider *obstacles,
                                    struct cs_arena *arena, struct cs_error *error);

/* Puts those that are elsewhere now where they are; seen_anew: the camera has moved. */
void cs_gl_colliders_move(struct cs_gl_colliders *colliders,
                          const struct cs_posed_collider *obstacles, bool seen_anew);

void cs_gl_colliders_draw(const struct cs_gl_colliders *colliders,
                          const struct cs_surface_program *program);
/* All but planes, with another program in use. */
void cs_gl_colliders_draw_shadow(const struct cs_gl_colliders *colliders);

#endif

/* collider.h - spheres, planes and floors as they are drawn. */
#ifndef CS_DRAW_COLLIDER_H
#define CS_DRAW_COLLIDER_H

#include "draw/gl/surface.h"
#include "model/system/system.h"

struct cs_obstacles {
    const struct cs_scene *scene;
    struct cs_surface ball;
    struct cs_surface *squares; /* (scene->colliders.n); those of spheres stay empty */
    double cell;                /* m: how coarse the cloth is that lies on them */
};

enum cs_status cs_obstacles_init(struct cs_obstacles *obstacles, const struct cs_system *system,
                                 struct cs_arena *arena, struct cs_error *error);
void cs_obstacles_draw(const struct cs_obstacles *obstacles,
                       const struct cs_surface_program *program);
/* Only the spheres, with another program in use whose uniform `model` is given. */
void cs_obstacles_draw_shadow(const struct cs_obstacles *obstacles, int model);

#endif

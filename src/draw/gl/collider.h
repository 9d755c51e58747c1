/* collider.h - colliders as they are drawn. */
#ifndef CS_DRAW_COLLIDER_H
#define CS_DRAW_COLLIDER_H

#include "draw/gl/surface.h"
#include "model/contact/obstacle.h"

struct cs_gl_colliders {
    uint32_t n;
    struct cs_obstacle *obstacles; /* (n) where they are now */
    struct cs_surface ball;        /* of spheres */
    struct cs_surface *surfaces;   /* (n) of the others */
    struct cs_vertex *vertices;    /* work: room for the largest of them */
    double cell;                   /* m: how coarse the cloth is that lies on them */
};

/* obstacles (scene->colliders.n): where they are at the start */
enum cs_status cs_gl_colliders_init(struct cs_gl_colliders *colliders,
                                    const struct cs_system *system,
                                    const struct cs_obstacle *obstacles, struct cs_arena *arena,
                                    struct cs_error *error);

/* Puts those that are elsewhere now where they are. */
void cs_gl_colliders_move(struct cs_gl_colliders *colliders,
                          const struct cs_obstacle *obstacles);

void cs_gl_colliders_draw(const struct cs_gl_colliders *colliders,
                          const struct cs_surface_program *program);
/* All but planes, with another program in use whose uniform `model` is given. */
void cs_gl_colliders_draw_shadow(const struct cs_gl_colliders *colliders, int model);

#endif

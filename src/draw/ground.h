/* ground.h - the ground below a scene: shadows that lie on it, and perhaps a grid. */
#ifndef CS_DRAW_GROUND_H
#define CS_DRAW_GROUND_H

#include "draw/view.h"
#include "model/contact/posed_collider.h"
#include "model/system/particle_system.h"

/* The ground of a scene; zeroed: none. */
struct cs_ground {
    bool present;
    bool follows_lowest; /* it moves below anything lower */
    double height;       /* m, without anything lower */
    float fade_disc[4];  /* centre x, height, centre z, radius in m where it has faded out */
    float box[4]; /* m: min x and z, max x and z of the visible part; max <= min: nothing in
                     this frame */
    float line_spacing;   /* m between lines; every tenth one is stronger; 0: none */
    float line_colour[3]; /* linear RGB */
    float shadow;         /* 0..1: opacity of a shadow */
};

/* Makes the ground that the scene wants: lines spaced by a power of ten of 1 m that fits its
 * extent, or shadows alone. colliders (scene->colliders.n) at the start. */
void cs_ground_make(struct cs_ground *ground, const struct cs_system *system,
                    const struct cs_posed_collider *colliders,
                    const struct cs_bounding_sphere *extent);

/* Places the ground below everything in a frame, and bounds its visible part: lines, or the
 * shadows of `solid`. */
void cs_ground_aim(struct cs_ground *ground, const struct cs_view_block *block,
                   const struct cs_bounding_sphere *solid);

#endif

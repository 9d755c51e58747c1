/* ground.h - the ground below a scene: shadows that lie on it, and perhaps a grid. */
#ifndef CS_DRAW_GROUND_H
#define CS_DRAW_GROUND_H

#include "draw/view.h"
#include "model/contact/posed_collider.h"
#include "model/system/system.h"

struct cs_ground {
    bool present;
    bool follows_lowest; /* it gives way where something is lower */
    double height;       /* m, where nothing is */
    float fade_disc[4];  /* centre x, height, centre z, half side in m, where it has melted */
    float box[4]; /* m: least x and z, greatest x and z of what may show; greatest <= least:
                     nothing in this frame */
    float line_spacing;   /* m between lines; every tenth one is stronger; 0: none */
    float line_colour[3]; /* linear RGB */
    float shadow;         /* 0..1: how dark a shadow is inked */
};

/* As the scene asks for it: lines with a distance of 1 m times a power of ten, fit for its
 * extent, or shadows alone. obstacles (scene->colliders.n) at the start. */
void cs_ground_make(struct cs_ground *ground, const struct cs_system *system,
                    const struct cs_posed_collider *colliders,
                    const struct cs_bounding_sphere *extent);

/* Puts it below all that a frame holds, and bounds what of it shows: lines, or where shadows
 * of `solid` can lie. */
void cs_ground_aim(struct cs_ground *ground, const struct cs_view_block *block,
                   const struct cs_bounding_sphere *solid);

#endif

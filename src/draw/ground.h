/* ground.h - the grid on the ground: its place, pitch and ink. */
#ifndef CS_DRAW_GROUND_H
#define CS_DRAW_GROUND_H

#include "draw/view.h"

struct cs_ground {
    float span[4]; /* centre x, height, centre z, half side in m */
    float pitch;   /* m between lines; every tenth one is stronger */
    float ink[3];  /* linear RGB */
    float shadow;  /* 0..1: how dark a shadow is inked */
};

/* Lines with a distance of 1 m times a power of ten, fit for a scene of this extent. */
void cs_ground_make(struct cs_ground *ground, const struct cs_scene *scene,
                    const struct cs_ball *extent);

#endif

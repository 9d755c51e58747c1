/* sky_and_ground.h - what stands behind everything: the sky, and the grid on the ground. */
#ifndef CS_GL_SKY_AND_GROUND_H
#define CS_GL_SKY_AND_GROUND_H

#include "draw/ground.h"

struct cs_sky_and_ground {
    unsigned object, sky, program;
    int fade_disc, box; /* uniforms of the ground's program */
    struct cs_ground ground;
};

/* As the scene of a ground has it (cs_ground_make). */
enum cs_status cs_sky_and_ground_init(struct cs_sky_and_ground *backdrop,
                                      const struct cs_ground *ground, struct cs_error *error);
/* Covers every pixel; depth is left alone. */
void cs_sky_and_ground_draw_sky(const struct cs_sky_and_ground *backdrop);
/* Where it has been aimed at (cs_ground_aim). */
void cs_sky_and_ground_draw_ground(const struct cs_sky_and_ground *backdrop);

#endif

/* sky_and_ground.h - background through OpenGL: the sky, and the ground with its grid. */
#ifndef CS_GL_SKY_AND_GROUND_H
#define CS_GL_SKY_AND_GROUND_H

#include "draw/ground.h"

/* OpenGL names and uniform locations. */
struct cs_sky_and_ground {
    unsigned object, sky, program;
    int fade_disc, box; /* uniforms of the ground's program */
    struct cs_ground ground;
};

/* Builds the programs for a ground (cs_ground_make), which is copied. CS_ERR_MODULE. */
enum cs_status cs_sky_and_ground_init(struct cs_sky_and_ground *backdrop,
                                      const struct cs_ground *ground, struct cs_error *error);
/* Draws the sky over every pixel; leaves the depth alone. */
void cs_sky_and_ground_draw_sky(const struct cs_sky_and_ground *backdrop);
/* Draws the ground in its rectangle of this frame (cs_ground_aim). */
void cs_sky_and_ground_draw_ground(const struct cs_sky_and_ground *backdrop);

#endif

/* backdrop.h - what stands behind everything: the sky, and the grid on the ground. */
#ifndef CS_DRAW_BACKDROP_H
#define CS_DRAW_BACKDROP_H

#include "draw/ground.h"

struct cs_backdrop {
    unsigned object, sky, program;
    int span, box; /* uniforms of the ground's program */
    struct cs_ground ground;
};

/* As the scene of a ground has it (cs_ground_make). */
enum cs_status cs_backdrop_init(struct cs_backdrop *backdrop, const struct cs_ground *ground,
                                struct cs_error *error);
/* Covers every pixel; depth is left alone. */
void cs_backdrop_draw_sky(const struct cs_backdrop *backdrop);
/* Where it has been aimed at (cs_ground_aim). */
void cs_backdrop_draw_ground(const struct cs_backdrop *backdrop);

#endif

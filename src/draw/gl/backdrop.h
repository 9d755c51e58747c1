/* backdrop.h - what stands behind everything: the sky, and the grid on the ground. */
#ifndef CS_DRAW_BACKDROP_H
#define CS_DRAW_BACKDROP_H

#include "draw/view.h"

struct cs_backdrop {
    unsigned object, sky, ground;
};

enum cs_status cs_backdrop_init(struct cs_backdrop *backdrop, const struct cs_scene *scene,
                                const struct cs_ball *extent, struct cs_error *error);
/* Covers every pixel; depth is left alone. */
void cs_backdrop_draw_sky(const struct cs_backdrop *backdrop);
/* Lines with a distance of 1 m times a power of ten, every tenth one stronger. */
void cs_backdrop_draw_ground(const struct cs_backdrop *backdrop);

#endif

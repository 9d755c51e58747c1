/* target.h - the frame buffer that is drawn into, and how its pixels come back. */
#ifndef CS_DRAW_TARGET_H
#define CS_DRAW_TARGET_H

#include "base/arena.h"
#include "base/image.h"

struct cs_target {
    unsigned many,
        single; /* frame buffers: multisampled, and the one to read; may be the same */
    int width, height;
    uint8_t *rgba; /* owned by the arena */
};

enum cs_status cs_target_init(struct cs_target *target, int width, int height, int samples,
                              struct cs_arena *arena, struct cs_error *error);
void cs_target_begin(const struct cs_target *target);

/* Averages the samples and copies the picture, top row first. */
void cs_target_read(const struct cs_target *target, struct cs_image *image);

#endif

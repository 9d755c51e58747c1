/* framebuffer.h - the frame buffer that is drawn into, and how its pixels come back. */
#ifndef CS_GL_FRAMEBUFFER_H
#define CS_GL_FRAMEBUFFER_H

#include "base/arena.h"
#include "draw/srgb.h"
#include "scene/scene.h"

struct cs_framebuffer {
    unsigned draw_framebuffer,
        read_framebuffer; /* frame buffers; the same where a pixel has one sample */
    int width, height;
    uint32_t n_samples; /* a pixel */
    bool clear;         /* what is behind everything lets light through */
    unsigned samples, program,
        object;                 /* texture of the samples, and what copies one of each pixel */
    int number;                 /* which one: a uniform of the program */
    uint32_t *rgba[4];          /* (height, width) by sample, owned by the arena */
    const struct cs_srgb *srgb; /* owned by the arena */
};

/* As the scene has it. */
enum cs_status cs_framebuffer_init(struct cs_framebuffer *target,
                                   const struct cs_render *render, struct cs_arena *arena,
                                   struct cs_error *error);
void cs_framebuffer_begin(const struct cs_framebuffer *target);

/* Copies the picture, top row first, each pixel the mean of its samples (cs_srgb_mean): drivers
 * take the mean of bytes. */
void cs_framebuffer_read(const struct cs_framebuffer *target, struct cs_image *image);

#endif

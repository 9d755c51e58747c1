/* framebuffer.h - the frame buffer of a picture, and reading its pixels back. */
#ifndef CS_GL_FRAMEBUFFER_H
#define CS_GL_FRAMEBUFFER_H

#include "base/arena.h"
#include "draw/srgb.h"
#include "scene/scene.h"

/* OpenGL names and copies of the samples. */
struct cs_framebuffer {
    unsigned draw_framebuffer,
        read_framebuffer; /* frame buffers; the same where a pixel has one sample */
    int width, height;
    uint32_t n_samples; /* per pixel: 1 or 4 */
    bool clear;         /* transparent background */
    unsigned samples, program,
        object;        /* texture of the samples; the program that copies one of each pixel */
    int number;        /* location of the uniform: which sample */
    uint32_t *rgba[4]; /* (height, width) per sample, bottom row first, of the arena */
    const struct cs_srgb *srgb; /* owned by the arena */
};

/* Makes the buffers of the scene's size and samples. CS_ERR_MODULE if the driver cannot,
 * CS_ERR_MEMORY. */
enum cs_status cs_framebuffer_init(struct cs_framebuffer *target,
                                   const struct cs_render *render, struct cs_arena *arena,
                                   struct cs_error *error);
/* Clears the depth; what is drawn until the next frame buffer goes here. */
void cs_framebuffer_begin(const struct cs_framebuffer *target);

/* Copies the picture, top row first. Each pixel is the mean of its samples in linear light
 * (cs_srgb_mean); the resolve of drivers averages bytes. */
void cs_framebuffer_read(const struct cs_framebuffer *target, struct cs_image *image);

#endif

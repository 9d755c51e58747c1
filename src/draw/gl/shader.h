/* shader.h - GLSL programs: their text, and how they are built. */
#ifndef CS_DRAW_SHADER_H
#define CS_DRAW_SHADER_H

#include "base/status.h"

/* The text of one program; common text (the view block, sRGB, colour map) is put before both.
 */
struct cs_shader_text {
    const char *name, *vertex, *fragment;
};

extern const struct cs_shader_text cs_shader_sky;     /* background with a vertical gradient */
extern const struct cs_shader_text cs_shader_surface; /* cloth and colliders */
extern const struct cs_shader_text cs_shader_shadow;  /* depth seen from the light */
extern const struct cs_shader_text cs_shader_ground;  /* grid of lines on the ground */
extern const struct cs_shader_text cs_shader_line;    /* lines and dots of any width */
extern const struct cs_shader_text cs_shader_bar;     /* rectangle in colours of the map */
extern const struct cs_shader_text cs_shader_sample;  /* one sample of every pixel */

/* Compiles and links. The view block is bound to CS_VIEW_BINDING, the samplers `picture` and
 * `depth` to texture units 0 and 1. On failure CS_ERR_MODULE with the compiler's log in one
 * line. */
enum cs_status cs_shader_make(const struct cs_shader_text *text, unsigned *program,
                              struct cs_error *error);

#endif

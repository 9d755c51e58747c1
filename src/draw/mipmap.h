/* mipmap.h - a texture that repeats over a cloth, with its smaller copies (Williams 1983). */
#ifndef CS_DRAW_MIPMAP_H
#define CS_DRAW_MIPMAP_H

#include "base/arena.h"
#include "base/image.h"
#include "draw/srgb.h"

enum { CS_MIPMAP_LEVELS_MAX = 24 }; /* enough for sides below 2^24 texels */

/* Texels are linear light, not bytes of sRGB: their mean is the colour seen from afar. */
struct cs_mipmap {
    int n; /* levels, each half as wide and high as the one before (rounded down), to 1 x 1 */
    struct {
        int width, height;
        const uint16_t *light; /* (height, width, 3) in 1/65535, owned by the arena */
    } levels[CS_MIPMAP_LEVELS_MAX];
};

/* Makes all levels of an image; memory from the arena. Fails with CS_ERR_MEMORY. */
enum cs_status cs_mipmap_make(struct cs_mipmap *mips, const struct cs_image *image,
                              const struct cs_srgb *srgb, struct cs_arena *arena,
                              struct cs_error *error);

/* Linear colour at (u, v), which repeats with period 1. square: squared distance of
 * neighbouring pixels in texels of level 0. */
void cs_mipmap_sample(const struct cs_mipmap *mips, float u, float v, float square,
                      float rgb[3]);

#endif

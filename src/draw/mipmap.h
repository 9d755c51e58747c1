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

/* The footprint of a pixel on a texture: a row of equal parts along the longer of its two
 * sides, so that a surface seen at a grazing angle blurs only in the direction in which it is
 * shortened (McCormack et al. 1999). */
struct cs_texel_footprint {
    float side[2]; /* the longer side in texture coordinates; 0 of a single part */
    float square;  /* squared width of a part in texels of level 0 */
    int parts;     /* 1 to CS_FOOTPRINT_PARTS_MAX */
};

enum { CS_FOOTPRINT_PARTS_MAX = 8 };

/* Makes the footprint whose sides are the steps to the next pixel in a row and in a column, in
 * texture coordinates. Parts are as wide as the shorter side, or a texel, unless that takes too
 * many of them. */
void cs_texel_footprint_make(const struct cs_mipmap *mips, float steps[2][2],
                             struct cs_texel_footprint *footprint);

/* Mean linear colour of a footprint about (u, v); the texture repeats with period 1. */
void cs_mipmap_sample(const struct cs_mipmap *mips, float u, float v,
                      const struct cs_texel_footprint *footprint, float rgb[3]);

#endif

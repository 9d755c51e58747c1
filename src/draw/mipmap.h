/* mipmap.h - a picture that repeats over a cloth, in ever smaller copies. */
#ifndef CS_DRAW_MIPMAP_H
#define CS_DRAW_MIPMAP_H

#include "base/arena.h"
#include "base/image.h"
#include "draw/srgb.h"

enum { CS_MIPMAP_LEVELS_MAX = 24 };

/* Light, not bytes of sRGB: a mean of it is what is seen from afar. */
struct cs_mipmap {
    int n; /* copies, each half as wide and high as the one before, down to 1 x 1 */
    struct {
        int width, height;
        const uint16_t *light; /* (height, width, 3) of 65535, owned by the arena */
    } levels[CS_MIPMAP_LEVELS_MAX];
};

enum cs_status cs_mipmap_make(struct cs_mipmap *mips, const struct cs_image *image,
                              const struct cs_srgb *tone, struct cs_arena *arena,
                              struct cs_error *error);

/* The linear colour at (u, v) in 0..1 a repeat. square: texels of the first copy from one pixel
 * to the next, squared. */
void cs_mipmap_sample(const struct cs_mipmap *mips, float u, float v, float square,
                      float rgb[3]);

#endif

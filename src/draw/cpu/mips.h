/* mips.h - a picture that repeats over a cloth, in ever smaller copies. */
#ifndef CS_DRAW_MIPS_H
#define CS_DRAW_MIPS_H

#include "base/arena.h"
#include "base/image.h"

enum { CS_MIPS_MOST = 24 };

/* Bytes stay in sRGB and are blended as such, as OpenGL does with a plain texture. */
struct cs_mips {
    int n; /* copies, each half as wide and high as the one before, down to 1 x 1 */
    struct {
        int width, height;
        const uint8_t *rgb; /* owned by the arena */
    } copies[CS_MIPS_MOST];
};

enum cs_status cs_mips_make(struct cs_mips *mips, const struct cs_image *image,
                            struct cs_arena *arena, struct cs_error *error);

/* The colour at (u, v) in 0..1 a repeat, as sRGB in 0..255. square: texels of the first copy
 * from one pixel to the next, squared. */
void cs_mips_look(const struct cs_mips *mips, float u, float v, float square, float rgb[3]);

#endif

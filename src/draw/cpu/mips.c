/* mips.c - trilinear filtering (Williams 1983): two copies, four texels of each. */
#include "draw/cpu/mips.h"

#include <math.h>
#include <string.h>

static int halved(int n) {
    return n > 1 ? n / 2 : 1;
}

// texels i and j = i + 1 at most n - 1, and the share of j, of place i of a copy in the larger
static void source(int i, int small, int large, int at[2], float *share) {
    const float where = ((float)i + 0.5f) * (float)large / (float)small - 0.5f;
    at[0] = where > 0 ? (int)where : 0;
    at[1] = at[0] + 1 < large ? at[0] + 1 : at[0];
    *share = where > 0 ? where - (float)at[0] : 0;
}

static void shrink(const uint8_t *from, int width, int height, uint8_t *to) {
    const int w = halved(width), h = halved(height);
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++) {
            int column[2], row[2];
            float across, down;
            source(x, w, width, column, &across);
            source(y, h, height, row, &down);
            for (int k = 0; k < 3; k++) {
                float line[2];
                for (int r = 0; r < 2; r++) {
                    const uint8_t *in = from + 3 * (size_t)row[r] * (size_t)width + k;
                    const float a = (float)in[3 * column[0]], b = (float)in[3 * column[1]];
                    line[r] = a + across * (b - a);
                }
                *to++ = (uint8_t)(line[0] + down * (line[1] - line[0]) + 0.5f);
            }
        }
}

enum cs_status cs_mips_make(struct cs_mips *mips, const struct cs_image *image,
                            struct cs_arena *arena, struct cs_error *error) {
    int width = (int)image->width, height = (int)image->height;
    for (mips->n = 0; mips->n < CS_MIPS_MOST; mips->n++) {
        uint8_t *rgb = cs_arena_take_n(arena, (size_t)width * (size_t)height, 3, error);
        if (!rgb)
            return error->status;
        const int last = mips->n - 1;
        if (mips->n == 0)
            memcpy(rgb, image->rgb, 3 * (size_t)width * (size_t)height);
        else
            shrink(mips->copies[last].rgb, mips->copies[last].width, mips->copies[last].height,
                   rgb);
        mips->copies[mips->n].width = width;
        mips->copies[mips->n].height = height;
        mips->copies[mips->n].rgb = rgb;
        if (width == 1 && height == 1) {
            mips->n++;
            break;
        }
        width = halved(width);
        height = halved(height);
    }
    return CS_OK;
}

// neighbours of a place in a row of n texels that repeats, and the share of the second
static void wrap(float at, int n, int texels[2], float *share) {
    const float where = (at - floorf(at)) * (float)n - 0.5f;
    const float down = floorf(where);
    const int first = (int)down;
    *share = where - down;
    texels[0] = first < 0 ? n - 1 : first < n ? first : n - 1;
    texels[1] = first + 1 < n ? first + 1 : 0;
}

static void bilinear(const struct cs_mips *mips, int copy, float u, float v, float rgb[3]) {
    const int width = mips->copies[copy].width;
    int column[2], row[2];
    float across, down;
    wrap(u, width, column, &across);
    wrap(v, mips->copies[copy].height, row, &down);
    for (int k = 0; k < 3; k++) {
        float line[2];
        for (int r = 0; r < 2; r++) {
            const uint8_t *in = mips->copies[copy].rgb + 3 * (size_t)row[r] * (size_t)width + k;
            const float a = (float)in[3 * column[0]], b = (float)in[3 * column[1]];
            line[r] = a + across * (b - a);
        }
        rgb[k] = line[0] + down * (line[1] - line[0]);
    }
}

/* Logarithm to base 2 of a positive number, straight between whole ones: at most 0.09 too low,
 * as renderers of OpenGL take it, too little to be seen. */
static float log_2(float value) {
    uint32_t bits;
    float mantissa;
    memcpy(&bits, &value, sizeof bits);
    const int exponent = (int)(bits >> 23 & 255) - 127;
    bits = (bits & 0x7fffff) | 0x3f800000;
    memcpy(&mantissa, &bits, sizeof mantissa);
    return (float)exponent + (mantissa - 1);
}

void cs_mips_look(const struct cs_mips *mips, float u, float v, float square, float rgb[3]) {
    // below 1 texel a pixel the first copy is blown up; NAN and huge numbers come to an end too
    const float level = square > 1 ? 0.5f * log_2(square < 1e30f ? square : 1e30f) : 0;
    const int whole = (int)level;
    float then[3];
    if (whole >= mips->n - 1) {
        bilinear(mips, mips->n - 1, u, v, rgb);
        return;
    }
    bilinear(mips, whole, u, v, rgb);
    if (!(level > (float)whole))
        return;
    bilinear(mips, whole + 1, u, v, then);
    for (int k = 0; k < 3; k++)
        rgb[k] += (level - (float)whole) * (then[k] - rgb[k]);
}

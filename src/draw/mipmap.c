/* mipmap.c - trilinear filtering (Williams 1983): two levels, four texels of each.
 *
 * A part of a pixel that covers rho texels of level 0 in width takes the level log2(rho), where
 * a texel is about as wide as it. It interpolates linearly between the two nearest whole
 * levels. Footprints have rho^2, which needs no root: log2(rho) = log2(rho^2) / 2.
 */
#include "draw/mipmap.h"

#include <clothsim/clones.h>
#include <math.h>
#include <string.h>

// side of the next level, at least 1
static int halved(int n) {
    return n > 1 ? n / 2 : 1;
}

/* Texel i of a row of `small` covers the interval from i large/small to (i + 1) large/small of
 * a row of `large`, at most three times as many. Returns the first texel in it; shares:
 * fraction of the interval in each of four texels from there on. An odd side thus loses no
 * light. */
static int cover(int i, int small, int large, double shares[4]) {
    const double from = (double)i * large / small, to = (double)(i + 1) * large / small;
    const int first = (int)from;
    for (int k = 0; k < 4; k++) {
        const double low = fmax(from, first + k), high = fmin(to, first + k + 1);
        shares[k] = first + k < large && high > low ? (high - low) / (to - from) : 0;
    }
    return first;
}

// the mean of a channel over a rectangle of texels, weighted by area
static uint16_t mean_of(const uint16_t *from, size_t stride, const double across[4],
                        const double down[4]) {
    double sum = 0;
    for (size_t r = 0; r < 4; r++)
        for (size_t c = 0; c < 4; c++)
            if (down[r] > 0 && across[c] > 0)
                sum += down[r] * across[c] * from[r * stride + 3 * c];
    return (uint16_t)(sum + 0.5);
}

// makes one level from the one before
static void shrink(const uint16_t *from, int width, int height, uint16_t *to) {
    const int w = halved(width), h = halved(height);
    const size_t stride = 3 * (size_t)width;
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++) {
            double across[4], down[4];
            const int column = cover(x, w, width, across), row = cover(y, h, height, down);
            for (size_t k = 0; k < 3; k++)
                *to++ = mean_of(from + (size_t)row * stride + 3 * (size_t)column + k, stride,
                                across, down);
        }
}

enum cs_status cs_mipmap_make(struct cs_mipmap *mips, const struct cs_image *image,
                              const struct cs_srgb *srgb, struct cs_arena *arena,
                              struct cs_error *error) {
    int width = (int)image->width, height = (int)image->height;
    for (mips->n = 0; mips->n < CS_MIPMAP_LEVELS_MAX; mips->n++) {
        const size_t n = 3 * (size_t)width * (size_t)height;
        const int last = mips->n - 1;
        // texels are read four numbers at a time
        uint16_t *light = cs_arena_alloc_array(arena, n + 1, sizeof *light, error);
        if (!light)
            return error->status;
        for (size_t i = 0; mips->n == 0 && i < n; i++)
            light[i] = (uint16_t)(srgb->linear[image->rgb[i]] * 65535 + 0.5f);
        if (mips->n > 0)
            shrink(mips->levels[last].light, mips->levels[last].width,
                   mips->levels[last].height, light);
        mips->levels[mips->n].width = width;
        mips->levels[mips->n].height = height;
        mips->levels[mips->n].light = light;
        if (width == 1 && height == 1) {
            mips->n++;
            break;
        }
        width = halved(width);
        height = halved(height);
    }
    return CS_OK;
}

/* red, green and blue of a texel, and a number that nobody reads */
typedef float texel __attribute__((vector_size(16)));
typedef uint16_t light __attribute__((vector_size(8)));

CS_INLINE texel texel_at(const uint16_t *at) {
    light read;
    memcpy(&read, at, sizeof read);
    return __builtin_convertvector(read, texel);
}

/* The two texels of a row of n beside coordinate `at`, and the weight of the second. Texel i
 * has its middle at (i + 1/2) / n; neighbours wrap around. */
CS_INLINE void wrap_texel(float at, int n, int texels[2], float *share) {
    const float where = (at - floorf(at)) * (float)n - 0.5f;
    const float down = floorf(where);
    const int first = (int)down;
    *share = where - down;
    texels[0] = first < 0 ? n - 1 : first < n ? first : n - 1;
    texels[1] = first + 1 < n ? first + 1 : 0;
}

// bilinear interpolation in one level
CS_INLINE texel bilinear(const struct cs_mipmap *mips, int copy, float u, float v) {
    const int width = mips->levels[copy].width;
    int column[2], row[2];
    float across, down;
    wrap_texel(u, width, column, &across);
    wrap_texel(v, mips->levels[copy].height, row, &down);
    texel line[2];
    for (int r = 0; r < 2; r++) {
        const uint16_t *in = mips->levels[copy].light + 3 * (size_t)row[r] * (size_t)width;
        const texel a = texel_at(in + 3 * column[0]), b = texel_at(in + 3 * column[1]);
        line[r] = a + across * (b - a);
    }
    return (line[0] + down * (line[1] - line[0])) / 65535;
}

/* log2 of a positive number 2^e (1 + m), taken as e + m. The error log2(1 + m) - m is largest
 * at m = 1/ln 2 - 1, where it is 0.086: too little to be seen in a level. OpenGL renderers do
 * the same. */
CS_INLINE float log_2(float value) {
    uint32_t bits;
    float mantissa;
    memcpy(&bits, &value, sizeof bits);
    const int exponent = (int)(bits >> 23 & 255) - 127;
    bits = (bits & 0x7fffff) | 0x3f800000;
    memcpy(&mantissa, &bits, sizeof mantissa);
    return (float)exponent + (mantissa - 1);
}

void cs_texel_footprint_make(const struct cs_mipmap *mips, float steps[2][2],
                             struct cs_texel_footprint *footprint) {
    float squares[2];
    for (int i = 0; i < 2; i++) {
        const float du = steps[i][0] * (float)mips->levels[0].width;
        const float dv = steps[i][1] * (float)mips->levels[0].height;
        squares[i] = du * du + dv * dv;
    }
    const int longer = squares[0] > squares[1] ? 0 : 1;
    const float square = squares[longer], other = squares[1 - longer];
    const float least = other > 1 ? other : 1;
    int parts = 1;
    // NaN and huge numbers are one part
    while (parts < CS_FOOTPRINT_PARTS_MAX && square < 1e30f &&
           (float)(parts * parts) * least < square)
        parts++;
    const float part = square / (float)(parts * parts);
    footprint->parts = parts;
    footprint->square = parts > 1 && part < least ? least : part;
    for (int k = 0; k < 2; k++)
        footprint->side[k] = parts > 1 ? steps[longer][k] : 0;
}

/* level: whole ones, and a fraction of the next. */
CS_INLINE texel trilinear(const struct cs_mipmap *mips, float u, float v, float level) {
    const int whole = (int)level;
    if (whole >= mips->n - 1)
        return bilinear(mips, mips->n - 1, u, v);
    const texel near = bilinear(mips, whole, u, v);
    if (!(level > (float)whole))
        return near;
    return near + (level - (float)whole) * (bilinear(mips, whole + 1, u, v) - near);
}

CS_CLONES void cs_mipmap_sample(const struct cs_mipmap *mips, float u, float v,
                                const struct cs_texel_footprint *footprint, float rgb[3]) {
    const float share = 1 / (float)footprint->parts, square = footprint->square;
    // below 1 texel per pixel level 0 is magnified; NaN and huge numbers stay in range
    const float level = square > 1 ? 0.5f * log_2(square < 1e30f ? square : 1e30f) : 0;
    texel sum = {0};
    for (int i = 0; i < footprint->parts; i++) {
        const float at = ((float)i + 0.5f) * share - 0.5f;
        sum += share *
               trilinear(mips, u + at * footprint->side[0], v + at * footprint->side[1], level);
    }
    memcpy(rgb, &sum, 3 * sizeof *rgb);
}

/* srgb.h - linear light to the bytes of sRGB and back (IEC 61966-2-1), without libm. */
#ifndef CS_DRAW_SRGB_H
#define CS_DRAW_SRGB_H

#include "base/image.h"

#include <clothsim/clones.h>
#include <stddef.h>

/* Zero: not made. */
struct cs_srgb {
    uint8_t segment_start[4098]; /* byte at each 1/4096 */
    float threshold[258]; /* linear light from which on a byte holds; past the last one 2 */
    float linear[256];    /* of each byte */
};

void cs_srgb_make(struct cs_srgb *tone);

/* The byte of c in 0..1, rounded exactly: no two thresholds lie within 1/4096. */
CS_INLINE uint32_t cs_srgb_encode(const struct cs_srgb *tone, float c) {
    const uint32_t byte = tone->segment_start[(int)(c * 4096)];
    return byte + (c >= tone->threshold[byte + 1]);
}

CS_INLINE uint32_t cs_srgb_pack(const struct cs_srgb *tone, float red, float green,
                                float blue) {
    return cs_srgb_encode(tone, red) | cs_srgb_encode(tone, green) << 8 |
           cs_srgb_encode(tone, blue) << 16;
}

/* a b / 255 of two bytes, rounded. */
CS_INLINE uint32_t cs_srgb_scale(uint32_t a, uint32_t b) {
    const uint32_t product = a * b;
    return (product + (product >> 8) + 128) >> 8;
}

/* cs_srgb_blend on what does not cover: the rule `over` (Porter and Duff 1984), for colours
 * that are not times how much they cover. */
uint32_t cs_srgb_blend_rows(uint32_t under, uint32_t over, uint32_t share);

/* `over` laid on `under` with a share of 0..255; bytes of red, green, blue from the lowest on,
 * and in `under` how much it lets through. Both parts are rounded, as renderers of bytes do;
 * 255 gives `over`. */
CS_INLINE uint32_t cs_srgb_blend(uint32_t under, uint32_t over, uint32_t share) {
    uint32_t out = 0;
    if (under >> 24)
        return cs_srgb_blend_rows(under, over, share);
    for (int k = 0; k < 24; k += 8) {
        const uint32_t sum = cs_srgb_scale(under >> k & 255, 255 - share) +
                             cs_srgb_scale(over >> k & 255, share);
        out |= (sum < 255 ? sum : 255) << k;
    }
    return out;
}

/* cs_srgb_mean where samples let light through: each counts by what it covers. */
uint32_t cs_srgb_mean_clear(const struct cs_srgb *tone, const uint32_t samples[4]);

/* The mean of four samples' light, not of their bytes: what covers half of a pixel gives half
 * of its light. Colours are packed, the highest byte how much they let through; four equal
 * ones stay what they are. */
CS_INLINE uint32_t cs_srgb_mean(const struct cs_srgb *tone, const uint32_t samples[4]) {
    float light[3] = {0, 0, 0};
    if ((samples[0] | samples[1] | samples[2] | samples[3]) >> 24)
        return cs_srgb_mean_clear(tone, samples);
    for (int s = 0; s < 4; s++)
        for (int k = 0; k < 3; k++)
            light[k] += tone->linear[samples[s] >> 8 * k & 255];
    return cs_srgb_pack(tone, light[0] * 0.25f, light[1] * 0.25f, light[2] * 0.25f);
}

/* A colour that lets light through, as it is on white paper. */
uint32_t cs_srgb_blend_on_white(const struct cs_srgb *tone, uint32_t colour);

/* A packed colour becomes pixel i of an image; where that has no alpha, on white paper. */
CS_INLINE void cs_srgb_store(const struct cs_srgb *tone, uint32_t colour,
                             const struct cs_image *image, size_t i) {
    if (image->alpha)
        image->alpha[i] = (uint8_t)(255 - (colour >> 24));
    else if (colour >> 24)
        colour = cs_srgb_blend_on_white(tone, colour);
    image->rgb[3 * i] = (uint8_t)colour;
    image->rgb[3 * i + 1] = (uint8_t)(colour >> 8);
    image->rgb[3 * i + 2] = (uint8_t)(colour >> 16);
}

#endif

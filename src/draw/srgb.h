/* srgb.h - linear light to the bytes of sRGB and back (IEC 61966-2-1), without libm.
 *
 * With c the byte / 255 and y linear light in 0..1:
 *   y = c / 12.92 if c <= 0.04045, else ((c + 0.055) / 1.055)^2.4
 * Encoding rounds to the nearest byte: byte b stands for y from decode((b - 1/2) / 255) to
 * decode((b + 1/2) / 255). These thresholds are stored, so encoding needs no power and gives
 * the same bytes on every machine.
 *
 * A packed colour is red | green << 8 | blue << 16 | transparency << 24; transparency 0
 * covers. */
#ifndef CS_DRAW_SRGB_H
#define CS_DRAW_SRGB_H

#include "base/image.h"

#include <clothsim/clones.h>
#include <math.h>
#include <stdbool.h>

enum { CS_SAMPLES = 8 }; /* of a pixel; fewer are repeated */

/* Tables of both directions, about 6 KiB. Zero: not made. */
struct cs_srgb {
    uint8_t segment_start[4098]; /* byte of y = i / 4096 */
    float threshold[258]; /* smallest y that rounds to a byte; [256], [257]: 2, never reached */
    float linear[256];    /* y of each byte */
};

/* Fills the tables. */
void cs_srgb_make(struct cs_srgb *srgb);

/* The byte of c in 0..1, rounded exactly. Thresholds are at least 1 / (255 * 12.92) = 3.0e-4
 * apart, the slope of the straight part. A segment of 1/4096 = 2.4e-4 thus contains one of them
 * at most, and a single comparison decides. */
CS_INLINE uint32_t cs_srgb_encode(const struct cs_srgb *srgb, float c) {
    const uint32_t byte = srgb->segment_start[(int)(c * 4096)];
    return byte + (c >= srgb->threshold[byte + 1]);
}

/* Encodes three channels in 0..1 into a packed colour that covers. */
CS_INLINE uint32_t cs_srgb_pack(const struct cs_srgb *srgb, float red, float green,
                                float blue) {
    return cs_srgb_encode(srgb, red) | cs_srgb_encode(srgb, green) << 8 |
           cs_srgb_encode(srgb, blue) << 16;
}

/* Threshold 0..1 of row y in an ordered dither (Bayer 1973) of 16 rows: the bits of y, the
 * lowest first. Rows stay smooth, because noise along them makes files five times as large. */
CS_INLINE float cs_srgb_dither(int y) {
    int v = 0;
    for (int k = 0; k < 4; k++)
        v = 2 * v + (y >> k & 1);
    return ((float)v + 0.5f) / 16;
}

/* Light c in 0..1 plus the part of a byte that a threshold asks for: encoded, colours that vary
 * slowly are rounded up or down by the row, and show no bands. A byte is dc = 2.4 / 1.055
 * c^(1.4 / 2.4) / 255 of light wide; the power is 0.78 sqrt(c) + 0.22 c within 6 % from 0.05 on
 * and larger below. */
CS_INLINE float cs_srgb_dithered(float c, float threshold) {
    const float byte = (0.00697f * sqrtf(c) + 0.00195f * c) * (threshold - 0.5f) + c;
    return byte > 0 ? (byte < 1 ? byte : 1) : 0;
}

/* a b / 255 of two bytes, rounded. */
CS_INLINE uint32_t cs_srgb_scale(uint32_t a, uint32_t b) {
    const uint32_t product = a * b;
    return (product + (product >> 8) + 128) >> 8;
}

/* cs_srgb_blend for an `under` with transparency: the operator `over` (Porter and Duff 1984) on
 * colours that are not premultiplied.
 *   alpha = a + (1 - a) b,   colour = (a over + (1 - a) b under) / alpha
 * with the opacity a of `over` (share / 255) and b of `under`. */
uint32_t cs_srgb_blend_rows(uint32_t under, uint32_t over, uint32_t share);

/* `over` laid on `under` with an opacity of 0..255. Both products are rounded, as renderers of
 * bytes do, so the sum may be 256 and is limited; 255 gives `over`. */
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

/* cs_srgb_mean for samples with transparency: the mean weighted by opacity, and mean opacity.
 */
uint32_t cs_srgb_mean_clear(const struct cs_srgb *srgb, const uint32_t samples[CS_SAMPLES]);

/* The mean of the samples' linear light, not of their bytes: a surface that covers half of a
 * pixel gives half of its light. Equal colours give the same colour. */
CS_INLINE uint32_t cs_srgb_mean(const struct cs_srgb *srgb,
                                const uint32_t samples[CS_SAMPLES]) {
    const float part = 1.0f / CS_SAMPLES;
    float light[3] = {0, 0, 0};
    uint32_t any = 0;
    for (int s = 0; s < CS_SAMPLES; s++) {
        any |= samples[s];
        for (int k = 0; k < 3; k++)
            light[k] += srgb->linear[samples[s] >> 8 * k & 255];
    }
    if (any >> 24)
        return cs_srgb_mean_clear(srgb, samples);
    return cs_srgb_pack(srgb, light[0] * part, light[1] * part, light[2] * part);
}

/* Blends a colour with transparency over white, in linear light; the result covers. */
uint32_t cs_srgb_blend_on_white(const struct cs_srgb *srgb, uint32_t colour);

/* Writes a packed colour to pixel i of an image; over white if the image has no alpha. */
CS_INLINE void cs_srgb_store(const struct cs_srgb *srgb, uint32_t colour,
                             const struct cs_image *image, size_t i) {
    if (image->alpha)
        image->alpha[i] = (uint8_t)(255 - (colour >> 24));
    else if (colour >> 24)
        colour = cs_srgb_blend_on_white(srgb, colour);
    image->rgb[3 * i] = (uint8_t)colour;
    image->rgb[3 * i + 1] = (uint8_t)(colour >> 8);
    image->rgb[3 * i + 2] = (uint8_t)(colour >> 16);
}

/* Shrinks a picture to size (width, height), with its upper left corner at pixel `first` of
 * `paper`: each pixel is the mean of the linear light in the box that it covers, by area. What
 * is not opaque lies on white. */
void cs_srgb_shrink(const struct cs_srgb *srgb, const struct cs_image *image,
                    const uint32_t size[2], size_t first, const struct cs_image *paper);

/* Colour maps of values, and the colours of lines and marks. */

/* Sets six evenly spaced stops in linear RGB for the look's values, lowest first. Force runs
 * from dark violet over green to bright yellow. Strain, which has a sign, is blue where springs
 * are short, pale at 0 and red where they are long. Marks are red at the end. Neighbouring
 * stops differ for readers who see no green, and by lightness in grey. green_red: from green
 * over yellow to red instead. */
void cs_colour_stops(int32_t look, bool green_red, float stops[6][4]);

/* Converts 0xRRGGBB in sRGB to linear RGB, within 0.002 (srgb.c). */
void cs_colour_linear(uint32_t hex, float linear[3]);

/* Sets a dark or a light ink in linear RGB, the one with more contrast to a background. */
void cs_colour_ink(const double background[3], float ink[3]);

#endif

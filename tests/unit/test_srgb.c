/* Bytes of sRGB against the standard's formula, blending, and copies of textures. */
#include "unit.h"

#include "draw/mipmap.h"
#include "draw/srgb.h"

#include <math.h>
#include <stdlib.h>

static struct cs_srgb srgb;

static double encode(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1 / 2.4) - 0.055;
}

static double decode(double c) {
    return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
}

/* 16 thresholds, each once in 16 rows, about their middle; the mean of a dithered colour is the
 * colour to a tenth of a byte. */
TEST(dither_keeps_the_mean) {
    uint32_t seen = 0;
    cs_srgb_make(&srgb);
    for (int byte = 20; byte < 240; byte++) {
        const float part = 0.3f * srgb.threshold[byte] + 0.7f * srgb.threshold[byte + 1];
        double sum = 0;
        for (int i = 0; i < 16; i++) {
            const float threshold = cs_srgb_dither(i + 80);
            seen |= 1u << (int)(16 * threshold);
            sum += cs_srgb_encode(&srgb, cs_srgb_dithered(part, threshold));
        }
        ck_assert_double_eq_tol(sum / 16, byte + 0.2, 0.1);
    }
    ck_assert_uint_eq(seen, 0xffff);
}

/* the nearest byte, but where the formula is within its own rounding of the middle of two */
TEST(a_byte_is_the_nearest_of_the_curve) {
    double most = 0;
    cs_srgb_make(&srgb);
    for (int i = 0; i <= 1000000; i++) {
        const float linear = (float)i / 1000000;
        const double exact = 255 * encode((double)linear);
        most = fmax(most, fabs(exact - cs_srgb_encode(&srgb, linear)));
    }
    ck_assert_double_le(most, 0.5 + 1e-5);
}

TEST(bytes_come_back) {
    cs_srgb_make(&srgb);
    for (uint32_t byte = 0; byte < 256; byte++) {
        ck_assert_uint_eq(cs_srgb_encode(&srgb, srgb.linear[byte]), byte);
        ck_assert_double_le(fabs(255 * encode((double)srgb.linear[byte]) - byte), 1e-4);
    }
    ck_assert_uint_eq(cs_srgb_pack(&srgb, 1, 0, 1), 0xff00ff);
}

/* all or nothing is exact; between, at most one off the exact mean, and nothing overflows */
TEST(blending_is_a_mean) {
    double most = 0;
    uint32_t wrong = 0;
    for (uint32_t a = 0; a < 256; a += 3)
        for (uint32_t b = 0; b < 256; b += 5)
            for (uint32_t share = 0; share < 256; share += 5) {
                const uint32_t under = a << 16 | b, over = b << 16 | a;
                const uint32_t found = cs_srgb_blend(under, over, share);
                const double high = (b * share + a * (255.0 - share)) / 255;
                const double low = (a * share + b * (255.0 - share)) / 255;
                most = fmax(most, fmax(fabs(found / 65536 - high), fabs(found % 65536 - low)));
                wrong += (share == 0 && found != under) || (share == 255 && found != over);
            }
    ck_assert_double_le(most, 1);
    ck_assert_uint_eq(wrong, 0);
}

/* Samples give the byte of the mean of their light; whoever of them comes first. */
TEST(samples_give_the_mean_of_their_light) {
    uint32_t wrong = 0;
    cs_srgb_make(&srgb);
    for (uint32_t a = 0; a < 256; a++)
        for (uint32_t b = 0; b < 256; b += 3) {
            const uint32_t pair[2] = {a << 16 | b << 8 | 255, b << 16 | a << 8};
            const double light = 0.875 * decode(a / 255.0) + 0.125 * decode(b / 255.0);
            for (uint32_t odd = 0; odd < CS_SAMPLES; odd++) {
                uint32_t samples[CS_SAMPLES];
                for (int s = 0; s < CS_SAMPLES; s++)
                    samples[s] = pair[0];
                wrong += cs_srgb_mean(&srgb, samples) != pair[0];
                samples[odd] = pair[1];
                const double found = cs_srgb_mean(&srgb, samples) >> 16;
                wrong += fabs(found - 255 * encode(light)) > 0.5 + 1e-4;
                // seven parts of white light and one of none
                wrong += (cs_srgb_mean(&srgb, samples) & 255) != 240;
            }
        }
    ck_assert_uint_eq(wrong, 0);
}

/* A colour laid on nothing stays what it is and covers by its share; laid on what covers by
 * half, the two count as Porter and Duff have it. */
TEST(colours_lie_on_nothing) {
    const uint32_t nothing = 0xff000000, colour = 0x102030;
    for (uint32_t share = 1; share < 256; share++)
        ck_assert_uint_eq(cs_srgb_blend(nothing, colour, share), colour | (255 - share) << 24);
    ck_assert_uint_eq(cs_srgb_blend(nothing, colour, 0), nothing);
    // 100 covers by 102 of 255; 200 over it by 51: they are seen by 51 and by 81.6
    ck_assert_uint_eq(cs_srgb_blend(0x99000064, 200, 51), (255u - 133) << 24 | 138);
    ck_assert_uint_eq(cs_srgb_blend(0x99000064, 200, 255), 200);
}

/* What six of eight samples show is the pixel's colour, and they cover three quarters; on
 * white it is the mean of the light. */
TEST(samples_of_nothing_leave_the_colour) {
    const uint32_t nothing = 0xff000000, colour = 0x4080c0, white = 0xffffff;
    uint32_t none[CS_SAMPLES], some[CS_SAMPLES], on_white[CS_SAMPLES];
    for (uint32_t s = 0; s < CS_SAMPLES; s++) {
        none[s] = nothing;
        some[s] = s % 4 == 1 ? nothing : colour;
    }
    cs_srgb_make(&srgb);
    ck_assert_uint_eq(cs_srgb_mean(&srgb, some), colour | (255u - 191) << 24);
    ck_assert_uint_eq(cs_srgb_mean(&srgb, none), nothing);
    ck_assert_uint_eq(cs_srgb_blend_on_white(&srgb, nothing), white);
    for (uint32_t covered = 0; covered <= CS_SAMPLES; covered++) {
        for (uint32_t s = 0; s < CS_SAMPLES; s++) {
            some[s] = s < covered ? colour : nothing;
            on_white[s] = s < covered ? colour : white;
        }
        const uint32_t found = cs_srgb_blend_on_white(&srgb, cs_srgb_mean(&srgb, some));
        const uint32_t expected = cs_srgb_mean(&srgb, on_white);
        for (int k = 0; k < 24; k += 8)
            ck_assert_int_le(abs((int)(found >> k & 255) - (int)(expected >> k & 255)), 1);
    }
}

static void near(float found, float expected, double by) {
    ck_assert_double_le(fabs((double)found - (double)expected), by);
}

enum { WIDE = 12, HIGH = 8 };

static void make(struct cs_mipmap *mips, struct cs_arena *arena, int (*value)(int x, int y)) {
    struct cs_error error = {0};
    uint8_t rgb[3 * WIDE * HIGH];
    const struct cs_image image = {WIDE, HIGH, rgb, NULL};
    cs_srgb_make(&srgb);
    for (int i = 0; i < WIDE * HIGH; i++)
        for (int k = 0; k < 3; k++)
            rgb[3 * i + k] = (uint8_t)value(i % WIDE, i / WIDE);
    ck_assert_int_eq(cs_mipmap_make(mips, &image, &srgb, arena, &error), CS_OK);
}

static int columns(int x, int y) {
    (void)y;
    return x % 2 ? 200 : 100;
}
static int rows(int x, int y) {
    (void)x;
    return y % 2 ? 200 : 100;
}
static int slope(int x, int y) {
    return 10 * x + 5 * y;
}

/* 12 x 8, 6 x 4, 3 x 2, 1 x 1: each the mean of the light of what it replaces */
TEST(copies_are_means) {
    struct cs_arena arena = {0};
    struct cs_mipmap mips;
    const double expected = 65535 * (decode(100 / 255.0) + decode(200 / 255.0)) / 2;
    make(&mips, &arena, columns);
    ck_assert_int_eq(mips.n, 4);
    ck_assert_int_eq(mips.levels[2].width, 3);
    ck_assert_int_eq(mips.levels[2].height, 2);
    for (int copy = 1; copy < mips.n; copy++)
        for (int i = 0; i < 3 * mips.levels[copy].width * mips.levels[copy].height; i++)
            near(mips.levels[copy].light[i], (float)expected, 1.5);
    cs_arena_finish(&arena);
}

// light of a byte
static float light(double byte) {
    return (float)decode(byte / 255);
}

/* the light at (u, v) of a square pixel that is as large as `square` texels */
static void sample(const struct cs_mipmap *mips, float u, float v, float square, float rgb[3]) {
    const float side = sqrtf(square);
    float steps[2][2] = {{side / WIDE, 0}, {0, side / HIGH}};
    struct cs_texel_footprint footprint;
    cs_texel_footprint_make(mips, steps, &footprint);
    ck_assert_int_eq(footprint.parts, 1);
    cs_mipmap_sample(mips, u, v, &footprint, rgb);
}

/* in the middle of a texel its own light, between two their mean, and the same a repeat on */
TEST(a_texture_repeats_and_is_blended) {
    struct cs_arena arena = {0};
    struct cs_mipmap mips;
    float rgb[3];
    make(&mips, &arena, slope);
    for (int turn = -2; turn <= 2; turn++) {
        sample(&mips, (4.5f / WIDE) + (float)turn, 2.5f / HIGH, 0.5f, rgb);
        near(rgb[0], light(50), 2e-5);
        sample(&mips, 5.0f / WIDE, 3.0f / HIGH + (float)turn, 1, rgb);
        near(rgb[1], (light(50) + light(55) + light(60) + light(65)) / 4, 2e-5);
        // across the seam: between the last column and the first
        sample(&mips, (float)turn, 0.5f / HIGH, 1, rgb);
        near(rgb[2], (light(0) + light(110)) / 2, 2e-5);
    }
    // from afar: the mean of all, and nothing beyond the smallest copy
    float sum = 0;
    for (int i = 0; i < WIDE * HIGH; i++)
        sum += light(slope(i % WIDE, i / WIDE)) / (WIDE * HIGH);
    sample(&mips, 0.3f, 0.4f, 1e6f, rgb);
    near(rgb[0], sum, 1e-4);
    sample(&mips, 0.3f, 0.4f, NAN, rgb);
    near(rgb[0], 0.5f, 0.5);
    sample(&mips, 0.3f, 0.4f, INFINITY, rgb);
    near(rgb[0], 0.5f, 0.5);
    cs_arena_finish(&arena);
}

/* A pixel that covers six texels in a row and one in height is six parts of a texel: in the
 * middle of a stripe it has that stripe's light, where a square pixel of that width has the
 * mean of all. Six columns are a whole number of the columns' periods, so that their mean is
 * exact. */
TEST(a_long_pixel_blurs_along_its_longer_side) {
    struct cs_arena arena = {0};
    struct cs_mipmap mips;
    struct cs_texel_footprint footprint;
    float along[2][2] = {{6.0f / WIDE, 0}, {0, 1.0f / HIGH}}, rgb[3];
    make(&mips, &arena, rows);
    for (int turn = 0; turn < 2; turn++) {
        cs_texel_footprint_make(&mips, along, &footprint);
        ck_assert_int_eq(footprint.parts, 6);
        near(footprint.square, 1, 1e-6);
        near(footprint.side[0], 0.5, 0);
        cs_mipmap_sample(&mips, 0.3f, 2.5f / HIGH, &footprint, rgb);
        near(rgb[0], light(100), 2e-5);
        sample(&mips, 0.3f, 2.5f / HIGH, 36, rgb);
        near(rgb[0], (light(100) + light(200)) / 2, 1e-3);
        // the same pixel, its sides in the other order
        const float swap[2] = {along[0][0], along[0][1]};
        memcpy(along[0], along[1], sizeof swap);
        memcpy(along[1], swap, sizeof swap);
    }
    cs_arena_finish(&arena);
    make(&mips, &arena, columns);
    cs_texel_footprint_make(&mips, along, &footprint);
    cs_mipmap_sample(&mips, 6.0f / WIDE, 2.5f / HIGH, &footprint, rgb);
    near(rgb[0], (light(100) + light(200)) / 2, 2e-5);
    // longer than eight times: eight wider parts
    along[0][0] = 64.0f / WIDE;
    cs_texel_footprint_make(&mips, along, &footprint);
    ck_assert_int_eq(footprint.parts, CS_FOOTPRINT_PARTS_MAX);
    near(footprint.square, 64, 1e-4);
    cs_arena_finish(&arena);
}

/* rows of an odd length lose nothing: of three texels each counts by a third */
TEST(odd_copies_are_means_too) {
    struct cs_error error = {0};
    for (int lit = 0; lit < 9; lit++) {
        struct cs_arena arena = {0};
        struct cs_mipmap mips;
        uint8_t rgb[27] = {0};
        const struct cs_image image = {3, 3, rgb, NULL};
        rgb[3 * lit] = 255;
        cs_srgb_make(&srgb);
        ck_assert_int_eq(cs_mipmap_make(&mips, &image, &srgb, &arena, &error), CS_OK);
        ck_assert_int_eq(mips.n, 2);
        near(mips.levels[1].light[0], 65535.0f / 9, 0.6);
        cs_arena_finish(&arena);
    }
}

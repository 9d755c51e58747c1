/* The second level of the golden gate: what passes, what does not, and the figures. */
#include "shared/image_diff.h"
#include "unit.h"

#include <math.h>
#include <stdlib.h>

enum { SIDE = 100 };

/* A grey ramp; every test changes its own copy. */
static struct cs_image make_ramp(void) {
    struct cs_image image = {SIDE, SIDE, malloc(3 * SIDE * SIDE), NULL};
    ck_assert_ptr_nonnull(image.rgb);
    for (int i = 0; i < 3 * SIDE * SIDE; i++)
        image.rgb[i] = (uint8_t)(40 + i / 300);
    return image;
}

static bool passes(const struct cs_image *a, const struct cs_image *b) {
    const struct cs_image_difference difference = cs_image_compare(a, b);
    return cs_image_difference_passes(&difference);
}

TEST(identical_images_pass) {
    struct cs_image a = make_ramp(), b = make_ramp();
    const struct cs_image_difference difference = cs_image_compare(&a, &b);
    ck_assert_double_eq(difference.rmse, 0);
    ck_assert_double_eq(difference.share, 0);
    ck_assert_int_eq(difference.largest, 0);
    ck_assert_uint_eq(difference.pixels, 0);
    ck_assert(cs_image_difference_passes(&difference));
    free(a.rgb);
    free(b.rgb);
}

/* Two pixels of four differ: one by 3 and -1, one by 2. Sum of squares 14 over 12 channels. */
TEST(figures_of_a_small_image) {
    uint8_t left[12] = {10, 20, 30, 0, 0, 0, 255, 255, 255, 7, 7, 7};
    uint8_t right[12] = {13, 19, 30, 0, 0, 0, 255, 255, 253, 7, 7, 7};
    const struct cs_image a = {2, 2, left, NULL}, b = {2, 2, right, NULL};
    const struct cs_image_difference difference = cs_image_compare(&a, &b);
    ck_assert_double_eq_tol(difference.rmse, sqrt(14.0 / 12.0), 1e-15);
    ck_assert_double_eq(difference.share, 0.25);
    ck_assert_int_eq(difference.largest, 3);
    ck_assert_uint_eq(difference.pixels, 2);
    ck_assert(!cs_image_difference_passes(&difference));
}

/* Other CPU instructions: one channel in 20 off by one. */
TEST(rounding_passes) {
    struct cs_image a = make_ramp(), b = make_ramp();
    for (int i = 0; i < 3 * SIDE * SIDE; i += 20)
        b.rgb[i]++;
    ck_assert(passes(&a, &b));
    ck_assert(passes(&b, &a));
    free(a.rgb);
    free(b.rgb);
}

/* A light that moved a little: no channel is off by more than one, but half of them are. */
TEST(light_shift_fails) {
    struct cs_image a = make_ramp(), b = make_ramp();
    for (int i = 0; i < 3 * SIDE * SIDE; i += 2)
        b.rgb[i]--;
    const struct cs_image_difference difference = cs_image_compare(&a, &b);
    ck_assert_int_eq(difference.largest, 1);
    ck_assert_double_eq(difference.share, 0);
    ck_assert_double_eq_tol(difference.rmse, sqrt(0.5), 1e-15);
    ck_assert(!cs_image_difference_passes(&difference));
    free(a.rgb);
    free(b.rgb);
}

/* An edge that moved: few pixels, hardly any error in the mean. */
TEST(lost_edge_fails) {
    struct cs_image a = make_ramp(), b = make_ramp();
    for (int i = 0; i < 6; i++)
        b.rgb[3000 + 3 * i] += 3;
    const struct cs_image_difference difference = cs_image_compare(&a, &b);
    ck_assert_double_lt(difference.rmse, 0.45);
    ck_assert_double_eq_tol(difference.share, 6e-4, 1e-15);
    ck_assert(!cs_image_difference_passes(&difference));
    // five of them are just what is allowed
    b.rgb[3000] -= 3;
    ck_assert(passes(&a, &b));
    free(a.rgb);
    free(b.rgb);
}

TEST(bounds_are_inclusive) {
    struct cs_image_difference difference = {.rmse = 0.45, .share = 0.0005};
    ck_assert(cs_image_difference_passes(&difference));
    difference.rmse = 0.4501;
    ck_assert(!cs_image_difference_passes(&difference));
    difference.rmse = (double)NAN;
    ck_assert(!cs_image_difference_passes(&difference));
}

TEST(amplified_difference_is_clamped) {
    uint8_t left[6] = {10, 10, 10, 0, 255, 9}, right[6] = {10, 11, 9, 255, 0, 17}, pixels[6];
    static const uint8_t expected[6] = {128, 144, 112, 255, 0, 255};
    const struct cs_image a = {2, 1, left, NULL}, b = {2, 1, right, NULL};
    struct cs_image out = {0, 0, pixels, NULL};
    cs_image_amplify(&a, &b, &out);
    ck_assert_uint_eq(out.width, 2);
    ck_assert_uint_eq(out.height, 1);
    ck_assert_mem_eq(out.rgb, expected, sizeof expected);
}

TEST(empty_images_are_equal) {
    const struct cs_image none = {0, 0, NULL, NULL};
    ck_assert(passes(&none, &none));
}

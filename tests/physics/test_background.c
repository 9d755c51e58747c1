/* What lies behind and below the cloth in pictures: backgrounds and shadows on the ground. */
#include "picture_fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 160, HEIGHT = 120 };

/* a cloth before a box, so that one covers the other; %s: the background */
#define BACKED                                                                                 \
    "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6]}, \"mass\": {\"total\": 0.2}, \"pins\": "     \
    "[\"edges\"]}], \"colliders\": [{\"box\": {\"centre\": [0.4, 0.3, -0.5], \"size\": "       \
    "[0.3, 0.2, 0.1]}}], \"render\": {\"size\": [160, 120], \"ground\": \"none\", "            \
    "\"pins\": false, \"background\": %s}}"

static void draw_backed(const char *background, struct cs_image *image) {
    struct fixture cloth;
    fixture_open(&cloth, "symplectic-euler", BACKED, background);
    fixture_draw(&cloth, 0, image);
}

/* byte of sRGB from light that is laid on white */
static double on_white(double byte, double alpha) {
    const double c = byte / 255;
    const double light = c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
    const double laid = 1 + alpha / 255 * (light - 1);
    return 255 * (laid <= 0.0031308 ? 12.92 * laid : 1.055 * pow(laid, 1 / 2.4) - 0.055);
}

/* What has no background is, on white, what was drawn before white, but for roundings; an image
 * without alpha has it there already. */
TEST(nothing_behind_is_white_on_white) {
    static uint8_t rgb[3][3 * WIDTH * HEIGHT], alpha[WIDTH * HEIGHT];
    struct cs_image white = {WIDTH, HEIGHT, rgb[0], NULL};
    struct cs_image clear = {WIDTH, HEIGHT, rgb[1], alpha};
    struct cs_image laid = {WIDTH, HEIGHT, rgb[2], NULL};
    size_t edges = 0;
    double most = 0;
    draw_backed("{\"kind\": \"flat\", \"colour\": [1, 1, 1]}", &white);
    draw_backed("{\"kind\": \"none\", \"colour\": [1, 1, 1]}", &clear);
    draw_backed("{\"kind\": \"none\", \"colour\": [1, 1, 1]}", &laid);
    for (size_t i = 0; i < WIDTH * HEIGHT; i++) {
        edges += alpha[i] > 0 && alpha[i] < 255;
        for (size_t k = 3 * i; k < 3 * i + 3; k++) {
            most = fmax(most, fabs(on_white(rgb[1][k], alpha[i]) - rgb[0][k]));
            most = fmax(most, fabs((double)rgb[2][k] - rgb[0][k]));
        }
    }
    ck_assert_double_le(most, 1.5);
    ck_assert_uint_gt(edges, 100);
    ck_assert_uint_eq(alpha[0], 0);
}

/* From one colour above to the other below, and nothing in between but light. Dither makes the
 * mean exact between two bytes: light of 0.5 is 187.516. */
TEST(a_gradient_runs_from_edge_to_edge) {
    static uint8_t rgb[3 * WIDTH * HEIGHT];
    struct cs_image image = {WIDTH, HEIGHT, rgb, NULL};
    double blue = 0;
    draw_backed("{\"colour\": [1, 0, 0.5], \"below\": [0, 1, 0.5]}", &image);
    for (size_t y = 0; y < HEIGHT; y++) {
        const double down = ((double)y + 0.5) / HEIGHT;
        const uint8_t *pixel = rgb + 3 * y * WIDTH;
        ck_assert_double_le(fabs(pixel[0] - on_white(0, 255 * down)), 1);
        ck_assert_double_le(fabs(pixel[1] - on_white(0, 255 * (1 - down))), 1);
        ck_assert_int_le(abs(2 * pixel[2] - 375), 1);
        blue += pixel[2];
    }
    ck_assert_double_eq_tol(blue / HEIGHT, 187.516, 0.04);
}

/* a cloth that hangs or falls, without a background; %s: pins, collider, keys of the picture */
#define GROUNDED                                                                               \
    "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6], \"size\": [0.5, 0.5]}, \"mass\": "           \
    "{\"total\": 0.2}, \"springs\": {\"stretch\": 400}, \"pins\": "                            \
    "[%s]}], \"colliders\": [%s], \"light\": {\"point\": [0.5, 3, 1]}, \"camera\": {\"eye\": " \
    "[0, 0.6, 3]}, \"render\": {\"size\": [160, 120], \"background\": \"none\"%s}}"

static void draw_grounded(const char *pins, const char *collider, const char *keys,
                          uint32_t frames, struct cs_image *image) {
    struct fixture cloth;
    fixture_open(&cloth, "symplectic-euler", GROUNDED, pins, collider, keys);
    fixture_draw(&cloth, frames, image);
}

/* Where a cloth hangs and there is no floor, its shadow lies below it in every frame: beside
 * the cloth, which looks as it does without. It is asked for where a cloth falls, and not
 * wanted where there is a floor. */
TEST(shadows_lie_below_what_has_no_floor) {
    static const char *const scenes[][3] = {
        {"\"top-left\", \"top-right\"", "", ""},
        {"\"top\"", "", ""},
        {"", "", ", \"ground\": \"shadow\""},
        {"", "", ", \"ground\": \"shadow\", \"ground_height\": -0.9"},
        {"", "", ""},
        {"\"top\"", "{\"floor\": {\"height\": -0.7}}", ""}};
    static uint8_t rgb[2][3 * WIDTH * HEIGHT], alpha[2][WIDTH * HEIGHT];
    struct cs_image with = {WIDTH, HEIGHT, rgb[0], alpha[0]};
    struct cs_image without = {WIDTH, HEIGHT, rgb[1], alpha[1]};
    for (size_t k = 0; k < 6; k++)
        for (uint32_t frames = 1; frames < 20; frames += 9) {
            size_t hidden = 0, shaded = 0;
            draw_grounded(scenes[k][0], scenes[k][1], scenes[k][2], frames, &with);
            draw_grounded(scenes[k][0], scenes[k][1], ", \"ground\": \"none\"", frames,
                          &without);
            for (size_t i = 0; i < WIDTH * HEIGHT; i++) {
                hidden += alpha[1][i] == 255 && memcmp(rgb[0] + 3 * i, rgb[1] + 3 * i, 3);
                shaded += alpha[1][i] == 0 && alpha[0][i] > 40;
            }
            ck_assert_msg(!hidden, "scene %zu, frame %u: %zu pixels", k, frames, hidden);
            ck_assert_msg(k < 4 ? shaded > (k == 2 ? 0 : 50) : !shaded,
                          "scene %zu, frame %u: %zu pixels", k, frames, shaded);
        }
}

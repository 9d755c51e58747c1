/* A picture drawn beside the run is that of the state at which it was begun. */
#include "picture_fixture.h"

#include "draw/view.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 160, HEIGHT = 120, FRAMES = 6 };

/* pins are drawn, and let go in the middle: what is drawn of them changes with the run, and so
 * does the place of a box */
#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6]}, \"mass\": {\"total\": 0.2}, \"pins\": "     \
    "[\"top-left\", \"top-right\"]}], \"events\": [{\"at\": 0.05, \"release\": {}}, "          \
    "{\"at\": 0, \"move\": {\"collider\": 0, \"spin\": [0, 9, 0]}}], "                         \
    "\"colliders\": [{\"box\": {\"centre\": [0.4, 0.1, 1], \"size\": [0.3, 0.2, 0.1]}}], "     \
    "\"render\": {\"size\": [160, 120], \"look\": \"%s\"}}"

static uint8_t *draw_frames(const char *look, bool beside) {
    const size_t bytes = (size_t)WIDTH * HEIGHT * 3;
    struct fixture cloth;
    struct cs_picture picture;
    struct cs_error error = {0};
    uint8_t *all = calloc(FRAMES, bytes);
    ck_assert_ptr_nonnull(all);
    fixture_open(&cloth, "symplectic-euler", SCENE, look);
    fixture_start(&cloth);
    cs_picture_open(&picture, cloth.system, CS_RENDERER_AUTO, false, beside, &error);
    ck_assert_int_eq(picture.worker != NULL, beside);
    for (size_t k = 0; k < FRAMES && !error.status; k++) {
        struct cs_image image = {WIDTH, HEIGHT, all + k * bytes, NULL};
        cs_picture_begin(&picture, &cloth.session.run, &image);
        fixture_frames(&cloth, 1);
        cs_picture_end(&picture, &error);
    }
    ck_assert_msg(!error.status, "%s", error.message);
    ck_assert_ptr_nonnull(strstr(cs_picture_renderer(&picture), " | "));
    cs_picture_close(&picture);
    fixture_close(&cloth);
    return all;
}

/* the same, drawn at once: nothing can have moved under the painter */
TEST(pictures_beside_the_run_are_those_at_once) {
    static const char *const looks[] = {"lit", "springs", "force"};
    for (size_t l = 0; l < sizeof looks / sizeof *looks; l++) {
        const size_t bytes = (size_t)WIDTH * HEIGHT * 3;
        uint8_t *beside = draw_frames(looks[l], true), *at_once = draw_frames(looks[l], false);
        for (size_t k = 0; k < FRAMES; k++) {
            ck_assert_mem_eq(beside + k * bytes, at_once + k * bytes, bytes);
            ck_assert(k == 0 || memcmp(at_once + k * bytes, at_once + (k - 1) * bytes, bytes));
        }
        free(beside);
        free(at_once);
    }
}

/* a cloth at rest between two balls, which bound the scene; %s: a collider, %s: the events */
#define STILL                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6]}, \"mass\": {\"total\": 0.2}, \"pins\": "     \
    "[\"edges\"]}], \"forces\": {\"gravity\": [0, 0, 0]}, \"colliders\": [%s, "                \
    "{\"sphere\": {\"centre\": [1, 1, 1], \"radius\": 0.125}}, "                               \
    "{\"sphere\": {\"centre\": [-1, -1, -1], \"radius\": 0.125}}], \"events\": [%s], "         \
    "\"light\": {\"point\": [1, 2, 3]}, \"render\": {\"size\": [160, 120]}}"

static uint8_t *draw_moved(const char *collider, const char *events) {
    struct fixture cloth;
    struct cs_picture picture;
    struct cs_error error = {0};
    uint8_t *pixels = calloc((size_t)WIDTH * HEIGHT, 3);
    struct cs_image image = {WIDTH, HEIGHT, pixels, NULL};
    ck_assert_ptr_nonnull(pixels);
    fixture_open(&cloth, "symplectic-euler", STILL, collider, events);
    fixture_start(&cloth);
    cs_picture_open(&picture, cloth.system, CS_RENDERER_AUTO, false, true, &error);
    fixture_frames(&cloth, 2);
    cs_picture_begin(&picture, &cloth.session.run, &image);
    cs_picture_end(&picture, &error);
    ck_assert_msg(!error.status, "%s", error.message);
    cs_picture_close(&picture);
    fixture_close(&cloth);
    return pixels;
}

/* A collider on its way by (1/4, 1/2, -1/4) looks as one that stands there, shadow and all, and
 * not as one that stands where it was. The numbers have no rounding. */
TEST(moved_colliders_are_drawn_where_they_are) {
    static const char *const colliders[][2] = {
        {"{\"sphere\": {\"centre\": [0, -0.25, 0.75], \"radius\": 0.125}}",
         "{\"sphere\": {\"centre\": [0.25, 0.25, 0.5], \"radius\": 0.125}}"},
        {"{\"box\": {\"centre\": [0, -0.25, 0.75], \"size\": [0.5, 0.25, 0.125]}}",
         "{\"box\": {\"centre\": [0.25, 0.25, 0.5], \"size\": [0.5, 0.25, 0.125]}}"},
        {"{\"capsule\": {\"from\": [0, -0.25, 0.75], \"to\": [0.25, 0, 0.5]}}",
         "{\"capsule\": {\"from\": [0.25, 0.25, 0.5], \"to\": [0.5, 0.5, 0.25]}}"},
        {"{\"plane\": {\"point\": [0, -0.25, -0.25], \"normal\": [0, 0, 1], \"extent\": 0.5}}",
         "{\"plane\": {\"point\": [0.25, 0.25, -0.5], \"normal\": [0, 0, 1], \"extent\": "
         "0.5}}"}};
    for (size_t k = 0; k < sizeof colliders / sizeof *colliders; k++) {
        const size_t bytes = (size_t)WIDTH * HEIGHT * 3;
        uint8_t *moved =
            draw_moved(colliders[k][0], "{\"at\": 0, \"move\": {\"collider\": 0, \"path\":"
                                        " [{\"at\": 0.02, \"point\": [0.25, 0.5, -0.25]}]}}");
        uint8_t *there = draw_moved(colliders[k][1], "");
        uint8_t *before = draw_moved(colliders[k][0], "");
        ck_assert_msg(!memcmp(moved, there, bytes), "collider %zu", k);
        ck_assert_msg(memcmp(moved, before, bytes), "collider %zu", k);
        free(moved);
        free(there);
        free(before);
    }
}

/* their rectangles and marks come from the events, which a step changes */
TEST(what_viewpoint_forces_see_is_drawn_at_once) {
    struct fixture cloth;
    struct cs_picture picture;
    struct cs_error error = {0};
    fixture_open(
        &cloth, "symplectic-euler",
        "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6]}, \"mass\": {\"total\": 0.2}}], "
        "\"events\": [{\"from\": 0, \"to\": 1, \"viewpoint_force\": {\"viewpoint\": {\"eye\": "
        "[0, 0, 2]}, \"rectangle\": [0.4, 0.4, 0.6, 0.6], \"force\": 0.01}}], "
        "\"render\": {\"size\": [160, 120], \"viewpoint_forces\": true}}");
    fixture_start(&cloth);
    cs_picture_open(&picture, cloth.system, CS_RENDERER_AUTO, false, true, &error);
    ck_assert_msg(!error.status, "%s", error.message);
    ck_assert_ptr_null(picture.worker);
    cs_picture_close(&picture);
    fixture_close(&cloth);
}

/* A side of a box that is seen straight on has one colour from edge to edge; a ball has not. */
TEST(sides_of_a_box_are_flat) {
    static uint8_t rgb[3 * WIDTH * HEIGHT], alpha[WIDTH * HEIGHT];
    static const char *const shapes[] = {"box", "sphere"};
    for (size_t k = 0; k < 2; k++) {
        struct cs_image image = {WIDTH, HEIGHT, rgb, alpha};
        struct fixture body;
        size_t covered = 0, first = 0, others = 0;
        fixture_open(
            &body, "symplectic-euler",
            "{\"bodies\": [{\"mesh\": {\"shape\": \"%s\", \"detail\": 4}, \"mass\": "
            "{\"total\": 1}, \"material\": {\"specular\": 0}}], \"camera\": {\"eye\": "
            "[0, 0, 3], \"projection\": \"orthographic\"}, \"light\": {\"direction\": "
            "[0, 0, -1]}, \"render\": {\"size\": [160, 120], \"background\": \"none\", "
            "\"ground\": \"none\"}}",
            shapes[k]);
        fixture_draw(&body, 0, &image);
        for (size_t i = 0; i < WIDTH * HEIGHT; i++) {
            if (alpha[i] < 255)
                continue;
            first = covered++ ? first : i;
            others += memcmp(rgb + 3 * i, rgb + 3 * first, 3) != 0;
        }
        ck_assert_uint_gt(covered, 1000);
        ck_assert_msg(k == 0 ? others == 0 : others > 500, "%zu of %zu", others, covered);
    }
}

/* a sheet of 0.8 m seen straight on from 3 m, held by two corners; %s: keys of the picture */
#define SHEET                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [5, 5], \"size\": [0.8, 0.8]}, \"mass\": "           \
    "{\"total\": 1}, \"pins\": [\"top\"]}], \"camera\": {\"eye\": [0, 0, 3], \"projection\": " \
    "\"orthographic\"}, \"render\": {\"size\": [160, 120], \"background\": \"none\", "         \
    "\"ground\": \"none\", %s}}"

static void draw_sheet(const char *keys, struct cs_image *image) {
    struct fixture sheet;
    fixture_open(&sheet, "symplectic-euler", SHEET, keys);
    fixture_draw(&sheet, 0, image);
}

/* A normal (0, 0, 1) is (0.5, 0.5, 1) squared as light; texture coordinates run from 0 to 1 to
 * the right and up or down; pegs and the rod between them are the pixels that pins adds. */
TEST(looks_show_normals_coordinates_and_pins) {
    static uint8_t rgb[4][3 * WIDTH * HEIGHT], alpha[4][WIDTH * HEIGHT];
    static const char *const keys[] = {"\"look\": \"normals\", \"pins\": false",
                                       "\"look\": \"uv\", \"pins\": false", "\"pins\": false",
                                       "\"look\": \"lit\""};
    const size_t middle = HEIGHT / 2 * WIDTH + WIDTH / 2;
    size_t differ = 0, rows = 0;
    for (size_t k = 0; k < 4; k++) {
        struct cs_image image = {WIDTH, HEIGHT, rgb[k], alpha[k]};
        draw_sheet(keys[k], &image);
        ck_assert_uint_eq(alpha[k][middle], 255);
    }
    const uint8_t *normal = rgb[0] + 3 * middle, *uv = rgb[1] + 3 * middle;
    ck_assert(normal[0] == 137 && normal[1] == 137 && normal[2] == 255);
    ck_assert_int_le(abs(uv[0] - 137), 3);
    ck_assert_int_le(abs(uv[1] - 137), 3);
    ck_assert_int_gt(uv[30] - uv[0], 10);
    ck_assert_int_gt(abs(uv[3 * 10 * WIDTH + 1] - uv[1]), 10);
    for (size_t i = 0; i < WIDTH * HEIGHT; i++)
        if (alpha[2][i] != alpha[3][i] || memcmp(rgb[2] + 3 * i, rgb[3] + 3 * i, 3)) {
            differ++;
            rows += i / WIDTH > HEIGHT / 2;
        }
    ck_assert_uint_gt(differ, 20);
    ck_assert_uint_eq(rows, 0);
}

static enum cs_status fail_to_paint(struct cs_canvas *canvas, const struct cs_frame *frame,
                                    struct cs_image *image, struct cs_error *error) {
    (void)canvas, (void)image;
    return cs_fail(error, CS_ERR_MODULE, "no paint left at %g s", frame->t);
}

/* told by the end of that picture and of all later ones, and closed without a wait for more */
TEST(a_renderer_that_fails_is_told) {
    static uint8_t pixels[(size_t)WIDTH * HEIGHT * 3];
    struct cs_image image = {WIDTH, HEIGHT, pixels, NULL};
    for (int beside = 0; beside < 2; beside++) {
        struct fixture cloth;
        struct cs_picture picture;
        struct cs_error error = {0}, failure = {0}, later = {0};
        fixture_open(&cloth, "symplectic-euler", SCENE, "lit");
        fixture_start(&cloth);
        cs_picture_open(&picture, cloth.system, CS_RENDERER_AUTO, false, beside, &error);
        ck_assert_msg(!error.status, "%s", error.message);
        struct cs_renderer failing = *picture.renderer;
        failing.paint = fail_to_paint;
        ck_assert_int_eq(cs_picture_end(&picture, &failure), CS_OK);
        picture.renderer = &failing;
        for (int k = 0; k < 2; k++) {
            cs_picture_begin(&picture, &cloth.session.run, &image);
            fixture_frames(&cloth, 1);
            ck_assert_int_eq(cs_picture_end(&picture, k ? &later : &failure), CS_ERR_MODULE);
        }
        ck_assert_str_eq(failure.message, "no paint left at 0 s");
        ck_assert_str_eq(later.message, failure.message);
        cs_picture_begin(&picture, &cloth.session.run, &image); /* under way when closed */
        cs_picture_close(&picture);
        fixture_close(&cloth);
    }
}

/* Ramps of light, colour and field of view end in the picture of the scene that has their
 * values, and change no bit of the state. */
TEST(ramps_of_pictures) {
    static const char scene[] =
        "{\"bodies\": [{\"cloth\": {\"grid\": [6, 5]}, \"mass\": {\"total\": 0.1}, \"pins\":"
        " [\"top\"], \"material\": {\"colour\": [%s, 0.2, 0.2]}}], \"colliders\": [{\"sphere\":"
        " {\"centre\": [0, -0.2, -0.6]}, \"colour\": [0.4, %s, 0.4]}], \"camera\": {\"frame\":"
        " \"given\", \"fov\": %s}, \"light\": {\"strength\": %s}, \"lights\": [{\"point\":"
        " [1, %s, 1], \"shadow\": false}], \"render\": {\"size\": [64, 48]}, \"events\": [%s]}";
    static const char ramps[] =
        "{\"from\": 0.01, \"to\": 0.05, \"ramp\": {\"key\": \"bodies[0].material.colour[0]\","
        " \"value\": 0.1}}, {\"at\": 0.03, \"ramp\": {\"key\": \"colliders[0].colour[1]\","
        " \"value\": 0.9}}, {\"from\": 0, \"to\": 0.1, \"ramp\": {\"key\": \"camera.fov\","
        " \"value\": 30}}, {\"from\": 0, \"to\": 0.02, \"ramp\": {\"key\": \"light.strength\","
        " \"value\": 0.9}}, {\"from\": 0.02, \"to\": 0.1, \"ramp\": {\"key\": "
        "\"light.strength\","
        " \"value\": 0.4}}, {\"from\": 0, \"to\": 0.1, \"ramp\": {\"key\":"
        " \"lights[0].point[1]\", \"value\": 2}}";
    struct fixture ramped, plain;
    struct cs_image images[3];
    for (int k = 0; k < 3; k++)
        images[k] = (struct cs_image){64, 48, malloc(3 * 64 * 48), NULL};
    fixture_open(&ramped, "velocity-verlet:dt=0.001", scene, "0.8", "0.1", "50", "0.1", "0",
                 ramps);
    fixture_open(&plain, "velocity-verlet:dt=0.001", scene, "0.1", "0.9", "30", "0.4", "2", "");
    fixture_start(&ramped);
    fixture_start(&plain);
    fixture_frames(&ramped, 6);
    fixture_frames(&plain, 6);
    ck_bits(ramped.x, plain.x, 6 * plain.n, "states");
    fixture_close(&ramped);
    fixture_close(&plain);
    fixture_open(&ramped, "velocity-verlet:dt=0.001", scene, "0.8", "0.1", "50", "0.1", "0",
                 ramps);
    fixture_draw(&ramped, 6, images);
    fixture_open(&plain, "velocity-verlet:dt=0.001", scene, "0.1", "0.9", "30", "0.4", "2", "");
    fixture_draw(&plain, 6, images + 1);
    fixture_open(&ramped, "velocity-verlet:dt=0.001", scene, "0.8", "0.1", "50", "0.1", "0",
                 ramps);
    fixture_draw(&ramped, 3, images + 2);
    ck_assert(!memcmp(images[0].rgb, images[1].rgb, cs_image_bytes(images)));
    ck_assert(memcmp(images[0].rgb, images[2].rgb, cs_image_bytes(images)) != 0);
    for (int k = 0; k < 3; k++)
        free(images[k].rgb);
}

/* Lights add up: two suns of half the strength are one sun, to a byte; a light without shadow
 * is no darker anywhere than with it. */
TEST(lights_add_up) {
    static const char scene[] =
        "{\"bodies\": [{\"cloth\": {\"grid\": [6, 5], \"start\": \"flat\"}, \"mass\": "
        "{\"total\":"
        " 0.1}, \"pins\": [\"edges\"]}], \"colliders\": [{\"floor\": {\"height\": -0.5}}],"
        " \"camera\": {\"frame\": \"given\"}, \"light\": {\"direction\": [-1, -2, -1],"
        " \"strength\": %s, \"shadow\": %s}%s, \"render\": {\"size\": [64, 48]}}";
    static const char *const others[3][3] = {
        {"1", "true", ""},
        {"0.5", "true", ", \"lights\": [{\"direction\": [-1, -2, -1], \"strength\": 0.5}]"},
        {"1", "false", ""}};
    struct cs_image images[3];
    for (int k = 0; k < 3; k++) {
        struct fixture cloth;
        images[k] = (struct cs_image){64, 48, malloc(3 * 64 * 48), NULL};
        fixture_open(&cloth, "velocity-verlet:dt=0.001", scene, others[k][0], others[k][1],
                     others[k][2]);
        fixture_draw(&cloth, 1, images + k);
    }
    int brighter = 0;
    for (size_t i = 0; i < cs_image_bytes(images); i++) {
        ck_assert_int_le(abs(images[0].rgb[i] - images[1].rgb[i]), 1);
        ck_assert_int_ge(images[2].rgb[i], images[0].rgb[i]);
        brighter += images[2].rgb[i] > images[0].rgb[i];
    }
    ck_assert_int_gt(brighter, 100);
    for (int k = 0; k < 3; k++)
        free(images[k].rgb);
}

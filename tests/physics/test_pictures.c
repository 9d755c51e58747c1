/* A picture drawn beside the run is that of the state at which it was begun. */
#include "fixture.h"

#include "study/picture.h"

#include <stdlib.h>
#include <string.h>

enum { WIDTH = 160, HEIGHT = 120, FRAMES = 6 };

/* pins are drawn, and let go in the middle: what is drawn of them changes with the run */
#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6]}, \"mass\": {\"total\": 0.2}, \"pins\": "     \
    "[\"top-left\", \"top-right\"]}], \"events\": [{\"at\": 0.05, \"release\": {}}], "         \
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
    cs_picture_open(&picture, cloth.system, CS_GL_AUTO, false, beside, &error);
    ck_assert_int_eq(picture.hand != NULL, beside);
    for (size_t k = 0; k < FRAMES && !error.status; k++) {
        struct cs_image image = {WIDTH, HEIGHT, all + k * bytes};
        cs_picture_begin(&picture, &cloth.session.run, &image);
        fixture_frames(&cloth, 1);
        cs_picture_end(&picture, &error);
    }
    ck_assert_msg(!error.status, "%s", error.message);
    ck_assert_ptr_nonnull(strstr(cs_picture_renderer(&picture), "caps="));
    cs_picture_close(&picture);
    fixture_close(&cloth);
    return all;
}

/* the same, drawn at once: nothing can have moved under the painter */
START_TEST(pictures_beside_the_run_are_those_at_once) {
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
END_TEST

/* their rectangles and marks come from the events, which a step changes */
START_TEST(what_prods_see_is_drawn_at_once) {
    struct fixture cloth;
    struct cs_picture picture;
    struct cs_error error = {0};
    fixture_open(&cloth, "symplectic-euler",
                 "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6]}, \"mass\": {\"total\": 0.2}}], "
                 "\"events\": [{\"from\": 0, \"to\": 1, \"prod\": {\"viewpoint\": {\"eye\": "
                 "[0, 0, 2]}, \"rectangle\": [0.4, 0.4, 0.6, 0.6], \"force\": 0.01}}], "
                 "\"render\": {\"size\": [160, 120], \"prods\": true}}");
    fixture_start(&cloth);
    cs_picture_open(&picture, cloth.system, CS_GL_AUTO, false, true, &error);
    ck_assert_msg(!error.status, "%s", error.message);
    ck_assert_ptr_null(picture.hand);
    cs_picture_close(&picture);
    fixture_close(&cloth);
}
END_TEST

static enum cs_status fail_to_paint(struct cs_canvas *canvas, const struct cs_frame *frame,
                                    struct cs_image *image, struct cs_error *error) {
    (void)canvas, (void)image;
    return cs_fail(error, CS_ERR_MODULE, "no paint left at %g s", frame->t);
}

/* told by the end of that picture and of all later ones, and closed without a wait for more */
START_TEST(a_renderer_that_fails_is_told) {
    static uint8_t pixels[(size_t)WIDTH * HEIGHT * 3];
    struct cs_image image = {WIDTH, HEIGHT, pixels};
    for (int beside = 0; beside < 2; beside++) {
        struct fixture cloth;
        struct cs_picture picture;
        struct cs_error error = {0}, failure = {0}, later = {0};
        fixture_open(&cloth, "symplectic-euler", SCENE, "lit");
        fixture_start(&cloth);
        cs_picture_open(&picture, cloth.system, CS_GL_AUTO, false, beside, &error);
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
END_TEST

int main(void) {
    const TTest *const tests[] = {pictures_beside_the_run_are_those_at_once,
                                  what_prods_see_is_drawn_at_once,
                                  a_renderer_that_fails_is_told};
    return fixture_run("pictures", tests, sizeof tests / sizeof *tests);
}

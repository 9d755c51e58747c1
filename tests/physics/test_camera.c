/* What cameras see: lenses, paths, and all of the bodies where a scene names no camera. */
#include "picture_fixture.h"

#include "draw/view.h"
#include "scene/collider_keys.h"
#include "scene/picture_keys.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 160, HEIGHT = 120 };

/* two balls, one in front; %s: the camera */
#define SEEN                                                                                   \
    "{\"bodies\": [{\"cloth\": {\"grid\": [2, 2], \"size\": [0.01, 0.01]}, \"mass\": "         \
    "{\"total\": 0.2}, \"pins\": "                                                             \
    "[\"edges\"]}], \"colliders\": [{\"sphere\": {\"centre\": [-0.5, 0, 0.5], \"radius\": "    \
    "0.25}}, "                                                                                 \
    "{\"sphere\": {\"centre\": [0.5, 0, -1], \"radius\": 0.25}}], "                            \
    "\"camera\": %s, \"render\": {\"size\": [160, 120], \"ground\": \"none\", "                \
    "\"background\": \"none\"}}"

static void draw_seen(const char *camera, uint32_t frames, struct cs_image *image) {
    struct fixture cloth;
    fixture_open(&cloth, "symplectic-euler", SEEN, camera);
    fixture_draw(&cloth, frames, image);
}

/* pixels that are covered in the left and in the right half */
static void count_covered(const uint8_t *alpha, double covered[2]) {
    covered[0] = covered[1] = 0;
    for (size_t i = 0; i < WIDTH * HEIGHT; i++)
        covered[i % WIDTH >= WIDTH / 2] += alpha[i] / 255.0;
}

/* A ball of radius r covers pi r^2 of an orthographic picture, however far it is: there 2 m are
 * 120 pixels. In a perspective the nearer one is larger, by the square of the distances. */
TEST(an_orthographic_picture_has_no_distance) {
    static uint8_t rgb[3 * WIDTH * HEIGHT], alpha[WIDTH * HEIGHT];
    struct cs_image image = {WIDTH, HEIGHT, rgb, alpha};
    const double expected = 3.14159265358979 * 15 * 15;
    double covered[2];
    draw_seen("{\"eye\": [0, 0, 2.41421356], \"fov\": 45, \"projection\": \"orthographic\"}", 1,
              &image);
    count_covered(alpha, covered);
    ck_assert_double_eq_tol(covered[0], expected, 0.01 * expected);
    ck_assert_double_eq_tol(covered[1], expected, 0.01 * expected);
    draw_seen("{\"eye\": [0, 0, 2.41421356], \"fov\": 45}", 1, &image);
    count_covered(alpha, covered);
    ck_assert_double_eq_tol(covered[0] / covered[1], 3.1813, 0.2);
}

/* at its keys and between them a camera on a path draws what one draws that stands there */
TEST(a_camera_follows_its_path) {
    static const char *const there[] = {"{\"eye\": [1, 0.5, 2], \"target\": [0, 0, 0]}",
                                        "{\"eye\": [0, 0.5, 2], \"target\": [0.25, 0, 0]}",
                                        "{\"eye\": [-1, 0.5, 2], \"target\": [0.5, 0, 0]}"};
    static uint8_t rgb[2][3 * WIDTH * HEIGHT], alpha[2][WIDTH * HEIGHT];
    struct cs_image moving = {WIDTH, HEIGHT, rgb[0], alpha[0]};
    struct cs_image still = {WIDTH, HEIGHT, rgb[1], alpha[1]};
    for (uint32_t k = 0; k < 6; k++) {
        char camera[400];
        snprintf(camera, sizeof camera,
                 "{\"motion\": \"%s\", \"path\": [{\"at\": 0.0166666666666666667, \"eye\": [1, "
                 "0.5, 2], \"target\": [0, 0, 0]}, {\"at\": 0.05, \"eye\": [-1, 0.5, 2], "
                 "\"target\": [0.5, 0, 0]}]}",
                 k < 3 ? "linear" : "smooth");
        draw_seen(camera, 2 * (k % 3) + (k % 3 == 0) - (k % 3 == 2), &moving);
        draw_seen(there[k % 3], 1, &still);
        for (size_t i = 0; i < sizeof rgb[0]; i++)
            ck_assert_int_le(abs(rgb[0][i] - rgb[1][i]) * (alpha[1][i / 3] > 127), 3);
    }
}

/* Bodies that fall without end, slide off a table, are blown away, squeezed by plates that come
 * and go, hang behind a wall, or fall behind one; without a word of the camera. */
#define CLOTH    "\"bodies\": [{\"cloth\": {\"grid\": [8, 8], "
#define PLATE(x) "{\"box\": {\"centre\": [" x ", 0, 0], \"size\": [0.1, 1, 1]}}"
#define SQUEEZE(k, x)                                                                          \
    "{\"from\": 0, \"to\": 1, \"move\": {\"collider\": " k                                     \
    ", \"path\": [{\"at\": 0.5, \"point\": [" x                                                \
    ", 0, 0]}, {\"at\": 1, \"point\": [0, 0, 0]}]}}"
static const char *const unframed[] = {
    "{" CLOTH "\"velocity\": [1, 0, -2]}, \"mass\": {\"total\": 0.2}}]}",
    "{" CLOTH
    "\"start\": \"flat\", \"velocity\": [3, 0, 0], \"place\": {\"translate\": [0, 0.1, 0]}}, "
    "\"mass\": {\"total\": 0.2}}], \"colliders\": [{\"box\": {\"centre\": [0, -0.3, 0], "
    "\"size\": [1, 0.6, 1]}}, {\"floor\": {\"height\": -0.6}}]}",
    "{" CLOTH "\"bump\": 0.1}, \"mass\": {\"total\": 0.05}}], \"forces\": {\"wind\": "
    "{\"direction\": [-1, 0.5, 3], \"strength\": 4}}}",
    "{" CLOTH
    "\"size\": [0.5, 0.5], \"place\": {\"rotate\": [0, 0.3, 0, 1]}}, \"mass\": {\"total\": "
    "0.2}, \"pins\": [\"top\"]}], \"colliders\": [" PLATE("-0.7") ", " PLATE(
        "0.7") "], "
               "\"events\": [" SQUEEZE("0", "0.3") ", " SQUEEZE("1", "-0.3") "]}",
    "{" CLOTH "\"size\": [0.6, 0.6]}, \"mass\": {\"total\": 0.2}, \"pins\": [\"top\"]}], "
    "\"colliders\": [{\"box\": {\"centre\": [0.2, 0, 0.8], \"size\": [1.4, 1.4, 0.1]}}]}",
    "{" CLOTH
    "\"size\": [0.6, 0.6], \"start\": \"flat\", \"place\": {\"translate\": [0, 1, 0]}}, "
    "\"mass\": {\"total\": 0.2}}], \"colliders\": [{\"box\": {\"centre\": [0, 0.4, 0.6], "
    "\"size\": [1.4, 0.8, 0.1]}}, {\"box\": {\"centre\": [0, 0, 0], \"size\": [1.2, 0.1, "
    "1]}}]}"};
enum { UNFRAMED = sizeof unframed / sizeof *unframed, SQUEEZED = 3, SECOND = 60 };

/* True if the sides of a collider's box, without its turn, are met by the line from eye to p.
 */
static bool is_behind(const struct cs_posed_collider *box, const double eye[3],
                      const double p[3]) {
    double from = 0, to = 1 - 1e-3;
    for (int c = 0; c < 3; c++) {
        const double half = box->collider->box.size[c] / 2, way = p[c] - eye[c];
        const double a = (box->centre[c] - half - eye[c]) / way,
                     b = (box->centre[c] + half - eye[c]) / way;
        from = fmax(from, fmin(a, b));
        to = fmin(to, fmax(a, b));
    }
    return from < to;
}

/* Fails unless every particle is in the picture; returns how many are behind boxes. */
static uint32_t count_hidden(const struct fixture *cloth, const struct cs_view_state *view,
                             const struct cs_posed_collider *posed) {
    const struct cs_scene *scene = cloth->session.scene;
    const float *m = view->block.world_to_clip;
    uint32_t hidden = 0;
    for (size_t i = 0; i < cloth->n; i++) {
        const double p[4] = {cloth->x[i], cloth->x[cloth->n + i], cloth->x[2 * cloth->n + i],
                             1};
        double clip[4] = {0};
        bool behind = false;
        for (int k = 0; k < 16; k++)
            clip[k % 4] += (double)m[k] * p[k / 4];
        for (int c = 0; c < 3; c++)
            ck_assert_msg(fabs(clip[c]) < clip[3], "particle %zu at t = %g: %g of %g in row %d",
                          i, cloth->session.run.t, clip[c], clip[3], c);
        for (uint32_t k = 0; k < scene->colliders.n; k++)
            behind = behind || (posed[k].collider->box.present &&
                                is_behind(posed + k, view->camera.eye, p));
        hidden += behind;
    }
    return hidden;
}

/* nothing of the bodies is cut off, and obstacles before them are looked past; the camera
 * stands still as long as they stay */
TEST(a_camera_that_nobody_placed_shows_all_of_a_run) {
    for (size_t s = 0; s < UNFRAMED; s++) {
        struct fixture cloth;
        struct cs_posed_collider posed[2];
        struct cs_view_state view;
        struct cs_camera first;
        fixture_open(&cloth, "implicit-linearised", "%s", unframed[s]);
        fixture_start(&cloth);
        cs_posed_colliders_at_start(cloth.system, posed);
        const struct cs_bounding_sphere extent =
            cs_scene_extent_solid(cloth.system, cloth.x, posed);
        cs_view_init(&view, cloth.system, posed, &extent);
        first = view.camera;
        for (int k = 0; k <= SECOND; k++) {
            cs_posed_colliders_at(cloth.system, cloth.session.run.t, posed);
            const struct cs_bounding_sphere solid =
                cs_scene_extent_solid(cloth.system, cloth.x, posed);
            const struct cs_frame frame = {.t = cloth.session.run.t, .x = cloth.x};
            cs_view_move(&view, cloth.session.scene, &solid, cloth.n, &frame);
            const uint32_t hidden = count_hidden(&cloth, &view, posed);
            if (s >= SQUEEZED)
                ck_assert_msg(hidden == 0, "scene %zu, frame %d: %u hidden", s, k, hidden);
            if (s >= SQUEEZED || k == 0)
                ck_assert_mem_eq(view.camera.eye, first.eye, sizeof first.eye);
            if (k < SECOND)
                fixture_frames(&cloth, 1);
        }
        ck_assert_int_eq(first.eye[0] != view.camera.eye[0], s < SQUEEZED);
        fixture_close(&cloth);
    }
}

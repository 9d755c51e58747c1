/* Cameras that frame places: what they show reaches as far as it was asked to. */
#include "draw/camera_fit.h"
#include "scene/collider_keys.h"
#include "scene/force_keys.h"
#include "scene/picture_keys.h"
#include "unit.h"

#include <math.h>

enum { N = 500 };

/* a cloud, of no symmetry */
static void scatter(double x[3 * N]) {
    uint32_t seed = 7;
    for (size_t i = 0; i < 3 * N; i++) {
        seed = seed * 1664525u + 1013904223u;
        x[i] = (double)seed / 4294967296.0 * (1 + (double)(i / N)) - 0.3;
    }
}

static void begin(struct cs_camera_fit *fit, int32_t projection, int64_t width) {
    const struct cs_camera camera = {.eye = {1, 2, 3},
                                     .target = {0, 0.5, 0},
                                     .up = {0, 1, 0},
                                     .fov = 35,
                                     .projection = projection};
    cs_camera_fit_begin(fit, &camera, &(const struct cs_render){.size = {width, 480}});
}

/* highest and lowest place at the share that was asked for; the view keeps its direction */
TEST(places_reach_as_far_as_they_should) {
    double x[3 * N], rows[2];
    scatter(x);
    for (int32_t projection = 0; projection < 2; projection++)
        for (double share = 0.3; share < 1; share += 0.2) {
            struct cs_camera_fit fit;
            struct cs_camera camera;
            begin(&fit, projection, 2000);
            cs_camera_fit_solve(&fit, N, x, share, &camera);
            cs_camera_fit_rows(&fit, &camera, N, x, rows);
            ck_assert_double_eq_tol(rows[0], -share, 1e-12);
            ck_assert_double_eq_tol(rows[1], share, 1e-12);
            const double lean =
                (camera.eye[1] - camera.target[1]) /
                hypot(camera.eye[0] - camera.target[0], camera.eye[2] - camera.target[2]);
            ck_assert_double_eq_tol(lean, 1.5 / sqrt(10), 1e-12);
        }
}

/* a picture that is narrow is filled from side to side, and its height less than was asked */
TEST(a_narrow_picture_is_full_in_its_width) {
    struct cs_camera_fit fit;
    struct cs_camera camera;
    double x[3 * N], rows[2];
    scatter(x);
    begin(&fit, CS_PROJECTION_PERSPECTIVE, 160);
    cs_camera_fit_solve(&fit, N, x, 0.9, &camera);
    cs_camera_fit_rows(&fit, &camera, N, x, rows);
    ck_assert_double_lt(rows[1] - rows[0], 1.2);
    ck_assert_double_gt(rows[1] - rows[0], 0.2);
}

/* those that bound a cloud give its camera to a hundredth, and what is not finite counts not */
TEST(extremes_stand_for_all) {
    struct cs_camera_fit fit;
    struct cs_camera camera;
    double x[3 * N], few[3 * CS_CAMERA_FIT_EXTREMES], rows[2];
    scatter(x);
    x[3] = (double)NAN;
    x[N + 4] = HUGE_VAL;
    begin(&fit, CS_PROJECTION_PERSPECTIVE, 640);
    cs_camera_fit_extremes(&fit, N, x, few);
    cs_camera_fit_solve(&fit, CS_CAMERA_FIT_EXTREMES, few, 0.6, &camera);
    x[3] = x[N + 4] = 0.2;
    cs_camera_fit_rows(&fit, &camera, N, x, rows);
    ck_assert_double_eq_tol(rows[1] - rows[0], 1.2, 0.012);
}

/* The camera of a scene that names none shows the box of the start, and the floor below it. */
TEST(the_start_is_in_the_picture) {
    struct cs_collider floor = {.floor = {.present = true, .height = -2}};
    const double low[3] = {4, 0, -1}, high[3] = {6, 2, 1};
    struct cs_scene scene = {.camera = &(struct cs_camera){.frame = CS_FRAME_START,
                                                           .eye = {1, 2, 3},
                                                           .up = {0, 1, 0},
                                                           .fov = 40},
                             .render = &(struct cs_render){.size = {640, 480}},
                             .forces = &(struct cs_forces){.gravity = {0, -9.81, 0}},
                             .colliders = {.items = &floor, .n = 0}};
    const struct cs_system system = {.scene = &scene};
    const struct cs_posed_collider posed = {.collider = &floor};
    for (uint32_t n = 0; n < 2; n++) {
        struct cs_camera_fit fit;
        struct cs_camera camera;
        double rows[2];
        scene.colliders.n = n;
        cs_camera_fit_start(&fit, &system, &posed, low, high);
        cs_camera_fit_picture(&fit, &posed, 0, NULL, &camera);
        for (int k = 0; k < 8; k++) {
            // the lower side is narrower by half of the depth, and by a quarter at most
            const double in = k & 2 ? 0 : 0.5;
            const double corner[3] = {k & 1 ? 4 + in : 6 - in,
                                      k & 2 ? 2
                                      : n   ? -2
                                            : -1,
                                      k & 4 ? -1 + in : 1 - in};
            cs_camera_fit_rows(&fit, &camera, 1, corner, rows);
            ck_assert_msg(fabs(rows[0]) <= 0.9 + 1e-9, "corner %d at %g", k, rows[0]);
        }
    }
}

/* The camera of the start where a ball of 0.5 m, below a particle, goes by `to` along x, at the
 * time when the ball is at `at`. */
static struct cs_camera camera_of(double to, double at) {
    struct cs_path_point point = {.at = 1, .point = {to, 0, 0}};
    struct cs_event event = {
        .at = (double)NAN,
        .move = {.present = true, .relative = true, .path = {.items = &point, .n = 1}}};
    struct cs_collider ball = {.visible = true};
    const struct cs_scene scene = {.camera = &(struct cs_camera){.frame = CS_FRAME_START,
                                                                 .eye = {0, 0, 3},
                                                                 .up = {0, 1, 0},
                                                                 .fov = 40},
                                   .render = &(struct cs_render){.size = {640, 480}},
                                   .forces = &(struct cs_forces){.drag = 0},
                                   .colliders = {.items = &ball, .n = 1},
                                   .events = {.items = &event, .n = 1}};
    const double particle[3] = {0, 2, 0};
    const struct cs_system system = {.scene = &scene, .view = {.n = 1, .start = particle}};
    struct cs_posed_collider posed = {
        .collider = &ball, .shape = &cs_shape_sphere, .radius = 0.5};
    const double low[3] = {-0.5, -0.5, -0.5}, high[3] = {0.5, 2, 0.5};
    struct cs_camera_fit fit;
    struct cs_camera camera;
    cs_camera_fit_start(&fit, &system, &posed, low, high);
    posed.centre[0] = at;
    cs_camera_fit_picture(&fit, &posed, 0, NULL, &camera);
    return camera;
}

/* The whole of a short path, from -0.5 m to 1.4 m, is in the middle of all pictures. */
TEST(what_moves_later_is_in_the_picture) {
    ck_assert_double_eq_tol(camera_of(0.9, 0).target[0], 0.45, 1e-9);
    ck_assert_double_eq_tol(camera_of(0.9, 0.9).target[0], 0.45, 1e-9);
}

/* On a path of many times its size the camera goes with the ball, at the distance of the start.
 */
TEST(the_camera_follows_what_goes_far) {
    const struct cs_camera first = camera_of(30, 0), later = camera_of(30, 7);
    ck_assert_double_eq_tol(first.target[0], 0, 1e-9);
    ck_assert_double_eq_tol(later.target[0], 7, 1e-9);
    ck_assert_double_eq_tol(later.eye[2], first.eye[2], 1e-9);
    ck_assert_double_lt(first.eye[2], 6);
}

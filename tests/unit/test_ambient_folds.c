/* How deep vertices lie in folds, against grooves whose curvature is known. */
#include "draw/mesh.h"
#include "scene/body_keys.h"
#include "scene/picture_keys.h"
#include "unit.h"

#include <math.h>

enum { SIDE = 21, N = SIDE * SIDE, MIDDLE = N / 2 };

/* a grid of 1 m bent to a cylinder of radius r about the y axis, 0: flat; its front inside */
static void bend(double r, double x[3 * N]) {
    for (int i = 0; i < N; i++) {
        const double s = (i % SIDE) / (SIDE - 1.0) - 0.5;
        x[i] = r > 0 ? r * sin(s / r) : s;
        x[N + i] = 0.5 - (i / SIDE) / (SIDE - 1.0);
        x[2 * N + i] = r > 0 ? r - r * cos(s / r) : 0;
    }
}

static void update(struct cs_mesh *mesh, const double *x, struct cs_arena *arena) {
    static struct cs_body body = {.cloth = {.present = true, .grid = {SIDE, SIDE}}};
    static struct cs_render render;
    static struct cs_scene scene = {.bodies = {&body, 1}, .render = &render};
    static struct cs_body_range range = {0, N, SIDE, SIDE, NULL};
    static double start[3 * N];
    struct cs_error error = {0};
    bend(0, start);
    const struct cs_system system = {
        .scene = &scene, .bodies = &range, .view = {.n = N, .start = start}};
    const struct cs_frame frame = {.x = x};
    *mesh = (struct cs_mesh){.n_vertices = 0};
    cs_mesh_init(mesh, &system, 0, false, arena, &error);
    UNIT_ASSERT_OK(&error);
    cs_mesh_update(mesh, N, &frame);
}

/* a tenth of the diagonal away the walls of a groove of radius r rise by reach / 2 r */
TEST(grooves_have_the_slope_of_their_walls) {
    static double x[3 * N];
    for (double r = 0.3; r < 3; r *= 2) {
        struct cs_arena arena = {0};
        struct cs_mesh mesh;
        bend(r, x);
        update(&mesh, x, &arena);
        const double expected = 0.1 * sqrt(2) / (2 * r);
        ck_assert_double_eq_tol((double)mesh.vertices[MIDDLE].value, expected, 0.01 * expected);
        // seen from the other side it is a ridge
        for (int i = 0; i < N; i++)
            x[2 * N + i] = -x[2 * N + i];
        cs_mesh_update(&mesh, N, &(struct cs_frame){.x = x});
        ck_assert_double_eq_tol((double)mesh.vertices[MIDDLE].value, -expected,
                                0.01 * expected);
        cs_arena_finish(&arena);
    }
}

/* what is flat has no folds, at its border neither, however it is turned */
TEST(a_plane_has_no_folds) {
    static double x[3 * N];
    struct cs_arena arena = {0};
    struct cs_mesh mesh;
    bend(0, x);
    for (int i = 0; i < N; i++)
        x[2 * N + i] = 0.7 * x[i] - 0.4 * x[N + i];
    update(&mesh, x, &arena);
    for (int i = 0; i < N; i++)
        UNIT_ASSERT_OFTEN(fabs((double)mesh.vertices[i].value) < 1e-12);
    cs_arena_finish(&arena);
}

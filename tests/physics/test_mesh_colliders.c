/* Colliders that are meshes: against a pinned body of the same triangles, in a frame that moves
 * with them, on their paths, by order, derivative and count. */
#include "methods.h"

#include "model/contact/ccd/accd.h"
#include "model/contact/ccd/crossings.h"
#include "model/contact/contact_samples.h"
#include "model/contact/narrow_phase/contact_pairs.h"
#include "model/contact/posed_collider.h"
#include "model/force/terms.h"
#include "model/plan.h"
#include "scene/file/scene_read.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* a sheet above a ring; %s: its velocity, and what the ring is */
#define SHEET                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [7, 6], \"size\": [0.9, 0.8], \"start\": \"flat\","  \
    " \"place\": {\"translate\": [0.05, 0.25, 0.02], \"rotate\": [0.02, 0.1, 0.01, 1]},"       \
    " \"velocity\": [%s]}, \"mass\": {\"particle\": 0.02}, \"thickness\": 0.06,"               \
    " \"springs\": {\"stretch\": 60, \"shear\": 20, \"bend\": 2, \"damping\": 0.02}}"
#define RING                                                                                   \
    "\"mesh\": {\"shape\": \"torus\", \"detail\": 5, \"scale\": [0.8, 0.8, 0.8],"              \
    " \"place\": {\"translate\": [0, 0.05, 0], \"rotate\": [1, 0, 0.2, 1]}}"
#define REST                                                                                   \
    "\"contact\": {\"law\": \"force\", \"stiffness\": 60, \"damping\": 0.002,"                 \
    " \"friction_speed\": 0.05}"
#define ON_COLLIDER                                                                            \
    SHEET "], \"colliders\": [{\"floor\": {\"height\": -9}}, {" RING                           \
          ", \"friction\": 0.4, \"thickness\": 0.06}], \"forces\": {\"gravity\": [0, -9, "     \
          "0]}, " REST ", \"events\": [%s]}"
#define ON_BODY                                                                                \
    SHEET ", {" RING ", \"mass\": {\"total\": 1}, \"springs\": {\"stretch\": 0, \"bend\": 0}," \
          " \"thickness\": 0.06, \"pins\": [{\"box\": {\"min\": [-9, -9, -9], \"max\": [9, 9," \
          " 9]}}]}], \"pairs\": {\"among\": \"all\", \"friction\": 0.4},"                      \
          " \"forces\": {\"gravity\": [0, -9, 0]}, " REST "}"

enum { SHEET_N = 42, FRAMES = 10 };

/* --- against what there was before --- */

TEST(it_is_a_pinned_body) {
    static const char *const methods[] = {"velocity-verlet:dt=1e-3", "rk4:dt=2e-3",
                                          "implicit-linearised:dt=4e-3", "xpbd:dt=2e-3"};
    for (size_t m = 0; m < LENGTH(methods); m++) {
        struct fixture one, other;
        fixture_open(&one, methods[m], ON_COLLIDER, "0.3, -1, 0", "");
        fixture_open(&other, methods[m], ON_BODY, "0.3, -1, 0");
        ck_assert_uint_eq(one.n, SHEET_N);
        fixture_start(&one);
        fixture_start(&other);
        fixture_frames(&one, FRAMES);
        fixture_frames(&other, FRAMES);
        ck_assert_uint_gt(one.system->pairs->current_contacts->n, 10);
        // bit by bit, where the solver's sums go over the same particles
        double most = 0;
        for (size_t c = 0; c < 3; c++)
            for (size_t i = 0; i < SHEET_N; i++)
                most = fmax(most, fabs(one.x[c * one.n + i] - other.x[c * other.n + i]));
        ck_assert_msg(m < 2 ? most == 0 : most < 2e-4, "%s: %.3g m", methods[m], most);
        fixture_close(&one);
        fixture_close(&other);
    }
}

/* --- on the move --- */

/* Friction and damping depend on velocities against each other alone: a ring that comes at u is
 * a sheet that goes at -u. */
TEST(only_relative_motion_counts) {
    struct fixture still, moved;
    const char *method = "rk4:dt=1e-3";
    fixture_open(&still, method, ON_COLLIDER, "0.3, -1, 0", "");
    fixture_open(&moved, method, ON_COLLIDER, "0.8, -0.5, 0.25",
                 "{\"at\": 0, \"move\": {\"collider\": 1, \"path\": [{\"at\": 2, \"point\": "
                 "[1, 1, 0.5]}]}}");
    fixture_start(&still);
    fixture_start(&moved);
    fixture_frames(&still, FRAMES);
    fixture_frames(&moved, FRAMES);
    const double u[3] = {0.5, 0.5, 0.25}, t = FRAMES / 60.0;
    ck_assert_uint_gt(still.system->pairs->current_contacts->n, 10);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < SHEET_N; i++) {
            const size_t k = c * SHEET_N + i;
            ck_assert_double_eq_tol(moved.x[k] - t * u[c], still.x[k], 1e-9);
            ck_assert_double_eq_tol(moved.v[k] - u[c], still.v[k], 1e-7);
        }
    fixture_close(&still);
    fixture_close(&moved);
}

/* Rodrigues' formula with libm's sine, and differences for the velocity */
TEST(points_turn_with_it) {
    struct fixture cloth;
    static double before[3 * 400], after[3 * 400], v[3 * 400];
    const double w[3] = {0.3, 1.1, -0.4}, t = 0.7, h = 1e-6;
    fixture_open(&cloth, "rk4:dt=0.01", ON_COLLIDER, "0, 0, 0",
                 "{\"at\": 0, \"move\": {\"collider\": 1, \"spin\": [0.3, 1.1, -0.4], "
                 "\"path\": [{\"at\": 2, \"point\": [1, 1, 0.5]}]}}");
    fixture_start(&cloth);
    fixture_frames(&cloth, 1);
    const struct cs_system *system = cloth.system;
    const size_t n = system->surfaces->n_points;
    ck_assert(n > SHEET_N && n <= 400);
    const double *p = cs_surface_points_positions(system, CS_POINTS_BEGIN, 0, cloth.x);
    double start[3] = {p[n - 1], p[2 * n - 1], p[3 * n - 1]};
    memcpy(before, cs_surface_points_positions(system, CS_POINTS_BEGIN, t - h, cloth.x),
           3 * n * sizeof *p);
    memcpy(after, cs_surface_points_positions(system, CS_POINTS_END, t + h, cloth.x),
           3 * n * sizeof *p);
    memcpy(v, cs_surface_points_velocities(system, t, cloth.v), 3 * n * sizeof *p);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++) {
            const double slope = (after[c * n + i] - before[c * n + i]) / (2 * h);
            const double expected = i < SHEET_N ? cloth.v[c * SHEET_N + i] : slope;
            ck_assert_double_eq_tol(v[c * n + i], expected, 1e-8);
        }
    p = cs_surface_points_positions(system, CS_POINTS_BEGIN, t, cloth.x);
    const double centre[3] = {0, 0.05, 0}, shift[3] = {t / 2, t / 2, t / 4};
    const double speed = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]), angle = speed * t;
    double arm[3], along = 0;
    for (int c = 0; c < 3; c++) {
        arm[c] = start[c] - centre[c];
        along += w[c] / speed * arm[c];
    }
    for (int c = 0; c < 3; c++) {
        const int d = (c + 1) % 3, e = (c + 2) % 3;
        const double across = (w[d] * arm[e] - w[e] * arm[d]) / speed;
        const double turned =
            cos(angle) * arm[c] + sin(angle) * across + (1 - cos(angle)) * along * w[c] / speed;
        ck_assert_double_eq_tol(p[(size_t)(c + 1) * n - 1], centre[c] + shift[c] + turned,
                                1e-13);
    }
    fixture_close(&cloth);
}

#define SPIN "{\"at\": 0, \"move\": {\"collider\": %d, \"spin\": [0, 3, 0.5]}}"

/* a sheet that comes down slowly on a ball that turns below it, with friction */
#define BALL                                                                                   \
    "{\"bodies\": [{\"cloth\": {\"grid\": [7, 6], \"size\": [0.9, 0.8], \"start\": \"flat\","  \
    " \"place\": {\"translate\": [0.05, 0.25, 0.02], \"rotate\": [0.02, 0.1, 0.01, 1]},"       \
    " \"velocity\": [0.1, -0.3, 0]}, \"mass\": {\"particle\": 0.02}, \"springs\": "            \
    "{\"stretch\": 60, \"shear\": 20, \"bend\": 2, \"damping\": 0.02}}], \"colliders\": "      \
    "[{\"mesh\": {\"shape\": \"sphere\", \"detail\": 3, \"scale\": [0.8, 0.8, 0.8], "          \
    "\"place\": {\"translate\": [0, -0.19, 0]}}, \"friction\": 0.4, \"thickness\": 0.04}],"    \
    " \"contact\": {\"law\": \"force\", \"stiffness\": 60, \"damping\": 0.002,"                \
    " \"friction_speed\": 0.5}, \"events\": [" SPIN "]}"

static void end_state(const char *name, double h, double state[6 * SHEET_N]) {
    struct fixture cloth;
    char integrator[120];
    methods_set(integrator, name, "dt", h);
    fixture_open(&cloth, integrator, BALL, 0);
    fixture_start(&cloth);
    fixture_frames(&cloth, 6);
    ck_assert_uint_gt(cloth.system->pairs->current_contacts->n, 10);
    memcpy(state, cloth.x, 6 * SHEET_N * sizeof *state);
    fixture_close(&cloth);
}

/* each its own order, to the fourth */
TEST(orders_hold_on_a_turning_mesh) {
    methods_check_mesh_orders("turning mesh", end_state, 6 * SHEET_N, 1.0 / 2400, 1.0 / 2400,
                              1.0 / 600);
}

/* --- a slope of triangles --- */

/* a sheet turned by 17 degrees on the top of a box, with gravity along it */
#define SLOPE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [9, 9], \"size\": [0.4, 0.4], \"start\": \"flat\", " \
    "\"place\": {\"translate\": [-0.6, 0.0155, 0.013], \"rotate\": [0, 0.15, 0, 1]}}, "        \
    "\"mass\": {\"areal_density\": 0.3}, \"springs\": {\"stretch\": 60, \"shear\": 20, "       \
    "\"bend\": 1, \"damping\": 0.02}}], \"colliders\": [{\"mesh\": {\"shape\": \"box\", "      \
    "\"detail\": 6, \"scale\": [2, 0.1, 1], \"place\": {\"translate\": [0, -0.05, 0]}}, "      \
    "\"friction\": %g, \"thickness\": 0.02}], \"contact\": {\"law\": \"force\", "              \
    "\"damping\": 0.001, \"friction_speed\": 0.05}, \"forces\": {\"gravity\": [%.17g, %.17g, " \
    "0]}}"

/* m/s2 along the slope, from frame 10 to 30 */
static double slide(double mu, double tangent) {
    const double cosine = 1 / sqrt(1 + tangent * tangent), g = 9.81;
    double speed[2] = {0};
    struct fixture cloth;
    fixture_open(&cloth, "rk4:dt=2e-3", SLOPE, mu, g * tangent * cosine, -g * cosine);
    fixture_start(&cloth);
    for (uint32_t part = 0; part < 2; part++) {
        fixture_frames(&cloth, 10 + 10 * part);
        for (size_t i = 0; i < cloth.n; i++)
            speed[part] += cloth.v[i] / (double)cloth.n;
    }
    fixture_close(&cloth);
    return (speed[1] - speed[0]) / (20 / 60.0);
}

/* g cos a (tan a - mu): edges and corners of the mesh take less than 0.001 g without friction,
 * and give nothing */
TEST(slope_of_triangles_is_a_slope) {
    const double g = 9.81;
    double expected = g * (0.5 - 0.3) / sqrt(1 + 0.25), found = slide(0.3, 0.5);
    ck_assert_msg(fabs(found - expected) < 0.002 * g, "%.5g, not %.5g", found, expected);
    expected = g * 0.1 / sqrt(1 + 0.01);
    found = slide(0, 0.1);
    ck_assert_msg(expected - found < 0.001 * g && found - expected < 0.001 * g,
                  "%.5g, not %.5g", found, expected);
}

/* --- the derivative --- */

TEST(derivative_knows_the_moving_mesh) {
    struct fixture cloth;
    enum { N = 3 * SHEET_N };
    static double d[2 * N], f[2][N], df[N], x[2][N], v[2][N];
    const double h = 1e-7;
    fixture_open(&cloth, "rk4:dt=1e-3", BALL, 0);
    fixture_start(&cloth);
    fixture_frames(&cloth, 9);
    struct cs_system alone = *cloth.system;
    alone.terms[0] = &cs_term_pairs;
    alone.n_terms = 1;
    for (int k = 0; k < 2 * N; k++)
        d[k] = sin(1.3 * k);
    for (int s = 0; s < 2; s++) {
        for (int k = 0; k < N; k++) {
            x[s][k] = cloth.x[k] + (s ? h : -h) * d[k];
            v[s][k] = cloth.v[k] + (s ? h : -h) * d[N + k];
        }
        cs_terms_force(&alone,
                       &(struct cs_eval){.t = 0.15, .x = x[s], .v = v[s], .parts = CS_PART_ALL},
                       f[s]);
    }
    ck_assert_uint_gt(cloth.system->pairs->current_contacts->n, 10);
    cs_terms_jvp(
        &alone,
        &(struct cs_eval){
            .t = 0.15, .x = cloth.x, .v = cloth.v, .dx = d, .dv = d + N, .parts = CS_PART_ALL},
        df);
    double most = 0, wrong = 0;
    for (int k = 0; k < N; k++) {
        most = fmax(most, fabs(df[k]));
        wrong = fmax(wrong, fabs((f[1][k] - f[0][k]) / (2 * h) - df[k]));
    }
    ck_assert_msg(most > 1 && wrong < 1e-6 * most, "%.3g of %.3g", wrong, most);
    fixture_close(&cloth);
}

/* --- the count, and what is not there --- */

/* two triangles about a needle, which goes through one of them; a rod and a block far below go
 * through each other */
#define NEEDLE                                                                                 \
    "{\"bodies\": [{\"cloth\": {\"grid\": [2, 2], \"start\": \"flat\", \"place\": "            \
    "{\"translate\": [0.2, 0.3, 0.1]}}, \"mass\": {\"total\": 1}, \"self_contact\": true}], "  \
    "\"colliders\": "                                                                          \
    "[{\"mesh\": "                                                                             \
    "{\"shape\": \"box\", \"detail\": 3, \"scale\": [0.03, 0.4, 0.03]}, \"thickness\": "       \
    "0.02}, {\"mesh\": {\"shape\": \"box\", \"detail\": 3, \"scale\": [0.5, 0.02, 0.02], "     \
    "\"place\": {\"translate\": [0, -0.6, 0], \"rotate\": [0, 1, 0, 2]}}}, {\"mesh\": "        \
    "{\"shape\": \"box\", \"detail\": 3, \"scale\": [0.1, 0.1, 0.1], \"place\": "              \
    "{\"translate\": [0, -0.6, 0]}}}, {\"floor\": {\"height\": -9}}], \"crossings\": "         \
    "\"%s\", \"contact\": \"force\", "                                                         \
    "\"events\": [{\"at\": 0, \"move\": {\"collider\": 0, \"path\": [{\"at\": 1, \"point\": "  \
    "[0, 0.6, 0]}]}}]}"

TEST(crossings_are_counted_and_foreseen) {
    static const char *const policies[] = {"count", "limit"};
    for (size_t p = 0; p < LENGTH(policies); p++) {
        struct fixture net;
        double to[12];
        fixture_open(&net, "rk4:dt=0.01", NEEDLE, policies[p]);
        fixture_start(&net);
        const struct cs_system *system = net.system;
        ck_assert_uint_eq(net.n, 4);
        memcpy(to, net.x, sizeof to);
        // obstacles go through each other as they like
        ck_assert_uint_eq(cs_crossings_count(system, 0, net.x).n, 0);
        ck_assert_double_eq(cs_crossings_safe_fraction(system, 0, net.x, 0, to), 1);
        for (int i = 0; i < 4; i++)
            to[4 + i] = 0.17;
        // the needle ends at 0.2: 8 edges along its sides, and 8 across them
        const struct cs_crossing_count found = cs_crossings_count(system, 0, to);
        ck_assert_uint_ge(found.n, 8);
        const double share = cs_crossings_safe_fraction(system, 0, net.x, 0, to);
        ck_assert_msg(share < 0.1 / 0.13 && share > 0.6, "%.3g", share);
        struct cs_text text = {0};
        cs_crossings_print(system, &found, &text);
        ck_assert_msg(strstr(cs_text_get(&text), "vertex ") &&
                          strstr(cs_text_get(&text), " of colliders[0]"),
                      "%s", cs_text_get(&text));
        cs_text_finish(&text);
        fixture_close(&net);
    }
}

/* the sheet stays where it is, and the needle comes: at t = 1 it is 0.6 m higher */
TEST(what_comes_is_foreseen) {
    struct fixture net;
    fixture_open(&net, "rk4:dt=0.01", NEEDLE, "limit");
    fixture_start(&net);
    // the first event is at 0
    fixture_frames(&net, 1);
    for (int i = 0; i < 4; i++)
        net.x[4 + i] = 0.3;
    const double share = cs_crossings_safe_fraction(net.system, 1.0 / 60, net.x, 0.5, net.x);
    const double whole = 0.6 * (0.5 - 1.0 / 60), gap = 0.1 - 0.6 / 60;
    ck_assert_msg(share < gap / whole && share > 0.8 * gap / whole, "%.3g", share);
    ck_assert_uint_eq(cs_crossings_count(net.system, 1.0 / 60, net.x).n, 0);
    ck_assert_uint_gt(cs_crossings_count(net.system, 0.5, net.x).n, 0);
    // the list of contact, which covers the shorter ways, says what the search says; it once
    // did not serve scenes with a floor beside mesh colliders
    struct cs_system *system = net.system;
    struct cs_pairs *pairs = system->pairs;
    uint32_t cut = 0, covered = 0;
    for (int k = 1; k < 30; k++) {
        const double t = (1.0 + k) / 60;
        system->pairs = pairs;
        covered += cs_crossings_list_suffices(
            system, cs_surface_points_positions(system, CS_POINTS_BEGIN, 1.0 / 60, net.x),
            cs_surface_points_positions(system, CS_POINTS_END, t, net.x));
        const double listed = cs_crossings_safe_fraction(system, 1.0 / 60, net.x, t, net.x);
        system->pairs = NULL;
        ck_assert_double_eq(cs_crossings_safe_fraction(system, 1.0 / 60, net.x, t, net.x),
                            listed);
        cut += listed < 1;
    }
    ck_assert_uint_gt(cut, 10);
    ck_assert_uint_gt(covered, 5);
    system->pairs = pairs;
    fixture_close(&net);
}

TEST(others_pay_nothing) {
    struct fixture cloth;
    fixture_open(&cloth, "rk4:dt=0.01",
                 SHEET "], \"colliders\": [{\"floor\": {\"height\": -9}}], " REST "}",
                 "0, 0, 0");
    ck_assert_ptr_null(cloth.system->points);
    ck_assert_ptr_null(cloth.system->surfaces);
    ck_assert_ptr_null(cloth.system->pairs);
    fixture_start(&cloth);
    fixture_close(&cloth);
    fixture_open(&cloth, "rk4:dt=0.01", ON_BODY, "0, 0, 0");
    ck_assert_ptr_null(cloth.system->points);
    ck_assert_ptr_eq(cs_surface_points_positions(cloth.system, CS_POINTS_BEGIN, 0, cloth.x),
                     cloth.x);
    ck_assert_uint_eq(cloth.system->surfaces->n_points, cloth.n);
    fixture_start(&cloth);
    fixture_close(&cloth);
}

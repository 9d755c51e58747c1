/* Colliders whose vertices follow key frames: against the same motion by events, in frames that
 * move, by velocity, order, count and energy. */
#include "key_frame_file.h"
#include "methods.h"

#include "base/vec3.h"
#include "model/contact/ccd/crossings.h"
#include "model/contact/contact_samples.h"
#include "model/contact/narrow_phase/contact_pairs.h"
#include "model/contact/posed_collider.h"
#include "sim/energy_ledger.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FRAMES = 10 };

/* --- against events --- */

/* a sheet above a ring; %s: its velocity, what moves the ring by key frames, by events */
#define RING                                                                                   \
    "{\"bodies\": [{\"cloth\": {\"grid\": [7, 6], \"size\": [0.9, 0.8], \"start\": \"flat\","  \
    " \"place\": {\"translate\": [0.05, 0.25, 0.02], \"rotate\": [0.02, 0.1, 0.01, 1]},"       \
    " \"velocity\": [%s]}, \"mass\": {\"particle\": 0.02}, \"thickness\": 0.06,"               \
    " \"springs\": {\"stretch\": 60, \"shear\": 20, \"bend\": 2, \"damping\": 0.02}}],"        \
    " \"colliders\": [{\"floor\": {\"height\": -9}}, {\"mesh\": {\"shape\": \"torus\", "       \
    "\"detail\": 5, \"scale\": [0.8, 0.8, 0.8], \"place\": {\"translate\": [0, 0.05, 0], "     \
    "\"rotate\": [1, 0, 0.2, 1]}%s}, \"friction\": 0.4, \"thickness\": 0.06}], \"forces\": "   \
    "{\"gravity\": [0, -9, 0]}, \"contact\": {\"law\": \"force\", \"stiffness\": 60, "         \
    "\"damping\": 0.002, \"friction_speed\": 0.05}, \"events\": [%s]}"
#define KEYS(file, rate, end)                                                                  \
    ", \"key_frames\": {\"file\": \"" file "\", \"rate\": " #rate ", \"end\": \"" end "\"}"

enum { SHEET_N = 42 };

/* what place and scale of the ring make of it: (0.5, 0.5, 0.25) m/s in the world */
static const double along_world[3] = {0.5, 0.5, 0.25};

static void along_ring(double t, const double p[3], double x[3]) {
    // the inverse of the rotation by the quaternion (1, 0, 0.2, 1) over its length, 2.04
    // squared
    const double q[4] = {1, 0, 0.2, 1}, s = 2.04;
    const double r[3][3] = {
        {1 - 2 * (q[1] * q[1] + q[2] * q[2]) / s, 2 * (q[0] * q[1] - q[2] * q[3]) / s,
         2 * (q[0] * q[2] + q[1] * q[3]) / s},
        {2 * (q[0] * q[1] + q[2] * q[3]) / s, 1 - 2 * (q[0] * q[0] + q[2] * q[2]) / s,
         2 * (q[1] * q[2] - q[0] * q[3]) / s},
        {2 * (q[0] * q[2] - q[1] * q[3]) / s, 2 * (q[1] * q[2] + q[0] * q[3]) / s,
         1 - 2 * (q[0] * q[0] + q[1] * q[1]) / s}};
    for (int c = 0; c < 3; c++) {
        x[c] = p[c];
        for (int d = 0; d < 3; d++)
            x[c] += t * r[d][c] * along_world[d] / 0.8;
    }
}

/* Key frames on a straight way are an event that moves the collider. */
TEST(straight_keys_are_a_move) {
    const struct methods methods = methods_find(
        &(struct methods_query){.test = "moved keys",
                                .without = CS_ADAPTIVE | CS_EXPLICIT_OUTER | CS_NOT_GALILEAN,
                                .residual = 1e-12});
    write_keys("ring.npz", CS_MESH_TORUS, 5, along_ring, 5, 10);
    for (size_t m = 0; m < methods.n; m++) {
        struct fixture by_keys, by_event;
        double most = 0;
        fixture_open(&by_keys, methods.list[m].text, RING, "0.8, -0.5, 0.25",
                     KEYS("ring.npz", 10, "continue"), "");
        fixture_open(&by_event, methods.list[m].text, RING, "0.8, -0.5, 0.25", "",
                     "{\"at\": 0, \"move\": {\"collider\": 1, \"path\": [{\"at\": 2, "
                     "\"point\": [1, 1, 0.5]}]}}");
        fixture_start(&by_keys);
        fixture_start(&by_event);
        fixture_frames(&by_keys, FRAMES);
        fixture_frames(&by_event, FRAMES);
        ck_assert_uint_gt(by_keys.system->pairs->current_contacts->n, 10);
        for (size_t k = 0; k < 3 * SHEET_N; k++)
            most = fmax(most, fabs(by_keys.x[k] - by_event.x[k]));
        ck_assert_msg(most < 1e-6, "%s: %.3g m", methods.list[m].text, most);
        ck_assert_uint_eq(by_keys.session.run.counts.steps, by_event.session.run.counts.steps);
        fixture_close(&by_keys);
        fixture_close(&by_event);
    }
}

/* --- velocity --- */

/* of period 1 s */
static void wobble(double t, const double p[3], double x[3]) {
    const double turn = 2 * 3.14159265358979324;
    const double size = 1 + 0.08 * sin(turn * t + 3 * p[0]);
    x[0] = size * p[0] + 0.04 * sin(turn * t);
    x[1] = p[1] + 0.04 * sin(turn * t + 4 * p[2]);
    x[2] = size * p[2];
}

/* Differences of positions give the velocities, with key frames, a path and a spin at once; and
 * the vertex that others ask for is that of the surface. */
TEST(velocities_are_those_of_the_positions) {
    struct fixture cloth;
    static double before[3 * 400], after[3 * 400], v[3 * 400];
    const double t = 0.733, h = 1e-6;
    write_keys("wobble.npz", CS_MESH_TORUS, 5, wobble, 20, 20);
    fixture_open(&cloth, "rk4:dt=0.01", RING, "0, 0, 0", KEYS("wobble.npz", 20, "loop"),
                 "{\"at\": 0, \"move\": {\"collider\": 1, \"spin\": [0.3, 1.1, -0.4], "
                 "\"path\": [{\"at\": 2, \"point\": [1, 1, 0.5]}]}}");
    fixture_start(&cloth);
    fixture_frames(&cloth, 1);
    const struct cs_system *system = cloth.system;
    const size_t n = system->surfaces->n_points;
    ck_assert(n > SHEET_N && n <= 400);
    memcpy(before, cs_surface_points_positions(system, CS_POINTS_BEGIN, t - h, cloth.x),
           3 * n * sizeof *v);
    memcpy(after, cs_surface_points_positions(system, CS_POINTS_END, t + h, cloth.x),
           3 * n * sizeof *v);
    memcpy(v, cs_surface_points_velocities(system, t, cloth.v), 3 * n * sizeof *v);
    struct cs_posed_collider ring;
    cs_posed_collider_at(system, 1, t, &ring);
    double fastest = 0;
    for (size_t i = SHEET_N; i < n; i++) {
        double p[3], w[3];
        cs_posed_collider_vertex(&ring, (uint32_t)(i - SHEET_N), p, w);
        for (size_t c = 0; c < 3; c++) {
            const double slope = (after[c * n + i] - before[c * n + i]) / (2 * h);
            ck_assert_double_eq_tol(v[c * n + i], slope, 1e-8);
            ck_assert_double_eq(v[c * n + i], w[c]);
            fastest = fmax(fastest, fabs(w[c]));
        }
    }
    ck_assert_double_gt(fastest, 0.3);
    fixture_close(&cloth);
}

/* --- relative motion --- */

/* m/s by which the frame moves against the one of the sheet */
static double drift[3];

static void wobble_and_drift(double t, const double p[3], double x[3]) {
    wobble(t, p, x);
    for (int c = 0; c < 3; c++)
        x[c] = 0.3 * x[c] + t * drift[c];
}

/* a sheet above a ball; %s: its velocity, stiffness, range */
#define BALL                                                                                   \
    "{\"bodies\": [{\"cloth\": {\"grid\": [5, 4], \"size\": [0.24, 0.18], \"start\": "         \
    "\"flat\", \"place\": {\"translate\": [0.01, 0.21, 0.004], \"rotate\": [0.02, 0.1, 0.01, " \
    "1]}, \"velocity\": [%g, %g, %g]}, \"mass\": {\"particle\": 0.002}, \"thickness\": 0.02,"  \
    " \"springs\": {\"stretch\": 50, \"shear\": 20, \"bend\": 1, \"damping\": 0.01}}],"        \
    " \"colliders\": [{\"mesh\": {\"shape\": \"sphere\", \"detail\": 3" KEYS(                  \
        "ball.npz", 40,                                                                        \
        "continue") "}, \"friction\": 0.3, \"thickness\": 0.02}],"                             \
                    " \"contact\": {\"law\": \"force\", \"stiffness\": %g, \"damping\": 1e-4," \
                    " \"friction_speed\": 0.05}}"

/* The sheet thrown at a ball that deforms is the sheet at rest at which the ball is thrown. */
static void compare(const char *method, double stiffness, const double u[3]) {
    struct fixture thrown, at_rest;
    const uint32_t frames = 5;
    double most = 0;
    size_t met = 0;
    memset(drift, 0, sizeof drift);
    write_keys("ball.npz", CS_MESH_SPHERE, 3, wobble_and_drift, 9, 40);
    fixture_open(&thrown, method, BALL, -u[0], -u[1], -u[2], stiffness);
    memcpy(drift, u, sizeof drift);
    write_keys("ball.npz", CS_MESH_SPHERE, 3, wobble_and_drift, 9, 40);
    fixture_open(&at_rest, method, BALL, 0.0, 0.0, 0.0, stiffness);
    fixture_start(&thrown);
    fixture_start(&at_rest);
    for (uint32_t frame = 1; frame <= frames; frame++) {
        fixture_frames(&thrown, 1);
        fixture_frames(&at_rest, 1);
        met += at_rest.system->pairs->current_contacts->n;
        for (size_t c = 0; c < 3; c++)
            for (size_t i = 0; i < thrown.n; i++)
                most = fmax(most, fabs(at_rest.x[c * thrown.n + i] -
                                       (thrown.x[c * thrown.n + i] + u[c] * frame / 60)));
    }
    ck_assert_uint_gt(met, 0);
    ck_assert_msg(most < 1e-6, "%s at %g m/s: %.3g m apart", method, u[1], most);
    ck_assert_uint_eq(thrown.session.run.counts.steps, at_rest.session.run.counts.steps);
    fixture_close(&thrown);
    fixture_close(&at_rest);
}

TEST(only_relative_motion_counts) {
    const struct methods methods = methods_find(
        &(struct methods_query){.test = "relative keys",
                                .always = "ros2",
                                .without = CS_NOT_GALILEAN | CS_ADAPTIVE | CS_EXPLICIT_OUTER,
                                .residual = 1e-12});
    for (size_t m = 0; m < methods.n; m++) {
        compare(methods.list[m].text, 2e3, (double[3]){0.3, 1, -0.1});
        compare(methods.list[m].text, 4e4, (double[3]){0.5, 10, 0.2});
    }
}

/* --- what grows --- */

/* m/s by which the ball of radius 0.1 m grows */
static double growth;

static void grow(double t, const double p[3], double x[3]) {
    for (int c = 0; c < 3; c++)
        x[c] = (0.2 + 2 * growth * t) * p[c];
}

/* no springs and no weight: particles in the range of a ball that grows, off its top */
#define DUST                                                                                   \
    "{\"bodies\": [{\"cloth\": {\"grid\": [9, 9], \"size\": [0.5, 0.5], \"start\": \"flat\", " \
    "\"place\": {\"translate\": [0.003, 0.13, 0.002]}}, \"mass\": {\"areal_density\": 0.2}, "  \
    "\"thickness\": 0.005, \"self_contact\": true, \"springs\": {\"stretch\": 100, "           \
    "\"shear\": "                                                                              \
    "30, \"bend\": 0, \"damping\": 0.01}}], \"colliders\": [{\"mesh\": {\"shape\": "           \
    "\"sphere\", \"detail\": 4" KEYS(                                                          \
        "grow.npz", 20, "continue") "}, \"friction\": 0.2, "                                   \
                                    "\"thickness\": 0.005}], \"contact\": \"force\", "         \
                                    "\"forces\": {\"gravity\": [0, 0, 0]}}"

/* A ball that grows at 1 and 10 m/s pushes a sheet off: nothing crosses, and no particle is
 * left behind inside. */
TEST(what_grows_pushes) {
    static const double speeds[] = {1, 10};
    const struct methods methods = methods_find(&(struct methods_query){
        .test = "growing ball", .without = CS_EXPLICIT_OUTER | CS_ADAPTIVE | CS_NOT_GALILEAN});
    for (size_t s = 0; s < LENGTH(speeds); s++) {
        growth = speeds[s];
        write_keys("grow.npz", CS_MESH_SPHERE, 4, grow, 3, 20);
        for (size_t m = 0; m < methods.n; m++) {
            struct fixture sheet;
            if (!suite_takes(s + m + 1, 2)) // both speeds, in turn
                continue;
            fixture_open(&sheet, methods.list[m].text, DUST);
            fixture_start(&sheet);
            for (uint32_t frame = 1; frame <= (s ? 3 : 12); frame++) {
                const double t = frame / 60.0;
                double least = HUGE_VAL;
                fixture_frames(&sheet, 1);
                ck_assert_uint_eq(cs_crossings_count(sheet.system, t, sheet.x).n, 0);
                for (size_t i = 0; i < sheet.n; i++) {
                    const double *x = sheet.x + i;
                    least = fmin(least, sqrt(x[0] * x[0] + x[sheet.n] * x[sheet.n] +
                                             x[2 * sheet.n] * x[2 * sheet.n]));
                }
                // the flat faces of the ball lie 5 % inside
                ck_assert_msg(least > 0.94 * (0.1 + growth * t), "%s, frame %u: %.3g m",
                              methods.list[m].text, frame, least);
            }
            double up = 0;
            for (size_t i = 0; i < sheet.n; i++)
                up = fmax(up, sheet.v[sheet.n + i]);
            ck_assert_double_gt(up, 0.8 * growth);
            fixture_close(&sheet);
        }
    }
}

/* --- orders --- */

static void end_state(const char *name, double h, double state[6 * SHEET_N]) {
    struct fixture cloth;
    char integrator[120];
    methods_set(integrator, name, "dt", h);
    fixture_open(&cloth, integrator, RING, "0.3, -1, 0", KEYS("smooth.npz", 45, "loop"), "");
    fixture_start(&cloth);
    fixture_frames(&cloth, 6);
    ck_assert_uint_gt(cloth.system->pairs->current_contacts->n, 10);
    memcpy(state, cloth.x, 6 * SHEET_N * sizeof *state);
    fixture_close(&cloth);
}

/* each its own order, to the fourth, though no step ends on a key frame */
TEST(orders_hold_on_key_frames) {
    write_keys("smooth.npz", CS_MESH_TORUS, 5, wobble, 45, 45);
    methods_check_mesh_orders("key frames", end_state, 6 * SHEET_N, 1.0 / 4800, 1.0 / 3000,
                              1.0 / 1500);
}

/* --- what is not there --- */

TEST(others_pay_nothing) {
    struct fixture cloth;
    fixture_open(&cloth, "rk4:dt=0.01", RING, "0, 0, 0", "", "");
    ck_assert_ptr_null(cloth.system->motions);
    ck_assert(!cloth.system->plan.rows[CS_FEATURE_KEY_FRAMES].built);
    fixture_close(&cloth);
    write_keys("wobble.npz", CS_MESH_TORUS, 5, wobble, 20, 20);
    fixture_open(&cloth, "rk4:dt=0.01", RING, "0, 0, 0", KEYS("wobble.npz", 20, "loop"), "");
    const struct cs_plan_row *row = cloth.system->plan.rows + CS_FEATURE_KEY_FRAMES;
    ck_assert(row->built);
    ck_assert_uint_ge(row->bytes,
                      2 * 20 * 3 * sizeof(double) * cloth.system->surfaces->first_point[3] -
                          2 * 20 * 3 * sizeof(double) * cloth.system->surfaces->first_point[2]);
    fixture_close(&cloth);
}

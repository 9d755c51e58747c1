/* Events: at their time to the bit, with what they promise, and nothing without them. */
#include "eventful.h"
#include "methods.h"

#include "model/event/events.h"
#include "scene/force_keys.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* every method there is */
static struct methods all_methods(void) {
    static const char *const more[] = {"position-verlet:loss=0.01",
                                       "implicit-linearised:dt=0.002,hessian=exact", NULL};
    return methods_find(&(struct methods_query){.test = "events", .more = more});
}

/* What the frame loop does about events, by hand on a run without any. */
static void advance_by_hand(struct fixture *cloth, double from, double to) {
    struct cs_error error = {0};
    ck_assert_int_eq(cs_run_advance(&cloth->session.run, from, to, &error), CS_OK);
}

static void restart(struct fixture *cloth, double t) {
    struct cs_error error = {0};
    ck_assert_int_eq(cs_run_restart(&cloth->session.run, t, &error), CS_OK);
}

/* A blow at 0.0375 s and one at 0.05 s, which is frame 3: the same bits as three runs joined.
 * The blow that does not come lets no method pass frames there either. */
TEST(runs_are_joined_at_events) {
    const struct methods methods = all_methods();
    for (size_t k = 0; k < methods.n; k++) {
        const char *method = methods.list[k].text;
        struct fixture cloth, parts;
        fixture_open(&cloth, method, CLOTH,
                     "{\"at\": 0.05, \"impact\": {\"direction\": [0, 3, 4], \"impulse\": 0.1,"
                     " \"particles\": [17]}},"
                     "{\"at\": 0.0375, \"impact\": {\"direction\": [1, 0, 0], \"impulse\": 0.2,"
                     " \"particles\": [\"bottom-right\"]}}");
        fixture_open(&parts, method, CLOTH,
                     "{\"at\": 100, \"impact\": {\"direction\": [1, 0, 0]}}");
        fixture_start(&cloth);
        fixture_start(&parts);
        fixture_frames(&cloth, 4);

        const size_t n = parts.n;
        advance_by_hand(&parts, 0, 1 / 60.0);
        advance_by_hand(&parts, 1 / 60.0, 2 / 60.0);
        advance_by_hand(&parts, 2 / 60.0, 0.0375);
        parts.v[29] += 0.2 / 0.01;
        restart(&parts, 0.0375);
        advance_by_hand(&parts, 0.0375, 3 / 60.0);
        parts.v[n + 17] += 0.6 * (0.1 / 0.01);
        parts.v[2 * n + 17] += 0.8 * (0.1 / 0.01);
        restart(&parts, 3 / 60.0);
        advance_by_hand(&parts, 3 / 60.0, 4 / 60.0);
        ck_bits(cloth.x, parts.x, 6 * n, method);
        fixture_close(&cloth);
        fixture_close(&parts);
    }
}

/* At once, and over an interval that begins and ends within frames: momentum changes by the
 * impulse, and springs in between change nothing about it. */
TEST(impact_gives_its_impulse) {
    static const char *const times[] = {"\"at\": 0.03", "\"from\": 0.02, \"to\": 0.07"};
    static const char *const by_methods[] = {"symplectic-euler", "velocity-verlet",
                                             "implicit-linearised:dt=0.005,rtol=1e-13"};
    for (size_t k = 0; k < 2; k++)
        for (size_t m = 0; m < 3; m++) {
            struct fixture dust;
            char events[256];
            double p[3], l[3];
            snprintf(events, sizeof events,
                     "{%s, \"impact\": {\"direction\": [2, 1, -2], \"impulse\": 0.6,"
                     " \"particles\": [\"left\", 7]}}",
                     times[k]);
            fixture_open(&dust, by_methods[m], DUST, "40", events);
            fixture_start(&dust);
            fixture_frames(&dust, 6);
            fixture_momentum(&dust, p, l);
            ck_assert_double_eq_tol(p[0], 0.4, 1e-12);
            ck_assert_double_eq_tol(p[1], 0.2, 1e-12);
            ck_assert_double_eq_tol(p[2], -0.4, 1e-12);
            fixture_close(&dust);
        }
}

/* Frame by frame the grabbed particles are on their path to the bit, whatever the method. */
TEST(grab_is_exact) {
    const struct methods methods = all_methods();
    for (size_t k = 0; k < methods.n; k++) {
        const char *method = methods.list[k].text;
        struct fixture cloth;
        fixture_open(&cloth, method, CLOTH,
                     "{\"from\": 0.05, \"to\": 0.35, \"grab\": {\"particles\": [29, 28],"
                     " \"path\": [{\"at\": 0.15, \"point\": [0.5, -0.25, 0.5]},"
                     " {\"at\": 0.25, \"point\": [0.5, -0.25, 1.5]}]}},"
                     "{\"at\": 0.05, \"grab\": {\"particles\": [0], \"relative\": true,"
                     " \"motion\": \"smooth\","
                     " \"path\": [{\"at\": 0.25, \"point\": [0, 0, -1]}]}}");
        const size_t n = cloth.n;
        fixture_start(&cloth);
        fixture_frames(&cloth, 3);
        const double apart = cloth.x[29] - cloth.x[28], corner = cloth.x[2 * n];
        fixture_frames(&cloth, 6); /* 0.15 s: the first point, and half of the cubic */
        ck_assert_msg(cloth.x[28] == 0.5 && cloth.x[n + 28] == -0.25 &&
                          cloth.x[2 * n + 28] == 0.5,
                      "%s", method);
        ck_assert(fabs(cloth.x[29] - (0.5 + apart)) < 1e-15);
        ck_assert(fabs(cloth.x[2 * n] - (corner - 0.5)) < 1e-15);
        fixture_frames(&cloth, 3); /* 0.2 s: half way at 10 m/s */
        ck_assert(fabs(cloth.x[2 * n + 28] - 1) < 1e-12);
        ck_assert(fabs(cloth.v[2 * n + 28] - 10) < 1e-12 && cloth.v[28] == 0);
        fixture_frames(&cloth, 3); /* 0.25 s: there */
        ck_assert(cloth.x[2 * n + 28] == 1.5 && cloth.x[2 * n] == corner - 1);
        fixture_frames(&cloth, 5); /* 0.333 s: at rest there */
        ck_assert(cloth.x[2 * n + 28] == 1.5 && cloth.v[2 * n + 28] == 0);
        ck_assert(cloth.system->inv_mass[28] == 0 && cloth.system->inv_mass[0] == 0);
        fixture_frames(&cloth, 2); /* 0.367 s: let go */
        ck_assert(cloth.system->inv_mass[28] == 1 / 0.01 && cloth.system->inv_mass[0] == 0);
        ck_assert(cloth.x[2 * n + 28] != 1.5 && cloth.x[2 * n] == corner - 1);
        fixture_close(&cloth);
    }
}

/* Let go on the way, a particle flies on as it went. */
TEST(release_keeps_the_velocity) {
    struct fixture dust;
    fixture_open(&dust, "velocity-verlet", DUST, "0",
                 "{\"at\": 0, \"grab\": {\"particles\": [5], \"relative\": true,"
                 " \"path\": [{\"at\": 1, \"point\": [2, 0, -4]}]}},"
                 "{\"at\": 0.25, \"release\": {\"particles\": [5]}}");
    fixture_start(&dust);
    const double start = dust.x[5];
    fixture_frames(&dust, 30);
    ck_assert(dust.v[5] == 2 && dust.v[2 * dust.n + 5] == -4 && dust.v[6] == 0);
    ck_assert_double_eq_tol(dust.x[5], start + 1, 1e-12);
    fixture_close(&dust);
}

/* Held in flight, a particle stays to the bit; a later holder is not robbed by an earlier one.
 */
TEST(pins_come_and_go) {
    const struct methods methods = all_methods();
    for (size_t k = 0; k < methods.n; k++) {
        const char *method = methods.list[k].text;
        struct fixture cloth;
        fixture_open(&cloth, method, CLOTH,
                     "{\"from\": 0.1, \"to\": 0.2, \"pin\": {\"particles\": [\"bottom\"]}},"
                     "{\"from\": 0.15, \"to\": 0.3, \"pin\": {\"particles\": [27]}},"
                     "{\"at\": 0.1, \"release\": {\"particles\": [\"top\"]}}");
        fixture_start(&cloth);
        fixture_frames(&cloth, 6);
        const double held[2] = {cloth.x[cloth.n + 27], cloth.x[cloth.n + 28]};
        const double top = cloth.x[cloth.n];
        fixture_frames(&cloth, 6);
        ck_assert_uint_eq(cloth.system->n_pinned, 6);
        ck_assert_msg(cloth.x[cloth.n + 27] == held[0] && cloth.x[cloth.n + 28] == held[1] &&
                          cloth.v[cloth.n + 27] == 0,
                      "%s", method);
        ck_assert(cloth.x[cloth.n] < top);
        fixture_frames(&cloth, 3);
        ck_assert(cloth.x[cloth.n + 27] == held[0] && cloth.x[cloth.n + 28] < held[1]);
        fixture_frames(&cloth, 6);
        ck_assert_uint_eq(cloth.system->n_pinned, 0);
        fixture_close(&cloth);
    }
}

/* From none to 3 Pa along x, over to 4 Pa along y, and off. */
TEST(wind_rises_and_turns) {
    struct fixture dust;
    fixture_open(&dust, "velocity-verlet:dt=0.001", DUST, "0",
                 "{\"from\": 0, \"to\": 0.1, \"wind\": {\"direction\": [9, 0, 0],"
                 " \"strength\": 3}}, {\"from\": 0.1, \"to\": 0.2, \"wind\":"
                 " {\"direction\": [0, 2, 0], \"strength\": 4}},"
                 "{\"at\": 0.25, \"wind\": {\"strength\": 0}}");
    const struct cs_wind *wind = &dust.system->scene->forces->wind;
    fixture_start(&dust);
    fixture_frames(&dust, 3);
    ck_assert_double_eq_tol(wind->strength, 1.5, 1e-14);
    ck_assert(wind->direction[0] == 1 && wind->direction[1] == 0);
    fixture_frames(&dust, 6); /* (1.5, 2, 0) Pa */
    ck_assert_double_eq_tol(wind->strength, 2.5, 1e-14);
    ck_assert_double_eq_tol(wind->direction[0], 0.6, 1e-14);
    ck_assert_double_eq_tol(wind->direction[1], 0.8, 1e-14);
    fixture_frames(&dust, 5);
    ck_assert(wind->strength == 4 && wind->direction[0] == 0 && wind->direction[1] == 1);
    fixture_frames(&dust, 4);
    ck_assert(wind->strength == 0 && wind->direction[1] == 1);
    fixture_close(&dust);
}

/* A ramp, a path, a push and a wind at once: two methods that have nothing in common agree, and
 * the coarser comes near four times as fast when its step is halved. */
TEST(methods_agree) {
    static const char *const by[] = {"cvode-bdf:rtol=1e-9,linear_rtol=1e-9,max_order=5",
                                     "velocity-verlet:dt=0.0005", "velocity-verlet:dt=0.001"};
    struct fixture cloths[3];
    for (size_t k = 0; k < 3; k++) {
        fixture_open(cloths + k, by[k], CLOTH,
                     "{\"from\": 0.02, \"to\": 0.2, \"ramp\": {\"key\":"
                     " \"bodies[0].springs.stretch\", \"value\": 90}},"
                     "{\"from\": 0.03, \"to\": 0.25, \"wind\": {\"direction\": [0, 0, 1],"
                     " \"strength\": 2}},"
                     "{\"from\": 0.05, \"to\": 0.15, \"grab\": {\"particles\": [29],"
                     " \"motion\": \"smooth\", \"relative\": true,"
                     " \"path\": [{\"at\": 0.15, \"point\": [0.1, 0.1, 0.2]}]}},"
                     "{\"from\": 0.1, \"to\": 0.2, \"impact\": {\"direction\": [0, 0, -1],"
                     " \"impulse\": 0.05}}");
        fixture_start(cloths + k);
        fixture_frames(cloths + k, 18);
    }
    const size_t n = 3 * cloths[0].n;
    const double fine = cs_rms_difference(cloths[0].x, cloths[1].x, n);
    const double coarse = cs_rms_difference(cloths[0].x, cloths[2].x, n);
    ck_assert_msg(fine < 1e-5, "%g m apart", fine);
    ck_assert_msg(coarse / fine > 3 && coarse / fine < 5.5, "%g and %g m apart", coarse, fine);
    for (size_t k = 0; k < 3; k++)
        fixture_close(cloths + k);
}

/* The plan says what they take, and without any there is nothing. */
TEST(bytes_are_planned) {
    struct fixture with, without;
    fixture_open(&with, "velocity-verlet", CLOTH,
                 "{\"from\": 0.1, \"to\": 0.2, \"impact\": {\"direction\": [0, 0, 1]}},"
                 "{\"at\": 0.1, \"grab\": {\"motion\": \"smooth\","
                 " \"path\": [{\"at\": 0.5, \"point\": [0, 0, 1]}]}}");
    fixture_open(&without, "velocity-verlet", CLOTH, "");
    const size_t more = with.system->arena.used - without.system->arena.used;
    ck_assert_uint_eq(more, with.system->plan.rows[CS_FEATURE_EVENTS].bytes);
    fixture_close(&with);
    fixture_close(&without);
}

TEST(nothing_without_events) {
    struct fixture cloth;
    fixture_open(&cloth, "velocity-verlet", CLOTH, "");
    ck_assert_ptr_null(cloth.system->events);
    ck_assert_ptr_eq(cloth.system->scene, cloth.session.scene);
    ck_assert(!cloth.session.plan.rows[CS_FEATURE_EVENTS].built);
    ck_assert_uint_eq(cloth.system->plan.rows[CS_FEATURE_EVENTS].bytes, 0);
    fixture_close(&cloth);
}

/* A spin is a rotation about the centre: no momentum, and w for every particle. */
TEST(cloth_starts_with_a_spin) {
    struct fixture cloth;
    double p[3], l[3];
    fixture_open(&cloth, "velocity-verlet",
                 "{\"bodies\": [{\"cloth\": {\"grid\": [5, 3], \"spin\": [0, 0, 2],"
                 " \"velocity\": [0, 0, 1], \"place\": {\"translate\": [3, 1, 0]}},"
                 " \"mass\": {\"particle\": 0.1}, \"pins\": [0]}]}");
    fixture_momentum(&cloth, p, l);
    ck_assert(cloth.v[0] == 0 && cloth.v[cloth.n] == 0);
    ck_assert_double_eq_tol(p[2], 1.4, 1e-14);
    for (size_t i = 1; i < cloth.n; i++) {
        ck_assert_double_eq_tol(cloth.v[i], -2 * (cloth.x[cloth.n + i] - 1), 1e-14);
        ck_assert_double_eq_tol(cloth.v[cloth.n + i], 2 * (cloth.x[i] - 3), 1e-14);
    }
    fixture_close(&cloth);
}

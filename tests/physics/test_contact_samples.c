/* Contact by force of what lies between particles: nothing comes in where edges are coarse, the
 * forces are those of points added up one by one, and methods keep order and energy. */
#include "base/pool.h"
#include "base/vec3.h"
#include "methods.h"
#include "model/contact/contact_samples.h"
#include "model/force/terms.h"
#include "session/scene_findings.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- nothing comes in --- */

#define SPRINGS                                                                                \
    "\"springs\": {\"stretch\": 300, \"shear\": 100, \"bend\": 5, \"damping\": 0.05}"

/* obstacles that are finer than cells of 0.1 to 0.2 m */
static const struct {
    const char *name, *scene;
} coarse[] = {
    {"ball of 0.35 m under 13 x 13 with a thin range",
     "{\"bodies\": [{\"cloth\": {\"grid\": [13, 13], \"start\": \"flat\", \"place\": "
     "{\"translate\": [0.05, 0.4, 0.02], \"rotate\": [0, 0.2, 0, 1]}}, \"mass\": "
     "{\"areal_density\": 0.3}, " SPRINGS "}], \"colliders\": [{\"sphere\": {\"centre\": "
     "[0, 0, 0], \"radius\": 0.35}, \"friction\": 0.3, \"thickness\": 0.008}], \"contact\": "
     "\"force\"}"},
    {"ball of 0.04 m through the cells of a curtain",
     "{\"bodies\": [{\"cloth\": {\"grid\": [7, 7], \"size\": [1.05, 1.05]}, \"mass\": "
     "{\"areal_density\": 0.25}, \"pins\": [\"top\"], " SPRINGS "}], \"colliders\": "
     "[{\"sphere\": {\"centre\": [0.0875, -0.05, -0.2], \"radius\": 0.04}, \"friction\": "
     "0.3}], \"events\": [{\"at\": 0.02, \"move\": {\"collider\": 0, \"path\": [{\"at\": 0.6, "
     "\"point\": [0, 0, 0.5]}]}}], \"contact\": \"force\"}"},
    {"corner of a box under a cloth",
     "{\"bodies\": [{\"cloth\": {\"grid\": [7, 7], \"start\": \"flat\", \"place\": "
     "{\"translate\": [0.1, 0.33, 0.05]}}, \"mass\": {\"areal_density\": 0.3}, " SPRINGS
     "}], \"colliders\": [{\"box\": {\"centre\": [0, 0, 0], \"size\": [0.5, 0.4, 0.5], "
     "\"radius\": 0.01, \"rotate\": [0.1, 0, 0.1, 1]}, \"friction\": 0.3, \"thickness\": "
     "0.03}], \"contact\": \"force\"}"},
    {"thin pole under a cloth",
     "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6], \"start\": \"flat\", \"place\": "
     "{\"translate\": [0.02, 0.06, 0.03]}}, \"mass\": {\"areal_density\": 0.3}, " SPRINGS
     "}], \"colliders\": [{\"capsule\": {\"from\": [-0.7, 0, 0.01], \"to\": [0.7, 0.02, "
     "-0.02], \"radius\": 0.01}, \"friction\": 0.5, \"thickness\": 0.02}], \"contact\": "
     "\"force\"}"}};

/* m, from the obstacle at t to the nearest of many points of the cloth */
static double nearest(const struct fixture *cloth, const struct cs_surfaces *surfaces,
                      double t) {
    enum { FINE = 8 };
    struct cs_posed_collider collider;
    double least = HUGE_VAL;
    cs_posed_collider_at(cloth->system, 0, t, &collider);
    for (uint32_t item = 0; item < surfaces->n_triangles; item++)
        for (int a = 0; a <= FINE; a++)
            for (int b = 0; a + b <= FINE; b++) {
                const uint32_t *at = surfaces->triangles + 3 * (size_t)item;
                double p[3], n[3];
                for (size_t c = 0; c < 3; c++) {
                    const double *x = cloth->x + c * cloth->n;
                    p[c] = ((FINE - a - b) * x[at[0]] + a * x[at[1]] + b * x[at[2]]) / FINE;
                }
                least = fmin(least, cs_posed_collider_distance(&collider, p, n));
            }
    return least;
}

/* the least distance in 0.8 s, particles alone or all */
static double least_distance(const char *scene, const char *integrator, bool alone) {
    struct fixture cloth;
    struct cs_text warning = {0};
    double least = HUGE_VAL;
    fixture_open(&cloth, integrator, "%s", scene);
    ck_assert_ptr_nonnull(cloth.system->contact_samples);
    cs_sampling_warning_print(cloth.system, &warning);
    ck_assert_uint_eq(warning.length, 0);
    if (alone) {
        // the points are the last term
        cloth.system->contact_samples = NULL;
        cloth.system->n_terms--;
    }
    fixture_start(&cloth);
    for (int frame = 1; frame <= 48; frame++) {
        fixture_frames(&cloth, 1);
        least = fmin(least, nearest(&cloth, cloth.system->surfaces, frame / 60.0));
    }
    fixture_close(&cloth);
    return least;
}

TEST(nothing_comes_in_between_particles) {
    for (size_t k = 0; k < LENGTH(coarse); k++) {
        const double alone =
            least_distance(coarse[k].scene, "implicit-linearised:dt=0.004", true);
        const double all =
            least_distance(coarse[k].scene, "implicit-linearised:dt=0.004", false);
        ck_assert_msg(alone < 0, "%s: particles alone keep it %g m away", coarse[k].name,
                      alone);
        ck_assert_msg(all > 0, "%s: %g m", coarse[k].name, all);
    }
}

/* the same for every family, on the curtain */
TEST(every_family_keeps_it_out) {
    const struct methods methods =
        methods_find(&(struct methods_query){.test = "curtain",
                                             .without = CS_EXPLICIT_OUTER | CS_NOT_GALILEAN,
                                             .dt = 0.004,
                                             .dt_for = CS_IMPLICIT,
                                             .rtol = 1e-3});
    for (size_t m = 0; m < methods.n; m++) {
        const double all = least_distance(coarse[1].scene, methods.list[m].text, false);
        ck_assert_msg(all > 0, "%s: %g m", methods.list[m].text, all);
    }
}

/* --- what is kept --- */

/* a sheet on a ball that fits between its particles, soft enough for a smooth motion */
#define SHEET                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [4, 4], \"start\": \"flat\", \"place\": "            \
    "{\"translate\": [0.04, 0.12, 0.03]}}, \"mass\": {\"particle\": 0.1}, \"springs\": "       \
    "{\"stretch\": 40, \"shear\": 15, \"bend\": 5, \"damping\": 0}}], \"colliders\": "         \
    "[{\"sphere\": {\"centre\": [0, -0.05, 0], \"radius\": 0.05}, \"thickness\": 0.2, "        \
    "\"friction\": %g}], \"contact\": {\"law\": \"force\", \"stiffness\": 40, "                \
    "\"friction_speed\": 0.5}, \"time\": {\"fps\": 10}}"

enum { N = 16, VALUES = 6 * N };

static void open_sheet(struct fixture *sheet, const char *name, double h, double friction) {
    char integrator[120];
    methods_set(integrator, name, "dt", h);
    fixture_open(sheet, integrator, SHEET, friction);
    cs_perturb_smooth(sheet->system, 0.01, 0.2);
    fixture_start(sheet);
}

static void end_state(const char *name, double h, double state[VALUES]) {
    struct fixture sheet;
    open_sheet(&sheet, name, h, 0.3);
    fixture_frames(&sheet, 3);
    memcpy(state, sheet.x, VALUES * sizeof *state);
    fixture_close(&sheet);
}

TEST(orders_hold) {
    const struct methods methods = methods_find(&(struct methods_query){
        .without = CS_ADAPTIVE | CS_EXPLICIT_OUTER | CS_NOT_GALILEAN, .residual = 1e-12});
    double reference[VALUES];
    end_state("rk4", 2e-4, reference);
    for (size_t m = 0; m < methods.n; m++) {
        const struct method_asked *method = methods.list + m;
        double state[VALUES], error[2];
        for (int k = 0; k < 2; k++) {
            end_state(method->text, methods_step(method->order_damped) / (1 + k), state);
            error[k] = cs_rms_difference(state, reference, VALUES);
        }
        const double order = log2(error[0] / error[1]);
        ck_assert_msg(fabs(order - method->order_damped) < 0.2,
                      "%s: order %.3f, stated %u (errors %.3g, %.3g)", method->text, order,
                      method->order_damped, error[0], error[1]);
    }
}

/* without friction nothing but the method's own error takes energy: of fifth order in a step */
TEST(energy_is_kept) {
    double lost[2];
    for (int k = 0; k < 2; k++) {
        struct fixture sheet;
        open_sheet(&sheet, "rk4", 4e-3 / (1 + k), 0);
        const double start = fixture_energy(&sheet);
        fixture_frames(&sheet, 4);
        lost[k] = fabs(fixture_energy(&sheet) - start);
        fixture_close(&sheet);
    }
    ck_assert_double_lt(lost[0], 1e-4);
    ck_assert_double_gt(lost[0] / lost[1], 16);
}

/* --- point by point --- */

/* f += the law at one point, its moment about the origin too */
static uint32_t add_point(const struct fixture *sheet, const struct cs_posed_collider_law *law,
                          const uint32_t *at, const double w[3], double f[6]) {
    double p[3] = {0}, v[3] = {0}, push[3], turn[3];
    struct cs_point_contact contact;
    for (int k = 0; k < 3; k++)
        for (size_t c = 0; c < 3 && w[k] > 0; c++) {
            p[c] += w[k] * sheet->x[c * N + at[k]];
            v[c] += w[k] * sheet->v[c * N + at[k]];
        }
    if (!cs_posed_collider_law_in_range(law, p, v, &contact))
        return 0;
    cs_point_contact_force(&contact, (struct cs_contact_force_parts){1, 1}, push);
    cs_vec3_cross(p, push, turn);
    for (int c = 0; c < 3; c++)
        f[c] += push[c], f[3 + c] += turn[c];
    return 1;
}

/* Force and moment of all particles, of the points at thirds of all edges and of the middles of
 * all triangles: the longest edges are 0.471 m, parts may have 0.224 m, and the sides 0.333 m,
 * which are cut at their middles. */
TEST(force_is_that_of_points) {
    struct fixture sheet;
    struct cs_posed_collider_law law;
    double f[3 * N], sum[6] = {0}, one[6] = {0};
    uint32_t points = 0;
    open_sheet(&sheet, "rk4", 1e-3, 0.3);
    fixture_frames(&sheet, 1);
    const struct cs_surfaces *surfaces = sheet.system->surfaces;
    cs_posed_collider_law_at(sheet.system, 0, 0.1, &law);
    for (uint32_t i = 0; i < N; i++)
        add_point(&sheet, &law, &i, (double[3]){1, 0, 0}, one);
    for (size_t e = 0; e < surfaces->n_edges; e++) {
        const uint32_t *at = surfaces->edges + 2 * e;
        const bool across = at[1] - at[0] == 3;
        for (int k = 1; k < (across ? 3 : 2); k++) {
            const double w = k / (across ? 3.0 : 2.0);
            points += add_point(&sheet, &law, at, (double[3]){1 - w, w, 0}, one);
        }
    }
    for (size_t t = 0; t < surfaces->n_triangles; t++)
        points += add_point(&sheet, &law, surfaces->triangles + 3 * t,
                            (double[3]){1 / 3.0, 1 / 3.0, 1 / 3.0}, one);
    ck_assert_uint_ge(points, 6);

    // springs and gravity are left out
    const struct cs_eval at = {
        .t = 0.1, .x = sheet.x, .v = sheet.v, .parts = CS_PART_POTENTIAL | CS_PART_DISSIPATIVE};
    cs_terms_force(sheet.system, &at, f);
    for (size_t i = 0; i < N; i++) {
        double p[3], push[3], turn[3];
        for (size_t c = 0; c < 3; c++)
            p[c] = sheet.x[c * N + i], push[c] = f[c * N + i];
        cs_vec3_cross(p, push, turn);
        for (int c = 0; c < 3; c++)
            sum[c] += push[c], sum[3 + c] += turn[c];
    }
    for (int c = 0; c < 6; c++)
        ck_assert_double_eq_tol(sum[c], one[c], 1e-12 * fabs(one[1]));
    ck_assert_double_gt(one[1], 0.1);
    fixture_close(&sheet);
}

/* --- bits, and what is left out --- */

TEST(bits_are_those_of_one_thread) {
    static const char *const methods[] = {"velocity-verlet:dt=5e-4",
                                          "implicit-linearised:dt=0.004"};
    for (size_t m = 0; m < LENGTH(methods); m++) {
        double one[6 * 169] = {0};
        for (uint32_t threads = 1; threads <= 3; threads++) {
            struct fixture cloth;
            struct cs_error error = {0};
            ck_assert_int_eq(cs_pool_start(threads, &error), CS_OK);
            fixture_open(&cloth, methods[m], "%s", coarse[0].scene);
            fixture_start(&cloth);
            fixture_frames(&cloth, 12);
            if (threads == 1)
                memcpy(one, cloth.x, sizeof one);
            ck_assert_msg(!memcmp(one, cloth.x, sizeof one), "%s: %u threads", methods[m],
                          threads);
            fixture_close(&cloth);
            cs_pool_stop();
        }
    }
}

static const struct cs_plan_row *row_of(const struct cs_system *system) {
    uint32_t k = 0;
    while (cs_terms[k] != &cs_term_cover)
        k++;
    return system->plan.forces + k;
}

#define ON(collider)                                                                           \
    "{\"bodies\": [{\"cloth\": {\"grid\": [5, 5]}, \"mass\": {\"total\": 1}}], \"contact\": "  \
    "{\"law\": \"force\", \"stiffness\": 100}, \"colliders\": [{" collider                     \
    ", \"thickness\": 0.02}]}"

/* No array and no call where edges are short enough, or nothing is round; a part of an edge may
 * have sqrt(D (2R + 3/4 D)). */
TEST(what_is_not_needed_is_left_out) {
    static const struct {
        const char *scene, *why;
        size_t points;
    } scenes[] = {{ON("\"floor\": {\"height\": -2}"), "every collider is flat", 0},
                  // sides are 0.25, the longest edge sqrt(2) of that = 0.354: R = 3.118
                  {ON("\"sphere\": {\"centre\": [0, -9, 0], \"radius\": 3.13}"),
                   "edges are short enough for every collider", 0},
                  {ON("\"sphere\": {\"centre\": [0, -9, 0], \"radius\": 3.11}"), NULL, 16},
                  {ON("\"sphere\": {\"centre\": [0, -9, 0], \"radius\": 1.5}"), NULL, 40 + 16},
                  // thirds of the longest edges
                  {ON("\"sphere\": {\"centre\": [0, -9, 0], \"radius\": 0.36}"), NULL,
                   2 * 40 + 2 * 16 + 32}};
    for (size_t k = 0; k < LENGTH(scenes); k++) {
        struct fixture cloth;
        fixture_open(&cloth, "velocity-verlet", "%s", scenes[k].scene);
        const struct cs_plan_row *row = row_of(cloth.system);
        ck_assert_int_eq(row->built, !scenes[k].why);
        if (scenes[k].why) {
            ck_assert_str_eq(row->reason, scenes[k].why);
            ck_assert_uint_eq(row->bytes, 0);
            ck_assert_ptr_null(cloth.system->contact_samples);
            ck_assert_ptr_null(cloth.system->surfaces);
        } else {
            ck_assert_uint_eq(cloth.system->contact_samples->n_points, scenes[k].points);
        }
        fixture_close(&cloth);
    }
}

/* a needle is finer than the points there may be */
TEST(what_is_too_fine_is_told) {
    struct fixture cloth;
    struct cs_text warning = {0};
    fixture_open(&cloth, "velocity-verlet", "%s",
                 ON("\"capsule\": {\"from\": [0, -9, 0], \"to\": [0, -5, 0], \"radius\": "
                    "0.0001}"));
    cs_sampling_warning_print(cloth.system, &warning);
    ck_assert_msg(strstr(cs_text_get(&warning), "colliders[0]: an edge of 0.354 m") != NULL,
                  "%s", cs_text_get(&warning));
    cs_text_finish(&warning);
    fixture_close(&cloth);
}

/* a ball in the middle of a cell, where no particle is */
TEST(what_starts_inside_is_refused) {
    struct cs_session session = {0};
    struct cs_error error = {0};
    const struct cs_session_settings settings = {
        .scene = "ball.json",
        .text = ON("\"sphere\": {\"centre\": [0.125, 0.125, 0], \"radius\": 0.03}"),
        .integrator = "velocity-verlet"};
    ck_assert_int_eq(cs_session_open(&session, &settings, &error), CS_ERR_SCENE);
    ck_assert_msg(strstr(error.message, "starts 0.03 m inside colliders[0]") != NULL, "%s",
                  error.message);
    cs_session_close(&session);
}

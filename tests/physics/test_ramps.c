/* Ramps: values that change over an interval, or at once. */
#include "eventful.h"

#include "model/contact/posed_collider.h"
#include "model/event/events.h"
#include "model/force/diagnostics.h"
#include "model/plan.h"
#include "scene/body_keys.h"
#include "scene/force_keys.h"

#include <math.h>

/* Gravity from 0 to 6 m/s2 between 0.1 and 0.6 s: v = 6 t^2 and x = 2 t^3 from there. */
TEST(ramp_is_linear_in_time) {
    struct fixture dust;
    fixture_open(&dust, "velocity-verlet:dt=0.0005", DUST, "0",
                 "{\"from\": 0.1, \"to\": 0.6,"
                 " \"ramp\": {\"key\": \"forces.gravity[1]\", \"value\": 6}}");
    fixture_start(&dust);
    const double start = dust.x[dust.n];
    fixture_frames(&dust, 24); /* 0.4 s */
    ck_assert_double_eq_tol(dust.v[dust.n], 6 * 0.3 * 0.3, 1e-13);
    ck_assert_double_eq_tol(dust.x[dust.n] - start, 2 * 0.3 * 0.3 * 0.3, 1e-6);
    ck_assert(fabs(dust.system->scene->forces->gravity[1] - 3.6) < 1e-14);
    fixture_frames(&dust, 24); /* 0.8 s: 0.2 s at 6 m/s2 */
    ck_assert_double_eq_tol(dust.v[dust.n], 1.5 + 1.2, 1e-13);
    ck_assert(dust.system->scene->forces->gravity[1] == 6);
    ck_assert(dust.session.scene->forces->gravity[1] == 0);
    fixture_close(&dust);
}

/* A stiffness that changes at the start is that of a scene which has it, to the bit; and the
 * automatic step is right for the stiffest that a ramp will come to. */
TEST(springs_are_rebuilt) {
    struct fixture soft, stiff;
    fixture_open(&soft, "velocity-verlet", CLOTH,
                 "{\"at\": 0, \"ramp\": {\"key\": \"bodies[0].springs.stretch\","
                 " \"value\": 4000}}");
    fixture_open(&stiff, "velocity-verlet", CLOTH, "");
    ck_assert(soft.system->view.omega > 5 * stiff.system->view.omega);
    fixture_close(&stiff);
    struct cs_error error = {0};
    fixture_open(&stiff, "velocity-verlet", CLOTH, "");
    struct cs_body *body = cs_scene_bodies(stiff.session.scene);
    body->springs.stretch = 4000;
    cs_system_finish(stiff.system);
    cs_system_build(stiff.system, stiff.session.scene, &stiff.session.plan, &error);
    ck_assert_int_eq(error.status, CS_OK);
    ck_assert(soft.system->view.omega == stiff.system->view.omega);
    fixture_start(&soft);
    fixture_start(&stiff);
    fixture_frames(&soft, 10);
    fixture_frames(&stiff, 10);
    ck_bits(soft.x, stiff.system->state, 6 * soft.n, "stiffer");
    fixture_close(&soft);
    fixture_close(&stiff);
}

/* A weight on a spring, 2 pi a second: at 0.25 s it passes the middle with 0.1 m * 2 pi and
 * becomes four times as heavy, so that it swings half as fast and twice as far: at 0.75 s it is
 * at rest 0.2 m behind the middle. */
TEST(masses_change_at_once) {
    static const char *const exact[] = {"velocity-verlet:dt=1e-4", "rk4:dt=1e-3",
                                        "implicit-midpoint:dt=1e-3", "cvode-bdf:rtol=1e-8"};
    for (size_t k = 0; k < sizeof exact / sizeof *exact; k++) {
        struct fixture weight;
        fixture_open(&weight, exact[k],
                     "{\"bodies\": [{\"cloth\": {\"grid\": [2, 1], \"stretch\": [1.1, 1]},"
                     " \"mass\": {\"particle\": 1}, \"springs\": {\"stretch\":"
                     " 39.478417604357434}, \"pins\": [0]}], \"forces\": {\"gravity\":"
                     " [0, 0, 0]}, \"events\": [{\"at\": 0.25, \"ramp\": {\"key\":"
                     " \"bodies[0].mass.particle\", \"value\": 4}}]}");
        fixture_start(&weight);
        fixture_frames(&weight, 45);
        const double length = weight.x[1] - weight.x[0];
        ck_assert_msg(fabs(length - 0.8) < 1e-4, "%s: %.9g m", exact[k], length);
        ck_assert_msg(fabs(weight.v[1]) < 1e-3, "%s: %.9g m/s", exact[k], weight.v[1]);
        ck_assert_double_eq(weight.system->mass[1], 4);
        fixture_close(&weight);
    }
}

/* The automatic step is right for the lightest that comes. */
TEST(lightest_mass_binds_the_step) {
    struct fixture cloth, light;
    fixture_open(&cloth, "velocity-verlet", CLOTH, "");
    fixture_open(&light, "velocity-verlet", CLOTH,
                 "{\"at\": 1, \"ramp\": {\"key\": \"bodies[0].mass.particle\","
                 " \"value\": 0.0001}}");
    ck_assert_double_eq_tol(light.system->view.omega, 10 * cloth.system->view.omega, 1e-9);
    ck_assert_double_eq(light.system->mass[0], 0.01);
    fixture_close(&light);
    fixture_close(&cloth);
}

/* a body of edges, hinges and a network; %s: stretch, bend, unit, and the events */
#define JELLY                                                                                  \
    "{\"bodies\": [{\"mesh\": {\"shape\": \"sphere\", \"detail\": 3, \"spin\": [1, 2, 3]},"    \
    " \"network\": {\"springs\": 4, \"surface\": 3}, \"mass\": {\"total\": 1}, \"springs\":"   \
    " {\"stretch\": %s, \"bend\": %s, \"stiffness_unit\": \"%s\"}}], \"events\": [%s]}"

/* The same for a mesh, in both units; and half way of a ramp the energy is the mean of both
 * ends'. */
TEST(springs_of_a_mesh_follow_ramps) {
    static const char *const units[] = {"N/m", "N"};
    static const char at_once[] =
        "{\"at\": 0, \"ramp\": {\"key\": \"bodies[0].springs.stretch\", \"value\": 90}},"
        "{\"at\": 0, \"ramp\": {\"key\": \"bodies[0].springs.bend\", \"value\": 7}}";
    for (size_t k = 0; k < 2; k++) {
        struct fixture soft, stiff;
        fixture_open(&soft, "implicit-linearised:dt=0.005", JELLY, "20", "1", units[k],
                     at_once);
        fixture_open(&stiff, "implicit-linearised:dt=0.005", JELLY, "90", "7", units[k], "");
        ck_assert(soft.system->view.omega == stiff.system->view.omega);
        fixture_start(&soft);
        fixture_start(&stiff);
        fixture_frames(&soft, 5);
        fixture_frames(&stiff, 5);
        ck_bits(soft.x, stiff.x, 6 * soft.n, units[k]);
        fixture_close(&soft);
        fixture_close(&stiff);

        fixture_open(&soft, "velocity-verlet", JELLY, "20", "1", units[k],
                     "{\"from\": 0, \"to\": 0.1, \"ramp\": {\"key\":"
                     " \"bodies[0].springs.stretch\", \"value\": 0}}");
        cs_perturb_smooth(soft.system, 0.05, 0);
        double energy[3];
        cs_events_apply(soft.system, 0);
        for (int share = 0; share < 3; share++) {
            cs_events_move_values(soft.system, 0.05 * share);
            energy[share] = cs_springs_energy(&soft.system->springs, (uint32_t)soft.n, soft.x,
                                              CS_PART_SPRINGS);
        }
        ck_assert_double_eq_tol(energy[1], (energy[0] + energy[2]) / 2, 1e-12 * energy[0]);
        ck_assert(energy[2] < 0.5 * energy[0] && energy[2] > 0);
        fixture_close(&soft);
    }
}

/* The method with a factored matrix takes implicit Euler's steps also while the matrix changes:
 * springs get a hundred times as stiff, and drag comes in, within ten steps. */
TEST(factored_matrix_follows_ramps) {
    static const char scene[] =
        "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6]}, \"mass\": {\"areal_density\": 0.3},"
        " \"springs\": {\"stretch\": 20, \"shear\": 7, \"bend\": 2, \"damping\": 0.01,"
        " \"damping_model\": \"relative\"}, \"pins\": [\"top-left\", \"top-right\"]}],"
        " \"events\": [{\"from\": 0, \"to\": 0.5, \"ramp\": {\"key\":"
        " \"bodies[0].springs.stretch\", \"value\": 2000}}, {\"from\": 0.1, \"to\": 0.4,"
        " \"ramp\": {\"key\": \"forces.drag\", \"value\": 0.05}}], \"time\": {\"fps\": 20}}";
    struct cs_registry registry = {0};
    struct cs_error error = {0};
    const struct cs_registry_entry *found;
    const bool built = !cs_registry_find(&registry, "fast-mass-spring", &found, &error);
    cs_registry_finish(&registry);
    if (!built)
        return;
    struct fixture euler, factored;
    fixture_open(&euler, "backward-euler:rtol=1e-12", "%s", scene);
    fixture_open(&factored, "fast-mass-spring:iterations=3000", "%s", scene);
    fixture_start(&euler);
    fixture_start(&factored);
    fixture_frames(&euler, 12);
    fixture_frames(&factored, 12);
    for (size_t i = 0; i < 3 * euler.n; i++)
        ck_assert_double_eq_tol(factored.x[i], euler.x[i], 1e-9);
    fixture_close(&euler);
    fixture_close(&factored);
}

/* A ball whose radius goes from 0.2 to 0.5 m within 0.1 to 0.4 s: 1 m/s along its normals. */
TEST(radius_follows_its_ramp) {
    static const char scene[] =
        "{\"bodies\": [{\"cloth\": {\"grid\": [3, 3]}, \"mass\": {\"total\": 1},"
        " \"pins\": [\"top\"]}], \"contact\": \"force\", \"colliders\": [{\"floor\":"
        " {\"height\": -9}}, {\"sphere\": {\"centre\": [5, 0, 0], \"radius\": 0.2}}],"
        " \"events\": [{\"from\": 0.1, \"to\": 0.4, \"ramp\": {\"key\":"
        " \"colliders[1].sphere.radius\", \"value\": 0.5}}]}";
    const double p[3] = {5, 0.6, 0.8};
    struct fixture cloth;
    struct cs_posed_collider ball;
    double v[3];
    fixture_open(&cloth, "velocity-verlet:dt=0.001", "%s", scene);
    fixture_start(&cloth);
    fixture_frames(&cloth, 12); /* 0.2 s */
    for (int k = 0; k <= 2; k++) {
        cs_posed_collider_at(cloth.system, 1, 0.2 + 0.1 * k, &ball);
        ck_assert_double_eq_tol(ball.radius, 0.3 + 0.1 * k, 1e-14);
        cs_posed_collider_velocity(&ball, p, v);
        ck_assert_double_eq_tol(v[1], 0.6, 1e-14);
        ck_assert_double_eq_tol(v[2], 0.8, 1e-14);
    }
    fixture_frames(&cloth, 18); /* 0.5 s */
    cs_posed_collider_at(cloth.system, 1, 0.5, &ball);
    cs_posed_collider_velocity(&ball, p, v);
    ck_assert(ball.radius == 0.5 && v[1] == 0 && v[2] == 0);
    fixture_close(&cloth);
}

/* A ball that swells below a sheet lifts it, and does not come through: after 0.1 s all of it
 * is farther out than the ball, and it holds more energy than before. */
TEST(swelling_lifts_a_sheet) {
    static const char scene[] =
        "{\"bodies\": [{\"cloth\": {\"grid\": [9, 9], \"size\": [0.4, 0.4], \"start\": "
        "\"flat\","
        " \"place\": {\"translate\": [0.01, 0.21, 0.02]}}, \"mass\": {\"total\": 0.1},"
        " \"springs\": {\"stretch\": 100, \"shear\": 30, \"bend\": 1}}], \"contact\":"
        " {\"law\": \"force\", \"stiffness\": 200}, \"colliders\": [{\"sphere\": {\"centre\":"
        " [0, 0, 0], \"radius\": 0.2},"
        " \"thickness\": 0.02}], \"events\": [{\"from\": 0, \"to\": 0.1, \"ramp\": {\"key\":"
        " \"colliders[0].sphere.radius\", \"value\": 0.22}}, {\"from\": 0, \"to\": 0.1, "
        "\"ramp\":"
        " {\"key\": \"colliders[0].thickness\", \"value\": 0.03}}]}";
    struct fixture cloth;
    fixture_open(&cloth, "velocity-verlet:dt=1e-4", "%s", scene);
    fixture_start(&cloth);
    struct cs_energy before = cs_diagnostics_energy(cloth.system, 0, cloth.x, cloth.v);
    fixture_frames(&cloth, 6);
    struct cs_energy after = cs_diagnostics_energy(cloth.system, 0.1, cloth.x, cloth.v);
    double lowest = HUGE_VAL;
    for (size_t i = 0; i < cloth.n; i++) {
        const double *x = cloth.x;
        lowest = fmin(lowest, sqrt(x[i] * x[i] + x[cloth.n + i] * x[cloth.n + i] +
                                   x[2 * cloth.n + i] * x[2 * cloth.n + i]));
    }
    ck_assert_double_gt(lowest, 0.22);
    ck_assert_double_gt(after.kinetic + after.elastic + after.gravity + after.other,
                        before.kinetic + before.elastic + before.gravity + before.other);
    fixture_close(&cloth);
}

/* alpha and beta of bodies that keep their shape: a ramp at the start is the scene that has its
 * values, to the bit. */
TEST(shape_matching_follows_ramps) {
    static const char scene[] =
        "{\"bodies\": [{\"mesh\": {\"shape\": \"box\", \"detail\": 3, \"spin\": [1, 2, 3]},"
        " \"shape_matching\": {\"alpha\": %s, \"beta\": %s}, \"mass\": {\"total\": 1}}],"
        " \"colliders\": [{\"floor\": {\"height\": -0.6}}], \"events\": [%s]}";
    struct fixture ramped, plain;
    fixture_open(
        &ramped, "shape-matching:dt=0.01", scene, "0.2", "0",
        "{\"at\": 0, \"ramp\": {\"key\": \"bodies[0].shape_matching.alpha\", \"value\":"
        " 0.7}}, {\"at\": 0, \"ramp\": {\"key\": \"bodies[0].shape_matching.beta\","
        " \"value\": 0.5}}");
    fixture_open(&plain, "shape-matching:dt=0.01", scene, "0.7", "0.5", "");
    fixture_start(&ramped);
    fixture_start(&plain);
    fixture_frames(&ramped, 20);
    fixture_frames(&plain, 20);
    ck_bits(ramped.x, plain.x, 6 * plain.n, "alpha and beta");
    fixture_close(&ramped);
    fixture_close(&plain);
}

/* Air that flows past cloth, and the pressure in a balloon: against closed forms, with the work
 * in the ledger. */
#include "methods.h"

#include "model/force/terms.h"
#include "sim/energy_ledger.h"

#include <math.h>
#include <stdlib.h>

/* A flat sheet of 2 m2 and 0.5 kg that falls flat. Its area and mass go by the same fractions:
 * it stays flat. %s: the velocity of the air */
#define SHEET                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [5, 4], \"size\": [2, 1], \"start\": \"flat\"},"     \
    " \"mass\": {\"areal_density\": 0.25}, \"springs\": {\"stretch\": 40, \"shear\": 20,"      \
    " \"bend\": 0}}], \"forces\": {\"gravity\": [0, -9.81, 0], \"wind\": {\"velocity\":"       \
    " %s, \"density\": 1.3, \"drag\": 0.9}}, \"time\": {\"fps\": 100}}"

/* v = -v_t tanh(g t / v_t) with m g = rho c A v_t^2 / 2, from rest in still air, by every
 * method; as far as its order goes at its own step. */
TEST(a_parachute_has_a_terminal_speed) {
    const double terminal = sqrt(2 * 0.5 * 9.81 / (1.3 * 0.9 * 2));
    const struct methods methods =
        methods_find(&(struct methods_query){.test = "parachute", .dt = 1e-3, .rtol = 1e-9});
    for (size_t k = 0; k < methods.n; k++) {
        const struct method_asked *method = methods.list + k;
        const double tolerance = method->order_damped > 1 ? 3e-5 : 4e-3;
        struct fixture sheet;
        fixture_open(&sheet, method->text, SHEET, "[0, 0, 0]");
        fixture_start(&sheet);
        for (int frame = 25; frame <= 400; frame *= 2) {
            const double t = frame / 100.0, v = -terminal * tanh(9.81 * t / terminal);
            fixture_frames(&sheet, (uint32_t)(frame > 25 ? frame / 2 : frame));
            for (size_t i = sheet.n; i < 2 * sheet.n; i++)
                ck_assert_msg(fabs(sheet.v[i] - v) < tolerance,
                              "%s: %.9g m/s at %g s, not %.9g", method->text, sheet.v[i], t, v);
        }
        fixture_close(&sheet);
    }
}

/* What goes with the air feels none of it; against it the force is on the normal alone. */
TEST(only_the_velocity_against_the_cloth_counts) {
    struct fixture sheet;
    double f[60];
    fixture_open(&sheet, "rk4", SHEET, "[3, 4, 0]");
    struct cs_eval at = {.x = sheet.x, .v = sheet.v, .parts = CS_PART_ALL & ~CS_PART_GRAVITY};
    cs_normals_update(sheet.system, sheet.x);
    cs_terms_force(sheet.system, &at, f);
    double sum[3] = {0};
    for (size_t k = 0; k < 60; k++)
        sum[k / 20] += f[k];
    // drag 4/5 and lift -3/5 of it, by the wind's own direction
    ck_assert_double_eq_tol(sum[1], 0.5 * 1.3 * 0.9 * 2 * 16, 1e-12);
    ck_assert_double_eq_tol(sum[0], 0, 1e-12);
    for (size_t i = 0; i < 20; i++) {
        sheet.v[i] = 3;
        sheet.v[20 + i] = 4;
    }
    cs_terms_force(sheet.system, &at, f);
    for (size_t k = 0; k < 60; k++)
        ck_assert_double_eq_tol(f[k], 0, 1e-12);
    fixture_close(&sheet);
}

/* In any state the part against the velocity takes energy. */
TEST(the_rest_dissipates) {
    struct fixture sheet;
    double f[60];
    fixture_open(&sheet, "rk4", SHEET, "[3, -2, 5]");
    cs_perturb_smooth(sheet.system, 0.2, 3);
    for (int state = 1; state < 20; state++) {
        double power = 0;
        for (size_t k = 0; k < 60; k++)
            sheet.v[k] = 6 * sin(1.7 * state * (double)k);
        cs_normals_update(sheet.system, sheet.x);
        cs_terms_force(
            sheet.system,
            &(struct cs_eval){.x = sheet.x, .v = sheet.v, .parts = CS_PART_DISSIPATIVE}, f);
        for (size_t k = 0; k < 60; k++)
            power += f[k] * sheet.v[k];
        ck_assert_double_lt(power, -1e-3);
    }
    fixture_close(&sheet);
}

/* The energy of a sheet changes by the work of what acts, and by nothing else. */
static void check_ledger(const char *scene, const char *keys, double least) {
    struct fixture sheet;
    struct cs_energy_ledger ledger = {0};
    struct cs_error error = {0};
    double work = 0;
    fixture_open(&sheet, "rk4:dt=5e-4", scene, keys);
    cs_energy_ledger_open(&ledger, sheet.system, 0, &error);
    ck_assert_int_eq(error.status, CS_OK);
    sheet.session.settings.run.ledger = &ledger;
    fixture_start(&sheet);
    const double before = cs_energy_ledger_sum(&ledger);
    fixture_frames(&sheet, 20);
    for (int k = 0; k < CS_WORKS_MAX; k++)
        work += ledger.work[k];
    ck_assert_double_gt(fabs(ledger.work[CS_WORK_WIND]), least);
    ck_assert_double_lt(fabs(ledger.work[CS_WORK_INTEGRATOR]), 1e-5);
    ck_assert_double_eq_tol(cs_energy_ledger_sum(&ledger) - before, work, 1e-9);
    cs_energy_ledger_close(&ledger);
    fixture_close(&sheet);
}

/* a ball that is blown up, in still air; %s: its pressure */
#define BALL                                                                                   \
    "{\"bodies\": [{\"mesh\": {\"shape\": \"sphere\", \"detail\": 6, \"scale\": [0.2, 0.2,"    \
    " 0.2]}, \"mass\": {\"areal_density\": 0.2}, \"springs\": {\"stretch\": 60, \"bend\": 0,"  \
    " \"damping\": 0.002}, \"pressure\": %s}], \"forces\": {\"gravity\": [0, 0, 0]}}"

TEST(the_ledger_has_the_work_of_air) {
    check_ledger(SHEET, "[4, 3, -2]", 0.1);
    check_ledger(BALL, "40", 0.01);
}

/* The forces of a pressure are p dV/dx: no force and no moment on the whole, and the power is p
 * dV/dt, V by the divergence theorem. */
TEST(pressure_is_the_slope_of_the_volume) {
    struct fixture ball;
    fixture_open(&ball, "rk4", BALL, "30");
    const size_t n = ball.n;
    double *f = calloc(3 * n, sizeof *f), sum[3] = {0}, moment[3] = {0}, by_volume[2];
    cs_perturb_smooth(ball.system, 0.02, 1);
    const struct cs_trimesh *mesh = ball.system->bodies[0].mesh;
    cs_terms_force(ball.system,
                   &(struct cs_eval){.x = ball.x, .v = ball.v, .parts = CS_PART_WIND}, f);
    for (size_t i = 0; i < n; i++)
        for (size_t c = 0; c < 3; c++) {
            const size_t y = (c + 1) % 3 * n + i, z = (c + 2) % 3 * n + i;
            sum[c] += f[c * n + i];
            moment[c] += ball.x[y] * f[z] - ball.x[z] * f[y];
        }
    for (int c = 0; c < 3; c++) {
        ck_assert_double_eq_tol(sum[c], 0, 1e-13);
        ck_assert_double_eq_tol(moment[c], 0, 1e-13);
    }
    for (size_t k = 0; k < 3 * n; k += 17) {
        const double x = ball.x[k], h = 1e-5;
        for (int side = 0; side < 2; side++) {
            ball.x[k] = x + (side ? -h : h);
            by_volume[side] = 0;
            for (uint32_t t = 0; t < mesh->n_triangles; t++) {
                const uint32_t *at = mesh->triangles + 3 * (size_t)t;
                for (size_t c = 0; c < 3; c++) {
                    const size_t d = (c + 1) % 3 * n, e = (c + 2) % 3 * n;
                    by_volume[side] += ball.x[c * n + at[0]] *
                                       (ball.x[d + at[1]] * ball.x[e + at[2]] -
                                        ball.x[e + at[1]] * ball.x[d + at[2]]) /
                                       6;
                }
            }
        }
        ball.x[k] = x;
        ck_assert_double_eq_tol(f[k], 30 * (by_volume[0] - by_volume[1]) / (2 * h), 1e-9);
    }
    free(f);
    fixture_close(&ball);
}

/* A membrane of stiffness Y t and poisson nu under p: its tension T = p r / 2 (Laplace), with
 * the strain (r/R - 1) = (1 - nu) T / (Y t) for small strains. */
TEST(a_balloon_rests_at_the_radius_of_laplace) {
    struct fixture ball;
    fixture_open(&ball, "implicit-linearised:dt=0.004",
                 "{\"bodies\": [{\"mesh\": {\"shape\": \"sphere\", \"detail\": 8}, \"mass\":"
                 " {\"areal_density\": 0.2}, \"elastic\": {\"membrane\": {\"young\": 4000,"
                 " \"poisson\": 0.3}, \"damping\": 0.02}, \"pressure\": %s}],"
                 " \"forces\": {\"gravity\": [0, 0, 0], \"drag\": 0.05}}",
                 "40");
    const size_t n = ball.n;
    const double start =
        sqrt(ball.x[0] * ball.x[0] + ball.x[n] * ball.x[n] + ball.x[2 * n] * ball.x[2 * n]);
    double mean = 0;
    fixture_start(&ball);
    fixture_frames(&ball, 240);
    for (size_t i = 0; i < n; i++)
        mean += sqrt(ball.x[i] * ball.x[i] + ball.x[n + i] * ball.x[n + i] +
                     ball.x[2 * n + i] * ball.x[2 * n + i]) /
                (double)n;
    const double strain = 0.7 * 40 * start / 2 / 4000;
    ck_assert_double_eq_tol(mean / start - 1, strain, 0.06 * strain);
    fixture_close(&ball);
}

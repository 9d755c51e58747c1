/* Linear theory from the code that runs: step limits of single oscillators, the fastest motion
 * of a chain, and the verdicts of runs that are known. */
#include "borders/theory.h"
#include "session/energy_monitor.h"

#include "../physics/fixture.h"

#include <math.h>

#define PAIR                                                                                   \
    "{\"bodies\": [{\"cloth\": {\"grid\": [2, 1]}, \"mass\": {\"particle\": 1}, "              \
    "\"springs\": {\"stretch\": 1}}]}"

static double limit_of(const char *method, double square, double rate) {
    struct fixture pair;
    struct cs_error error = {0};
    double limit = (double)NAN;
    fixture_open(&pair, method, PAIR);
    const struct cs_amplification amplification = {pair.session.method.integrator,
                                                   pair.session.method.options, 0, NULL};
    cs_amplification_limit(&amplification, square, rate, &limit, &error);
    ck_assert_msg(!error.status, "%s", error.message);
    fixture_close(&pair);
    return limit;
}

/* For w = 10/s and damping rate r, by the characteristic polynomials: symplectic Euler
 * h^2 w^2 + 2 h r = 4, velocity Verlet with a predicted velocity h^2 w^2 + 4 h r = 4, forward
 * Euler h = r / w^2 where underdamped, averaged Euler twice that, RK4 h w = 2 sqrt 2. The
 * search ends within 2^(1/4) / 2^12 of the limit; what is left is the start that a method
 * with history has not quite forgotten after 8 steps. */
TEST(limits_of_one_oscillator) {
    static const struct {
        const char *method;
        double rate, limit;
    } rows[] = {{"symplectic-euler", 0, 0.2},
                {"symplectic-euler", 4, 0.164},
                {"position-verlet", 0, 0.2},
                {"position-verlet", 4, 0.164},
                {"position-verlet:loss=0.01", 0, 0.19950},
                {"velocity-verlet", 0, 0.2},
                {"velocity-verlet", 4, 0.1354},
                {"explicit-euler", 4, 0.04},
                {"averaged-euler", 4, 0.08},
                {"explicit-euler", 100, 0.0202},
                {"rk4", 0, 0.28284}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const double found = limit_of(rows[i].method, 100, rows[i].rate);
        ck_assert_msg(fabs(found / rows[i].limit - 1) < 5e-3,
                      "%s, rate %g: limit %.6g s, expected %.6g", rows[i].method, rows[i].rate,
                      found, rows[i].limit);
    }
    ck_assert_double_eq(limit_of("explicit-euler", 100, 0), 0);
    ck_assert(limit_of("implicit-linearised", 100, 0) > 1e100);
    ck_assert(limit_of("backward-euler", 100, 4) > 1e100);
}

/* A chain of n particles, both ends pinned: w^2 = 4 k/m sin^2(pi (n-2) / (2 (n-1))). */
TEST(fastest_motion_of_a_chain) {
    const double pi = 3.14159265358979323846;
    struct fixture chain;
    struct cs_stiffest_modes modes;
    struct cs_error error = {0};
    fixture_open(&chain, "velocity-verlet",
                 "{\"bodies\": [{\"cloth\": {\"grid\": [40, 1]}, \"mass\": {\"particle\": 0.5},"
                 " \"springs\": {\"stretch\": 8, \"bend\": 0, \"damping\": 0.25}, "
                 "\"pins\": [0, 39]}]}");
    ck_assert_int_eq(cs_stiffest_modes_init(&modes, chain.system, &error), CS_OK);
    const double wave = sin(pi * 38 / (2.0 * 39));
    const struct cs_mode mode = cs_stiffest_modes_largest(&modes, chain.x, 1, 0);
    ck_assert_double_eq_tol(mode.omega_squared / (4 * 8 / 0.5 * wave * wave), 1, 1e-3);
    ck_assert_double_eq_tol(mode.damping_rate / mode.omega_squared, 0.25 / 8, 1e-9);
    cs_stiffest_modes_finish(&modes);
    fixture_close(&chain);
}

/* Linear theory leaves out friction, and no damper of an elastic body: at rest the damping of a
 * membrane is `damping` times its stiffness. */
TEST(elastic_dampers_limit_steps) {
    struct fixture sheet;
    struct cs_theory theory;
    struct cs_theory_limit limit;
    struct cs_error error = {0};
    fixture_open(&sheet, "symplectic-euler",
                 "{\"bodies\": [{\"cloth\": {\"grid\": [7, 7], \"size\": [1, 1]}, \"pins\": "
                 "[\"top\"], \"mass\": {\"areal_density\": 0.2}, \"elastic\": {\"membrane\": "
                 "{\"young\": 2e4}, \"damping\": 1e-4}}]}");
    const struct cs_method *method = &sheet.session.method;
    ck_assert_int_eq(
        cs_theory_init(&theory, sheet.system, method->integrator, method->options, 0, &error),
        CS_OK);
    ck_assert_int_eq(cs_theory_at(&theory, sheet.x, &limit, &error), CS_OK);
    ck_assert_double_eq_tol(limit.mode.damping_rate / limit.mode.omega_squared, 1e-4, 1e-9);
    // explicit dampers: h^2 w^2 + 2 h c = 4, instead of h = 2/w
    const double w = sqrt(limit.mode.omega_squared), c = limit.mode.damping_rate;
    ck_assert_double_eq_tol(limit.dt * limit.dt * w * w + 2 * limit.dt * c, 4, 0.02);
    cs_theory_finish(&theory);
    fixture_close(&sheet);
}

/* Pulled apart by hand, one particle in a sound cloth is a local instability; thrown apart as a
 * whole, it is a global one. */
TEST(watch_tells_local_from_global) {
    struct fixture cloth;
    struct cs_energy_monitor monitor;
    struct cs_energy_monitor_row row;
    struct cs_error error = {0};
    fixture_open(&cloth, "velocity-verlet",
                 "{\"bodies\": [{\"cloth\": {\"grid\": [20, 20]}, \"mass\": {\"particle\": 1}, "
                 "\"springs\": {\"stretch\": 100}, \"pins\": [\"top\"]}]}");
    fixture_start(&cloth);
    ck_assert_int_eq(cs_energy_monitor_begin(&monitor, &cloth.session.run, &error), CS_OK);
    fixture_frames(&cloth, 30);
    cs_energy_monitor_sample(&monitor, &cloth.session.run, &row);
    ck_assert_int_eq(row.verdict, CS_STABILITY_BEYOND); // its springs are that soft
    cloth.v[250] = 1.2 * row.speed_limit;
    cs_energy_monitor_sample(&monitor, &cloth.session.run, &row);
    ck_assert_int_eq(row.verdict, CS_STABILITY_LOCAL);
    ck_assert_uint_eq(row.particle, 250);
    ck_assert_uint_eq(row.particles, 1);
    for (size_t i = 100; i < 400; i++)
        cloth.v[i] = 20 * row.speed_limit;
    cs_energy_monitor_sample(&monitor, &cloth.session.run, &row);
    ck_assert_int_eq(row.verdict, CS_STABILITY_GLOBAL);
    ck_assert(row.made > 100 * row.bound);
    cloth.v[7] = (double)NAN;
    cs_energy_monitor_sample(&monitor, &cloth.session.run, &row);
    ck_assert_int_eq(row.verdict, CS_STABILITY_NOT_FINITE);
    ck_assert_int_eq(monitor.first.verdict, CS_STABILITY_LOCAL);
    fixture_close(&cloth);
}

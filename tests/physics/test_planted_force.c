/* A force that the program does not know reaches every method, by what it says of itself.
 *
 * The planted forces (planted_terms.h) act on a free sheet that moves as a whole, so that each
 * has a closed form or an ODE in one number:
 *   resistance  v' = -2 v                      v(1) = exp(-2)
 *   trap        q'' = -k q^3/m                 Runge-Kutta in steps of 1e-4
 *   swing       v' = cos(3 t)                  v(1) = sin(3)/3, x(1) = (1 - cos 3)/9
 * Methods with a step are run at two and must fall by their order; those with error control
 * must meet 1e-5. Methods of another model are left out. */
#include "borders/sampled_run.h"
#include "methods.h"
#include "model/force/diagnostics.h"
#include "model/force/terms.h"
#include "model/solver/linear.h"
#include "planted_terms.h"
#include "sim/energy_ledger.h"
#include "sim/registry.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SHEET                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [4, 3], \"velocity\": [1, 0, 0.5]}, \"mass\": "      \
    "{\"particle\": 0.1}, \"springs\": {\"stretch\": 0.2, \"shear\": 0.1, \"bend\": 0.05}}],"  \
    " \"forces\": {\"gravity\": [0, 0, 0]}}"

#define MASS 0.1

/* what a particle's state is at t = 1 s: place since the start and velocity along one line */
struct motion {
    double q, v;
};

static struct motion end_of(const struct fixture *cloth, const double *direction) {
    struct motion end = {0};
    const size_t n = cloth->n;
    for (size_t c = 0; c < 3; c++) {
        end.q += direction[c] * (cloth->x[c * n] - cloth->system->start[c * n]);
        end.v += direction[c] * cloth->v[c * n];
    }
    return end;
}

/* q'' = -k q^3/m from q = 0, q' = v */
static struct motion trapped(double v) {
    const int steps = 10000;
    const double h = 1.0 / steps, k = planted.trap / MASS;
    double q = 0;
    for (int i = 0; i < steps; i++) {
        const double q1 = v, v1 = -k * pow(q, 3);
        const double q2 = v + h / 2 * v1, v2 = -k * pow(q + h / 2 * q1, 3);
        const double q3 = v + h / 2 * v2, v3 = -k * pow(q + h / 2 * q2, 3);
        const double q4 = v + h * v3, v4 = -k * pow(q + h * q3, 3);
        q += h / 6 * (q1 + 2 * q2 + 2 * q3 + q4);
        v += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
    }
    return (struct motion){q, v};
}

/* largest error of place and velocity after a second */
static double error_of(const char *method, const double *direction, struct motion expected) {
    struct fixture cloth;
    fixture_open(&cloth, method, SHEET);
    fixture_start(&cloth);
    fixture_frames(&cloth, 60);
    const struct motion end = end_of(&cloth, direction);
    fixture_close(&cloth);
    return fmax(fabs(end.q - expected.q), fabs(end.v - expected.v));
}

static void check_order(const struct method_asked *method, const char *force,
                        const double *direction, struct motion expected) {
    double errors[2];
    for (int k = 0; k < 2; k++) {
        char text[120];
        methods_set(text, method->text, "dt", 1 / (240.0 * (1 + k)));
        errors[k] = error_of(text, direction, expected);
    }
    const double order = log2(errors[0] / errors[1]), least = method->order_damped - 0.25;
    // below the first, rounding and the tolerances of solvers are all there is
    ck_assert_msg(errors[1] < 1e-6 || (order > least && errors[1] < 0.05),
                  "%s, %s: off by %g, at half the step %g: order %.2f", method->text, force,
                  errors[0], errors[1], order);
}

static void check_all(const char *force, const double *direction, struct motion expected) {
    const struct methods methods =
        methods_find(&(struct methods_query){.test = "planted force", .rtol = 1e-7});
    ck_assert_uint_ge(methods.n_by_trait, 15);
    for (size_t k = 0; k < methods.n; k++) {
        const struct method_asked *method = methods.list + k;
        if (!(method->traits & CS_ADAPTIVE)) {
            check_order(method, force, direction, expected);
            continue;
        }
        const double error = error_of(method->text, direction, expected);
        ck_assert_msg(error < 1e-5, "%s, %s: off by %g", method->text, force, error);
    }
}

static const double x_axis[3] = {1, 0, 0};

TEST(resistance_reaches_every_method) {
    planted = (struct planted){.resist = 2};
    check_all("resistance", x_axis, (struct motion){(1 - exp(-2)) / 2, exp(-2)});
}

TEST(trap_reaches_every_method) {
    planted = (struct planted){.trap = 0.4};
    check_all("trap", planted_direction, trapped(1));
}

TEST(swing_reaches_every_method) {
    planted = (struct planted){.swing = 1};
    check_all("swing", x_axis, (struct motion){1 + (1 - cos(3)) / 9, 1 + sin(3) / 3});
}

/* 40 x 40 particles, stiff enough for the multigrid's levels; half of them in a trap that is
 * stiffer still, of which the solver sees 3x3 blocks. */
TEST(solver_takes_blocks) {
    for (int trap = 0; trap < 2; trap++) {
        struct fixture cloth;
        struct cs_arena arena = {0};
        struct cs_error error = {0};
        struct cs_linear linear;
        uint64_t iterations;
        double residual;
        planted = (struct planted){.trap = trap ? 1e5 : 0, .trap_damping = trap ? 1e4 : 0};
        fixture_open(&cloth, "implicit-linearised",
                     "{\"bodies\": [{\"cloth\": {\"grid\": [40, 40]}, \"mass\": "
                     "{\"areal_density\": 0.3}, \"springs\": {\"stretch\": 200, \"shear\": 75,"
                     " \"bend\": 25}, \"pins\": [0, 77]}]}");
        const size_t n = cloth.n;
        double *b = calloc(9 * n, sizeof *b), *u = b + 3 * n, *au = u + 3 * n;
        for (size_t i = 0; i < n; i++)
            for (size_t c = 0; c < 3; c++) {
                const bool free = cloth.system->inv_mass[i] > 0;
                cloth.x[c * n + i] *= free ? 1.5 : 1;
                // off their start in a corner only
                cloth.x[c * n + i] += free && i % 40 < 20 ? 0.01 * planted_direction[c] : 0;
                b[c * n + i] = free ? sin(1.7 * (double)i + (double)c) : 0;
            }
        const double h = 0.01;
        const struct cs_matrix matrix = {
            .x = cloth.x, .v = cloth.v, .cm = 1, .cd = -h, .ck = -h * h, .psd = true};
        ck_assert_int_eq(cs_linear_init(&linear, cloth.system, &arena, &error), CS_OK);
        cs_linear_setup(&linear, &matrix);
        ck_assert(linear.stiff);
        ck_assert(!linear.blocks == !trap);
        ck_assert_int_eq(cs_linear_solve(&linear, b, 1e-8, u, &iterations, &residual),
                         CS_LINEAR_DONE);
        ck_assert_uint_lt(iterations, 60);

        // A u by the products of the forces, which no solver made; stretched, so psd drops
        // nothing
        for (size_t i = 0; i < 3 * n; i++)
            u[i] = -u[i];
        cs_terms_jvp(
            cloth.system,
            &(struct cs_eval){.x = cloth.x, .v = cloth.v, .parts = CS_PART_LINEARISED, .dx = u},
            au);
        double off = 0, size = 0;
        for (size_t i = 0; i < 3 * n; i++)
            au[i] *= h * h;
        double *damped = calloc(3 * n, sizeof *damped);
        cs_terms_jvp(
            cloth.system,
            &(struct cs_eval){.x = cloth.x, .v = cloth.v, .parts = CS_PART_LINEARISED, .dv = u},
            damped);
        for (size_t i = 0; i < 3 * n; i++) {
            const bool free = cloth.system->inv_mass[i % n] > 0;
            const double found = au[i] + h * damped[i] - cloth.system->mass[i % n] * u[i];
            off += free ? (found - b[i]) * (found - b[i]) : 0;
            size += b[i] * b[i];
        }
        ck_assert_double_le(sqrt(off / size), 2e-8);
        free(damped);
        free(b);
        cs_arena_finish(&arena);
        fixture_close(&cloth);
    }
}

/* the bounds of the trap are those of its block; those of the run leave it out */
TEST(bounds_follow_the_state) {
    struct fixture cloth;
    double work[24], omega, delta;
    planted = (struct planted){.trap = 50, .trap_damping = 3, .resist = 2};
    fixture_open(&cloth, "rk4", SHEET);
    const double q = 0.3, rest = cloth.system->view.omega;
    for (size_t c = 0; c < 3; c++)
        cloth.x[c * 12 + 5] += q * planted_direction[c];
    const struct cs_eval at = {.x = cloth.x, .v = cloth.v, .parts = CS_PART_ALL};
    cs_spectral_bounds_at(cloth.system, &at, work, &omega, &delta);
    const double springs = 2 * (4 * 0.2 + 4 * 0.1 + 2 * 0.05 + 0.05 * (12 > 4)) / MASS;
    ck_assert_double_le(omega * omega, 3 * 50 * q * q / MASS + springs);
    ck_assert_double_ge(omega * omega, 3 * 50 * q * q / MASS);
    ck_assert_double_eq_tol(delta, 0.5 * (2 * MASS + 3 * q * q) / MASS, 1e-12);
    ck_assert_double_lt(rest * rest, springs);
    ck_assert_double_eq_tol(cloth.system->view.delta, 1, 1e-14);
    fixture_close(&cloth);
}

/* what the column of a name has in the account's row */
static double entry(const struct cs_energy_ledger *account, const char *name) {
    struct cs_text text = {0};
    char *head_at, *row_at, *head, *row;
    double value = (double)NAN;
    cs_energy_ledger_print_head(&text);
    cs_energy_ledger_print_row(account, 0, &text);
    head = strtok_r(text.bytes, "\n", &head_at);
    row = strtok_r(NULL, "\n", &head_at);
    head = strtok_r(head, ",", &head_at);
    row = strtok_r(row, ",", &row_at);
    for (; head && row;
         head = strtok_r(NULL, ",", &head_at), row = strtok_r(NULL, ",", &row_at))
        if (!strcmp(head, name))
            value = strtod(row, NULL);
    cs_text_finish(&text);
    return value;
}

/* the account of a second of the sheet, which stands where it is until close */
static void run_account(struct fixture *cloth, struct cs_energy_ledger *account) {
    struct cs_error error = {0};
    fixture_open(cloth, "dopri5:rtol=1e-12,atol=1e-13", SHEET);
    cloth->session.settings.run.ledger = account;
    cs_energy_ledger_open(account, cloth->system, 0, &error);
    ck_assert_int_eq(error.status, CS_OK);
    fixture_start(cloth);
    fixture_frames(cloth, 60);
}

static void close_account(struct fixture *cloth, struct cs_energy_ledger *account) {
    cs_energy_ledger_close(account);
    fixture_close(cloth);
}

/* by its name alone, and none is friction or a push; nothing is left to a tight method */
TEST(energy_ledger_has_a_column_for_each) {
    const double kinetic = 0.5 * MASS * 12 * 1.25;
    struct fixture cloth;
    struct cs_energy_ledger account;
    planted = (struct planted){.resist = 2};
    run_account(&cloth, &account);
    ck_assert_double_eq_tol(entry(&account, "planted_resistance"), (exp(-4) - 1) * kinetic,
                            1e-9);
    ck_assert_double_eq(entry(&account, "friction"), 0);
    ck_assert_double_eq_tol(entry(&account, "integrator"), 0, 1e-9);
    close_account(&cloth, &account);

    planted = (struct planted){.trap = 3, .trap_damping = 0.5};
    run_account(&cloth, &account);
    ck_assert_double_gt(entry(&account, "planted_trap"), 1e-3);
    ck_assert_double_lt(entry(&account, "planted_trap_work"), -1e-3);
    ck_assert_double_eq(entry(&account, "other"), 0);
    ck_assert_double_eq(entry(&account, "friction"), 0);
    ck_assert_double_eq_tol(entry(&account, "integrator"), 0, 1e-9);
    ck_assert_double_eq_tol(entry(&account, "sum"),
                            kinetic + entry(&account, "planted_trap_work"), 1e-9);
    close_account(&cloth, &account);

    planted = (struct planted){.swing = 1};
    run_account(&cloth, &account);
    ck_assert_double_eq_tol(entry(&account, "planted_swing"),
                            entry(&account, "kinetic") - kinetic, 1e-9);
    ck_assert_double_eq(entry(&account, "events_force"), 0);
    close_account(&cloth, &account);
    planted = (struct planted){0};
}

/* The singular force of a run of a sheet that ends after so long. */
static struct cs_singular_force find_singular(double seconds) {
    const struct cs_session_settings settings = {.scene = "sheet.json", .text = SHEET};
    struct cs_singular_force found;
    struct cs_error error = {0};
    ck_assert_int_eq(cs_singular_force_find(&settings, seconds, 16000, &found, &error), CS_OK);
    return found;
}

/* When rk4 ends with a step, in s. */
static double end_by_rk4(double dt) {
    const struct cs_sampled_run_settings settings = {
        .session = {.scene = "sheet.json", .text = SHEET, .integrator = "rk4", .dt = dt},
        .seconds = 1,
        .samples = 10};
    struct cs_sampled_run run;
    struct cs_error error = {0};
    ck_assert_int_eq(cs_sampled_run_execute(&run, &settings, &error), CS_OK);
    ck_assert(cs_outcome_is_blow_up(run.result.outcome));
    return run.result.time;
}

/* A trap that pushes away, q'' = K q^3 with K = 400/(m s)^2 from q = 0, q' = 1 m/s: q is
 * infinite at t = (2/K)^(1/4) times the integral of du/sqrt(1 + u^4), 1.8540747, and the energy
 * is unbounded before. A step that is too long ends elsewhere at half the step. */
TEST(singular_force_is_told_from_a_long_step) {
    planted = (struct planted){.trap = -400 * MASS};
    const struct cs_singular_force found = find_singular(1);
    const double end = 1.8540747 * pow(2.0 / 400, 0.25), t = found.time;
    ck_assert_msg(strstr(found.text, "a force is singular at t = "), "%s", found.text);
    ck_assert_msg(t > 0.8 * end && t < end, "%g s, expected 0.8 to 1 times %g s", t, end);
    for (double dt = 1e-3; dt > 1e-4; dt /= 2)
        ck_assert_double_eq_tol(end_by_rk4(dt), t, 0.04 * end);
    planted = (struct planted){.resist = 1e3};
    ck_assert_double_gt(end_by_rk4(0.05), 2 * end_by_rk4(0.0125));
    ck_assert_str_eq(find_singular(1).text, "");
}

/* Attraction by a plane: r'' = -G/r^2 from r = R = 1/2 m and r' = -1 m/s, with G = R^2 m. Then
 * r'^2/2 - G/r is 0 for good, and r^(3/2) = R^(3/2) - (3/2) sqrt(2 G) t. */
TEST(singular_attraction_is_found_at_its_time) {
    planted = (struct planted){.attract = 0.25, .distance = -0.5};
    const double end = pow(0.5, 1.5) / (1.5 * sqrt(2 * 0.25));
    const struct cs_singular_force found = find_singular(1);
    ck_assert_double_eq_tol(found.time, end, 1e-3 * end);
    for (double dt = 1e-3; dt > 1e-4; dt /= 2)
        ck_assert_double_eq_tol(end_by_rk4(dt), end, 2 * dt);
}

/* Evaluations of a search along a stiff sheet, which no search follows to the end. */
static long count_calls(double evaluations) {
    const struct cs_session_settings settings = {
        .scene = "stiff.json",
        .text = "{\"bodies\": [{\"cloth\": {\"grid\": [4, 3], \"stretch\": [1.05, 1.05]}, "
                "\"mass\": {\"particle\": 0.1}, \"springs\": {\"stretch\": 2e6}}]}"};
    struct cs_singular_force found;
    struct cs_error error = {0};
    planted = (struct planted){.swing = 1};
    ck_assert_int_eq(cs_singular_force_find(&settings, 100, evaluations, &found, &error),
                     CS_OK);
    ck_assert_str_eq(found.text, "");
    return planted.calls;
}

/* A nominal call takes more than 1e-6 s; a step of dop853 takes some 12 evaluations. */
TEST(search_for_a_singular_force_keeps_its_budget) {
    const long least = count_calls(0), more = count_calls(30000);
    ck_assert_int_gt(least, 100);
    ck_assert_int_lt(least, (long)(CS_SINGULAR_SECONDS / 1e-6) + 50);
    ck_assert_int_ge(more, least + 29900);
    ck_assert_int_le(more, least + 30050);
    planted = (struct planted){0};
}

/* What all position-level methods share, whatever they come to: closed forms of motions along
 * one spring and in free fall, momentum, pins, memory and substeps. */
#include "allocations.h"
#include "position_level.h"

#include <math.h>
#include <string.h>

static const char *const methods[] = {
    "xpbd",       "xpbd:mode=pbd", "xpbd:substeps=4,iterations=1",
    LOCAL_GLOBAL, QUASI_NEWTON,    "vbd:iterations=200,rho=0.7"};
enum { METHODS = sizeof methods / sizeof *methods };

static bool is_missing(const char *method) {
    return (!strcmp(method, LOCAL_GLOBAL) || !strcmp(method, QUASI_NEWTON)) &&
           !is_built(method);
}

#define PAIR                                                                                   \
    "{\"bodies\": [{\"cloth\": {\"grid\": [2, 1]}, \"mass\": {\"particle\": 0.5}, "            \
    "\"springs\": "                                                                            \
    "{\"stretch\": 25, \"damping\": 0.6, \"damping_model\": \"%s\"}}],"                        \
    " \"forces\": {\"gravity\": [0, 0, 0]}, \"time\": {\"fps\": 20}}"

/* Along one spring all is linear, and the methods take the implicit Euler step itself. */
TEST(pair_swings_by_the_closed_form) {
    static const char *const rows[][2] = {{"xpbd:iterations=1", "axial"},
                                          {"xpbd:iterations=200", "relative"},
                                          {"vbd:iterations=200", "relative"},
                                          {"vbd:iterations=200", "axial"},
                                          {QUASI_NEWTON, "relative"},
                                          {LOCAL_GLOBAL ":iterations=1", "relative"},
                                          {LOCAL_GLOBAL ":iterations=1", "axial"}};
    const double k = 25, c = 0.6, h = 1 / 20.0, mu = 2 / 0.5;
    double s = 0.1, w = 0;
    for (int i = 0; i < 20; i++) {
        w = (w - h * mu * k * s) / (1 + h * mu * c + h * h * mu * k);
        s += h * w;
    }
    for (size_t r = 0; r < 7 && (r < 4 || is_built(LOCAL_GLOBAL)); r++) {
        struct fixture pair;
        fixture_open(&pair, rows[r][0], PAIR, rows[r][1]);
        pair.x[0] -= 0.05, pair.x[1] += 0.05;
        fixture_start(&pair);
        fixture_frames(&pair, 20);
        ck_assert_double_eq_tol(pair.x[1] - pair.x[0] - 1, s, 1e-13);
        ck_assert_double_eq_tol(pair.v[1] - pair.v[0], w, 1e-12);
        fixture_close(&pair);
    }
}

/* N steps of h fall g h^2 N (N + 1) / 2, with springs at rest and velocity kept to the bit. */
TEST(cloth_falls_freely) {
    for (size_t m = 0; m < METHODS; m++) {
        if (is_missing(methods[m]))
            continue;
        struct fixture cloth;
        fixture_open(&cloth, methods[m],
                     "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6], \"velocity\": [1, 0, 2]}, "
                     "\"mass\": {\"total\": 0.3}, \"springs\": {\"stretch\": 500, \"damping\": "
                     "0.1}}]}");
        const double top = cloth.x[36];
        fixture_start(&cloth);
        fixture_frames(&cloth, 60);
        const double n = (double)cloth.session.run.counts.steps;
        const double expected = 9.81 / (n * n) * n * (n + 1) / 2;
        for (size_t i = 0; i < 36; i++) {
            ck_assert_double_eq_tol(cloth.v[i], 1, 1e-12);
            ck_assert_double_eq_tol(cloth.v[72 + i], 2, 1e-12);
        }
        ck_assert_double_eq_tol(top - cloth.x[36], expected, 1e-11);
        fixture_close(&cloth);
    }
}

TEST(momentum_is_kept) {
    static const char *const models[] = {"relative", "axial"};
    for (size_t m = 0; m < METHODS; m++)
        for (size_t k = 0; k < 2 && !is_missing(methods[m]); k++) {
            struct fixture cloth;
            double before[3], later[3], turning[3];
            fixture_open(
                &cloth, methods[m],
                "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6]}, \"mass\": "
                "{\"areal_density\": 0.3}, \"springs\": {\"stretch\": 500, \"damping\": "
                "0.1, \"damping_model\": \"%s\"}}], \"forces\": {\"gravity\": [0, 0, "
                "0]}}",
                models[k]);
            cs_perturb_smooth(cloth.system, 0.02, 1);
            fixture_start(&cloth);
            fixture_momentum(&cloth, before, turning);
            fixture_frames(&cloth, 60);
            fixture_momentum(&cloth, later, turning);
            for (int c = 0; c < 3; c++)
                // blocks of one particle pair their forces in the limit alone
                ck_assert_msg(fabs(later[c] - before[c]) <
                                  (strncmp(methods[m], "vbd", 3) ? 1e-13 : 1e-8),
                              "%s: %.17g became %.17g", methods[m], before[c], later[c]);
            fixture_close(&cloth);
        }
}

#define FULL                                                                                   \
    "{\"bodies\": [{\"cloth\": {\"grid\": [8, 8]}, \"mass\": {\"total\": 0.2}, \"springs\": "  \
    "{\"damping\": 0.02}, \"pins\": [\"top-left\", 20]}], \"forces\": {\"drag\": 0.01,"        \
    " \"wind\": {\"direction\": [0, 0, 1], \"strength\": 2}}}"

/* Pinned particles keep every bit of their place; what is kept of a step's work is taken in the
 * first one. */
TEST(pins_hold_and_steps_take_no_memory) {
    allocations_begin();
    for (size_t m = 0; m < METHODS; m++) {
        if (is_missing(methods[m]))
            continue;
        struct fixture cloth;
        struct cs_error error = {0};
        fixture_open(&cloth, methods[m], FULL);
        fixture_start(&cloth);
        cs_run_frame(&cloth.session.run, &error);
        const uint64_t before = allocations;
        for (int frame = 1; frame < 60; frame++)
            cs_run_frame(&cloth.session.run, &error);
        const uint64_t taken = allocations - before;
        ck_assert_msg(!error.status, "%s", error.message);
        ck_assert_msg(taken == 0, "%s took memory %llu times", methods[m],
                      (unsigned long long)taken);
        ck_assert_int_eq(cloth.session.run.outcome, CS_RUNNING);
        for (size_t i = 0; i < cloth.n; i++)
            for (size_t c = 0; c < 3; c++) {
                if (cloth.system->inv_mass[i] > 0)
                    continue;
                ck_assert_double_eq(cloth.x[c * 64 + i], cloth.system->start[c * 64 + i]);
                ck_assert_double_eq(cloth.v[c * 64 + i], 0);
            }
        fixture_close(&cloth);
    }
}

/* substeps=S of dt is dt/S, to the bit */
TEST(substeps_are_steps) {
    struct fixture parts, small;
    fixture_open(&parts, "xpbd:substeps=5,iterations=2,dt=0.01", FULL);
    fixture_open(&small, "xpbd:iterations=2,dt=0.002", FULL);
    fixture_start(&parts);
    fixture_start(&small);
    fixture_frames(&parts, 10);
    fixture_frames(&small, 10);
    ck_assert_uint_eq(parts.session.run.counts.steps, 10 * 2 * 5);
    ck_assert_uint_eq(parts.session.run.counts.method.newton, 10 * 2 * 5 * 2);
    ck_assert_uint_eq(small.session.run.counts.steps, 10 * 9);
    fixture_close(&parts);
    fixture_close(&small);

    fixture_open(&parts, "xpbd:substeps=5,iterations=2", FULL);
    fixture_open(&small, "xpbd:iterations=2,dt=0.00333333333333333", FULL);
    fixture_start(&parts);
    fixture_start(&small);
    fixture_frames(&parts, 10);
    fixture_frames(&small, 10);
    ck_assert_int_eq(memcmp(parts.x, small.x, 6 * 64 * sizeof(double)), 0);
    fixture_close(&parts);
    fixture_close(&small);
}

/* A sheet at rest length falls as a whole, y = -g h^2 n (n + 1)/2 after n steps: residuals of
 * rounding alone are no curvature, at any step and with drag on all particles alike. */
TEST(free_fall_leaves_rounding_alone) {
    static const double steps[] = {0.0005, 0.001, 0.003};
    for (size_t k = 0; is_built(QUASI_NEWTON) && k < 6; k++) {
        const double h = steps[k % 3], fall = 9.81 * h * h * 30 * 31 / 2;
        const bool drags = k >= 3;
        struct fixture cloth;
        fixture_open(&cloth, QUASI_NEWTON,
                     "{\"bodies\": [{\"cloth\": {\"grid\": [3, 3]}, \"mass\": {\"particle\": "
                     "0.01}, \"springs\": {\"stretch\": 100, \"shear\": 30, \"bend\": 5}}], "
                     "\"forces\": {\"drag\": %s}, \"time\": {\"fps\": %.17g}}",
                     drags ? "0.05" : "0", 1 / h);
        fixture_start(&cloth);
        fixture_frames(&cloth, 30);
        for (size_t i = 0; i < 3 * cloth.n; i++) {
            const double moved = cloth.x[i] - cloth.system->view.start[i];
            const bool falls = i / cloth.n == 1;
            const double expected = falls && drags
                                        ? cloth.x[cloth.n] - cloth.system->view.start[cloth.n]
                                    : falls ? -fall
                                            : 0;
            ck_assert_msg(fabs(moved - expected) < 1e-12,
                          "step %g s: %zu moved by %.17g m, expected %.17g", h, i, moved,
                          expected);
        }
        fixture_close(&cloth);
    }
}

/* What the position-level methods come to: fast-mass-spring, projective-dynamics and vbd to
 * implicit Euler as their iterations grow, xpbd to a place of its own beside it that implicit
 * Euler and it share as h goes to 0, its mode pbd to nothing.
 *
 * The implicit Euler step is found by a Newton method of this test, with a dense matrix.
 */
#include "allocations.h"
#include "fixture.h"

#include "model/force/terms.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define LOCAL_GLOBAL "fast-mass-spring"
#define QUASI_NEWTON "projective-dynamics"
#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [9, 9]}, \"mass\": {\"particle\": 1}, \"springs\": " \
    "{\"stretch\": 200, \"shear\": 60, \"bend\": 20%s}, \"pins\": [\"top-left\"]}],"           \
    " \"forces\": {\"drag\": %s}, \"time\": {\"fps\": %.17g}}"

enum { N = 81, VALUES = 3 * N };

/* The method on CHOLMOD may be missing from a build. */
static bool is_built(const char *name) {
    struct cs_registry registry = {0};
    struct cs_error error = {0};
    const struct cs_registry_entry *found;
    const bool built = !cs_registry_find(&registry, name, &found, &error);
    ck_assert_msg(built || error.status == CS_ERR_USAGE, "%s", error.message);
    cs_registry_finish(&registry);
    return built;
}

/* solves a u = b by elimination with row exchange; a and b are lost, u comes in b */
static void solve_dense(double (*a)[VALUES], double *b) {
    for (size_t j = 0; j < VALUES; j++) {
        size_t best = j;
        for (size_t i = j + 1; i < VALUES; i++)
            best = fabs(a[i][j]) > fabs(a[best][j]) ? i : best;
        for (size_t k = 0; k < VALUES; k++) {
            const double kept = a[j][k];
            a[j][k] = a[best][k];
            a[best][k] = kept;
        }
        const double kept = b[j];
        b[j] = b[best];
        b[best] = kept;
        for (size_t i = j + 1; i < VALUES; i++) {
            const double share = a[i][j] / a[j][j];
            for (size_t k = j; k < VALUES && share != 0; k++)
                a[i][k] -= share * a[j][k];
            b[i] -= share * b[j];
        }
    }
    for (size_t i = VALUES; i-- > 0;) {
        for (size_t k = i + 1; k < VALUES; k++)
            b[i] -= a[i][k] * b[k];
        b[i] /= a[i][i];
    }
}

/* g = h f(x, v) - M (v - v0) with v = (x - x0) / h; its norm */
static double miss(const struct fixture *cloth, double h, const double *x, double *v,
                   double *g) {
    const double *x0 = cloth->x, *v0 = cloth->v;
    double squared = 0;
    for (size_t k = 0; k < VALUES; k++)
        v[k] = (x[k] - x0[k]) / h;
    cs_terms_force(cloth->system, &(struct cs_eval){.x = x, .v = v, .parts = CS_PART_ALL}, g);
    for (size_t k = 0; k < VALUES; k++) {
        g[k] = cloth->system->inv_mass[k % N] > 0 ? h * g[k] - (v[k] - v0[k]) : 0;
        squared += g[k] * g[k];
    }
    return sqrt(squared);
}

/* The implicit Euler step of length h from the state of a cloth without wind: x (3,n). Newton
 * steps are halved until the miss shrinks. */
static void newton(const struct fixture *cloth, double h, double *x) {
    static double a[VALUES][VALUES];
    double v[VALUES], g[VALUES], tried[VALUES], column[VALUES], unit[VALUES] = {0},
                                                                rate[VALUES] = {0};
    for (size_t k = 0; k < VALUES; k++)
        x[k] = cloth->x[k] + h * cloth->v[k];
    double left = miss(cloth, h, x, v, g);
    for (int i = 0; i < 100 && left > 1e-13; i++) {
        for (size_t j = 0; j < VALUES; j++) {
            const bool free = cloth->system->inv_mass[j % N] > 0;
            unit[j] = free;
            rate[j] = free / h;
            cs_terms_jvp(
                cloth->system,
                &(struct cs_eval){.x = x, .v = v, .parts = CS_PART_ALL, .dx = unit, .dv = rate},
                column);
            for (size_t k = 0; k < VALUES; k++)
                a[k][j] = k == j ? (free ? 1 / h : 1) - h * column[k] : -h * column[k];
            unit[j] = rate[j] = 0;
        }
        solve_dense(a, g);
        double share = 1, next;
        do {
            for (size_t k = 0; k < VALUES; k++)
                tried[k] = x[k] + share * g[k];
            next = miss(cloth, h, tried, v, column);
            share /= 2;
        } while (next > left && share > 1e-6);
        if (next >= left)
            break; // rounding
        memcpy(x, tried, sizeof tried);
        left = miss(cloth, h, x, v, g);
    }
    ck_assert_double_lt(left, 1e-11);
}

struct start {
    const char *damping, *drag;
    double h, speed;
};

static void open(struct fixture *cloth, const char *integrator, const struct start *from) {
    fixture_open(cloth, integrator, SCENE, from->damping, from->drag, 1 / from->h);
    cs_perturb_smooth(cloth->system, 0.01, from->speed);
}

/* Distance in m (root of the mean square) of one step of a method from implicit Euler. */
static double distance(const char *integrator, const struct start *from) {
    struct fixture cloth;
    double expected[VALUES];
    open(&cloth, integrator, from);
    newton(&cloth, from->h, expected);
    fixture_start(&cloth);
    fixture_frames(&cloth, 1);
    const double found = cs_rms_difference(cloth.x, expected, VALUES) * sqrt(3);
    fixture_close(&cloth);
    return found;
}

static double after(const char *method, int iterations, const struct start *from) {
    char integrator[80];
    snprintf(integrator, sizeof integrator, "%s%citerations=%d", method,
             strchr(method, ':') ? ',' : ':', iterations);
    return distance(integrator, from);
}

/* Every kind of damping is part of the step, and none spoils the limit. */
TEST(local_global_comes_to_implicit_euler) {
    static const struct {
        struct start start;
        double ten; /* m, bound after ten iterations */
    } rows[] = {
        {{"", "0", 1 / 60.0, 1}, 1e-8},
        {{"", "0", 1 / 20.0, 1}, 3e-4},
        {{"", "0", 1 / 8.0, 1}, 1e-2},
        {{", \"damping\": 0.5, \"damping_model\": \"relative\"", "0.7", 1 / 20.0, 1}, 3e-4},
        {{", \"damping\": 0.5, \"damping_model\": \"axial\"", "0.7", 1 / 20.0, 1}, 3e-4}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows && is_built(LOCAL_GLOBAL); k++) {
        const struct start *from = &rows[k].start;
        double one = after(LOCAL_GLOBAL, 1, from), ten = after(LOCAL_GLOBAL, 10, from);
        double many = after(LOCAL_GLOBAL, 2000, from);
        ck_assert_msg(one > ten && ten < rows[k].ten && many < 1e-12,
                      "row %zu: %.3g m after 1 iteration, %.3g after 10, %.3g after 2000", k,
                      one, ten, many);
    }
}

/* The same step by blocks of one particle, which damps what is left of each pass, and by
 * L-BFGS. */
TEST(vbd_and_quasi_newton_come_to_implicit_euler) {
    static const struct {
        const char *method;
        int few, many;
        double bound; /* m, after the few */
    } rows[] = {{"vbd", 30, 2000, 1e-3},
                {"vbd:rho=0.9", 30, 1000, 1e-3},
                {QUASI_NEWTON, 10, 100, 1e-5}};
    static const struct start starts[] = {
        {"", "0", 1 / 20.0, 1},
        {", \"damping\": 0.5, \"damping_model\": \"relative\"", "0", 1 / 20.0, 1},
        {", \"damping\": 0.5, \"damping_model\": \"axial\"", "0", 1 / 20.0, 1}};
    for (size_t k = 0; k < 9; k++) {
        const char *method = rows[k / 3].method;
        const struct start *from = starts + k % 3;
        if (!is_built(method[0] == 'p' ? QUASI_NEWTON : "vbd"))
            continue;
        const double few = after(method, rows[k / 3].few, from);
        const double many = after(method, rows[k / 3].many, from);
        ck_assert_msg(few < rows[k / 3].bound && many < 1e-12,
                      "%s, start %zu: %.3g m after %d iterations, %.3g after %d", method, k % 3,
                      few, rows[k / 3].few, many, rows[k / 3].many);
    }
}

/* What acceleration is for: fewer passes, fewer solves. */
TEST(acceleration_saves_iterations) {
    const struct start from = {"", "0", 1 / 8.0, 1};
    const double plain = after("vbd", 40, &from), fast = after("vbd:rho=0.9", 40, &from);
    ck_assert_msg(fast < 0.2 * plain, "vbd: %.3g m, accelerated %.3g m", plain, fast);
    if (!is_built(QUASI_NEWTON))
        return;
    const double fixed = after(LOCAL_GLOBAL, 40, &from),
                 learnt = after(QUASI_NEWTON, 40, &from);
    ck_assert_msg(learnt < 0.01 * fixed, "%.3g m by one matrix, %.3g m by L-BFGS", fixed,
                  learnt);
}

/* A hundred iterations and a thousand give one place, and it lies the nearer to implicit Euler
 * the smaller the step. */
TEST(xpbd_settles_beside_implicit_euler) {
    static const double steps[] = {1 / 8.0, 1 / 20.0, 1 / 60.0, 1 / 200.0};
    double last = 1;
    for (size_t k = 0; k < sizeof steps / sizeof *steps; k++) {
        const struct start from = {"", "0", steps[k], 1};
        const double hundred = after("xpbd", 100, &from), many = after("xpbd", 1000, &from);
        ck_assert_msg(fabs(hundred - many) < 1e-6 * many, "h = %g s: %.9g m, then %.9g m",
                      steps[k], hundred, many);
        ck_assert_msg(many > 1e-11 && many < 0.15 * last, "h = %g s: %.3g m, before %.3g m",
                      steps[k], many, last);
        last = many;
    }
}

/* Forgetting the multipliers makes springs the stiffer the more iterations. */
TEST(pbd_does_not_settle) {
    const struct start from = {"", "0", 1 / 20.0, 1};
    double last = after("xpbd:mode=pbd", 1, &from);
    ck_assert_double_eq(last, after("xpbd", 1, &from));
    for (int iterations = 10; iterations <= 1000; iterations *= 10) {
        const double found = after("xpbd:mode=pbd", iterations, &from);
        ck_assert_double_gt(found, 1.2 * last);
        last = found;
    }
}

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

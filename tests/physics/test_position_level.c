/* What the position-level methods come to: fast-mass-spring, projective-dynamics, vbd and avbd to
 * implicit Euler as their iterations grow, xpbd to a place of its own beside it that implicit
 * Euler and it share as h goes to 0, its mode pbd to nothing.
 *
 * The implicit Euler step is found by a Newton method of this test, with a dense matrix.
 */
#include "fixture.h"
#include "position_level.h"

#include "model/force/terms.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [9, 9]}, \"mass\": {\"particle\": 1}, \"springs\": " \
    "{\"stretch\": 200, \"shear\": 60, \"bend\": 20%s}, \"pins\": [\"top-left\"]}],"           \
    " \"forces\": {\"drag\": %s}, \"time\": {\"fps\": %.17g}}"

enum { N = 81, VALUES = 3 * N };

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
                {"avbd", 30, 2000, 1e-3},
                {QUASI_NEWTON, 10, 100, 1e-5}};
    static const struct start starts[] = {
        {"", "0", 1 / 20.0, 1},
        {", \"damping\": 0.5, \"damping_model\": \"relative\"", "0", 1 / 20.0, 1},
        {", \"damping\": 0.5, \"damping_model\": \"axial\"", "0", 1 / 20.0, 1}};
    for (size_t k = 0; k < 3 * sizeof rows / sizeof *rows; k++) {
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

/* Where a strip of stretch springs of 1e5 N/m and bend springs of 1 N/m is 20 frames after it
 * was let go, in steps of a frame: p (3,63) in m. */
static void hang_strip(const char *integrator, double *p) {
    struct fixture strip;
    fixture_open(&strip, integrator,
                 "{\"bodies\": [{\"cloth\": {\"grid\": [3, 21], \"size\": [0.1, 1]}, "
                 "\"mass\": {\"particle\": 0.01}, \"springs\": {\"stretch\": 1e5, "
                 "\"shear\": 1e3, \"bend\": 1, \"damping\": 0}, \"pins\": [\"left\"]}]}");
    fixture_start(&strip);
    fixture_frames(&strip, 20);
    memcpy(p, strip.x, 3 * strip.n * sizeof *p);
    fixture_close(&strip);
}

/* Multipliers carry over stiff springs what passes cannot, and both come to one place. */
TEST(avbd_meets_implicit_euler_where_springs_are_stiff) {
    static const char *const methods[] = {"vbd:iterations=30,dt=frame",
                                          "avbd:iterations=30,dt=frame",
                                          "avbd:iterations=900,dt=frame"};
    double expected[189], found[189], off[3];
    hang_strip("backward-euler:dt=frame,rtol=1e-12", expected);
    for (int k = 0; k < 3; k++) {
        hang_strip(methods[k], found);
        off[k] = cs_rms_difference(found, expected, 189) * sqrt(3);
    }
    ck_assert_msg(off[0] > 5e-3 && off[1] < 1e-3 * off[0] && off[2] < 1e-8,
                  "vbd: %.3g m, avbd: %.3g m, after 900 passes %.3g m", off[0], off[1], off[2]);
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

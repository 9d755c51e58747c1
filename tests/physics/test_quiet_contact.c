/* What lies on triangles lies still: no loss on a slope, no drift of sheets on each other, and
 * rest that is rest. Longer runs with the argument all. */
#include "fixture.h"

#include "model/contact/narrow_phase/contact_pairs.h"
#include "model/force/terms.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define SHEET                                                                                  \
    "\"thickness\": 0.02, \"mass\": {\"areal_density\": 0.3}, \"springs\": {\"stretch\": 60, " \
    "\"shear\": 20, \"bend\": 1, \"damping\": 0.02}"

static const double gravity = 9.81;
/* --- a slope of triangles, without friction --- */

/* a sheet on the top of a box, with gravity along it: how the sheet is turned, cells of the box
 */
#define SLOPE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [9, 9], \"size\": [0.4, 0.4], \"start\": \"flat\", " \
    "\"place\": {\"translate\": [-0.6, 0.0155, 0.013], \"rotate\": [0, %g, 0, 1]}}, " SHEET    \
    "}], \"colliders\": [{\"mesh\": {\"shape\": \"box\", \"detail\": %u, \"scale\": [2, 0.1, " \
    "1], \"place\": {\"translate\": [0, -0.05, 0]}}, \"friction\": 0, \"thickness\": 0.02}], " \
    "\"contact\": {\"law\": \"force\", \"damping\": 0.001}, \"forces\": {\"gravity\": "        \
    "[%.17g, %.17g, 0]}}"

/* of g, from frame 10 to 30 */
static double lost_on_slope(const char *method, double turn, uint32_t detail) {
    const double tangent = 0.1, cosine = 1 / sqrt(1 + tangent * tangent);
    double speed[2] = {0};
    struct fixture cloth;
    fixture_open(&cloth, method, SLOPE, turn, detail, gravity * tangent * cosine,
                 -gravity * cosine);
    fixture_start(&cloth);
    for (uint32_t part = 0; part < 2; part++) {
        fixture_frames(&cloth, 10 + 10 * part);
        for (size_t i = 0; i < cloth.n; i++)
            speed[part] += cloth.v[i] / (double)cloth.n;
    }
    fixture_close(&cloth);
    return tangent * cosine - (speed[1] - speed[0]) / (20 / 60.0) / gravity;
}

/* Steps of 4 ms damp what little the rims of the sheet excite. */
TEST(slope_takes_nothing) {
    static const struct {
        const char *method;
        double most;
    } methods[] = {{"implicit-linearised:dt=4e-3", 0.002}, {"rk4:dt=2e-3", 0.001}};
    for (size_t m = 0; m < (suite_all ? LENGTH(methods) : 1); m++)
        for (int k = suite_all ? 0 : 1; k < (suite_all ? 4 : 2); k++) {
            const double lost =
                lost_on_slope(methods[m].method, 0.15 + 0.1 * k, k % 2 ? 18 : 6);
            ck_assert_msg(fabs(lost) < methods[m].most, "%s, turn %d: %.3g g",
                          methods[m].method, k, lost);
        }
}

/* --- a sheet on a sheet on a floor --- */

/* grid, size and turn of the upper, friction between the two */
#define STACK                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [9, 9], \"size\": [0.4, 0.4], \"start\": \"flat\", " \
    "\"place\": {\"translate\": [0, 0.014, 0]}}, " SHEET                                       \
    "}, {\"cloth\": {\"grid\": [%u, %u], \"size\": [%g, %g], \"start\": \"flat\", \"place\": " \
    "{\"translate\": [0.013, 0.029, 0.007], \"rotate\": [0, %g, 0, 1]}}, " SHEET               \
    "}], \"pairs\": {\"among\": \"all\", \"friction\": %g}, \"colliders\": [{\"floor\": "      \
    "{\"height\": 0}, \"friction\": 0.3, \"thickness\": 0.02}], \"contact\": {\"law\": "       \
    "\"force\", \"damping\": 0.001, \"friction_speed\": 0.01}}"

static void open_stack(struct fixture *cloth, const char *method, uint32_t grid, double turn,
                       double mu) {
    const double size = 0.05 * (grid - 1);
    fixture_open(cloth, method, STACK, grid, grid, size, size, turn, mu);
    fixture_start(cloth);
}

static double draw(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) / 9007199254740992.0;
}

/* Flat sheets, one over the other anywhere: means of the forces on the upper, along and up. The
 * part along is that of the rims alone, below which points come and go. */
static void push_flat(const struct fixture *cloth, size_t upper, double y, double mean[2]) {
    static double x[3 * 200], f[3 * 200];
    const size_t n = cloth->n;
    uint64_t state = 1;
    struct cs_system alone = *cloth->system;
    alone.terms[0] = &cs_term_pairs;
    alone.n_terms = 1;
    for (int k = 0; k < 100; k++) {
        const double shift[2] = {0.05 * draw(&state), 0.05 * draw(&state)};
        double sum[3] = {0};
        for (size_t i = 0; i < n; i++) {
            x[i] = cloth->x[i] + (i >= upper ? shift[0] : 0);
            x[n + i] = i >= upper ? 0.02 * y : 0;
            x[2 * n + i] = cloth->x[2 * n + i] + (i >= upper ? shift[1] : 0);
        }
        cs_terms_force(&alone, &(struct cs_eval){.x = x, .v = cloth->v, .parts = CS_PART_ALL},
                       f);
        for (size_t i = upper; i < n; i++)
            for (size_t c = 0; c < 3; c++)
                sum[c] += f[c * n + i];
        mean[0] += hypot(sum[0], sum[2]) / 100;
        mean[1] += sum[1] / 100;
    }
}

TEST(sheets_push_straight) {
    static const double heights[] = {0.5, 0.7};
    for (size_t k = 0; k < LENGTH(heights); k++) {
        struct fixture cloth;
        double mean[2] = {0};
        open_stack(&cloth, "rk4", 6, 0.2, 0);
        push_flat(&cloth, cloth.n - 36, heights[k], mean);
        ck_assert_msg(mean[0] < 0.005 * mean[1], "at %g: %.3g of %.3g N", heights[k], mean[0],
                      mean[1]);
        fixture_close(&cloth);
    }
}

/* m/s, of particles [begin, end): root mean square, and as a whole along the floor */
static void speeds_of(const struct fixture *cloth, size_t begin, size_t end, double *rms,
                      double *drift) {
    double squared = 0, v[3] = {0};
    for (size_t i = begin; i < end; i++)
        for (size_t c = 0; c < 3; c++) {
            const double one = cloth->v[c * cloth->n + i];
            squared += one * one / (double)(end - begin);
            v[c] += one / (double)(end - begin);
        }
    *rms = sqrt(squared);
    *drift = hypot(v[0], v[2]);
}

TEST(sheets_lie_still) {
    const char *method = suite_all ? "symplectic-euler:dt=2e-4" : "implicit-linearised:dt=4e-3";
    const uint32_t frames = suite_all ? 180 : 30;
    for (int rubs = 0; rubs < 2; rubs++) {
        struct fixture cloth;
        double rms, drift;
        open_stack(&cloth, method, 6, 0.25, rubs ? 0.3 : 0);
        fixture_frames(&cloth, frames);
        speeds_of(&cloth, 0, cloth.n, &rms, &drift);
        // a tenth of friction_speed
        ck_assert_msg(!rubs || rms < 0.001, "rms %.3g m/s", rms);
        speeds_of(&cloth, cloth.n - 36, cloth.n, &rms, &drift);
        ck_assert_msg(drift < (suite_all ? 0.001 : 0.002) * gravity * frames / 60,
                      "rub %d: %.3g g", rubs, drift / gravity / (frames / 60.0));
        fixture_close(&cloth);
    }
}

/* --- friction that is linearised --- */

/* A particle at rest on a floor, but for a speed along it; a is h mu N/(m ev), in steps of 4 ms
 * with mu = 0.5. */
static double slide(const char *method, double a) {
    const double speed = 4e-3 * 0.5 * gravity / a;
    // carries the weight at 0.49 of the range of 0.02 m
    const double y = 0.49, part = (1 - y) * (1 - y) * (1 - y) * (1 + 3 * y) / (y * y);
    const double stiffness = 12 * 1e-3 * gravity / (0.02 * part);
    struct fixture block;
    fixture_open(
        &block, method,
        "{\"bodies\": [{\"cloth\": {\"grid\": [1, 1], \"start\": \"flat\", \"velocity\": "
        "[%.17g, 0, 0], \"place\": {\"translate\": [0, 0.0098, 0]}}, \"mass\": {\"total\": "
        "1e-3}}], \"colliders\": [{\"floor\": {\"height\": 0}, \"friction\": 0.5, "
        "\"thickness\": 0.02}], \"contact\": {\"law\": \"force\", \"stiffness\": %.17g, "
        "\"damping\": 0.01, \"friction_speed\": %.17g}, \"time\": {\"fps\": 250}}",
        3 * speed, stiffness, speed);
    fixture_start(&block);
    fixture_frames(&block, 300);
    const double v = fabs(block.v[0]) / speed;
    fixture_close(&block);
    return v;
}

/* Friction at its slope would be thrown to and fro for ever where h mu N/(m ev) > sqrt(54). By
 * its chord it rests however large that is, as by Newton's iteration. */
TEST(linearised_friction_rests) {
    static const double limits[] = {7, 8, 30, 1e3, 1e6};
    for (size_t k = 0; k < LENGTH(limits); k++) {
        ck_assert_double_lt(slide("implicit-linearised:dt=4e-3", limits[k]), 1e-9);
        ck_assert_double_lt(slide("backward-euler:dt=4e-3", limits[k]), 1e-9);
    }
}

/* Six sheets that fall on one another and on a floor, with friction of 0.3. */
static void drop_stack(struct fixture *stack, double ev, double along, double down) {
    char bodies[6 * 400] = "";
    size_t length = 0;
    for (int k = 0; k < 6; k++)
        length += (size_t)snprintf(
            bodies + length, sizeof bodies - length,
            "%s{\"cloth\": {\"grid\": [8, 8], \"size\": [0.2, 0.2], \"start\": \"flat\", "
            "\"place\": {\"translate\": [%g, %g, %g]}}, \"mass\": {\"areal_density\": 0.2}, "
            "\"springs\": {\"stretch\": 100, \"shear\": 30, \"bend\": 1, \"damping\": 0.01}, "
            "\"thickness\": 0.002, \"friction\": 0.3}",
            k ? ", " : "", 0.002 * (k % 3), 0.01 + 0.006 * k, 0.003 * (k % 2));
    fixture_open(stack, "implicit-linearised",
                 "{\"bodies\": [%s], \"colliders\": [{\"floor\": {\"height\": 0}, "
                 "\"friction\": 0.3, \"thickness\": 0.002}], \"pairs\": {\"among\": "
                 "\"all\", \"friction\": 0.3}, \"contact\": {\"law\": \"force\", "
                 "\"friction_speed\": %g}, \"forces\": {\"gravity\": [%.17g, %.17g, 0]}}",
                 bodies, ev, along, -down);
    fixture_start(stack);
}

/* Sheets that fell on one another rest, however small friction_speed is. Each contact alone
 * would take the friction of its neighbours as it was, which turns as its own does: below 1e-3
 * they would go to and fro for ever, at 0.02 m/s. */
TEST(linearised_stacks_rest) {
    static const double evs[] = {1e-3, 1e-4, 1e-5};
    for (size_t e = 0; e < LENGTH(evs); e++) {
        struct fixture stack;
        double most = 0;
        drop_stack(&stack, evs[e], 0, gravity);
        fixture_frames(&stack, 120);
        for (size_t i = 0; i < 3 * stack.n; i++)
            most = fmax(most, fabs(stack.v[i]));
        ck_assert_msg(most < 1e-4, "ev %g: %.3g m/s after 2 s", evs[e], most);
        fixture_close(&stack);
    }
}

/* On a slope above the angle of friction they slide: what settles friction does not hold them.
 */
TEST(linearised_stacks_slide) {
    static const double evs[] = {1e-3, 1e-4, 1e-5};
    const double slope = 0.45, cosine = 1 / sqrt(1 + slope * slope);
    for (size_t e = 0; e < LENGTH(evs); e++) {
        struct fixture stack;
        double begin = 0, speed = 0;
        drop_stack(&stack, evs[e], gravity * slope * cosine, gravity * cosine);
        fixture_frames(&stack, 40);
        for (size_t i = 0; i < stack.n; i++)
            begin += stack.v[i] / (double)stack.n;
        fixture_frames(&stack, 30);
        for (size_t i = 0; i < stack.n; i++)
            speed += stack.v[i] / (double)stack.n;
        const double acceleration = (speed - begin) / 0.5;
        const double expected = gravity * (slope - 0.3) * cosine;
        ck_assert_msg(fabs(acceleration / expected - 1) < 0.02, "ev %g: %.4g of %.4g m/s2",
                      evs[e], acceleration, expected);
        fixture_close(&stack);
    }
}

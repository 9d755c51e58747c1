/* Checks motions that a method of order p follows without any error, so that a coefficient
 * which is off by a billionth shows at a long step already.
 *
 * Where the motion is a polynomial of the time of degree q, the error of a step is a multiple
 * of h^q, by its units; of order p it is O(h^(p+1)): for q <= p it is 0. That holds of every
 * method whose steps do not depend on the unit of time, of any sequence of steps. Where q > p
 * nothing is claimed.
 *
 *   polynomials       gravity that is constant, or grows with the time: v of degree 1 and 2,
 *                     x of degree 2 and 3. The method's quadrature. Then a throw on which the
 *                     host refuses a step, of which nothing may remain.
 *   order-conditions  particles that soft stitches without length pull one after the other. In
 *                     x_j'' = w^2 (x_(j-1) - x_j) + ..., with w h = 1e-7, all but the pull of
 *                     the one before is below rounding, and x_j is a polynomial. What a stage
 *                     finds passes through j further stages: the conditions of linear
 *                     equations, each with a body of its own. By dampers the same of
 *                     v_j' = d (v_(j-1) - v_j). */
#include "conform/conform_checks.h"

#include <math.h>
#include <string.h>

/* Two frames of as many steps, so that what a step leaves is not lost among many; or enough for
 * a method of several steps to leave its first ones behind. */
enum { FRAMES = 2, SEVERAL_STEPS = 10 };
#define FALL_TIME 0.2   /* s, of FRAMES */
#define PULL_TIME 0.002 /* s */

/* Relative error that rounding and inner solves may leave; of all shipped methods at most
 * 2.1e-13, by the differences of symmetric-multistep. */
#define SMALL 1e-12

/* Velocities change by more than 50 m/s in a step, to both sides; the inverse of the mass is no
 * number of single precision. */
#define FALLING                                                                                \
    "{\"bodies\": [{\"cloth\": {\"grid\": [2, 2], \"velocity\": [1, 2, -3]}, \"mass\": "       \
    "{\"particle\": 0.3}, \"springs\": {\"stretch\": 0, \"shear\": 0, \"bend\": 0}}], "        \
    "\"forces\": {\"gravity\": [5000, -4000, 7000]}, \"events\": [%s], \"time\": {\"fps\": "   \
    "10}}"
#define GRAVITY (-4000) /* m/s2, along y */
#define RAMP                                                                                   \
    "{\"from\": 0, \"to\": 0.2, \"ramp\": {\"key\": \"forces.gravity[1]\", \"value\": 9000}}"
#define GROWTH ((9000 - GRAVITY) / FALL_TIME) /* m/s3 */

/* Thrown over a thin post, which the chord of the second frame runs through: by 2 m, at 0.61 of
 * it, where methods rarely have a stage. Half of the frame passes 1.8 m above it. */
#define OVER_A_POST                                                                            \
    "{\"bodies\": [{\"cloth\": {\"grid\": [2, 2], \"size\": [0.1, 0.1], \"start\": \"flat\", " \
    "\"velocity\": [300, 500.1, 0]}, \"mass\": {\"particle\": 0.3}, \"springs\": "             \
    "{\"stretch\": "                                                                           \
    "0, "                                                                                      \
    "\"shear\": 0, \"bend\": 0}}], \"forces\": {\"gravity\": [0, -4000, 0]}, \"time\": "       \
    "{\"fps\": "                                                                               \
    "10}, \"colliders\": [{\"box\": {\"centre\": [48.3, 0, 0], \"size\": [0.06, 52, 10]}, "    \
    "\"thickness\": 0.01}], \"contact\": {\"law\": \"force\", \"stiffness\": 1000}}"
#define RISE 500.1 /* m/s, along y: no number of single precision */

/* Five bodies of two particles at one place but the first, which is 0.3 m above and flies. */
#define LINK                                                                                   \
    "\"mass\": {\"particle\": 1e9}, \"springs\": {\"stretch\": 0, \"shear\": 0, \"bend\": 0}}"
#define LINK_AT_REST "{\"cloth\": {\"grid\": [2, 1]}, " LINK
#define STITCH(one, other)                                                                     \
    "{\"body\": " one ", \"particles\": [0, 1], \"to\": {\"body\": " other                     \
    ", \"particles\": [0, 1]}, \"stiffness\": %.17g, \"damping\": %.17g, \"length\": 0}"
#define CHAIN                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [2, 1], \"velocity\": [0, 0, 0.7], \"place\": "      \
    "{\"translate\": [0, 0.3, 0]}}, " LINK ", " LINK_AT_REST ", " LINK_AT_REST                 \
    ", " LINK_AT_REST ", " LINK_AT_REST "], \"seams\": [" STITCH("0", "1") ", " STITCH(        \
        "1", "2") ", " STITCH("2", "3") ", " STITCH("3", "4") "], \"forces\": {\"gravity\": "  \
                                                              "[0, 0, 0]}, \"time\": "         \
                                                              "{\"fps\": 1000}}"
enum { LINKS = 5, PARTICLES = 2 * LINKS, Y = PARTICLES, Z = 2 * PARTICLES };
#define PLACE 0.3   /* m, of the first along y */
#define SPEED 0.7   /* m/s, of the first along z */
#define MASS  1e9   /* kg, so that soft stitches are in the range of scenes */
#define SOFT  1e-11 /* 1/s2 and 1/s, w^2 and d of a stitch */
#define LEAST 1e-9  /* N/m, the smallest stiffness that a scene takes */

/* False, and the row says why, if the check does not apply. */
static bool applies(const struct cs_conform *conform, struct cs_conform_row *row) {
    const struct cs_integrator *method = conform->method;
    if (method->fidelity != CS_FIDELITY_ODE)
        cs_row_skip(row, "it claims another fidelity");
    else if (method->traits & CS_ADAPTIVE && method->traits & CS_MULTISTEP)
        cs_row_skip(row, "it begins at a lower order than its own");
    else
        return cs_probe_can_be_set(conform, row);
    return false;
}

/* The order that is claimed, and whether a step needs no earlier ones. */
struct claim {
    uint32_t order;
    bool one_step;
};

static struct claim claim_of(const struct cs_conform *conform, bool damped) {
    return (struct claim){cs_conform_order(conform, damped),
                          !(conform->method->traits & CS_MULTISTEP)};
}

/* Runs the scene. A method without dt takes a step a frame, or shorter ones as it likes. */
static bool run(struct cs_probe *probe, const struct claim *claim, struct cs_conform_row *row) {
    cs_probe_set_frames(probe, claim->one_step ? probe->frame : probe->frame / SEVERAL_STEPS);
    const bool done = cs_probe_run(probe, FRAMES);
    if (!done)
        cs_row_fail(row, "%s", probe->error.message);
    return done;
}

/* t^k / k! */
static double power(double t, uint32_t k) {
    return k ? t / k * power(t, k - 1) : 1;
}

/* States how far the ratio of a value to its polynomial is from 1, where the order makes it 1.
 * What a method of several steps gives out may be off by O(h^p) that does not add up. */
static void state(struct cs_conform_row *row, const struct claim *claim, uint32_t degree,
                  double ratio, const char *what, uint32_t link) {
    if (degree < claim->order || (degree == claim->order && claim->one_step))
        cs_row_state(row, fabs(ratio - 1), SMALL,
                     "of the %s of particle %u, a polynomial of degree %u", what, link, degree);
}

static void fall(const struct cs_conform *conform, struct cs_conform_row *row, bool grows) {
    const struct claim claim = claim_of(conform, false);
    struct cs_probe sheet;
    cs_probe_open(&sheet, conform, conform->method, FALLING, grows ? RAMP : "");
    if (run(&sheet, &claim, row)) {
        const double g = GRAVITY, j = grows ? GROWTH : 0, v = 2;
        const double path = sheet.x[sheet.n] - sheet.session.system.start[sheet.n];
        state(row, &claim, grows ? 2 : 1,
              sheet.v[sheet.n] / (v + g * power(FALL_TIME, 1) + j * power(FALL_TIME, 2)),
              grows ? "velocity while gravity grows" : "velocity", 0);
        state(row, &claim, grows ? 3 : 2,
              path /
                  (v * power(FALL_TIME, 1) + g * power(FALL_TIME, 2) + j * power(FALL_TIME, 3)),
              grows ? "path while gravity grows" : "path", 0);
    }
    cs_probe_close(&sheet);
}

/* Also a method of several steps takes a whole frame. One whose first step leaves the arc, as
 * those of order 1 do, may run into the post; one that never asks max_step_fraction is stopped.
 */
static void throw_over(const struct cs_conform *conform, struct cs_conform_row *row) {
    const struct claim claim = claim_of(conform, false);
    struct cs_probe sheet;
    cs_probe_open(&sheet, conform, conform->method, OVER_A_POST);
    sheet.trace.enabled = true;
    cs_probe_set_frames(&sheet, sheet.frame);
    double t = FALL_TIME / FRAMES, start = 0, path = 0;
    if (cs_probe_run(&sheet, 1)) {
        start = sheet.session.system.start[sheet.n];
        path = RISE * power(t, 1) + GRAVITY * power(t, 2);
    }
    // on the arc: the next step is cut short by the post
    if (path > 0 && fabs(sheet.x[sheet.n] - start - path) <= SMALL * path) {
        const bool done = cs_probe_run(&sheet, FRAMES - 1);
        t = FALL_TIME;
        path = RISE * power(t, 1) + GRAVITY * power(t, 2);
        if (sheet.asks_step_fraction && !done)
            cs_row_fail(row, "past a refused step: %s", sheet.error.message);
        else if (sheet.asks_step_fraction) {
            state(row, &claim, 1, sheet.v[sheet.n] / (RISE + GRAVITY * t),
                  "velocity past a refused step", 0);
            state(row, &claim, 2, (sheet.x[sheet.n] - start) / path, "path past a refused step",
                  0);
        }
    }
    cs_probe_close(&sheet);
}

void cs_check_polynomials(const struct cs_conform *conform, struct cs_conform_row *row) {
    if (!applies(conform, row))
        return;
    fall(conform, row, false);
    struct cs_conform_row growing = *row;
    fall(conform, &growing, true);
    // a method may refuse events
    if (!*conform->refused)
        *row = growing;
    throw_over(conform, row);
    *conform->refused = false;
}

/* State (6, PARTICLES) of the chain, with a stiffness in N/m and a damping in N s/m. */
static bool run_chain(const struct cs_conform *conform, struct cs_conform_row *row,
                      const struct claim *claim, double k, double d, double *state) {
    struct cs_probe chain;
    cs_probe_open(&chain, conform, conform->method, CHAIN, k, d, k, d, k, d, k, d);
    const bool done = run(&chain, claim, row);
    if (done)
        memcpy(state, chain.x, 6 * PARTICLES * sizeof *state);
    cs_probe_close(&chain);
    return done;
}

/* By stitches the place along y and the speed along z of the first link reach the others in two
 * degrees each. */
static void pull(const struct cs_conform *conform, struct cs_conform_row *row) {
    const struct claim claim = claim_of(conform, false);
    double links[6 * PARTICLES], share = 1;
    if (!run_chain(conform, row, &claim, SOFT * MASS, 0, links))
        return;
    for (uint32_t j = 1; j < LINKS; j++) {
        const double *x = links + 2 * j, *v = x + 3 * PARTICLES;
        share *= SOFT;
        state(row, &claim, 2 * j - 1, v[Y] / (PLACE * share * power(PULL_TIME, 2 * j - 1)),
              "velocity", j);
        state(row, &claim, 2 * j, x[Y] / (PLACE * share * power(PULL_TIME, 2 * j)), "path", j);
        state(row, &claim, 2 * j, v[Z] / (SPEED * share * power(PULL_TIME, 2 * j)), "velocity",
              j);
        state(row, &claim, 2 * j + 1, x[Z] / (SPEED * share * power(PULL_TIME, 2 * j + 1)),
              "path", j);
    }
}

/* By dampers the speed reaches them in one degree. A stitch has some stiffness: its part, which
 * is linear in it where it is small, is taken out by a run with twice as much. */
static void drag(const struct cs_conform *conform, struct cs_conform_row *row) {
    const struct claim claim = claim_of(conform, true);
    double links[6 * PARTICLES], stiffer[6 * PARTICLES], share = 1;
    if (!run_chain(conform, row, &claim, LEAST, SOFT * MASS, links) ||
        !run_chain(conform, row, &claim, 2 * LEAST, SOFT * MASS, stiffer))
        return;
    for (size_t i = 0; i < 6 * PARTICLES; i++)
        links[i] = 2 * links[i] - stiffer[i];
    for (uint32_t j = 1; j < LINKS; j++) {
        const double *x = links + 2 * j, *v = x + 3 * PARTICLES;
        share *= SOFT;
        state(row, &claim, j, v[Z] / (SPEED * share * power(PULL_TIME, j)),
              "velocity by dampers", j);
        state(row, &claim, j + 1, x[Z] / (SPEED * share * power(PULL_TIME, j + 1)),
              "path by dampers", j);
    }
}

void cs_check_order_conditions(const struct cs_conform *conform, struct cs_conform_row *row) {
    if (!applies(conform, row))
        return;
    if (conform->method->traits & CS_IMPLICIT) {
        cs_row_skip(row, "its solves leave more than these motions");
        return;
    }
    pull(conform, row);
    drag(conform, row);
}

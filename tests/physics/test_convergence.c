/* Every method for the equation of motion converges to one and the same solution.
 *
 * A small drum, 0.1 s. Fixed-step methods run with steps h, h/2, h/4, ..., and their results
 * are extrapolated to h = 0 in the powers p, p + 1, ... of h, p the stated order, so that order
 * 1 needs no millions of steps; adaptive methods run once, with a tight tolerance. A new method
 * is a row of the table.
 */
#include "drum.h"
#include "methods.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SIDE = 5, VALUES = 6 * SIDE * SIDE, LEVELS_MAX = 8 };
#define DAMPING 0.01118

/* x and v after 0.1 s; returns the order that the method states. */
static uint32_t end_state(const char *integrator, double state[VALUES]) {
    struct fixture drum;
    fixture_open(&drum, integrator, DRUM, SIDE, SIDE, DAMPING, 10);
    fixture_start(&drum);
    fixture_frames(&drum, 1);
    memcpy(state, drum.x, VALUES * sizeof *state);
    const uint32_t order = drum.session.method.integrator->order_damped;
    fixture_close(&drum);
    return order;
}

/* Richardson's extrapolation of `levels` runs with steps h, h/2, ... */
static void limit_state(const char *name, double h, int levels, double state[VALUES]) {
    static double rows[LEVELS_MAX][VALUES];
    uint32_t order = 0;
    for (int k = 0; k < levels; k++) {
        char integrator[120];
        methods_set(integrator, name, "dt", ldexp(h, -k));
        order = end_state(integrator, rows[k]);
    }
    for (int column = 1; column < levels; column++)
        for (int k = levels - 1; k >= column; k--) {
            const double factor = ldexp(1, (int)order + column - 1) - 1;
            for (size_t i = 0; i < VALUES; i++)
                rows[k][i] += (rows[k][i] - rows[k - 1][i]) / factor;
        }
    memcpy(state, rows[levels - 1], VALUES * sizeof *state);
}

static double distance(const double *a, const double *b) {
    return cs_rms_difference(a, b, VALUES / 2);
}

/* Runs with steps of 1 ms, half of it, ...: as many as its order needs, and its start */
static int levels_of(const struct method_asked *method) {
    return method->order_damped == 1 ? 8 : method->order_damped == 2 ? 7 : 4;
}

TEST(all_converge_to_one_solution) {
    static const char *const more[] = {
        "bdf2:rtol=1e-13,solve=linear",
        "newmark:rtol=1e-13,variant=hht",
        "gauss:rtol=1e-13,order=6",
        "gauss:rtol=1e-13,order=8",
        "newmark:rtol=1e-13,variant=generalised-alpha,rho_inf=0.5",
        NULL};
    const struct methods methods = methods_find(&(struct methods_query){
        .test = "one solution", .rtol = 1e-12, .residual = 1e-13, .more = more});
    double start[VALUES], reference[VALUES], state[VALUES];
    struct fixture drum;
    fixture_open(&drum, "velocity-verlet", DRUM, SIDE, SIDE, DAMPING, 10);
    memcpy(start, drum.x, sizeof start);
    fixture_close(&drum);
    limit_state("velocity-verlet", 5e-4, 7, reference);
    const double motion = distance(start, reference);
    const double speed = distance(reference + VALUES / 2, start + VALUES / 2);

    for (size_t i = 0; i < methods.n; i++) {
        const struct method_asked *method = methods.list + i;
        const bool adaptive = method->traits & CS_ADAPTIVE;
        if (adaptive)
            end_state(method->text, state);
        else
            limit_state(method->text, 1e-3, levels_of(method), state);
        const double place = distance(state, reference) / motion;
        const double velocity = distance(state + VALUES / 2, reference + VALUES / 2) / speed;
        // an adaptive method may lose a few digits of its tolerance
        const double bound = adaptive ? 1e-8 : 1e-10;
        ck_assert_msg(place < bound && velocity < bound,
                      "%s: off by %.3g of the motion, %.3g of the speed", method->text, place,
                      velocity);
    }
}

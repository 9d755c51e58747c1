/* Every method for the equation of motion converges to one and the same solution.
 *
 * A small drum, 0.1 s. Fixed-step methods run with steps h, h/2, h/4, ..., and their results
 * are extrapolated to h = 0 in the powers p, p + 1, ... of h, p the stated order, so that order
 * 1 needs no millions of steps; adaptive methods run once, with a tight tolerance. A new method
 * is a row of the table.
 */
#include "drum.h"
#include "fixture.h"

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
        char integrator[160];
        snprintf(integrator, sizeof integrator, "%s%cdt=%.17g", name,
                 strchr(name, ':') ? ',' : ':', ldexp(h, -k));
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

static const struct {
    const char *name;
    double h; /* longest step; 0: adaptive */
    int levels;
} methods[] = {
    {"explicit-euler", 1e-3, 8},
    {"symplectic-euler", 1e-3, 8},
    {"averaged-euler", 1e-3, 8},
    {"velocity-verlet", 1e-3, 6},
    {"position-verlet", 1e-3, 8},
    {"rk4", 1e-3, 4},
    {"dopri5:rtol=1e-12", 0, 1},
    {"implicit-linearised:rtol=1e-13", 1e-3, 8},
    {"backward-euler:rtol=1e-13", 1e-3, 8},
    {"implicit-midpoint:rtol=1e-13", 1e-3, 6},
    {"bdf2:rtol=1e-13", 5e-4, 6},
    {"bdf2:rtol=1e-13,solve=linear", 5e-4, 6},
    {"tr-bdf2:rtol=1e-13", 1e-3, 6},
    {"sdirk2:rtol=1e-13", 1e-3, 6},
    {"ros2:rtol=1e-13", 1e-3, 6},
    {"newmark:rtol=1e-13", 1e-3, 6},
    {"newmark:rtol=1e-13,set=hht", 1e-3, 6},
    {"newmark:rtol=1e-13,set=generalised-alpha,rho_inf=0.5", 1e-3, 6},
    {"gauss:rtol=1e-13", 1e-3, 3},
    {"gauss:rtol=1e-13,order=6", 5e-4, 1},
    {"gauss:rtol=1e-13,order=8", 2e-3, 1},
    {"cvode-bdf:rtol=1e-12,max_order=5,linear_rtol=1e-8", 0, 1},
    {"cvode-adams:rtol=1e-12", 0, 1},
    {"ark-erk:rtol=1e-12", 0, 1},
    {"ark-dirk:rtol=1e-11", 0, 1},
    {"ark-imex:rtol=1e-11", 0, 1},
};

static double distance(const double *a, const double *b) {
    return cs_rms_difference(a, b, VALUES / 2);
}

TEST(all_converge_to_one_solution) {
    double start[VALUES], reference[VALUES], state[VALUES];
    struct fixture drum;
    fixture_open(&drum, "velocity-verlet", DRUM, SIDE, SIDE, DAMPING, 10);
    memcpy(start, drum.x, sizeof start);
    fixture_close(&drum);
    limit_state("velocity-verlet", 5e-4, 7, reference);
    const double motion = distance(start, reference);
    const double speed = distance(reference + VALUES / 2, start + VALUES / 2);

    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        if (methods[i].h > 0)
            limit_state(methods[i].name, methods[i].h, methods[i].levels, state);
        else
            end_state(methods[i].name, state);
        const double place = distance(state, reference) / motion;
        const double velocity = distance(state + VALUES / 2, reference + VALUES / 2) / speed;
        // an adaptive method may lose a few digits of its tolerance
        const double bound = methods[i].h > 0 ? 1e-10 : 1e-8;
        ck_assert_msg(place < bound && velocity < bound,
                      "%s: off by %.3g of the motion, %.3g of the speed", methods[i].name,
                      place, velocity);
    }
}

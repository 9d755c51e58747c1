/* The measured order of the implicit methods on the drum is the one that they state. */
#include "drum.h"
#include "fixture.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Without damping the fast modes of a fine grid ring on, and only far smaller steps would show
 * the order: the grid is coarser there. */
enum { SIDE = 8, SIDE_UNDAMPED = 6, VALUES_MAX = 6 * SIDE * SIDE };

/* x and v after 0.2 s; returns the order that the method states. */
static uint32_t end_state(const char *integrator, double damping, double state[VALUES_MAX],
                          size_t *values) {
    const int side = damping > 0 ? SIDE : SIDE_UNDAMPED;
    struct fixture drum;
    fixture_open(&drum, integrator, DRUM, side, side, damping, 5);
    fixture_start(&drum);
    fixture_frames(&drum, 1);
    *values = 6 * drum.n;
    memcpy(state, drum.x, *values * sizeof *state);
    const struct cs_integrator *method = drum.session.method.integrator;
    const uint32_t order = damping > 0 ? method->order_damped : method->order;
    fixture_close(&drum);
    return order;
}

/* Slopes of the errors of position and velocity from h to h/2, against a step far finer. */
static void check_order(const char *name, double h, double damping,
                        const double reference[VALUES_MAX]) {
    double state[VALUES_MAX], error[2][2];
    size_t values;
    uint32_t order = 0;
    for (int k = 0; k < 2; k++) {
        char integrator[128];
        snprintf(integrator, sizeof integrator, "%s,dt=%.17g", name, k ? h / 2 : h);
        order = end_state(integrator, damping, state, &values);
        error[0][k] = cs_rms_difference(state, reference, values / 2);
        error[1][k] = cs_rms_difference(state + values / 2, reference + values / 2, values / 2);
    }
    for (int part = 0; part < 2; part++) {
        const double slope = log2(error[part][0] / error[part][1]);
        ck_assert_msg(fabs(slope - order) < 0.1,
                      "%s, damping %g: order of %s is %.3f, stated %u (errors %.3g, %.3g)",
                      name, damping, part ? "velocity" : "position", slope, order,
                      error[part][0], error[part][1]);
    }
}

static const struct {
    const char *name;
    double h;
} methods[] = {{"backward-euler:rtol=1e-8", 2e-5},
               {"implicit-midpoint:rtol=1e-8", 2.5e-4},
               {"bdf2:rtol=1e-8", 1.25e-4},
               {"bdf2:rtol=1e-8,solve=linear", 1.25e-4},
               {"tr-bdf2:rtol=1e-8", 2.5e-4},
               {"sdirk2:rtol=1e-8", 2.5e-4},
               {"ros2:rtol=1e-8", 2.5e-4},
               {"newmark:rtol=1e-8", 2.5e-4},
               {"newmark:rtol=1e-8,set=hht", 2.5e-4},
               {"newmark:rtol=1e-8,set=generalised-alpha", 2.5e-4},
               {"newmark:rtol=1e-8,set=generalised-alpha,rho_inf=0", 1.25e-4}};

static void check_orders(double damping) {
    double reference[VALUES_MAX];
    size_t values;
    end_state("velocity-verlet:dt=1e-5", damping, reference, &values);
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++)
        check_order(methods[i].name, methods[i].h, damping, reference);
}

TEST(order_without_damping) {
    check_orders(0);
}

TEST(order_with_damping) {
    check_orders(0.01118);
}

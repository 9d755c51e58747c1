/* The measured order of the implicit methods on the drum is the one that they state. */
#include "drum.h"
#include "methods.h"

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
        char integrator[120];
        methods_set(integrator, name, "dt", k ? h / 2 : h);
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

static double step_of(const struct method_asked *method) {
    return method->order == 1 ? 2e-5 : method->order == 2 ? 1.25e-4 : 1e-3;
}

static void check_orders(double damping) {
    static const char *const more[] = {
        "bdf2:rtol=1e-8,solve=linear", "newmark:rtol=1e-8,variant=hht",
        "newmark:rtol=1e-8,variant=generalised-alpha",
        "newmark:rtol=1e-8,variant=generalised-alpha,rho_inf=0", NULL};
    const struct methods methods =
        methods_find(&(struct methods_query){.test = "drum",
                                             .with = CS_IMPLICIT,
                                             .without = CS_ADAPTIVE | CS_NOT_GALILEAN,
                                             .residual = 1e-8,
                                             .more = more});
    double reference[VALUES_MAX];
    size_t values;
    end_state("dopri5:rtol=1e-13", damping, reference, &values);
    for (size_t i = 0; i < methods.n; i++)
        check_order(methods.list[i].text, step_of(methods.list + i), damping, reference);
}

TEST(order_without_damping) {
    check_orders(0);
}

TEST(order_with_damping) {
    check_orders(0.01118);
}

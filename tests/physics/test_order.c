/* The measured order of every fixed-step method is the one that it states. */
#include "methods.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* hung at two corners, stirred, slow enough to be smooth over a step; %s: damping model */
#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [4, 4]}, \"mass\": {\"particle\": 0.1},"             \
    " \"springs\": {\"stretch\": 40, \"shear\": 15, \"bend\": 5, \"damping\": %g,"             \
    " \"damping_model\": \"%s\"}, \"pins\": [\"top-left\", \"top-right\"]}],"                  \
    " \"forces\": {\"drag\": %g}, \"time\": {\"fps\": 10}}"

enum { FRAMES = 3, VALUES = 6 * 16 };

struct damping {
    const char *model;
    double spring, drag;
};
static const struct damping none = {"axial", 0, 0};
static const struct damping kinds[] = {
    {"axial", 0.3, 0}, {"relative", 0.1, 0}, {"axial", 0, 0.2}};

/* The state after frames of 0.1 s; returns the order that the method states. */
static uint32_t state_after(const char *integrator, const struct damping *damping,
                            uint32_t frames, double state[VALUES]) {
    struct fixture cloth;
    fixture_open(&cloth, integrator, SCENE, damping->spring, damping->model, damping->drag);
    cs_perturb_smooth(cloth.system, 0.01, 0.2);
    fixture_start(&cloth);
    fixture_frames(&cloth, frames);
    memcpy(state, cloth.x, VALUES * sizeof *state);
    const struct cs_integrator *method = cloth.session.method.integrator;
    const uint32_t order = damping == &none ? method->order : method->order_damped;
    fixture_close(&cloth);
    return order;
}

static uint32_t end_state(const char *integrator, const struct damping *damping,
                          double state[VALUES]) {
    return state_after(integrator, damping, FRAMES, state);
}

/* Slopes of the errors of position and velocity from h to h/2, against a step far finer.
 * expected: the order of a method whose next terms are still seen at h; 0: as it states. */
static void check_order(const char *name, double h, const struct damping *damping,
                        uint32_t expected) {
    double reference[VALUES], state[VALUES], error[2][2];
    end_state("dopri5:rtol=1e-13", damping, reference);
    uint32_t order = 0;
    for (int k = 0; k < 2; k++) {
        char integrator[120];
        methods_set(integrator, name, "dt", k ? h / 2 : h);
        const uint32_t stated = end_state(integrator, damping, state);
        order = expected ? expected : stated;
        error[0][k] = cs_rms_difference(state, reference, VALUES / 2);
        error[1][k] = cs_rms_difference(state + VALUES / 2, reference + VALUES / 2, VALUES / 2);
    }
    for (int part = 0; part < 2; part++) {
        const double slope = log2(error[part][0] / error[part][1]);
        // errors of order 8 are near its later terms at h, and near rounding at h/2
        ck_assert_msg(
            fabs(slope - order) < (expected    ? 0.3
                                   : order > 6 ? 0.2
                                               : 0.1),
            "%s, %s damping %g, drag %g: order of %s is %.3f, stated %u (errors %.3g, %.3g)",
            name, damping->model, damping->spring, damping->drag,
            part ? "velocity" : "position", slope, order, error[part][0], error[part][1]);
    }
}

/* the shortcut's drag is h K_ii: it needs smaller steps before it is small at all */
static double step_of(const struct method_asked *method, const struct damping *damping) {
    return method->traits & CS_NOT_GALILEAN
               ? 2.5e-5
               : methods_step(damping == &none ? method->order : method->order_damped);
}

static void check_orders(const struct damping *damping) {
    const struct methods methods = methods_find(
        &(struct methods_query){.test = "order", .without = CS_ADAPTIVE, .residual = 1e-12});
    for (size_t i = 0; i < methods.n; i++)
        check_order(methods.list[i].text, step_of(methods.list + i, damping), damping, 0);
}

TEST(order_without_damping) {
    check_orders(&none);
}

TEST(order_with_damping) {
    for (size_t k = 0; k < LENGTH(kinds); k++)
        check_orders(kinds + k);
}

/* Methods that contact and events are refused for. */
TEST(order_of_methods_for_smooth_motion) {
    const struct methods methods =
        methods_find(&(struct methods_query){.with = CS_SMOOTH_ONLY});
    for (size_t i = 0; i < methods.n; i++)
        check_order(methods.list[i].text, 5e-3, &none, 0);
    for (size_t i = 0; i < methods.n; i++)
        for (size_t k = 0; k < LENGTH(kinds); k++)
            check_order(methods.list[i].text, 1.8e-3, kinds + k, methods.list[i].order_damped);
}

/* A velocity predicted from the last displacement alone lets other roots of the multistep
 * method grow as exp(0.2 delta t), and blows up here. */
TEST(damping_lets_no_other_root_grow) {
    static const struct damping settles = {"axial", 0.3, 0.2};
    double state[VALUES], reference[VALUES];
    state_after("dopri5:rtol=1e-10", &settles, 400, reference);
    state_after("symmetric-multistep:dt=2e-3", &settles, 400, state);
    ck_assert_double_le(cs_rms_difference(state, reference, VALUES), 1e-7);
}

/* Velocities by quadrature keep more of a composition's order with damping. */
TEST(order_of_compositions_by_quadrature) {
    static const struct {
        const char *method;
        uint32_t order;
        double h;
    } all[] = {{"composition:damping=quadrature", 5, 1e-2},
               {"composition:damping=quadrature,method=calvo-sanz-serna", 4, 4e-3},
               {"composition:damping=quadrature,method=vefrl", 4, 4e-3}};
    for (size_t i = 0; i < LENGTH(all); i++)
        for (size_t k = 0; k < LENGTH(kinds); k++)
            check_order(all[i].method, all[i].h, kinds + k, all[i].order);
}

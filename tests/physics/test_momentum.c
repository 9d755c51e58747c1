/* Without outer forces a free cloth keeps its momentum and, with axial forces, its angular
 * momentum; by energy-momentum its energy too, at any step. */
#include "methods.h"

#include <math.h>

#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [6, 5]}, \"mass\": {\"particle\": 0.1},"             \
    " \"springs\": {\"stretch\": 40, \"shear\": 15, \"bend\": 5, \"damping\": 0.02,"           \
    " \"damping_model\": \"%s\"}}], \"forces\": {\"gravity\": [0, 0, 0]}, \"time\": "          \
    "{\"fps\": 50}}"

/* Largest change of momentum and of angular momentum in one second, relative to the sizes that
 * they are made of. */
static void drift(const char *integrator, const char *model, double out[2]) {
    struct fixture cloth;
    double before[2][3], after[2][3];
    fixture_open(&cloth, integrator, SCENE, model);
    cs_perturb_smooth(cloth.system, 0.02, 0.5);
    for (size_t i = 0; i < cloth.n; i++)
        cloth.v[i] += 1;
    fixture_start(&cloth);
    fixture_momentum(&cloth, before[0], before[1]);
    fixture_frames(&cloth, 50);
    fixture_momentum(&cloth, after[0], after[1]);
    for (int k = 0; k < 2; k++) {
        out[k] = 0;
        for (int c = 0; c < 3; c++)
            out[k] = fmax(out[k], fabs(after[k][c] - before[k][c]));
    }
    fixture_close(&cloth);
}

/* Forces come in opposite pairs, so that only rounding (or the solver's residual) is left. */
TEST(momentum_is_kept) {
    const struct methods methods = methods_find(&(struct methods_query){
        .test = "momentum", .without = CS_NOT_GALILEAN, .dt = 1e-3, .residual = 1e-14});
    for (size_t i = 0; i < methods.n; i++) {
        const uint32_t traits = methods.list[i].traits;
        const double bound = !(traits & CS_IMPLICIT) ? 1e-12
                             : traits & CS_ADAPTIVE  ? 1e-9
                                                     : 1e-11;
        for (size_t m = 0; m < 2; m++) {
            double moved[2];
            if (!suite_takes(i + m, 2))
                continue;
            drift(methods.list[i].text, m ? "axial" : "relative", moved);
            ck_assert_msg(moved[0] < bound, "%s: momentum moved by %.3g", methods.list[i].text,
                          moved[0]);
        }
    }
}

/* The thesis's shortcut slows a cloth that drifts as a whole. */
TEST(block_shortcut_loses_momentum) {
    double moved[2];
    drift("implicit-block", "axial", moved);
    ck_assert_double_gt(moved[0], 0.1);
}

/* Kicks along the springs and drifts along the velocities keep angular momentum exactly; the
 * other methods lose or gain it with their order. */
TEST(angular_momentum_is_kept) {
    static const struct {
        const char *integrator;
        double bound; /* kg m2/s */
    } rows[] = {{"symplectic-euler:dt=1e-3", 1e-12},
                {"velocity-verlet:dt=1e-3", 1e-12},
                {"position-verlet:dt=1e-3", 1e-4},
                {"explicit-euler:dt=1e-4", 1e-3},
                {"cvode-bdf:rtol=1e-9,max_order=5", 1e-6}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        double moved[2];
        drift(rows[i].integrator, "axial", moved);
        ck_assert_msg(moved[1] < rows[i].bound, "%s: angular momentum moved by %.3g",
                      rows[i].integrator, moved[1]);
    }
}

#define VIOLENT                                                                                \
    "{\"bodies\": [{\"cloth\": {\"grid\": [12, 12], \"size\": [1, 1], \"stretch\": 1.3},"      \
    " \"mass\": {\"total\": 0.2}, \"springs\": {\"stretch\": 200, \"shear\": 60, \"bend\": 2," \
    " \"damping\": 0}, \"pins\": %s}], \"forces\": {\"gravity\": %s, \"drag\": 0}}"

/* Change of the energy in half a second of a sheet that is let go stretched by 1.3, over what
 * it is at first; of angular momentum too, in kg m2/s. */
static double energy_gain(const char *integrator, const char *pins, const char *gravity,
                          double *turned) {
    struct fixture cloth;
    double p[3], before[3], after[3];
    fixture_open(&cloth, integrator, VIOLENT, pins, gravity);
    cs_perturb_smooth(cloth.system, 0.02, 0.5);
    for (size_t i = 0; i < cloth.n; i++)
        if (cloth.system->inv_mass[i] > 0) // it turns
            cloth.v[2 * cloth.n + i] += 3 * cloth.x[i];
    fixture_start(&cloth);
    fixture_momentum(&cloth, p, before);
    const double energy = fixture_energy(&cloth);
    fixture_frames(&cloth, 30);
    fixture_momentum(&cloth, p, after);
    const double gain = (fixture_energy(&cloth) - energy) / fabs(energy);
    *turned = 0;
    for (int c = 0; c < 3; c++)
        *turned = fmax(*turned, fabs(after[c] - before[c]));
    fixture_close(&cloth);
    return gain;
}

/* The midpoint rule makes a hundred times the energy in this at 4 ms. */
TEST(energy_momentum_keeps_both_at_any_step) {
    static const char *const steps[] = {"1e-3", "4e-3", "frame"};
    double turned;
    for (size_t k = 0; k < 3; k++)
        for (int held = 0; held < 2; held++) {
            char integrator[64];
            snprintf(integrator, sizeof integrator, "energy-momentum:dt=%s,rtol=1e-12",
                     steps[k]);
            const double gain = energy_gain(integrator, held ? "[\"top-left\"]" : "[]",
                                            held ? "[0, -9.81, 0]" : "[0, 0, 0]", &turned);
            ck_assert_msg(fabs(gain) < 1e-9, "%s gains %.3g", integrator, gain);
            ck_assert_msg(held || turned < 1e-10, "%s turns by %.3g", integrator, turned);
        }
    ck_assert_double_gt(energy_gain("implicit-midpoint:dt=4e-3", "[]", "[0, 0, 0]", &turned),
                        10);
}

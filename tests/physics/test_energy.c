/* Energy: what the dampers, drag and wind do is what the cloth loses or gains. */
#include "fixture.h"

#include "model/force/normals.h"
#include "model/force/terms.h"

#include <math.h>

#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6]}, \"mass\": {\"particle\": 0.1},"             \
    " \"springs\": {\"stretch\": 40, \"shear\": 15, \"bend\": 5, \"damping\": %g,"             \
    " \"damping_model\": \"%s\"}, \"pins\": [\"top-left\", \"top-right\"]}],"                  \
    " \"forces\": {\"drag\": %g%s}, \"time\": {\"fps\": %d}}"
#define WIND                                                                                   \
    ", \"wind\": {\"direction\": [0, 0, 1], \"strength\": 0.3, \"strength_unit\": \"N\"}"

enum { N = 36 };

/* Power in W of the forces that have no potential. */
static double power(const struct fixture *cloth) {
    double f[3 * N], sum = 0;
    if (cloth->system->normals)
        cs_normals_update(cloth->system, cloth->x);
    cs_terms_force(cloth->system,
                   &(struct cs_eval){.x = cloth->x,
                                     .v = cloth->v,
                                     .parts = CS_PART_DAMPING | CS_PART_DRAG | CS_PART_WIND},
                   f);
    for (size_t i = 0; i < 3 * N; i++)
        sum += f[i] * cloth->v[i];
    return sum;
}

/* Steps of one frame for half a second: the change of energy less the work done, by the
 * trapezium rule over the steps; *work is the sum of its sizes. */
static double imbalance(const char *integrator, double damping, const char *model, double drag,
                        const char *wind, int fps, double *work) {
    struct fixture cloth;
    fixture_open(&cloth, integrator, SCENE, damping, model, drag, wind, fps);
    cs_perturb_smooth(cloth.system, 0.01, 0.5);
    fixture_start(&cloth);
    const double before = fixture_energy(&cloth);
    double done = 0, last = power(&cloth);
    *work = 0;
    for (int k = 0; k < fps / 2; k++) {
        fixture_frames(&cloth, 1);
        const double next = power(&cloth);
        done += (last + next) / 2 / fps;
        *work += fabs(last + next) / 2 / fps;
        last = next;
    }
    const double left = fixture_energy(&cloth) - before - done;
    fixture_close(&cloth);
    return left;
}

/* Second order: the balance closes four times better at half the step. */
TEST(balance_closes_with_the_step) {
    static const struct {
        double damping;
        const char *model;
        double drag;
        const char *wind;
    } rows[] = {{0.05, "axial", 0, ""},
                {0.05, "relative", 0, ""},
                {0, "axial", 0.1, ""},
                {0, "axial", 0, WIND},
                {0.05, "axial", 0.1, WIND}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        double left[2], work;
        for (int k = 0; k < 2; k++)
            left[k] = fabs(imbalance("velocity-verlet", rows[i].damping, rows[i].model,
                                     rows[i].drag, rows[i].wind, 1000 << k, &work));
        ck_assert_msg(work > 0.01, "row %zu: only %.3g J of work", i, work);
        ck_assert_msg(left[1] < 1e-3 * work && left[1] < left[0] / 3.5,
                      "row %zu: %.3g J and, at half the step, %.3g J of %.3g J are missing", i,
                      left[0], left[1], work);
    }
}

/* Without damping the energy stays: symplectic methods keep it near, explicit Euler gains and
 * implicit Euler loses it. */
TEST(undamped_energy_goes_the_methods_way) {
    double work;
    const double verlet = imbalance("velocity-verlet", 0, "axial", 0, "", 500, &work);
    const double symplectic = imbalance("symplectic-euler", 0, "axial", 0, "", 500, &work);
    const double gained = imbalance("explicit-euler", 0, "axial", 0, "", 500, &work);
    const double lost = imbalance("implicit-linearised", 0, "axial", 0, "", 500, &work);
    ck_assert_double_lt(fabs(verlet), 1e-3);
    ck_assert_double_lt(fabs(symplectic), 0.05);
    ck_assert_double_gt(gained, 0.1);
    ck_assert_double_lt(lost, -0.1);
}

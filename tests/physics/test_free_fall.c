/* Free fall: every method falls to its own discrete value, but the thesis's shortcut. */
#include "methods.h"

#include <math.h>

#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [%d, %d]}, \"mass\": {\"particle\": 1},"             \
    " \"springs\": {\"stretch\": 200, \"shear\": 75, \"bend\": 25}}], \"time\": {\"fps\": "    \
    "%d}}"

/* Distance that each particle fell in the first second: mean, and the largest deviation. */
static double fall(const char *integrator, int grid, int fps, double *spread) {
    struct fixture cloth;
    fixture_open(&cloth, integrator, SCENE, grid, grid, fps);
    fixture_start(&cloth);
    fixture_frames(&cloth, (uint32_t)fps);
    double sum = 0;
    for (size_t i = cloth.n; i < 2 * cloth.n; i++)
        sum += cloth.system->view.start[i] - cloth.x[i];
    const double mean = sum / (double)cloth.n;
    *spread = 0;
    for (size_t i = cloth.n; i < 2 * cloth.n; i++) {
        const double off = fabs(cloth.system->view.start[i] - cloth.x[i] - mean);
        *spread = off > *spread ? off : *spread;
    }
    fixture_close(&cloth);
    return mean;
}

/* With constant acceleration the sums are closed: g h^2 times N (N - 1)/2, N (N + 1)/2 or
 * N^2/2 steps of h = 1/240 s. Springs stay at rest length, so that only rounding is left. */
TEST(methods_fall_to_their_discrete_value) {
    static const char *const more[] = {
        "implicit-linearised:dt=0.00416666666666667,hessian=exact", NULL};
    const struct methods methods =
        methods_find(&(struct methods_query){.without = CS_ADAPTIVE | CS_NOT_GALILEAN,
                                             .dt = 1 / 240.0,
                                             .residual = 1e-12,
                                             .more = more});
    const double n = 240;
    for (size_t k = 0; k < methods.n; k++) {
        const struct method_asked *method = methods.list + k;
        // of order 1 most move by the velocity at the end of a step
        const double shift = method->order > 1                            ? 0
                             : methods_is(method->text, "explicit-euler") ? -1
                             : methods_is(method->text, "averaged-euler") ? 0
                                                                          : 1;
        double spread;
        const double found = fall(method->text, 6, 60, &spread);
        const double expected = 9.81 / (n * n) * n * (n + shift) / 2;
        ck_assert_msg(fabs(found - expected) < 1e-12 * expected && spread < 1e-12 * expected,
                      "%s fell %.15g m, expected %.15g, spread %.3g", method->text, found,
                      expected, spread);
    }
}

/* An adaptive method falls to the exact value, within its tolerance. */
TEST(adaptive_methods_fall_to_the_exact_value) {
    const struct methods methods = methods_find(
        &(struct methods_query){.test = "free fall", .with = CS_ADAPTIVE, .rtol = 1e-8});
    for (size_t k = 0; k < methods.n; k++) {
        double spread;
        const double found = fall(methods.list[k].text, 6, 60, &spread);
        ck_assert_msg(fabs(found - 4.905) < 1e-5 && spread < 1e-9,
                      "%s fell %.15g m, spread %.3g", methods.list[k].text, found, spread);
    }
}

/* The thesis's shortcut takes h K_ii v_i for a force: at its own stiffness and step the cloth
 * falls 2.113 m instead of 4.905 m, and at half the step 3.034 m. */
TEST(block_shortcut_falls_too_slowly) {
    double spread;
    ck_assert_double_eq_tol(fall("implicit-block", 16, 165, &spread), 2.113, 5e-4);
    ck_assert_double_gt(spread, 0.01);
    ck_assert_double_eq_tol(fall("implicit-block", 16, 330, &spread), 3.034, 5e-4);
    ck_assert_double_eq_tol(fall("implicit-linearised", 16, 165, &spread), 4.934727, 5e-7);
}

/* Two particles of mass m and one spring: closed forms of the damped oscillator.
 *
 * The distance s beyond the rest length obeys s'' + 2 d s' + w^2 s = 0 with w^2 = 2 k/m and
 * d = c/m, for both damping models; across the spring only the relative model damps.
 */
#include "fixture.h"

#include <math.h>

#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [2, 1], \"size\": [1, 1]},"                          \
    " \"mass\": {\"particle\": 0.5}, \"springs\": {\"stretch\": %.17g, \"damping\": %.17g,"    \
    " \"damping_model\": \"%s\"}}], \"forces\": {\"gravity\": [0, 0, 0]}, \"time\": "          \
    "{\"fps\": 20}}"
#define MASS 0.5

static const char *const models[] = {"relative", "axial"};

static double stretched(const struct fixture *pair) {
    return pair->x[1] - pair->x[0] - 1;
}

/* The distance after one second, from 0.1 m beyond rest. */
static double swing(const char *integrator, const char *model, double k, double c) {
    struct fixture pair;
    fixture_open(&pair, integrator, SCENE, k, c, model);
    pair.x[0] -= 0.05;
    pair.x[1] += 0.05;
    fixture_start(&pair);
    fixture_frames(&pair, 20);
    const double found = stretched(&pair);
    fixture_close(&pair);
    return found;
}

/* Underdamped: w = 10/s, d = 1.2/s. The bounds are each method's own error, a few times over:
 * h w^2/4 of the amplitude for order 1, (h w)^2 w/24 for order 2. */
TEST(axial_motion_follows_the_closed_form) {
    static const struct {
        const char *integrator;
        double bound; /* m */
    } rows[] = {{"explicit-euler:dt=1e-4", 4e-4},
                {"symplectic-euler:dt=1e-4", 4e-4},
                {"averaged-euler:dt=1e-4", 2e-4},
                {"velocity-verlet:dt=1e-3", 4e-6},
                {"position-verlet:dt=1e-4", 4e-5},
                {"implicit-linearised:dt=1e-4,rtol=1e-10", 4e-4},
                {"cvode-bdf:rtol=1e-9,max_order=5,linear_rtol=1e-8", 2e-7}};
    const double k = 25, c = 0.6, d = c / MASS, w = sqrt(2 * k / MASS - d * d);
    const double expected = 0.1 * exp(-d) * (cos(w) + d / w * sin(w));
    for (size_t m = 0; m < 2; m++)
        for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
            const double found = swing(rows[i].integrator, models[m], k, c);
            ck_assert_msg(fabs(found - expected) < rows[i].bound,
                          "%s, %s damping: %.9g m, expected %.9g, off by %.3g",
                          rows[i].integrator, models[m], found, expected,
                          fabs(found - expected));
        }
}

/* Overdamped: both roots real, the faster one within the explicit limit. */
TEST(overdamped_motion_follows_the_closed_form) {
    const double k = 25, c = 10, d = c / MASS, root = sqrt(d * d - 2 * k / MASS);
    const double slow = -d + root, fast = -d - root;
    const double expected = 0.1 * (slow * exp(fast) - fast * exp(slow)) / (slow - fast);
    for (size_t m = 0; m < 2; m++) {
        ck_assert_double_eq_tol(swing("velocity-verlet:dt=1e-4", models[m], k, c), expected,
                                1e-7);
        ck_assert_double_eq_tol(swing("implicit-linearised:dt=1e-4", models[m], k, c), expected,
                                1e-4);
    }
}

/* Along the spring all is linear, so that the implicit steps have a closed form of their own:
 * with w' = w + dw, s' = s + h w' and mu = 2/m,
 *   whole system  (1 + h mu c + h^2 mu k) dw = h (-mu k s - mu c w - h mu k w)
 *   own blocks    the same with mu/2 but in the force: each sees the other stand still */
TEST(implicit_steps_have_their_closed_form) {
    static const char *const integrators[] = {"implicit-linearised:rtol=1e-14",
                                              "implicit-block"};
    const double k = 25, c = 0.6, h = 1 / 20.0, mu = 2 / MASS;
    for (int own = 0; own < 2; own++) {
        const double part = own ? mu / 2 : mu;
        double s = 0.1, w = 0;
        for (int step = 0; step < 20; step++) {
            w += h * (-mu * (k * s + c * w) - h * part * k * w) /
                 (1 + h * part * c + h * h * part * k);
            s += h * w;
        }
        for (size_t m = 0; m < 2; m++)
            ck_assert_double_eq_tol(swing(integrators[own], models[m], k, c), s, 1e-13);
    }
}

/* Relative speed across the spring after one second, from 1 m/s, without stiffness. */
static double slide(const char *model) {
    struct fixture pair;
    fixture_open(&pair, "velocity-verlet:dt=1e-4", SCENE, 1e-9, 0.3, model);
    pair.v[2] = -0.005;
    pair.v[3] = 0.005;
    fixture_start(&pair);
    fixture_frames(&pair, 20);
    const double found = pair.v[3] - pair.v[2];
    fixture_close(&pair);
    return found;
}

/* Across the spring the relative model damps at rate 2 c/m, the axial model next to nothing:
 * the pair has turned by 0.01 rad, so that along / across is 1e-2 and the loss below 1e-4. */
TEST(only_relative_damping_acts_across) {
    ck_assert_double_eq_tol(slide("relative"), 0.01 * exp(-2 * 0.3 / MASS), 1e-8);
    ck_assert_double_eq_tol(slide("axial"), 0.01, 1e-6);
}

/* A pair that turns about its centre with the spring pulled out just so: axial damping does not
 * slow it, relative damping does. */
TEST(axial_damping_leaves_rotation_alone) {
    for (size_t m = 0; m < 2; m++) {
        struct fixture pair;
        fixture_open(&pair, "velocity-verlet:dt=1e-4", SCENE, 25.0, 0.3, models[m]);
        const double length = 1.1;
        const double speed = sqrt(25 * (length - 1) * length / 2 / MASS); // m v^2 / (l/2) = k s
        pair.x[0] = -length / 2, pair.x[1] = length / 2;
        pair.v[2] = -speed, pair.v[3] = speed;
        fixture_start(&pair);
        const double before = fixture_energy(&pair);
        fixture_frames(&pair, 20);
        const double lost = 1 - fixture_energy(&pair) / before;
        if (m == 0)
            ck_assert_double_gt(lost, 0.3);
        else
            ck_assert_double_lt(fabs(lost), 1e-7);
        fixture_close(&pair);
    }
}

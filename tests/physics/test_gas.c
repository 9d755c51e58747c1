/* Gas that is shut in by a closed mesh: Boyle's law against closed forms. */
#include "methods.h"
#include "scene/scene.h"

#include "model/force/diagnostics.h"
#include "model/force/terms.h"

#include <math.h>
#include <stdlib.h>

/* a ball without springs that matter, far from the origin; %s: pressures */
#define BALL                                                                                   \
    "{\"bodies\": [{\"mesh\": {\"shape\": \"sphere\", \"detail\": 4, \"place\": "              \
    "{\"translate\": [3, 1, 2]}}, \"mass\": {\"areal_density\": 0.2}, \"springs\": "           \
    "{\"stretch\": 1e-6, \"bend\": 0}, %s}], \"forces\": {\"gravity\": [0, 0, 0]}}"

static const double centre[3] = {3, 1, 2};

/* m3, by Gauss's theorem with the field (x, 0, 0): another form than that of the force. */
static double volume(const struct fixture *ball, const double *x) {
    const struct cs_trimesh *mesh = ball->system->bodies[0].mesh;
    double sum = 0;
    for (uint32_t t = 0; t < mesh->n_triangles; t++) {
        const uint32_t *at = mesh->triangles + 3 * (size_t)t;
        const double *y = x + ball->n, *z = y + ball->n;
        const double area = ((y[at[1]] - y[at[0]]) * (z[at[2]] - z[at[0]]) -
                             (z[at[1]] - z[at[0]]) * (y[at[2]] - y[at[0]])) /
                            2;
        sum += area * (x[at[0]] + x[at[1]] + x[at[2]]) / 3;
    }
    return sum;
}

/* The ball at `factor` times its size. */
static void scale(struct fixture *ball, const double *start, double factor, double *x) {
    for (size_t k = 0; k < 3 * ball->n; k++)
        x[k] = centre[k / ball->n] + factor * (start[k] - centre[k / ball->n]);
}

static double energy_at(const struct fixture *ball, const double *x) {
    return cs_term_gas.energy(ball->system, &(struct cs_eval){.x = x});
}

/* U(V) - U(V0) = Q (V - V0) - P V0 ln(V/V0), the work at one temperature; with Q = 0 it is p0
 * V0 ln. U is least where P V0 = Q V, and 0 there. */
TEST(the_energy_is_the_work_of_boyle) {
    static const struct {
        const char *keys;
        double inside, outside;
    } rows[] = {{"\"pressure\": 40, \"outer_pressure\": 0", 40, 0},
                {"\"pressure\": 40, \"outer_pressure\": 60", 100, 60},
                {"\"outer_pressure\": 101325", 101325, 101325}};
    static const double factors[] = {0.2, 0.9, 1.001, 1.3, 4};
    for (size_t r = 0; r < LENGTH(rows); r++) {
        struct fixture ball;
        fixture_open(&ball, "rk4", BALL, rows[r].keys);
        double *x = calloc(3 * ball.n, sizeof *x);
        const double start = volume(&ball, ball.x), scale_of = rows[r].inside * start;
        ck_assert_double_eq_tol(start, 0.5, 0.05);
        for (size_t k = 0; k < LENGTH(factors); k++) {
            scale(&ball, ball.x, factors[k], x);
            const double by = volume(&ball, x) / start;
            const double work = rows[r].outside * start * (by - 1) - scale_of * log(by);
            ck_assert_double_eq_tol(energy_at(&ball, x) - energy_at(&ball, ball.x), work,
                                    1e-12 * scale_of * (1 + by));
            ck_assert_double_ge(energy_at(&ball, x), 0);
        }
        if (rows[r].outside > 0) {
            scale(&ball, ball.x, cbrt(rows[r].inside / rows[r].outside), x);
            ck_assert_double_eq_tol(energy_at(&ball, x), 0, 1e-12 * scale_of);
        }
        free(x);
        fixture_close(&ball);
    }
}

/* Crushed and turned inside out the force still is the slope of the energy, and finite. */
TEST(a_crushed_ball_is_pushed_open) {
    struct fixture ball;
    fixture_open(&ball, "rk4", BALL, "\"pressure\": 40, \"outer_pressure\": 10");
    double *x = calloc(6 * ball.n, sizeof *x), *f = x + 3 * ball.n;
    static const double factors[] = {-0.5, 0.01, 0.0999, 0.1001, 0.5};
    for (size_t k = 0; k < LENGTH(factors); k++) {
        double along = 0, by_energy[2];
        const double h = 1e-6;
        scale(&ball, ball.x, factors[k], x);
        cs_terms_force(ball.system,
                       &(struct cs_eval){.x = x, .v = ball.v, .parts = CS_PART_POTENTIAL}, f);
        for (size_t i = 0; i < 3 * ball.n; i++)
            along += f[i] * (ball.x[i] - centre[i / ball.n]);
        for (int side = 0; side < 2; side++) {
            scale(&ball, ball.x, factors[k] + (side ? h : -h), x);
            by_energy[side] = energy_at(&ball, x);
        }
        const double slope = (by_energy[0] - by_energy[1]) / (2 * h);
        ck_assert_msg(fabs(along - slope) <= 1e-5 * fabs(slope) && slope > 0,
                      "%g: %.12g, not %.12g", factors[k], along, slope);
    }
    free(x);
    fixture_close(&ball);
}

/* m0 and V0 of the shape g = dV/dx: w^2 = (Q/V) sum |g|^2/m about the balance. */
static double frequency_of(const struct fixture *ball, double outside, double *shape) {
    const size_t n = ball->n;
    const double h = 1e-6;
    double sum = 0, *x = calloc(3 * n, sizeof *x);
    memcpy(x, ball->x, 3 * n * sizeof *x);
    for (size_t k = 0; k < 3 * n; k++) {
        x[k] = ball->x[k] + h;
        const double more = volume(ball, x);
        x[k] = ball->x[k] - h;
        const double g = (more - volume(ball, x)) / (2 * h);
        x[k] = ball->x[k];
        shape[k] = g * ball->system->inv_mass[k % n];
        sum += g * shape[k];
    }
    const double start = volume(ball, ball->x);
    free(x);
    return sqrt(outside * sum / start);
}

/* A light shell breathes with the air in it: after half a period what moved out along g/m moves
 * in. The bound of the frequency is above that of the motion, by which explicit methods step.
 */
TEST(a_shell_breathes_at_its_frequency) {
    static const struct {
        const char *method;
        double tolerance;
    } rows[] = {{"rk4:dt=2e-5", 1e-6},
                {"velocity-verlet:dt=2e-5", 1e-4},
                {"implicit-midpoint:dt=2e-5", 1e-3},
                {"implicit-linearised:dt=2e-5", 0.08},
                {"dopri5", 1e-2}};
    for (size_t r = 0; r < LENGTH(rows); r++) {
        struct fixture ball;
        double omega, delta, most = 0, error = 0;
        fixture_open(&ball, rows[r].method, BALL, "\"outer_pressure\": 101325");
        const size_t n = ball.n;
        double *shape = calloc(3 * n, sizeof *shape), *work = calloc(2 * n, sizeof *work);
        const double w = frequency_of(&ball, 101325, shape);
        const struct cs_eval at = {.x = ball.x, .v = ball.v, .parts = CS_PART_ALL};
        cs_spectral_bounds_at(ball.system, &at, work, &omega, &delta);
        ck_assert_double_gt(omega, w);
        ck_assert_double_lt(omega, 2 * w);
        for (size_t k = 0; k < 3 * n; k++)
            most = fmax(most, fabs(shape[k]));
        for (size_t k = 0; k < 3 * n; k++)
            ball.v[k] = 1e-4 * shape[k] / most;
        fixture_start(&ball);
        ball.session.scene->time.fps = w / 3.14159265358979323846;
        fixture_frames(&ball, 1);
        for (size_t k = 0; k < 3 * n; k++)
            error = fmax(error, fabs(ball.v[k] + 1e-4 * shape[k] / most));
        ck_assert_msg(error < 1e-4 * rows[r].tolerance, "%s: %.3g of the speed", rows[r].method,
                      error / 1e-4);
        free(work);
        free(shape);
        fixture_close(&ball);
    }
}

/* V/V0 of a ball with a skin, at rest. */
static double blown_up(const char *keys) {
    struct fixture ball;
    fixture_open(
        &ball, "implicit-linearised:dt=0.004",
        "{\"bodies\": [{\"mesh\": {\"shape\": \"sphere\", \"detail\": 4}, \"mass\": "
        "{\"areal_density\": 0.2}, \"elastic\": {\"membrane\": {\"young\": 200, "
        "\"poisson\": 0.3}, \"damping\": 0.02}, %s}], \"forces\": {\"gravity\": [0, 0, "
        "0], \"drag\": 0.05}}",
        keys);
    const double start = volume(&ball, ball.x);
    fixture_start(&ball);
    fixture_frames(&ball, 240);
    const double by = volume(&ball, ball.x) / start;
    fixture_close(&ball);
    return by;
}

/* Gas rests where a pump of P V0/V - Q would hold the skin, and further in than a pump of P -
 * Q. */
TEST(gas_rests_where_its_pressure_holds) {
    static const struct {
        const char *keys;
        double inside, outside;
    } rows[] = {{"\"pressure\": 100, \"outer_pressure\": 0", 100, 0},
                {"\"pressure\": 100, \"outer_pressure\": 2000", 2100, 2000}};
    const double free = blown_up("\"pressure\": 100");
    for (size_t r = 0; r < LENGTH(rows); r++) {
        char pump[64];
        const double by = blown_up(rows[r].keys);
        snprintf(pump, sizeof pump, "\"pressure\": %.12g",
                 rows[r].inside / by - rows[r].outside);
        ck_assert_double_eq_tol(by, blown_up(pump), 1e-4);
        ck_assert_double_gt(by, 1.005);
        ck_assert_double_lt(by, free - 0.02);
    }
}

/* The bisected border of stability against linear theory, on shipped scenes. */
#include "study/stability/stability.h"

#include "../physics/fixture.h"

#include <math.h>
#include <stdio.h>

struct row {
    const char *scene, *method, *grid;
    double seconds;
};

static double border_of(const struct row *row, struct cs_reference *reference) {
    char path[512];
    struct cs_error error = {0};
    const struct cs_override grid = {"bodies[0].cloth.grid", row->grid};
    double border = (double)NAN;
    snprintf(path, sizeof path, SCENES "/%s.json", row->scene);
    const struct cs_trial_settings trial = {.session = {.scene = path,
                                                        .integrator = row->method,
                                                        .overrides = &grid,
                                                        .n_overrides = 1,
                                                        .perturbation = 1e-6},
                                            .seconds = row->seconds,
                                            .samples = 32};
    ck_assert_msg(!cs_reference_run(reference, &trial, &error), "%s", error.message);
    ck_assert_msg(reference->found, "%s", reference->message);
    cs_stability_border(&trial, reference, reference->worst.dt / 3, reference->worst.dt * 2,
                        &border, &error);
    ck_assert_msg(!error.status, "%s", error.message);
    printf("%-10s %-18s %-9s border %.5g s, worst on the way %.5g, at the start %.5g: %.3f\n",
           row->scene, row->method, row->grid, border, reference->worst.dt,
           reference->at_rest.dt, border / reference->worst.dt);
    return border;
}

/* Found: 0.99 to 1.02 of the limit worst on the way; the limits at the start are up to 1.2
 * times too high where the cloth is drawn out far. */
START_TEST(border_lies_on_the_worst_limit) {
    static const struct row rows[] = {{"hang", "symplectic-euler", "[12, 12]", 0.5},
                                      {"hang", "symplectic-euler", "[20, 20]", 0.5},
                                      {"hang", "velocity-verlet", "[12, 12]", 0.5},
                                      {"hang", "velocity-verlet", "[20, 20]", 0.5},
                                      {"drum", "symplectic-euler", "[12, 12]", 0.5},
                                      {"drum", "symplectic-euler", "[20, 20]", 0.5},
                                      {"drum", "velocity-verlet", "[12, 12]", 0.5},
                                      {"drum", "velocity-verlet", "[20, 20]", 0.5}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct cs_reference reference;
        const double border = border_of(rows + i, &reference);
        ck_assert_msg(fabs(border / reference.worst.dt - 1) < 0.05,
                      "%s, %s, %s: border %.6g s, theory %.6g", rows[i].scene, rows[i].method,
                      rows[i].grid, border, reference.worst.dt);
    }
}
END_TEST

/* Found: 0.98. The limit is damping / stiffness, a fifteenth of 2 / omega here. */
START_TEST(forward_euler_lives_by_damping) {
    static const struct row row = {"drum", "explicit-euler", "[16, 16]", 1};
    struct cs_reference reference;
    const double border = border_of(&row, &reference);
    ck_assert_double_eq_tol(border / reference.at_rest.dt, 1, 0.1);
    ck_assert_double_lt(border, 0.1 * 2 / sqrt(reference.at_rest.mode.square));
}
END_TEST

int main(void) {
    const TTest *const tests[] = {border_lies_on_the_worst_limit,
                                  forward_euler_lives_by_damping};
    return fixture_run("border", tests, sizeof tests / sizeof *tests);
}

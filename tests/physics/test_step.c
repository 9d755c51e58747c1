/* The step of explicit methods: the automatic one is stable, and what was changed is told. */
#include "fixture.h"

#include <string.h>

#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [8, 8]}, \"mass\": {\"particle\": 0.01},"            \
    " \"springs\": {\"stretch\": 200, \"shear\": 75, \"bend\": 25, \"damping\": %g,"           \
    " \"damping_model\": \"relative\"}, \"pins\": [\"top\"]}], \"forces\": {\"drag\": %g}}"

static bool was_told(const struct fixture *cloth, const char *part) {
    const struct cs_run *run = &cloth->session.run;
    bool found = false;
    for (uint32_t k = 0; k < run->n_notes; k++)
        found |= strstr(run->notes[k], part) != NULL;
    return found;
}

/* Three seconds from a stirred start end with less energy than the start, from weak damping to
 * dampers that set the limit alone. */
TEST(automatic_step_is_stable) {
    static const char *const methods[] = {"explicit-euler", "symplectic-euler",
                                          "averaged-euler", "velocity-verlet",
                                          "position-verlet"};
    static const double damping[] = {0.002, 0.1, 2};
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++)
        for (size_t k = 0; k < sizeof damping / sizeof *damping; k++) {
            struct fixture cloth;
            fixture_open(&cloth, methods[i], SCENE, damping[k], 0.001);
            cs_perturb_smooth(cloth.system, 0.01, 0.5);
            fixture_start(&cloth);
            const double before = fixture_energy(&cloth);
            fixture_frames(&cloth, 180);
            const double after = fixture_energy(&cloth);
            ck_assert_msg(after < before, "%s, damping %g: %g J became %g J", methods[i],
                          damping[k], before, after);
            ck_assert(was_told(&cloth, "dt automatic: at most "));
            fixture_close(&cloth);
        }
}

/* No step of explicit Euler is stable without damping: it says so, and blows up. */
TEST(hopeless_step_is_told) {
    struct fixture cloth;
    struct cs_error error = {0};
    fixture_open(&cloth, "explicit-euler", SCENE, 0.0, 0.0);
    cs_perturb_smooth(cloth.system, 0.01, 0.5);
    fixture_start(&cloth);
    ck_assert(was_told(&cloth, "no step is stable without damping"));
    struct cs_run *run = &cloth.session.run;
    while (run->outcome == CS_RUNNING && run->frame < 180)
        ck_assert_int_eq(cs_run_frame(run, &error), CS_OK);
    ck_assert_int_ne(run->outcome, CS_RUNNING);
    fixture_close(&cloth);
}

/* dt is cut to whole steps a frame: 1/60 s in dt = 4 ms is five steps, in 1/600 s ten. */
TEST(steps_fill_the_frame) {
    static const struct {
        const char *integrator;
        uint64_t steps;
        bool told;
    } rows[] = {{"velocity-verlet:dt=0.004", 5, true},
                {"velocity-verlet:dt=0.00166666666666667", 10, false},
                {"velocity-verlet:dt=0.0083333", 2, false},
                {"velocity-verlet:dt=0.00833", 3, true},
                {"velocity-verlet:dt=1", 1, true},
                {"implicit-linearised", 1, false},
                {"implicit-block:dt=0.004", 5, true}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct fixture cloth;
        fixture_open(&cloth, rows[i].integrator, SCENE, 0.0, 0.0);
        fixture_start(&cloth);
        fixture_frames(&cloth, 2);
        ck_assert_uint_eq(cloth.session.run.counts.steps, 2 * rows[i].steps);
        ck_assert(was_told(&cloth, "dt reduced") == rows[i].told);
        fixture_close(&cloth);
    }
}

TEST(endless_frame_is_refused) {
    struct fixture cloth;
    struct cs_error error = {0};
    fixture_open(&cloth, "symplectic-euler:dt=1e-14", SCENE, 0.0, 0.0);
    fixture_start(&cloth);
    ck_assert_int_eq(cs_run_frame(&cloth.session.run, &error), CS_ERR_MODULE);
    ck_assert_msg(strstr(error.message, "needs more than 1e+09 steps"), "%s", error.message);
    fixture_close(&cloth);
}

/* cvode-bdf gives up with a reason when it may not take the steps it wants. */
TEST(step_budget_is_kept) {
    struct fixture cloth;
    fixture_open(&cloth, "cvode-bdf:rtol=1e-10,max_steps=3", SCENE, 0.1, 0.0);
    cs_perturb_smooth(cloth.system, 0.01, 0.5);
    fixture_start(&cloth);
    const char *reason = fixture_reason(&cloth);
    ck_assert_msg(strstr(reason, "more than 3 steps"), "%s", reason);
    ck_assert_uint_eq(cloth.session.run.counts.steps, 3);
    fixture_close(&cloth);
}

/* Runs a sheet for a frame with the limits; the work in passes at its end. */
static double work_within(double budget_passes, double *pot_passes, enum cs_outcome *outcome) {
    struct fixture cloth;
    struct cs_error error = {0};
    fixture_open(&cloth, "rk4:dt=1e-5", SCENE, 0.0, 0.0);
    const double pass = cs_pass_seconds(cloth.system);
    double pot = pot_passes ? *pot_passes * pass : 0;
    cloth.session.settings.run.budget = budget_passes * pass;
    cloth.session.settings.run.pot = pot_passes ? &pot : NULL;
    fixture_start(&cloth);
    ck_assert_int_eq(cs_run_frame(&cloth.session.run, &error), CS_OK);
    *outcome = cloth.session.run.outcome;
    const double work = cs_counts_work(&cloth.session.run.counts);
    fixture_close(&cloth);
    if (pot_passes)
        *pot_passes = pot / pass;
    return work;
}

/* A budget ends a run by its count of passes, at the step that exceeds it; runs with one pot
 * share what it holds. rk4 takes four passes per step. */
TEST(budget_counts_work) {
    enum cs_outcome outcome;
    const double first = work_within(1001, NULL, &outcome);
    ck_assert_int_eq(outcome, CS_OVER_BUDGET);
    ck_assert(first > 1001 && first <= 1006);
    double pot = 1500;
    ck_assert_double_eq(work_within(1001, &pot, &outcome), first);
    ck_assert_double_eq_tol(pot, 1500 - first, 1e-6);
    const double second = work_within(1001, &pot, &outcome);
    ck_assert_int_eq(outcome, CS_OVER_BUDGET);
    ck_assert(second > 1500 - first && second <= 1506 - first);
    ck_assert_double_lt(pot, 0);
    ck_assert_double_le(work_within(0, &pot, &outcome), 5);
    ck_assert_double_gt(work_within(1e9, NULL, &outcome), 5000);
    ck_assert_int_eq(outcome, CS_RUNNING);
}

/* A sheet that comes to lie on a floor: its particles are too quick for dt, which is cut for
 * most of the time. Steps that are worked out and thrown away are few, and what is known at the
 * end of a frame counts in the next. */
TEST(cut_steps_stay_cut) {
    static const char *const methods[] = {"implicit-linearised:dt=0.00833",
                                          "newmark:dt=0.00833"};
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        struct fixture cloth;
        fixture_open(
            &cloth, methods[i],
            "{\"bodies\": [{\"cloth\": {\"grid\": [5, 5], \"place\": {\"translate\": "
            "[0, 0.61, 0]}}, \"mass\": {\"particle\": 0.001}, \"springs\": {\"stretch\": "
            "200, \"damping\": 0.01}}], \"colliders\": [{\"floor\": {\"height\": 0}}], "
            "\"contact\": \"force\"}");
        fixture_start(&cloth);
        fixture_frames(&cloth, 40);
        const struct cs_counts *counts = &cloth.session.run.counts;
        ck_assert_msg(counts->steps > 100, "%s: %u steps", methods[i], (unsigned)counts->steps);
        const uint64_t rejected = counts->method.rejected;
        ck_assert_msg(rejected < counts->steps / 5, "%s: %u of %u", methods[i],
                      (unsigned)rejected, (unsigned)counts->steps);
        fixture_close(&cloth);
    }
}

/* A force that is not finite ends the run with time and place, and not as a solve that has
 * nothing to do. */
TEST(solve_that_is_not_finite_is_told) {
    static const char *const methods[] = {"implicit-linearised", "ros2"};
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++)
        for (int overflows = 0; overflows < 2; overflows++) {
            struct fixture cloth;
            struct cs_error error = {0};
            fixture_open(&cloth, methods[i], SCENE, 0.1, 0.001);
            fixture_start(&cloth);
            fixture_frames(&cloth, 1);
            // without a commit in between, as a stage of a method would
            cloth.x[20] = overflows ? 1e200 : (double)NAN;
            ck_assert_int_eq(cs_run_frame(&cloth.session.run, &error), CS_ERR_MODULE);
            ck_assert_msg(strstr(error.message,
                                 "in the step from t = 0.0166666667 s the linear "
                                 "system has no solution: ") != NULL,
                          "%s", error.message);
            ck_assert_msg(strstr(error.message,
                                 overflows ? "a sum overflows" : "not a number at particle ") !=
                              NULL,
                          "%s", error.message);
            fixture_close(&cloth);
        }
}

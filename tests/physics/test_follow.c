/* The loop over the frames of a run: where it stops, and what it says of the end. */
#include "fixture.h"

#include "session/session.h"

#include <string.h>

#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [4, 4]}, \"mass\": {\"particle\": 0.01},"            \
    " \"springs\": {\"stretch\": 200, \"damping\": 0}, \"pins\": [\"top\"]}],"                 \
    " \"time\": {\"fps\": 60}}"

/* Multiples of `every` are stopped at, the last frame is reached whatever it is. */
TEST(stops_are_multiples) {
    struct fixture cloth;
    struct cs_error error = {0};
    struct cs_run_result result;
    fixture_open(&cloth, "velocity-verlet", SCENE);
    fixture_start(&cloth);
    struct cs_follow follow = {.run = &cloth.session.run, .last = 8, .every = 3};
    const uint32_t expected[] = {3, 6};
    for (int k = 0; k < 2; k++) {
        ck_assert(cs_follow_next(&follow, &error));
        ck_assert_uint_eq(follow.run->frame, expected[k]);
    }
    ck_assert(!cs_follow_next(&follow, &error));
    ck_assert_uint_eq(follow.run->frame, 8);
    ck_assert(!cs_follow_next(&follow, &error));
    follow.last = 9; // a multiple that is the last frame is one too
    ck_assert(cs_follow_next(&follow, &error));
    follow.last = 11;
    follow.every = 0;
    ck_assert(!cs_follow_next(&follow, &error));
    ck_assert_uint_eq(follow.run->frame, 11);
    ck_assert(follow.cpu > 0 && follow.wall > 0);
    ck_assert(!cs_follow_result(follow.run, "", &result, &error));
    ck_assert_int_eq(result.outcome, CS_RUNNING);
    ck_assert(result.time == result.reached && result.reached == 11.0 / 60);
    ck_assert_str_eq(result.message, "finished");
    ck_assert(cs_follow_frames(follow.run->system->scene, 0.1) == 6);
    ck_assert(cs_follow_frames(follow.run->system->scene, 0.101) == 7);
    fixture_close(&cloth);
}

/* A blow-up and a method that gives up are results; the frame they are in is not stopped at. */
TEST(ends_are_results) {
    static const struct {
        const char *integrator;
        enum cs_outcome outcome;
        const char *message;
    } rows[] = {{"explicit-euler:dt=0.0166", CS_UNBOUNDED, "blew up: unbounded energy"},
                {"dopri5:rtol=1e-12,max_steps=3", CS_GAVE_UP, "more than 3 steps"},
                {"symplectic-euler:dt=1e-14", CS_FAILED, "needs more than 1e+09 steps"}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        struct fixture cloth;
        struct cs_error error = {0};
        struct cs_run_result result;
        fixture_open(&cloth, rows[k].integrator, SCENE);
        cs_perturb_smooth(cloth.system, 0.01, 0.5);
        fixture_start(&cloth);
        struct cs_run *run = &cloth.session.run;
        struct cs_follow follow = {.run = run, .last = 600, .every = 1};
        uint32_t stops = 0;
        while (cs_follow_next(&follow, &error))
            stops++;
        ck_assert_uint_eq(stops, run->frame);
        ck_assert_uint_lt(run->frame, 600);
        ck_assert(!cs_follow_result(run, "", &result, &error));
        ck_assert_int_eq(error.status, CS_OK);
        ck_assert_int_eq(result.outcome, rows[k].outcome);
        ck_assert_msg(strstr(result.message, rows[k].message), "%s", result.message);
        ck_assert(result.reached == run->t);
        ck_assert(result.time ==
                  (cs_outcome_has_reason(rows[k].outcome) ? run->t : run->blow_up.time));
        fixture_close(&cloth);
    }
}

/* An interruption is an error, as is the failure of a method that must not fail. */
TEST(interruptions_are_errors) {
    struct fixture cloth;
    struct cs_error error = {0};
    struct cs_run_result result;
    const volatile sig_atomic_t stop = 1;
    fixture_open(&cloth, "velocity-verlet", SCENE);
    cloth.session.settings.run.stop = &stop;
    fixture_start(&cloth);
    struct cs_follow follow = {.run = &cloth.session.run, .last = 2};
    ck_assert(!cs_follow_next(&follow, &error));
    ck_assert_int_eq(cs_follow_result(follow.run, " by a test", &result, &error),
                     CS_ERR_INTERRUPT);
    ck_assert_int_eq(result.outcome, CS_INTERRUPTED);
    ck_assert_str_eq(error.message, "interrupted by a test");
    error = (struct cs_error){CS_ERR_MODULE, "it gave up"};
    ck_assert_int_eq(cs_follow_check(follow.run, "", &error), CS_ERR_MODULE);
    fixture_close(&cloth);
}

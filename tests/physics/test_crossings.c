/* Two sheets that nothing keeps apart, thrown at each other: what is counted, what steps are
 * taken back, and where a run ends. */
#include "methods.h"

#include "model/contact/ccd/crossings.h"

#include <stdlib.h>
#include <string.h>

/* the blow that does not come keeps methods from passing frames, with a limit and without */
#define SHEETS                                                                                 \
    "{\"bodies\": [{\"cloth\": {\"grid\": [5, 5], \"size\": [0.4, 0.4], \"start\": \"flat\", " \
    "\"velocity\": [0, -1, 0], \"place\": {\"translate\": [0.03, 0.1, 0.02]}}, \"mass\": "     \
    "{\"total\": 0.1}, \"springs\": {\"damping\": 0.01}}, {\"cloth\": {\"grid\": [6, 5], "     \
    "\"size\": [0.5, 0.4], \"start\": \"flat\", \"velocity\": [0, 1, 0], \"bump\": 0.06}, "    \
    "\"mass\": {\"total\": 0.1}, \"springs\": {\"damping\": 0.01}}], \"forces\": "             \
    "{\"gravity\": [0, 0, 0]}, \"crossings\": \"%s\", \"time\": {\"fps\": 100}, "              \
    "\"events\": [{\"at\": 100, \"impact\": {\"direction\": [1, 0, 0]}}]}"

/* s at which the sheets meet: the gap is 0.1 m less the bump, which is 0.06 m in the middle */
#define MEET_FIRST 0.019
#define MEET_LAST  0.04

/* with steps long enough to be cut */
static struct methods all_methods(void) {
    return methods_find(&(struct methods_query){.test = "crossings", .dt = 0.005});
}

/* until the run ends or ten frames are done; the first failure stays in *error */
static uint64_t run_frames(struct fixture *fixture, const char *method, const char *policy,
                           struct cs_error *error) {
    struct cs_run *run = &fixture->session.run;
    uint64_t most = 0;
    fixture_open(fixture, method, SHEETS, policy);
    fixture_start(fixture);
    while (run->frame < 10 && !cs_run_frame(run, error) && run->outcome != CS_GAVE_UP) {
        ck_assert_msg(run->outcome == CS_RUNNING, "%s: %s", method,
                      cs_outcome_text(run->outcome));
        const uint64_t found = cs_crossings_count(fixture->system, run->t, run->x).n;
        most = found > most ? found : most;
    }
    return most;
}

TEST(counted_sheets_pass_through_each_other) {
    const struct methods methods = all_methods();
    for (size_t k = 0; k < methods.n; k++) {
        const char *method = methods.list[k].text;
        struct fixture fixture;
        struct cs_error error = {0};
        const uint64_t most = run_frames(&fixture, method, "count", &error);
        ck_assert_msg(!error.status, "%s", error.message);
        ck_assert_uint_eq(fixture.session.run.frame, 10);
        ck_assert_msg(most > 5, "%s: %llu", method, (unsigned long long)most);
        ck_assert_uint_eq(fixture.session.run.counts.subdivided_steps, 0);
        fixture_close(&fixture);
    }
}

/* the state is that of the last step that was good: nothing has crossed, and it is not a step
 * too early */
TEST(limited_sheets_stop_before_they_meet) {
    const struct methods methods = all_methods();
    for (size_t k = 0; k < methods.n; k++) {
        const char *method = methods.list[k].text;
        struct fixture fixture;
        struct cs_error error = {0};
        const uint64_t most = run_frames(&fixture, method, "limit", &error);
        const struct cs_run *run = &fixture.session.run;
        const bool gave_up = run->outcome == CS_GAVE_UP;
        const char *reason = gave_up ? run->reason : error.message;
        ck_assert_msg(gave_up || error.status == CS_ERR_MODULE, "%s: no end", method);
        ck_assert_msg(strstr(reason, " a surface") || strstr(reason, "the step fell to") ||
                          strstr(reason, "failed at t"),
                      "%s: %s", method, reason);
        ck_assert_uint_eq(most, 0);
        ck_assert_uint_eq(cs_crossings_count(fixture.system, run->t, run->x).n, 0);
        ck_assert_uint_gt(run->counts.subdivided_steps, 5);
        // a move of a hundredth of a frame more would cross
        double *next = malloc(3 * fixture.n * sizeof *next);
        for (size_t i = 0; i < 3 * fixture.n; i++)
            next[i] = run->x[i] + 1e-4 * run->v[i];
        ck_assert_double_lt(cs_crossings_safe_fraction(fixture.system, 0, run->x, 1, next), 1);
        free(next);
        fixture_close(&fixture);
    }
}

static double time_in(const char *message) {
    const char *place = strstr(message, "step to t = ");
    ck_assert_msg(place, "%s", message);
    return strtod(place + strlen("step to t = "), NULL);
}

TEST(stopped_sheets_say_when) {
    static const char *const asked[] = {"velocity-verlet:dt=0.0001", "xpbd:dt=0.001",
                                        "fast-mass-spring:dt=0.001",
                                        "implicit-linearised:dt=0.001"};
    for (size_t k = 0; k < sizeof asked / sizeof *asked; k++) {
        struct fixture fixture;
        struct cs_error error = {0};
        const uint64_t most = run_frames(&fixture, asked[k], "stop", &error);
        ck_assert_int_eq(error.status, CS_ERR_MODULE);
        const double t = time_in(error.message);
        ck_assert_msg(t > MEET_FIRST && t < MEET_LAST, "%s: %g", asked[k], t);
        ck_assert_uint_eq(most, 0);
        ck_assert_uint_gt(cs_crossings_count(fixture.system, 0, fixture.x).n, 0);
        fixture_close(&fixture);
    }
}

/* before they come near each other a limit changes nothing, to the bit */
TEST(limits_cost_no_bit_until_they_act) {
    const struct methods methods = all_methods();
    for (size_t k = 0; k < methods.n; k++) {
        const char *method = methods.list[k].text;
        struct fixture free, limited;
        fixture_open(&free, method, SHEETS, "ignore");
        fixture_open(&limited, method, SHEETS, "limit");
        fixture_start(&free);
        fixture_start(&limited);
        fixture_frames(&free, 1);
        fixture_frames(&limited, 1);
        ck_assert_msg(!memcmp(free.x, limited.x, 6 * free.n * sizeof *free.x), "%s", method);
        ck_assert_ptr_null(free.system->crossings);
        ck_assert_ptr_null(free.system->surfaces);
        ck_assert_uint_eq(limited.session.run.counts.subdivided_steps, 0);
        fixture_close(&free);
        fixture_close(&limited);
    }
}

#define BODY(x, y, speed)                                                                      \
    "{\"cloth\": {\"grid\": [5, 5], \"size\": [0.4, 0.4], \"start\": \"flat\", \"velocity\": " \
    "[0, " speed ", 0], \"place\": {\"translate\": [" x ", " y ", 0.02]}, \"bump\": 0.05}, "   \
    "\"mass\": {\"total\": 0.1}, \"springs\": {\"damping\": 0.01}}"
#define MEETING                                                                                \
    "{\"bodies\": [" BODY("0.03", "0.1", "-3") ", " BODY("0", "0", "1") ", " BODY(             \
        "0.05", "0.2", "-4") "], \"forces\": {\"gravity\": [0, 0, 0]}, \"contact\": "          \
                             "\"force\", \"pairs\": %s, \"time\": {\"fps\": 100}}"

/* by frames; the scene says nothing of crossings */
static uint64_t run_meeting(struct fixture *fixture, const char *method, const char *pairs) {
    struct cs_run *run = &fixture->session.run;
    struct cs_error error = {0};
    uint64_t most = 0;
    fixture_open(fixture, method, MEETING, pairs);
    fixture_start(fixture);
    ck_assert_ptr_nonnull(fixture->system->crossings);
    while (run->frame < 12 && run->outcome == CS_RUNNING && !cs_run_frame(run, &error)) {
        const uint64_t found = cs_crossings_count(fixture->system, run->t, run->x).n;
        most = found > most ? found : most;
    }
    ck_assert_msg(!error.status && run->frame == 12, "%s: %s", method, error.message);
    return most;
}

/* of three families; steps are limited where bodies keep off each other, and only these bodies
 */
TEST(contact_is_limited_by_itself) {
    static const char *const asked[] = {"velocity-verlet:dt=0.001",
                                        "implicit-linearised:dt=0.01", "cvode-bdf:rtol=1e-2"};
    for (size_t k = 0; k < sizeof asked / sizeof *asked; k++) {
        struct fixture fixture;
        ck_assert_uint_eq(run_meeting(&fixture, asked[k], "\"all\""), 0);
        fixture_close(&fixture);
        const uint64_t most =
            run_meeting(&fixture, asked[k], "{\"list\": [{\"bodies\": [0, 1]}]}");
        ck_assert_msg(most > 0, "%s", asked[k]);
        fixture_close(&fixture);
    }
}

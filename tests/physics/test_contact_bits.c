/* One state, to the last bit, of every scene in which surfaces meet: for lists with margins of
 * a half, one and two, for 1, 2, 3 and 8 threads, and for a run that was broken off and goes
 * on. (For compilers: golden hashes.) One small scene by default; "all" for the rest. */
#include "body_pair_fixture.h"
#include "fixture.h"

#include "base/pool.h"
#include "model/contact/narrow_phase/contact_pairs.h"
#include "sim/run_state.h"

#include <stdlib.h>
#include <string.h>

/* each until surfaces press on each other */
static const struct meeting scenes[] = {
    {.scene = "self_compare", .frames = 60},
    {.scene = "fold", .frames = 30, .overrides = {MEETING_GRID(9, 25)}},
    {.scene = "trampoline", .frames = 24, .overrides = {MEETING_GRID(13, 13)}},
    {.scene = "layers",
     .frames = 24,
     .overrides = {MEETING_GRID(13, 13), MEETING_GRID_OF(1, 13, 13)}},
    {.scene = "ribbon", .frames = 200},
    {.scene = "needles", .frames = 40, .overrides = {MEETING_GRID(13, 13)}},
    {.scene = "bear_drape", .frames = 30, .overrides = {MEETING_GRID(15, 15)}},
    {.scene = "walking_bear", .frames = 30, .overrides = {MEETING_GRID(15, 15)}},
    {.scene = "winding", .frames = 80, .overrides = {MEETING_GRID(11, 11)}},
    {.scene = "funnel",
     .frames = 40,
     .overrides = {MEETING_GRID(9, 9), MEETING_GRID_OF(1, 9, 9), MEETING_GRID_OF(2, 9, 9)}},
    {.scene = "bear_heap", .frames = 40},
    {.scene = "reef_knot", .frames = 40},
    {.scene = "curtain_ball",
     .frames = 40,
     .overrides = {MEETING_GRID(15, 17), MEETING_CURTAIN}},
};

static const char *const methods[] = {NULL, "dopri5:rtol=1e-3"};

/* How a scene is run. */
struct how {
    uint32_t threads;
    double margin; /* of lists, as a multiple */
    bool broken;   /* off in the middle, and taken up from its record */
};

static void open(struct cs_session *session, const struct meeting *params, struct how how) {
    struct cs_error error = {0};
    meeting_open_system(session, params);
    struct cs_candidates *search = &session->system.pairs->candidates;
    search->margin *= how.margin;
    search->is_built = false;
    cs_session_begin(session, NULL, &error);
    ck_assert_msg(!error.status, "%s", error.message);
}

/* In every run, as some methods start anew where a record is made. */
static void break_off(struct cs_session *session, const struct meeting *params,
                      struct how how) {
    struct cs_error error = {0};
    struct cs_serialiser serialiser = {0};
    cs_run_save(&session->run, &serialiser, &error);
    if (how.broken) {
        cs_session_close(session);
        open(session, params, how);
        serialiser.is_reading = true;
        cs_run_load(&session->run, &serialiser, &error);
    }
    ck_assert_msg(!error.status, "%s", error.message);
    cs_serialiser_finish(&serialiser);
}

/* Returns the state at the end, which the caller frees. */
static double *run(const struct meeting *params, struct how how, size_t *bytes) {
    struct cs_session session;
    struct cs_error error = {0};
    cs_pool_start(how.threads, &error);
    ck_assert_msg(!error.status, "%s", error.message);
    open(&session, params, how);
    for (uint32_t frame = 0; frame < params->frames; frame++) {
        if (frame == params->frames / 2)
            break_off(&session, params, how);
        meeting_frame(&session, params);
    }
    ck_assert_msg(session.system.pairs->current_contacts->n > 0, "%s: nothing meets",
                  params->scene);
    *bytes = 6 * session.system.view.n * sizeof(double);
    double *state = malloc(*bytes);
    ck_assert_ptr_nonnull(state);
    memcpy(state, session.run.x, *bytes);
    cs_session_close(&session);
    cs_pool_stop();
    return state;
}

static void check(const struct meeting *params) {
    static const struct how hows[] = {{1, 0.5, false}, {1, 2, false}, {2, 1, false},
                                      {3, 1, false},   {8, 1, false}, {1, 1, true}};
    size_t bytes;
    double *right = run(params, (struct how){1, 1, false}, &bytes);
    for (size_t k = 0; k < LENGTH(hows); k++) {
        double *state = run(params, hows[k], &bytes);
        ck_assert_msg(!memcmp(right, state, bytes),
                      "%s by %s: %u threads, margin %g, %s run differs", params->scene,
                      params->method ? params->method : "its own method", hows[k].threads,
                      hows[k].margin, hows[k].broken ? "broken" : "unbroken");
        free(state);
    }
    free(right);
}

TEST(one_state) {
    for (size_t s = 0; s < (suite_all ? LENGTH(scenes) : 1); s++)
        for (size_t m = 0; m < LENGTH(methods); m++) {
            struct meeting params = scenes[s];
            params.method = methods[m];
            check(&params);
        }
}

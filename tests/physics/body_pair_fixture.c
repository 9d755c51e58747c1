/* One method through a scene of the folder. */
#include "body_pair_fixture.h"

#include "model/contact/ccd/crossings.h"

#include "../suite.h"
#include <stdio.h>

/* What opens a session, as far as is asked for. */
typedef enum cs_status open_call(struct cs_session *session,
                                 const struct cs_session_settings *settings,
                                 struct cs_error *error);

static void open_by(open_call *call, struct cs_session *session, const struct meeting *params) {
    struct cs_error error = {0};
    char path[512];
    uint32_t n = 0;
    while (n < MEETING_OVERRIDES && params->overrides[n].path)
        n++;
    snprintf(path, sizeof path, SCENES "/%s.json", params->scene);
    const struct cs_session_settings settings = {.scene = path,
                                                 .overrides = params->overrides,
                                                 .n_overrides = n,
                                                 .integrator = params->method};
    call(session, &settings, &error);
    ck_assert_msg(!error.status, "%s: %s", params->scene, error.message);
}

void meeting_open_system(struct cs_session *session, const struct meeting *params) {
    open_by(cs_session_open_system, session, params);
}

void meeting_open(struct cs_session *session, const struct meeting *params) {
    open_by(cs_session_open, session, params);
}

void meeting_frame(struct cs_session *session, const struct meeting *params) {
    struct cs_error error = {0};
    cs_run_frame(&session->run, &error);
    ck_assert_msg(!error.status && session->run.outcome == CS_RUNNING, "%s by %s: %s",
                  params->scene, params->method ? params->method : "its own method",
                  error.status ? error.message : cs_outcome_text(session->run.outcome));
}

uint64_t meeting_crossings(const struct cs_session *session) {
    const struct cs_run *run = &session->run;
    return cs_crossings_count(&session->system, run->t, run->x).n;
}

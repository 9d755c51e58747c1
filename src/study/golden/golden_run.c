/* Opens the session of a golden row and steps it to the row's frame. */
#include "study/golden/golden_run.h"

#include "study/follow.h"

#include <stdio.h>
#include <string.h>

/* Splits "path=value;path=value" in place. Returns the number of overrides. */
static uint32_t split_overrides(char *text, struct cs_override *overrides, uint32_t most) {
    uint32_t n = 0;
    char *pair;
    while (n < most && (pair = strsep(&text, ";"))) {
        char *equals = strchr(pair, '=');
        if (!equals)
            continue;
        *equals = 0;
        overrides[n++] = (struct cs_override){pair, equals + 1};
    }
    return n;
}

enum cs_status cs_golden_step(const struct cs_golden *golden, const struct cs_golden_run *run,
                              bool render, struct cs_session *session, struct cs_error *error) {
    char scene[1280], text[1024];
    struct cs_override overrides[16];
    /* scenes are named from the folder above the golden one */
    snprintf(scene, sizeof scene, "%s/../%s", golden->folder, run->scene);
    /* a copy, which split_overrides cuts up */
    snprintf(text, sizeof text, "%s", run->overrides);
    const struct cs_session_settings settings = {
        .scene = scene,
        .overrides = overrides,
        .n_overrides = split_overrides(text, overrides, 16),
        .integrator = strcmp(run->integrator, "-") ? run->integrator : NULL,
        .render = render,
        .threads = golden->threads,
        .run = {.stop = golden->stop},
    };
    if (cs_session_open(session, &settings, error))
        return error->status;
    struct cs_follow follow = {.run = &session->run, .last = run->frames};
    cs_follow_next(&follow, error);
    if (cs_follow_check(&session->run, "", error))
        cs_session_close(session);
    return error->status;
}

/* Finds the range of colours in a run before the one that is drawn. */
#include "cli/run/job_state.h"

#include "model/force/diagnostics.h"
#include "study/follow.h"
#include "study/frame_picture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The preliminary run and its figures. */
struct search {
    struct cs_session session;
    double *scalar, *work; /* (n), (3,n) */
    double *most;          /* of each frame that will be drawn */
    uint32_t n;
};

static enum cs_status take(struct search *search, uint32_t frames, struct cs_error *error) {
    const size_t n = search->session.system.view.n;
    search->scalar = calloc(n + 1, sizeof *search->scalar);
    search->work = calloc(n + 1, 3 * sizeof *search->work);
    search->most = calloc((size_t)frames + 1, sizeof *search->most);
    if (!search->scalar || !search->work || !search->most)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the range of colours");
    return CS_OK;
}

/* Records the magnitude of each frame that will be drawn. */
static enum cs_status sample_frame(struct search *search, uint32_t frames, uint32_t every,
                                   struct cs_error *error) {
    struct cs_run *run = &search->session.run;
    struct cs_follow follow = {.run = run, .last = frames, .every = every, .at_start = !frames};
    while (cs_follow_next(&follow, error)) {
        cs_picture_values(&search->session.system, run, search->scalar, search->work);
        search->most[search->n++] =
            cs_diagnostics_magnitude(search->scalar, search->session.system.view.n);
    }
    return cs_follow_check(run, " in the run that finds the range of colours", error);
}

/* Refuses --range for a look whose colours show no value. */
static enum cs_status check(const struct cs_session *session, struct cs_error *error) {
    const struct cs_scene *scene = &session->scene;
    if (!cs_picture_is_coloured(scene))
        return cs_fail(error, CS_ERR_USAGE,
                       "--range: the look \"%s\" shows no values; \"force\" and \"strain\" do",
                       cs_look_names[scene->render.look]);
    return CS_OK;
}

/* Finds a value for render.range; empty if nothing moves. */
static enum cs_status search_range(const struct cs_job_settings *settings, char value[80],
                                   struct cs_error *error) {
    struct search search = {0};
    double range[2];
    struct cs_session *session = &search.session;
    if (!strcmp(settings->session.scene, "-"))
        return cs_fail(error, CS_ERR_USAGE,
                       "--range auto runs the scene twice: SCENE must be a file, not -");
    if (cs_session_open(session, &settings->session, error))
        return error->status;
    const uint32_t frames = cs_job_frames(settings, &session->scene);
    if (!check(session, error) && !take(&search, frames / settings->frame_interval, error) &&
        !sample_frame(&search, frames, settings->frame_interval, error)) {
        cs_picture_range(&session->scene, cs_diagnostics_magnitude(search.most, search.n),
                         range);
        if (range[0] < range[1])
            snprintf(value, 80, "[%.9g,%.9g]", range[0], range[1]);
    }
    free(search.scalar);
    free(search.work);
    free(search.most);
    cs_session_close(session);
    return error->status;
}

/* Reads "MIN,MAX" with MIN < MAX, and prints it with all digits. */
static enum cs_status read_range(const char *text, char value[80], struct cs_error *error) {
    const char *comma = strchr(text, ',');
    double least, most;
    char first[40];
    if (comma && comma - text < (long)sizeof first) {
        snprintf(first, sizeof first, "%.*s", (int)(comma - text), text);
        if (cs_parse_real(first, &least) && cs_parse_real(comma + 1, &most) && least < most) {
            snprintf(value, 80, "[%.17g,%.17g]", least, most);
            return CS_OK;
        }
    }
    return cs_fail(error, CS_ERR_USAGE, "--range: found \"%s\", expected \"auto\", or MIN,MAX",
                   text);
}

/* The override is appended after the user's own: the last one for a key wins. */
enum cs_status cs_run_range_set(struct cs_run_range *range, const char *text,
                                struct cs_job_settings *settings, struct cs_error *error) {
    struct cs_session_settings *session = &settings->session;
    if (strcmp(text, "auto") ? read_range(text, range->value, error)
                             : search_range(settings, range->value, error))
        return error->status;
    if (!*range->value)
        return CS_OK;
    range->overrides = calloc(session->n_overrides + 1, sizeof *range->overrides);
    if (!range->overrides)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the range of colours");
    if (session->n_overrides)
        memcpy(range->overrides, session->overrides,
               session->n_overrides * sizeof *range->overrides);
    range->overrides[session->n_overrides++] =
        (struct cs_override){"render.range", range->value};
    session->overrides = range->overrides;
    return CS_OK;
}

void cs_run_range_finish(struct cs_run_range *range) {
    free(range->overrides);
    *range = (struct cs_run_range){0};
}

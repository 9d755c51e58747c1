/* Finds the range of colours, or where an instability began, in a run before the one that is
 * drawn. */
#include "cli/run/job_state.h"

#include "cli/line/print.h"
#include "session/energy_monitor.h"
#include "session/frame_picture.h"
#include "session/session.h"

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

static enum cs_status allocate_bounds(struct search *search, uint32_t frames,
                                      struct cs_error *error) {
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
                       cs_look_names[scene->render->look]);
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
    if (!check(session, error) &&
        !allocate_bounds(&search, frames / settings->frame_interval, error) &&
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

/* Appends an override after the user's own: the last one for a key wins. */
static enum cs_status add_override(struct cs_run_range *range, const char *key,
                                   const char *value, struct cs_session_settings *session,
                                   struct cs_error *error) {
    struct cs_override *overrides = calloc(session->n_overrides + 1, sizeof *overrides);
    if (!overrides)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the override of %s", key);
    if (session->n_overrides)
        memcpy(overrides, session->overrides, session->n_overrides * sizeof *overrides);
    overrides[session->n_overrides++] = (struct cs_override){key, value};
    free(range->overrides);
    session->overrides = range->overrides = overrides;
    return CS_OK;
}

enum cs_status cs_run_range_set(struct cs_run_range *range, const char *text,
                                struct cs_job_settings *settings, struct cs_error *error) {
    struct cs_session_settings *session = &settings->session;
    if (strcmp(text, "auto") ? read_range(text, range->value, error)
                             : search_range(settings, range->value, error))
        return error->status;
    return *range->value ? add_override(range, "render.range", range->value, session, error)
                         : CS_OK;
}

/* Adds the particle, then its neighbours by stretch and shear springs, as numbers within its
 * body: a value of render.marks. */
static void print_marks(const struct cs_system *system, uint32_t particle,
                        struct cs_text *out) {
    uint32_t b = 0;
    while (particle >= system->bodies[b].first + system->bodies[b].count)
        b++;
    const uint32_t first = system->bodies[b].first;
    cs_text_add(out, "{\"body\": %u, \"particles\": [%u", b, particle - first);
    for (uint32_t r = 0; r < system->springs.n_runs; r++) {
        const struct cs_spring_run *run = system->springs.runs + r;
        for (uint32_t i = 0; run->kind != CS_SPRING_BEND && i < run->count; i++) {
            const uint32_t from = cs_spring_a(run, i), to = cs_spring_b(run, i);
            if (from == particle || to == particle)
                cs_text_add(out, ", %u", (from == particle ? to : from) - first);
        }
    }
    cs_text_add(out, "]}");
}

/* Runs the scene to its first instability, or to its end. */
static enum cs_status search_instability(const struct cs_job_settings *settings,
                                         struct cs_text *marks, struct cs_error *error) {
    struct cs_session session;
    struct cs_energy_monitor monitor = {0};
    struct cs_energy_monitor_row row;
    if (!strcmp(settings->session.scene, "-"))
        return cs_fail(error, CS_ERR_USAGE,
                       "--mark-instability runs the scene twice: SCENE must be a file, not -");
    if (cs_session_open(&session, &settings->session, error))
        return error->status;
    struct cs_run *run = &session.run;
    struct cs_follow follow = {
        .run = run, .last = cs_job_frames(settings, &session.scene), .every = 1};
    const struct cs_energy_monitor_row *first = &monitor.first;
    if (!cs_energy_monitor_begin(&monitor, run, error))
        while (first->verdict == CS_STABILITY_BOUNDED && cs_follow_next(&follow, error))
            cs_energy_monitor_sample(&monitor, run, &row);
    if (first->verdict != CS_STABILITY_BOUNDED)
        print_marks(&session.system, first->particle, marks);
    else if (cs_outcome_is_blow_up(run->outcome))
        print_marks(&session.system, run->blow_up.particle, marks);
    cs_follow_check(run, " in the run that finds the instability", error);
    cs_session_close(&session);
    return error->status;
}

enum cs_status cs_run_marks_set(struct cs_run_range *range, struct cs_job_settings *settings,
                                struct cs_error *error) {
    if (search_instability(settings, &range->marks, error))
        return error->status;
    if (range->marks.failed)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for marks");
    if (!range->marks.length) {
        cs_print_message("no instability was found: no particle is marked");
        return CS_OK;
    }
    return add_override(range, "render.marks", cs_text_get(&range->marks), &settings->session,
                        error);
}

void cs_run_range_finish(struct cs_run_range *range) {
    free(range->overrides);
    cs_text_finish(&range->marks);
    *range = (struct cs_run_range){0};
}

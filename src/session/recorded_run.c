/* Runs a method on a scene without post-step corrections, and records its trajectory. */
#include "session/recorded_run.h"

#include "model/event/events.h"
#include "scene/body_keys.h"
#include "scene/contact_keys.h"
#include "scene/force_keys.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* True if a body has a strain limit. */
static bool has_strain_limit(const struct cs_scene *scene) {
    for (uint32_t b = 0; b < scene->bodies.n; b++)
        if (!isnan(cs_scene_bodies(scene)[b].strain_limit))
            return true;
    return false;
}

void cs_recorded_run_describe_changes(const struct cs_scene *scene, struct cs_text *out) {
    const bool projected = scene->colliders.n > 0 && scene->contact->law == CS_CONTACT_PROJECT;
    const bool parts[] = {projected, has_strain_limit(scene), scene->forces->velocity_loss > 0};
    const char *const names[] = {"contact", "strain limit", "velocity loss"};
    bool any = false;
    for (int k = 0; k < 3; k++)
        if (parts[k]) {
            cs_text_add(out, "%s%s", any ? ", " : "", names[k]);
            any = true;
        }
}

enum cs_status cs_session_fit_frames(const struct cs_session_settings *settings,
                                     uint32_t *frames, double *seconds,
                                     struct cs_error *error) {
    struct cs_session session;
    struct cs_session_settings asked = *settings;
    asked.integrator = "velocity-verlet";
    if (cs_session_open_plan(&session, &asked, error))
        return error->status;
    const double cover = cs_follow_frames(&session.scene, *seconds);
    if (*frames)
        *seconds = *frames / session.scene.time.fps;
    else if (cover <= 1e6)
        *frames = (uint32_t)cover;
    else
        cs_fail(error, CS_ERR_USAGE, "--time: %g s are more than 1000000 frames", *seconds);
    cs_session_close(&session);
    return error->status;
}

/* Copies the state at time 0, which every run begins with. */
static enum cs_status store_start(struct cs_recorded_run *recording, struct cs_error *error) {
    const size_t n = recording->session.system.view.n;
    recording->initial_state = malloc(7 * n * sizeof *recording->initial_state);
    if (!recording->initial_state)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the start of a run");
    recording->free_from = recording->initial_state + 6 * n;
    memcpy(recording->initial_state, recording->session.system.state,
           6 * n * sizeof *recording->initial_state);
    return CS_OK;
}

/* Rebuilds a system with events: a run leaves pins, masses and constants as they were at its
 * end, and the next run needs those of the start. */
static enum cs_status renew(struct cs_recorded_run *recording, struct cs_error *error) {
    return recording->session.system.events ? cs_session_build(&recording->session, error)
                                            : CS_OK;
}

/* Finds when particles that are pinned can move first: applies the events without a run. */
static enum cs_status find_releases(struct cs_recorded_run *recording, struct cs_error *error) {
    struct cs_system *system = &recording->session.system;
    const double end = recording->frames / recording->session.scene.time.fps;
    double *free_from = recording->free_from, t = 0;
    for (uint32_t i = 0; i < system->view.n; i++)
        free_from[i] = system->inv_mass[i] > 0 ? 0 : HUGE_VAL;
    if (!system->events || system->n_pinned == 0)
        return CS_OK;
    while ((t = cs_events_next(system->events)) <= end) {
        cs_events_apply(system, t);
        for (uint32_t i = 0; i < system->view.n; i++)
            if (system->inv_mass[i] > 0)
                free_from[i] = fmin(free_from[i], t);
    }
    return renew(recording, error);
}

enum cs_status cs_recorded_run_open(struct cs_recorded_run *recording,
                                    const struct cs_recorded_run_settings *settings,
                                    const char *integrator, struct cs_error *error) {
    struct cs_session_settings asked = settings->session;
    *recording = (struct cs_recorded_run){.frames = settings->frames};
    asked.integrator = integrator;
    asked.switch_off_corrections = true;
    // a crossing is a property of a method at its step
    asked.count_crossings_only = true;
    if (!cs_session_open_system(&recording->session, &asked, error) &&
        (store_start(recording, error) || find_releases(recording, error)))
        cs_recorded_run_close(recording);
    return error->status;
}

/* Stores the state of the current frame, judges it and counts its crossings. */
static void store_state(struct cs_trajectory *trajectory, const struct cs_run *run,
                        struct cs_recorded_run_result *result) {
    struct cs_energy_monitor_row row;
    if (!trajectory)
        return;
    cs_crossing_stats_add(&result->crossings, run);
    cs_energy_monitor_sample(&result->monitor, run, &row);
    memcpy(cs_trajectory_state(trajectory, run->frame), run->x,
           6 * trajectory->n * sizeof *run->x);
    trajectory->n_recorded = run->frame;
}

/* Steps to the end and stores each frame. Copies and counts are not timed. Without a track the
 * clocks are read only twice, because short runs are timed through this function. */
static void step_frames(struct cs_recorded_run *recording, struct cs_trajectory *trajectory,
                        struct cs_recorded_run_result *result, struct cs_error *error) {
    struct cs_run *run = &recording->session.run;
    struct cs_follow follow = {
        .run = run, .last = recording->frames, .every = trajectory ? 1 : 0};
    if (trajectory && cs_energy_monitor_begin(&result->monitor, run, error))
        return;
    do
        store_state(trajectory, run, result);
    while (cs_follow_next(&follow, error));
    // a state between two frames, at which the run ended, counts as well
    if (run->outcome != CS_RUNNING && !error->status)
        store_state(trajectory, run, result);
    result->cpu = follow.cpu;
    result->wall = follow.wall;
}

/* Joins the notes of the run. */
static void store_notes(struct cs_recorded_run_result *result, const struct cs_run *run) {
    for (uint32_t k = 0; k < run->n_notes; k++) {
        const size_t used = strlen(result->note);
        snprintf(result->note + used, sizeof result->note - used, "%s%s", k ? "; " : "",
                 run->notes[k]);
    }
}

enum cs_status cs_recorded_run_execute(struct cs_recorded_run *recording, double budget,
                                       struct cs_trajectory *trajectory,
                                       struct cs_recorded_run_result *result,
                                       struct cs_error *error) {
    struct cs_session *session = &recording->session;
    *result = (struct cs_recorded_run_result){0};
    session->settings.run.budget = budget;
    if (!cs_session_begin(session, recording->initial_state, error)) {
        step_frames(recording, trajectory, result, error);
        result->counts = session->run.counts;
        store_notes(result, &session->run);
        cs_run_hash(&session->run, result->hash);
    }
    cs_follow_result(&session->run, "; finished rows are saved", &result->result, error);
    if (cs_outcome_has_reason(result->result.outcome))
        snprintf(result->note, sizeof result->note, "%.239s", result->result.message);
    cs_run_finish(&session->run);
    return error->status ? error->status : renew(recording, error);
}

uint32_t cs_recorded_run_count_stops(const struct cs_recorded_run *recording, double t) {
    const struct cs_events *events = recording->session.system.events;
    return events ? cs_events_count_stops(events, t) : 0;
}

void cs_recorded_run_close(struct cs_recorded_run *recording) {
    cs_session_close(&recording->session);
    free(recording->initial_state);
    *recording = (struct cs_recorded_run){0};
}

enum cs_status cs_trajectory_init(struct cs_trajectory *trajectory,
                                  const struct cs_recorded_run *recording,
                                  struct cs_error *error) {
    *trajectory = (struct cs_trajectory){.n = recording->session.system.view.n,
                                         .frames = recording->frames,
                                         .fps = recording->session.scene.time.fps};
    const size_t n = trajectory->n, values = ((size_t)trajectory->frames + 1) * 6 * n;
    trajectory->states = calloc(values + n, sizeof *trajectory->states);
    if (!trajectory->states)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for %u states",
                       trajectory->frames + 1);
    memcpy(trajectory->states + values, recording->free_from, n * sizeof *trajectory->states);
    trajectory->free_from = trajectory->states + values;
    return CS_OK;
}

double *cs_trajectory_state(const struct cs_trajectory *trajectory, uint32_t frame) {
    return trajectory->states + 6 * (size_t)trajectory->n * frame;
}

void cs_trajectory_finish(struct cs_trajectory *trajectory) {
    free(trajectory->states);
    *trajectory = (struct cs_trajectory){0};
}

/* Counts crossings frame by frame, and prints their statistics. */

/* Counts only if the plan has built the feature. `first` keeps the crossings of the first frame
 * with any, for the message. */
void cs_crossing_stats_add(struct cs_crossing_stats *stats, const struct cs_run *run) {
    if (!run->system->plan.rows[CS_FEATURE_CROSSINGS].built)
        return;
    const struct cs_crossing_count count = cs_crossings_count(run->system, run->t, run->x);
    if (!stats->is_counted)
        stats->start_count = count.n;
    stats->is_counted = true;
    stats->last_count = count.n;
    if (count.n > stats->max_count) {
        stats->max_count = count.n;
        stats->max_time = run->t;
    }
    if (count.n && !stats->first.n) {
        stats->first = count;
        stats->first_time = run->t;
    }
}

void cs_crossing_stats_print(const struct cs_crossing_stats *stats,
                             const struct cs_system *system, struct cs_text *out) {
    if (!stats->max_count) {
        cs_text_add(out, "no edge goes through a triangle in any frame");
        return;
    }
    cs_text_add(out, "%llu at the end, maximum %llu at t = %.6g s; from t = %.6g s on: ",
                (unsigned long long)stats->last_count, (unsigned long long)stats->max_count,
                stats->max_time, stats->first_time);
    cs_crossings_print(system, &stats->first, out);
}

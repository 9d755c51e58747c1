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
    const double cover = cs_follow_frames(session.scene, *seconds);
    if (*frames)
        *seconds = *frames / session.scene->time.fps;
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
    const double end = recording->frames / recording->session.scene->time.fps;
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
                                         .fps = recording->session.scene->time.fps};
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

const uint32_t *cs_crossing_stats_edge(const struct cs_crossing_stats *stats,
                                       const struct cs_system *system) {
    return system->surfaces->edges + 2 * (size_t)stats->first.edge;
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
    const struct cs_surfaces *at = system->surfaces;
    const uint32_t b = cs_surfaces_body(at->first_edge, at->n_bodies, stats->first.edge);
    if (b < system->scene->bodies.n && !cs_scene_bodies(system->scene)[b].self_contact &&
        b == cs_surfaces_body(at->first_triangle, at->n_bodies, stats->first.triangle))
        cs_text_add(out, "; bodies[%u].self_contact true keeps the body off itself", b);
}

/* Measures the distance of one recorded run from another. */

/* Squared distance of particle i in a and b. */
static double squared(size_t n, const double *a, const double *b, size_t i) {
    double sum = 0;
    for (size_t c = 0; c < 3; c++) {
        const double d = a[c * n + i] - b[c * n + i];
        sum += d * d;
    }
    return sum;
}

double cs_rms_difference(const double *a, const double *b, size_t n) {
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += (a[i] - b[i]) * (a[i] - b[i]);
    return sqrt(sum / (double)n);
}

double cs_distance_rms(const struct cs_system *system, const struct cs_trajectory *run,
                       uint32_t frame, const double *a, const double *b) {
    const size_t n = system->view.n;
    double sum = 0, mass = 0;
    for (size_t i = 0; i < n; i++)
        if (run->free_from[i] <= frame / run->fps) {
            sum += system->mass[i] * squared(n, a, b, i);
            mass += system->mass[i];
        }
    return mass > 0 ? sqrt(sum / mass) : 0;
}

double cs_distance_max(const struct cs_system *system, const double *a, const double *b) {
    const size_t n = system->view.n;
    double largest = 0;
    for (size_t i = 0; i < n; i++)
        largest = fmax(largest, squared(n, a, b, i));
    return sqrt(largest);
}

void cs_distance_each(uint32_t n, const double *a, const double *b, double *out) {
    for (uint32_t i = 0; i < n; i++)
        out[i] = sqrt(squared(n, a, b, i));
}

/* Total energy in J of a state (6n). */
static double energy_of(const struct cs_system *system, double t, const double *x) {
    const struct cs_energy energy =
        cs_diagnostics_energy(system, t, x, x + 3 * (size_t)system->view.n);
    return cs_energy_total(&energy);
}

/* Distance in m of the centres of mass. */
static double centre_distance(const struct cs_system *system, const double *a,
                              const double *b) {
    const size_t n = system->view.n;
    double squares = 0;
    for (size_t c = 0; c < 3; c++) {
        double sum = 0, mass = 0;
        for (size_t i = 0; i < n; i++) {
            sum += system->mass[i] * (a[c * n + i] - b[c * n + i]);
            mass += system->mass[i];
        }
        squares += sum / mass * (sum / mass);
    }
    return sqrt(squares);
}

/* largest difference of the six sides of the bounding boxes */
static double box_distance(size_t n, const double *a, const double *b) {
    double largest = 0;
    for (size_t c = 0; c < 3; c++) {
        double of_a[2], of_b[2];
        cs_diagnostics_range(a + c * n, (uint32_t)n, of_a);
        cs_diagnostics_range(b + c * n, (uint32_t)n, of_b);
        largest = fmax(largest, fmax(fabs(of_a[0] - of_b[0]), fabs(of_a[1] - of_b[1])));
    }
    return largest;
}

/* Updates the largest differences of energy, centre, box and strain with one frame. */
static void take_statistics(struct cs_trajectory_error *error, const struct cs_system *system,
                            double t, const double *a, const double *b) {
    const size_t n = system->view.n;
    error->energy =
        fmax(error->energy, fabs(energy_of(system, t, a) - energy_of(system, t, b)));
    error->centre = fmax(error->centre, centre_distance(system, a, b));
    error->box = fmax(error->box, box_distance(n, a, b));
    error->strain = fmax(error->strain, cs_diagnostics_strain(system, a));
}

/* path is the root mean square over frames of the RMS distance; end and velocity are those of
 * the last compared frame. */
void cs_trajectory_error_compute(struct cs_trajectory_error *error,
                                 const struct cs_system *system,
                                 const struct cs_trajectory *trajectory,
                                 const struct cs_trajectory *reference, uint32_t frames,
                                 uint32_t pointwise_frames) {
    const size_t v = 3 * (size_t)system->view.n;
    *error = (struct cs_trajectory_error){0};
    for (uint32_t k = 1; k <= frames; k++) {
        const double *a = cs_trajectory_state(trajectory, k),
                     *b = cs_trajectory_state(reference, k);
        take_statistics(error, system, k / system->scene->time.fps, a, b);
        if (k > pointwise_frames)
            continue;
        error->end = cs_distance_rms(system, trajectory, k, a, b);
        error->end_max = cs_distance_max(system, a, b);
        error->velocity = cs_distance_rms(system, trajectory, k, a + v, b + v);
        error->path += error->end * error->end;
        error->path_max = fmax(error->path_max, error->end_max);
    }
    error->path = sqrt(error->path / frames);
    if (pointwise_frames < frames)
        error->end = error->end_max = error->path = error->path_max = error->velocity =
            (double)NAN;
}

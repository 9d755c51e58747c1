/* viewpoint_forces.c - selects the particles of viewpoint forces, and schedules the
 * visibility tests. */

#include "model/event/event_state.h"
#include "scene/force_keys.h"

#include <math.h>
#include <string.h>

/* The keys of a viewpoint force in the scene. */
static const struct cs_viewpoint_force *viewpoint_force_of(const struct cs_scene *scene,
                                                           uint32_t event) {
    return &cs_scene_events(scene)[event].viewpoint_force;
}

/* The number of viewpoint forces in a scene. */
static uint32_t count(const struct cs_scene *scene) {
    uint32_t n = 0;
    for (uint32_t e = 0; e < scene->events.n; e++)
        n += viewpoint_force_of(scene, e)->present;
    return n;
}

bool cs_viewpoint_forces_any(const struct cs_scene *scene) {
    return count(scene) > 0;
}

enum cs_status cs_viewpoint_forces_build(struct cs_system *system, struct cs_error *error) {
    const struct cs_scene *scene = system->scene;
    const uint32_t n = system->view.n;
    struct cs_arena *arena = &system->arena;
    arena->part = &system->plan.rows[CS_FEATURE_VIEWPOINT_FORCES].bytes;
    struct cs_viewpoint_forces *viewpoint_forces =
        cs_arena_alloc(arena, sizeof *viewpoint_forces, error);
    if (!viewpoint_forces)
        return error->status;
    CS_ARENA_ARRAY(arena, viewpoint_forces->states, count(scene), error);
    for (uint32_t e = 0; e < scene->events.n && !error->status; e++) {
        if (!viewpoint_force_of(scene, e)->present)
            continue;
        bool *seen = cs_arena_alloc_array(arena, n, sizeof *seen, error);
        struct cs_viewpoint_force_state *state =
            viewpoint_forces->states + viewpoint_forces->n++;
        *state =
            (struct cs_viewpoint_force_state){.event = e, .is_visible = seen, .next = HUGE_VAL};
        cs_visibility_query_make(&state->query, viewpoint_force_of(scene, e));
    }
    /* scratch shared with the events: nothing in it outlives a call */
    viewpoint_forces->work_marks = system->events->work;
    system->events->viewpoint_forces = viewpoint_forces;
    return cs_visibility_scratch_init(&viewpoint_forces->work, n, arena, error);
}

/* The state of the viewpoint force of an event, which must be one. */
static struct cs_viewpoint_force_state *
state_of(const struct cs_viewpoint_forces *viewpoint_forces, uint32_t event) {
    uint32_t k = 0;
    while (viewpoint_forces->states[k].event != event)
        k++;
    return viewpoint_forces->states + k;
}

/* Repeats a visibility test at t; true if the selection changed. */
static bool retest_visibility(const struct cs_system *system,
                              struct cs_viewpoint_force_state *state, double t) {
    const struct cs_viewpoint_forces *viewpoint_forces = system->events->viewpoint_forces;
    const struct cs_viewpoint_force *viewpoint_force =
        viewpoint_force_of(system->scene, state->event);
    const size_t bytes = system->view.n * sizeof *state->is_visible;
    cs_visibility_query_run(&state->query, system, t, system->state, viewpoint_force->body,
                            &viewpoint_forces->work, viewpoint_forces->work_marks);
    const bool changed = memcmp(state->is_visible, viewpoint_forces->work_marks, bytes) != 0;
    memcpy(state->is_visible, viewpoint_forces->work_marks, bytes);
    return changed;
}

/* out (3,n) += factor / mass along the direction of view, for selected free particles: a
 * force in N gives an acceleration in m/s2, an impulse in N s a velocity in m/s. */
static void add_viewpoint_force(const struct cs_system *system,
                                const struct cs_viewpoint_force_state *state, double factor,
                                double *out) {
    const size_t n = system->view.n;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            if (state->is_visible[i] && system->inv_mass[i] > 0)
                out[c * n + i] += state->query.axes[2][c] * (factor / system->mass[i]);
}

/* Time in s of test number `looks` after begin, snapped to a frame; HUGE_VAL without refresh.
 * Counted from begin: no rounding adds up. */
static double time_of(const struct cs_scene *scene,
                      const struct cs_viewpoint_force *viewpoint_force, double begin,
                      double looks) {
    return viewpoint_force->refresh > 0
               ? cs_event_time_snap(scene, begin + looks / viewpoint_force->refresh)
               : HUGE_VAL;
}

/* Sets the time of the first test after t. */
static void plan_next(const struct cs_system *system, struct cs_viewpoint_force_state *state,
                      double t) {
    const struct cs_event_state *of = system->events->states + state->event;
    const struct cs_viewpoint_force *viewpoint_force =
        viewpoint_force_of(system->scene, state->event);
    do
        state->next = time_of(system->scene, viewpoint_force, of->begin, ++state->n_tests);
    while (state->next <= t + CS_EVENT_SAME);
}

void cs_viewpoint_force_start(struct cs_system *system, uint32_t event) {
    const struct cs_events *events = system->events;
    const struct cs_event_state *of = events->states + event;
    const struct cs_viewpoint_force *viewpoint_force = viewpoint_force_of(system->scene, event);
    struct cs_viewpoint_force_state *state = state_of(events->viewpoint_forces, event);
    retest_visibility(system, state, of->begin);
    state->active = of->end > of->begin;
    state->n_tests = 0;
    if (state->active)
        plan_next(system, state, of->begin);
    else
        add_viewpoint_force(system, state, viewpoint_force->force * viewpoint_force->duration,
                            system->state + 3 * (size_t)system->view.n);
}

void cs_viewpoint_force_finish(struct cs_system *system, uint32_t event) {
    struct cs_viewpoint_force_state *state = state_of(system->events->viewpoint_forces, event);
    state->active = false;
    state->next = HUGE_VAL;
}

bool cs_viewpoint_forces_retest(struct cs_system *system, double t) {
    struct cs_viewpoint_forces *viewpoint_forces = system->events->viewpoint_forces;
    bool changed = false;
    for (uint32_t k = 0; k < viewpoint_forces->n; k++) {
        if (viewpoint_forces->states[k].next > t + CS_EVENT_SAME)
            continue;
        changed |= retest_visibility(system, viewpoint_forces->states + k, t);
        plan_next(system, viewpoint_forces->states + k, t);
    }
    return changed;
}

double cs_viewpoint_forces_next(const struct cs_viewpoint_forces *viewpoint_forces) {
    double next = HUGE_VAL;
    for (uint32_t k = 0; k < viewpoint_forces->n; k++)
        next = fmin(next, viewpoint_forces->states[k].next);
    return next;
}

void cs_viewpoint_forces_add_push(const struct cs_system *system, double *push) {
    const struct cs_viewpoint_forces *viewpoint_forces = system->events->viewpoint_forces;
    for (uint32_t k = 0; k < viewpoint_forces->n; k++)
        if (viewpoint_forces->states[k].active)
            add_viewpoint_force(
                system, viewpoint_forces->states + k,
                viewpoint_force_of(system->scene, viewpoint_forces->states[k].event)->force,
                push);
}

double cs_viewpoint_forces_force(const struct cs_viewpoint_forces *viewpoint_forces,
                                 const struct cs_scene *scene) {
    double force = 0;
    for (uint32_t k = 0; k < viewpoint_forces->n; k++)
        if (viewpoint_forces->states[k].active)
            force += fabs(viewpoint_force_of(scene, viewpoint_forces->states[k].event)->force);
    return force;
}

uint32_t cs_viewpoint_forces_cuts(const struct cs_scene *scene, double t) {
    uint32_t cuts = 0;
    for (uint32_t e = 0; e < scene->events.n; e++) {
        const struct cs_event *event = cs_scene_events(scene) + e;
        const double end =
            event->viewpoint_force.present && isnan(event->at) ? fmin(event->to, t) : 0;
        for (double looks = 1, at;
             at = time_of(scene, &event->viewpoint_force, event->from, looks), at < end;
             looks++)
            cuts += at * scene->time.fps != floor(at * scene->time.fps + 0.5);
    }
    return cuts;
}

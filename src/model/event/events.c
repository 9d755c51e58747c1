/* events.c - cuts a run into segments, and applies the events that begin and end between two.
 */
#include "model/event/events.h"

#include "model/contact/posed_collider.h"
#include "model/force/diagnostics.h"
#include "scene/body_pairs.h"
#include "scene/event_key.h"
#include "scene/force_keys.h"

#include <math.h>
#include <string.h>

/* The state of one event, and the ramped number itself. The pointer to that number is of this
 * process and stays. */
static void record_event(struct cs_event_state *state, struct cs_serialiser *serialiser) {
    double *value = state->value;
    state->value = NULL;
    CS_SERIALISER(serialiser, *state);
    state->value = value;
    if (value)
        CS_SERIALISER(serialiser, *value);
}

/* Selected particles and test times of all viewpoint forces. */
static void record_viewpoint_forces(struct cs_viewpoint_forces *viewpoint_forces, uint32_t n,
                                    struct cs_serialiser *serialiser) {
    for (uint32_t k = 0; k < viewpoint_forces->n; k++) {
        struct cs_viewpoint_force_state *state = viewpoint_forces->states + k;
        cs_serialiser_bytes(serialiser, state->is_visible, n * sizeof *state->is_visible);
        CS_SERIALISER(serialiser, state->active);
        CS_SERIALISER(serialiser, state->n_tests);
        CS_SERIALISER(serialiser, state->next);
    }
}

/* The segment, the wind, and each event. */
static void record_marks(struct cs_events *events, struct cs_serialiser *serialiser) {
    CS_SERIALISER(serialiser, events->next);
    CS_SERIALISER(serialiser, events->begin);
    CS_SERIALISER(serialiser, events->end);
    CS_SERIALISER(serialiser, events->next_test);
    CS_SERIALISER(serialiser, events->values_time);
    CS_SERIALISER(serialiser, events->has_ramps);
    CS_SERIALISER(serialiser, events->has_grabs);
    CS_SERIALISER(serialiser, events->has_turns);
    CS_SERIALISER(serialiser, events->held_speed);
    CS_SERIALISER(serialiser, events->scene.forces->wind);
    for (uint32_t e = 0; e < events->scene.events.n; e++)
        record_event(events->states + e, serialiser);
}

void cs_events_serialise(struct cs_system *system, struct cs_serialiser *serialiser) {
    struct cs_events *events = system->events;
    const size_t n = system->view.n;
    if (!events)
        return;
    record_marks(events, serialiser);
    cs_serialiser_bytes(serialiser, events->held_by, n * sizeof *events->held_by);
    if (events->offsets)
        cs_serialiser_bytes(serialiser, events->offsets, 3 * n * sizeof *events->offsets);
    if (events->triangles)
        cs_serialiser_bytes(serialiser, events->triangles, n * sizeof *events->triangles);
    if (events->viewpoint_forces)
        record_viewpoint_forces(events->viewpoint_forces, system->view.n, serialiser);
    if (system->event_force)
        cs_serialiser_bytes(serialiser, system->event_force,
                            3 * n * sizeof *system->event_force);
    if (system->motions)
        cs_serialiser_bytes(serialiser, system->motions,
                            events->scene.colliders.n * sizeof *system->motions);
    cs_serialiser_bytes(serialiser, system->mass, n * sizeof *system->mass);
    cs_serialiser_bytes(serialiser, system->inv_mass, n * sizeof *system->inv_mass);
    CS_SERIALISER(serialiser, system->n_pinned);
    // a damaged number of them must not lead outside the array
    if (system->n_pinned > n)
        serialiser->failed = true;
    else
        cs_serialiser_bytes(serialiser, system->pinned,
                            system->n_pinned * sizeof *system->pinned);
    // springs and the view follow from the values that were read, ways are those of the start
    if (serialiser->is_reading) {
        cs_event_release_tangled(system, events->begin);
        cs_event_refresh_springs(system);
        cs_event_show_moves(system);
    }
}

/* Kinds of events, for any(): those over an interval that accelerate particles; those that move
 * particles along paths; those after which a pinned particle may be free. */
static bool pushes(const struct cs_event *event) {
    return (event->impact.present || event->viewpoint_force.present) && isnan(event->at);
}

static bool grabs(const struct cs_event *event) {
    return event->grab.present;
}

static bool releases(const struct cs_event *event) {
    return event->release.present ||
           ((event->pin.present || event->grab.present) && isnan(event->at));
}

/* True if an event of the scene is of a kind. */
static bool any(const struct cs_scene *scene, bool (*is)(const struct cs_event *event)) {
    for (uint32_t e = 0; e < scene->events.n; e++)
        if (is(cs_scene_events(scene) + e))
            return true;
    return false;
}

/* Takes all arrays, and copies the scene, whose numbers ramps change. */
static void alloc_arrays(struct cs_system *system, struct cs_events *events,
                         struct cs_error *error) {
    const size_t n = system->view.n;
    struct cs_arena *arena = &system->arena;
    struct cs_scene *scene = &events->scene;
    cs_scene_copy(scene, system->scene, arena, error);
    CS_ARENA_ARRAY(arena, events->times, cs_event_times_count(scene), error);
    CS_ARENA_ARRAY(arena, events->states, scene->events.n, error);
    events->held_by = cs_arena_alloc_array(arena, n, sizeof(uint32_t), error);
    events->work = cs_arena_alloc_array(arena, n, sizeof(bool), error);
    if (any(scene, pushes))
        system->event_force = cs_arena_alloc_array(arena, 3 * n, sizeof(double), error);
    if (any(scene, grabs) || (cs_event_moves_any(scene) && cs_scene_carries_pins(scene, false)))
        events->offsets = cs_arena_alloc_array(arena, 3 * n, sizeof(double), error);
    if (events->offsets && cs_scene_has_key_frames(scene))
        events->triangles = cs_arena_alloc_array(arena, n, sizeof(uint32_t), error);
    if (cs_event_moves_any(scene))
        cs_event_moves_build(system, error);
}

/* Gives the list of pinned particles room for all n: an event may pin any of them. */
static void widen_pinned(struct cs_system *system, struct cs_error *error) {
    uint32_t *pinned =
        cs_arena_alloc_array(&system->arena, system->view.n, sizeof *pinned, error);
    if (!pinned)
        return;
    memcpy(pinned, system->pinned, system->n_pinned * sizeof *pinned);
    system->pinned = pinned;
}

enum cs_status cs_events_build(struct cs_system *system, struct cs_error *error) {
    struct cs_events *events = cs_arena_alloc(&system->arena, sizeof *events, error);
    if (!events)
        return error->status;
    alloc_arrays(system, events, error);
    widen_pinned(system, error);
    const struct cs_event *list = cs_scene_events(&events->scene);
    for (uint32_t e = 0; e < events->scene.events.n && !error->status; e++) {
        /* ramps point into the copy of the scene, which they may change */
        struct cs_event_key key;
        if (list[e].ramp.present && !cs_event_is_picture(list + e) &&
            !cs_event_key_find(&events->scene, list[e].ramp.key, &key, error))
            events->states[e].value = key.value;
    }
    if (error->status)
        return error->status;
    cs_event_times_fill(events);
    events->end = events->n_times ? events->times[0] : HUGE_VAL;
    events->next_test = HUGE_VAL;
    system->events = events;
    system->scene = &events->scene;
    // pins to colliders that all rest are pins
    if (system->motions && cs_scene_carries_pins(system->scene, false) &&
        cs_event_attach_pins(system, error))
        return error->status;
    if (cs_scene_sews(system->scene, true) && cs_event_attach_seams(system, error))
        return error->status;
    return cs_viewpoint_forces_any(system->scene) ? cs_viewpoint_forces_build(system, error)
                                                  : CS_OK;
}

/* Updates the data derived from values that ramps change: springs, and masses if a ramp
 * changes one. */
static void refresh(struct cs_system *system) {
    cs_event_refresh_springs(system);
    if (any(&system->events->scene, cs_event_changes_mass))
        cs_system_set_masses(system);
}

/* Sets every ramped number to its extreme, frees every particle that an event may release,
 * computes the bounds, and restores all. Numbers are restored in reverse order: if two ramps
 * change one number, the first of them has stored the original. */
void cs_events_set_bounds(struct cs_system *system, double *work) {
    struct cs_events *events = system->events;
    const uint32_t n_events = events->scene.events.n;
    for (uint32_t e = 0; e < n_events; e++) {
        const struct cs_event *event = cs_scene_events(&events->scene) + e;
        struct cs_event_state *state = events->states + e;
        if (!state->value)
            continue;
        state->first = *state->value;
        /* the stiffest springs and the lightest particles: omega^2 = k/m is largest */
        if (cs_event_changes_mass(event) ? event->ramp.value < *state->value
                                         : fabs(event->ramp.value) > fabs(*state->value))
            *state->value = event->ramp.value;
    }
    refresh(system);
    // what is sewn to colliders may be opened
    if (any(&events->scene, releases) || events->seam_of)
        for (uint32_t p = 0; p < system->n_pinned; p++)
            system->inv_mass[system->pinned[p]] = 1 / system->mass[system->pinned[p]];
    cs_spectral_bounds_set(system, work);

    for (uint32_t p = 0; p < system->n_pinned; p++)
        system->inv_mass[system->pinned[p]] = 0;
    for (uint32_t e = n_events; e-- > 0;)
        if (events->states[e].value)
            *events->states[e].value = events->states[e].first;
    refresh(system);
}

double cs_events_next(const struct cs_events *events) {
    /* a visibility test this near to the end happens there */
    return events->next_test + CS_EVENT_SAME < events->end ? events->next_test : events->end;
}

uint32_t cs_events_count_stops(const struct cs_events *events, double t) {
    return events->n_times + cs_viewpoint_forces_cuts(&events->scene, t);
}

/* Closes the segment at t and opens the next: ends, then beginnings, then the chords of
 * paths. Pins, springs, masses and the positions of grabbed particles follow from these. */
static void end_segment(struct cs_system *system, double t) {
    struct cs_events *events = system->events;
    const uint32_t n = events->scene.events.n;
    cs_events_move_values(system, t);
    events->next++;
    events->begin = events->values_time = t;
    events->end = events->next < events->n_times ? events->times[events->next] : HUGE_VAL;
    /* ends first: the next event may take over the same value or particles */
    for (uint32_t e = 0; e < n; e++)
        if (events->states[e].active && events->states[e].end <= t)
            cs_event_finish(system, e);
    cs_event_release_tangled(system, t);
    for (uint32_t e = 0; e < n; e++)
        if (events->states[e].begin == t)
            cs_event_start(system, e);
    cs_event_release_tangled(system, t);

    /* the ramps, grabs and moves that are active in the segment that begins */
    events->has_ramps = false;
    for (uint32_t e = 0; e < n; e++) {
        const struct cs_event *event = cs_scene_events(&events->scene) + e;
        events->has_ramps |=
            events->states[e].active && (event->ramp.present || event->wind.present);
        if (event->grab.present || (event->move.present && system->motions))
            cs_event_next_leg(events, e, t);
        if (event->move.present)
            cs_event_follow_move(system, e, t);
    }
    cs_event_follow_growth(system);
    cs_event_show_moves(system);
    cs_event_find_held(system, t);
    cs_event_list_pinned(system);
    refresh(system);
    cs_events_apply_paths(system, t, system->state, system->state + 3 * (size_t)system->view.n);
}

bool cs_events_apply(struct cs_system *system, double t) {
    struct cs_events *events = system->events;
    const bool turns = events->end <= t;
    if (turns)
        end_segment(system, t);
    const bool others = events->viewpoint_forces && cs_viewpoint_forces_retest(system, t);
    if (turns || others)
        cs_event_sum_pushes(system);
    if (events->viewpoint_forces)
        events->next_test = cs_viewpoint_forces_next(events->viewpoint_forces);
    return turns || others;
}

/* Values are set once per time: a method asks for several results at one stage. */
void cs_events_move_values(struct cs_system *system, double t) {
    struct cs_events *events = system->events;
    // a stage may lie past the end of its step; forces are continued smoothly there
    const double now = fmax(t, events->begin);
    if (!events->has_ramps || now == events->values_time)
        return;
    events->values_time = now;
    for (uint32_t e = 0; e < events->scene.events.n; e++)
        if (events->states[e].active)
            cs_event_set_value(system, e, now);
    cs_event_refresh_springs(system);
}

double cs_events_speed(const struct cs_system *system) {
    const struct cs_events *events = system->events;
    double squared = 0;
    double growth = 0;
    for (uint32_t e = 0; e < events->scene.events.n; e++) {
        const struct cs_event_state *state = events->states + e;
        const double *rate = state->rate;
        squared = fmax(squared, rate[0] * rate[0] + rate[1] * rate[1] + rate[2] * rate[2]);
        if (state->active && state->value &&
            cs_event_grows(cs_scene_events(&events->scene) + e))
            growth =
                fmax(growth, fabs((state->last - state->first) / (state->end - state->begin)));
    }
    return sqrt(squared) + growth + fmax(cs_event_angular_speed(system), events->held_speed);
}

/* event_serialise.c - writes or reads the state of the events of a run, by one function for
 * both directions. */
#include "model/event/event_serialise.h"

#include "model/contact/posed_collider.h"
#include "model/event/event_apply.h"
#include "model/event/event_move.h"
#include "model/event/viewpoint_forces.h"

/* The state of one event, and the ramped number itself. The pointer to that number is of this
 * process and stays. */
static void record_event(struct cs_event_state *state, struct cs_serialiser *record) {
    double *value = state->value;
    state->value = NULL;
    CS_SERIALISER(record, *state);
    state->value = value;
    if (value)
        CS_SERIALISER(record, *value);
}

/* Selected particles and test times of all viewpoint forces. */
static void record_viewpoint_forces(struct cs_viewpoint_forces *viewpoint_forces, uint32_t n,
                                    struct cs_serialiser *record) {
    for (uint32_t k = 0; k < viewpoint_forces->n; k++) {
        struct cs_viewpoint_force_state *state = viewpoint_forces->states + k;
        cs_serialiser_bytes(record, state->is_visible, n * sizeof *state->is_visible);
        CS_SERIALISER(record, state->active);
        CS_SERIALISER(record, state->n_tests);
        CS_SERIALISER(record, state->next);
    }
}

/* The segment, the wind, and each event. */
static void record_marks(struct cs_events *events, struct cs_serialiser *record) {
    CS_SERIALISER(record, events->next);
    CS_SERIALISER(record, events->begin);
    CS_SERIALISER(record, events->end);
    CS_SERIALISER(record, events->next_test);
    CS_SERIALISER(record, events->values_time);
    CS_SERIALISER(record, events->has_ramps);
    CS_SERIALISER(record, events->has_grabs);
    CS_SERIALISER(record, events->scene.forces.wind);
    for (uint32_t e = 0; e < events->scene.events.n; e++)
        record_event(events->states + e, record);
}

void cs_events_serialise(struct cs_system *system, struct cs_serialiser *record) {
    struct cs_events *events = system->events;
    const size_t n = system->view.n;
    if (!events)
        return;
    record_marks(events, record);
    cs_serialiser_bytes(record, events->held_by, n * sizeof *events->held_by);
    if (events->offsets)
        cs_serialiser_bytes(record, events->offsets, 3 * n * sizeof *events->offsets);
    if (events->viewpoint_forces)
        record_viewpoint_forces(events->viewpoint_forces, system->view.n, record);
    if (system->event_force)
        cs_serialiser_bytes(record, system->event_force, 3 * n * sizeof *system->event_force);
    if (system->motions)
        cs_serialiser_bytes(record, system->motions,
                            events->scene.colliders.n * sizeof *system->motions);
    cs_serialiser_bytes(record, system->mass, n * sizeof *system->mass);
    cs_serialiser_bytes(record, system->inv_mass, n * sizeof *system->inv_mass);
    CS_SERIALISER(record, system->n_pinned);
    // a damaged number of them must not lead outside the array
    if (system->n_pinned > n)
        record->failed = true;
    else
        cs_serialiser_bytes(record, system->pinned, system->n_pinned * sizeof *system->pinned);
    // springs and the view follow from the values that were read
    if (record->is_reading) {
        cs_event_refresh_springs(system);
        cs_event_show_moves(system);
    }
}

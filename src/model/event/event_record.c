/* Writes or reads where the events of a run stand. */
#include "model/event/event_record.h"

#include "model/contact/obstacle.h"
#include "model/event/event_act.h"
#include "model/event/event_move.h"
#include "model/event/viewpoint_forces.h"

/* the state of one event, but for where its value lies, which is a matter of this process */
static void record_event(struct cs_event_state *state, struct cs_record *record) {
    double *value = state->value;
    state->value = NULL;
    CS_RECORD(record, *state);
    state->value = value;
    if (value)
        CS_RECORD(record, *value);
}

static void record_viewpoint_forces(struct cs_viewpoint_forces *viewpoint_forces, uint32_t n,
                                    struct cs_record *record) {
    for (uint32_t k = 0; k < viewpoint_forces->n; k++) {
        struct cs_viewpoint_force_state *state = viewpoint_forces->states + k;
        cs_record_bytes(record, state->seen, n * sizeof *state->seen);
        CS_RECORD(record, state->active);
        CS_RECORD(record, state->looks);
        CS_RECORD(record, state->next);
    }
}

static void record_marks(struct cs_events *events, struct cs_record *record) {
    CS_RECORD(record, events->next);
    CS_RECORD(record, events->begin);
    CS_RECORD(record, events->end);
    CS_RECORD(record, events->look);
    CS_RECORD(record, events->now);
    CS_RECORD(record, events->ramps);
    CS_RECORD(record, events->grabs);
    CS_RECORD(record, events->scene.forces.wind);
    for (uint32_t e = 0; e < events->scene.events.n; e++)
        record_event(events->states + e, record);
}

void cs_events_record(struct cs_system *system, struct cs_record *record) {
    struct cs_events *events = system->events;
    const size_t n = system->view.n;
    if (!events)
        return;
    record_marks(events, record);
    cs_record_bytes(record, events->holders, n * sizeof *events->holders);
    if (events->offsets)
        cs_record_bytes(record, events->offsets, 3 * n * sizeof *events->offsets);
    if (events->viewpoint_forces)
        record_viewpoint_forces(events->viewpoint_forces, system->view.n, record);
    if (system->push)
        cs_record_bytes(record, system->push, 3 * n * sizeof *system->push);
    if (system->motions)
        cs_record_bytes(record, system->motions,
                        events->scene.colliders.n * sizeof *system->motions);
    cs_record_bytes(record, system->mass, n * sizeof *system->mass);
    cs_record_bytes(record, system->inv_mass, n * sizeof *system->inv_mass);
    CS_RECORD(record, system->n_pinned);
    // a damaged number of them must not lead outside the array
    if (system->n_pinned > n)
        record->failed = true;
    else
        cs_record_bytes(record, system->pinned, system->n_pinned * sizeof *system->pinned);
    // springs hang on the values that were read
    if (record->loading) {
        cs_event_refresh_springs(system);
        cs_event_show_moves(system);
    }
}

/* events.h - the events of a run: their times, and their effect on state, pins and values.
 *
 * The times at which something begins, ends or turns cut a run into segments. The frame loop
 * advances a method within a segment only. Between two segments it calls cs_events_apply and
 * restarts the method. Within a segment ramps are linear in time, and grabbed particles and
 * colliders on paths move at constant velocity: every force is smooth there, as the order of
 * a method needs.
 *
 * Ramps change a copy of the scene's values, to which system->scene then points. A scene
 * without events has none of this, and system->events is NULL.
 *
 * The calls of a run, in order:
 * 1. cs_events_build, once, when all arrays of the system exist; then cs_events_set_bounds.
 * 2. cs_events_next and cs_events_apply between two advances.
 * 3. cs_events_move_values at each time that the method asks the host about.
 * 4. cs_events_apply_paths in each commit. */
#ifndef CS_EVENTS_H
#define CS_EVENTS_H

#include "model/event/event_state.h"

/* Builds the events of a system whose other arrays exist, from its arena. CS_ERR_MEMORY. */
enum cs_status cs_events_build(struct cs_system *system, struct cs_error *error);

/* Sets the system's bounds on frequency and damping (diagnostics.h) to the largest that
 * its ramps and releases can reach. They must hold for the whole run, as view->omega and
 * view->delta promise. The system's values are restored. work has 2n doubles. */
void cs_events_set_bounds(struct cs_system *system, double *work);

/* Time in s of the next thing to happen: the segment ends, or a viewpoint force tests
 * visibility again within it. HUGE_VAL: nothing more. */
double cs_events_next(const struct cs_events *events);

/* Applies everything that happens at t: ends before beginnings, each in the scene's order,
 * then visibility tests. Changes the system's state, pins and values. If the segment ended,
 * opens the one from t to events->end. Returns false if nothing changed: the tests selected
 * the same particles. */
bool cs_events_apply(struct cs_system *system, double t);

/* An upper bound of the number of times up to t, besides those of frames, at which a method
 * may have to stop. */
uint32_t cs_events_count_stops(const struct cs_events *events, double t);

/* Sets ramped values to those at t, or at the begin of the segment if t lies before it. Past
 * its end they continue at the same rate: a stage of a method may lie there, and a kink
 * within its step would cost the method its order. */
void cs_events_move_values(struct cs_system *system, double t);

/* Bound in m/s on the velocity that paths give to particles in the segment: the fastest path
 * plus the fastest point of a turning collider. */
double cs_events_speed(const struct cs_system *system);

#endif

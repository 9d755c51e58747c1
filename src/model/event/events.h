/* events.h - the events of a run: when they are, and what they do to state, pins and values.
 *
 * The times at which something begins, ends or turns cut a run into segments. The frame loop
 * advances a method within a segment only; between two of them it calls cs_events_apply and
 * restarts the method. Within a segment ramps are linear in time and grabbed particles move at
 * constant velocity. What ramps move is a copy of the scene's values, which takes the scene's
 * place in the system. A scene without events has none of this.
 */
#ifndef CS_EVENTS_H
#define CS_EVENTS_H

#include "model/event/event_state.h"

/* Makes the events of a system whose arrays are all there. CS_ERR_MEMORY. */
enum cs_status cs_events_build(struct cs_system *system, struct cs_error *error);

/* Sets the system's bounds (spectral_bounds.h) to the largest that its ramps and releases can
 * reach. work has 2n doubles. */
void cs_events_set_bounds(struct cs_system *system, double *work);

/* When something happens next that has not happened yet, in s: the segment ends, or within it a
 * viewpoint force tests visibility again. */
double cs_events_next(const struct cs_events *events);

/* Everything that happens at t: ends before beginnings, each in the scene's order, then
 * visibility tests. Changes the system's state, pins and values; where the segment ended, opens
 * the one from t to events->end. false if nothing changed: the tests selected the same
 * particles. */
bool cs_events_apply(struct cs_system *system, double t);

/* Times up to t, besides those of frames, at which a method may have to stop, or more. */
uint32_t cs_events_count_stops(const struct cs_events *events, double t);

/* Sets ramped values to those at t, or at the begin of the segment if t lies before it. Behind
 * its end they go on at the same rate: a stage of a method may lie there, and a bend within its
 * step would cost the method its order. */
void cs_events_move_values(struct cs_system *system, double t);

/* Largest velocity in m/s of a path in the segment, and of what a collider turns. */
double cs_events_speed(const struct cs_system *system);

/* Puts the grabbed particles where they are at t, with the velocity of their path. */
void cs_events_apply_paths(const struct cs_system *system, double t, double *x, double *v);

#endif

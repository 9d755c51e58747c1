/* event_path.h - the position of a grab or a move on its path. */
#ifndef CS_EVENT_PATH_H
#define CS_EVENT_PATH_H

#include "model/event/event_state.h"

/* Starts the path of a grab or a move at t, at the point state->chord_to. */
void cs_event_begin_path(struct cs_event_state *state, double t);
/* Moves to the next chord of the path if one begins at t: its two ends, times and velocity.
 * After the last point the velocity is 0 and the end HUGE_VAL. */
void cs_event_next_leg(struct cs_events *events, uint32_t event, double t);

#endif

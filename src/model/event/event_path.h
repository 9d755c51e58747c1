/* event_path.h - where a grab or a move is on its path. */
#ifndef CS_EVENT_PATH_H
#define CS_EVENT_PATH_H

#include "model/event/event_state.h"

/* The path of a grab or a move begins at t, at state->to. */
void cs_event_begin_path(struct cs_event_state *state, double t);
/* Goes on to the next chord of the path of a grab or a move if that begins at t. */
void cs_event_next_leg(struct cs_events *events, uint32_t event, double t);

#endif

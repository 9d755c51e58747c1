/* event_serialise.h - the state of a scene's events, for a checkpoint. */
#ifndef CS_EVENT_SERIALISE_H
#define CS_EVENT_SERIALISE_H

#include "base/serialise.h"
#include "model/event/event_state.h"

/* Writes or reads everything that events have changed in a system since it was built, except
 * x and v: their own state, pins, masses, values, pushes, and colliders on paths. Springs
 * follow from the values. Does nothing for a system without events. A record that would lead
 * outside an array sets record->failed. */
void cs_events_serialise(struct cs_system *system, struct cs_serialiser *record);

#endif

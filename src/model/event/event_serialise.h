/* event_serialise.h - where a scene's events stand, for a checkpoint. */
#ifndef CS_EVENT_SERIALISE_H
#define CS_EVENT_SERIALISE_H

#include "base/serialise.h"
#include "model/event/event_state.h"

/* All that events have changed in a system since it was built, but the state: their own marks,
 * pins, masses, values, springs, pushes, and obstacles on paths. Of a system without events it
 * is nothing. */
void cs_events_serialise(struct cs_system *system, struct cs_serialiser *record);

#endif

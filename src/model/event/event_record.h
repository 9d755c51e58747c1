/* event_record.h - where a scene's events stand, for a checkpoint. */
#ifndef CS_EVENT_RECORD_H
#define CS_EVENT_RECORD_H

#include "base/record.h"
#include "model/event/event_state.h"

/* All that events have changed in a system since it was built, but the state: their own marks,
 * pins, masses, values, springs, pushes, and obstacles on paths. Of a system without events it
 * is nothing. */
void cs_events_record(struct cs_system *system, struct cs_record *record);

#endif

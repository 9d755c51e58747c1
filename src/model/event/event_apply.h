/* event_apply.h - what single events do; for events.c. */
#ifndef CS_EVENT_APPLY_H
#define CS_EVENT_APPLY_H

#include "model/event/event_state.h"

/* An event begins, at events->begin: to the state and the pins, or to a value. */
void cs_event_start(struct cs_system *system, uint32_t event);
/* One over an interval ends. */
void cs_event_finish(struct cs_system *system, uint32_t event);

/* The value of an active ramp or gust at t. Springs are not refreshed. */
void cs_event_set_value(struct cs_system *system, uint32_t event, double t);

/* Accelerations of all active impacts and viewpoint forces over an interval, on the particles
 * that are free. */
void cs_event_sum_pushes(struct cs_system *system);

/* The springs' stiffness and damping, and the spring list, from the values of the scene. */
void cs_event_refresh_springs(struct cs_system *system);

#endif

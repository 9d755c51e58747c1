/* event_apply.h - starts and ends single events; for events.c. */
#ifndef CS_EVENT_APPLY_H
#define CS_EVENT_APPLY_H

#include "model/event/event_state.h"

/* Starts an event at events->begin. One that happens at once acts fully here: a change of
 * velocity, a new value, a pin, a release. One over an interval becomes active. */
void cs_event_start(struct cs_system *system, uint32_t event);
/* Ends an event over an interval: values get their last number exactly, particles that it
 * holds become free, a moved collider stops. */
void cs_event_finish(struct cs_system *system, uint32_t event);

/* Sets the value of an active ramp or gust to the one at t. The caller refreshes the springs.
 */
void cs_event_set_value(struct cs_system *system, uint32_t event, double t);

/* Sums system->event_force (3,n): the accelerations in m/s2 of all active impacts and
 * viewpoint forces on free particles. NULL without such events: then it does nothing. */
void cs_event_sum_pushes(struct cs_system *system);

/* Recomputes stiffness and damping of the springs from the scene's values: those of the runs
 * that forces use, and those of the list in the view. */
void cs_event_refresh_springs(struct cs_system *system);

#endif

/* event_move.h - events that move colliders; for events.c and event_apply.c. */
#ifndef CS_EVENT_MOVE_H
#define CS_EVENT_MOVE_H

#include "model/event/event_state.h"

/* An event of the scene moves a collider. */
bool cs_event_moves_any(const struct cs_scene *scene);

/* Makes system->motions, every collider at rest. CS_ERR_MEMORY. */
enum cs_status cs_event_moves_build(struct cs_system *system, struct cs_error *error);

/* A move begins at t: from here on the collider is its, whichever event had it. It ends: the
 * collider stays as it is then, if it is still its. */
void cs_event_begin_move(struct cs_system *system, uint32_t event, double t);
void cs_event_end_move(struct cs_system *system, uint32_t event, double t);

/* After cs_event_next_leg: the collider follows the chord that the event is in. */
void cs_event_follow_move(struct cs_system *system, uint32_t event, double t);

/* Shows in the view how the colliders move from now on. */
void cs_event_show_moves(struct cs_system *system);

/* Largest speed in m/s that matter of a turning collider has within the scene. */
double cs_event_angular_speed(const struct cs_system *system);

#endif

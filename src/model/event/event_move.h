/* event_move.h - events that move colliders; for events.c and event_apply.c. */
#ifndef CS_EVENT_MOVE_H
#define CS_EVENT_MOVE_H

#include "model/event/event_state.h"

/* True if an event of the scene moves a collider. */
bool cs_event_moves_any(const struct cs_scene *scene);

/* Takes system->motions, with every collider at rest, and the arrays of the view that show
 * them. CS_ERR_MEMORY. */
enum cs_status cs_event_moves_build(struct cs_system *system, struct cs_error *error);

/* begin: the event takes control of the collider, also from another event. end: the collider
 * stops where it is, if this event still controls it. */
void cs_event_begin_move(struct cs_system *system, uint32_t event, double t);
void cs_event_end_move(struct cs_system *system, uint32_t event, double t);

/* Makes the collider follow the chord of the event that begins at t; call it after
 * cs_event_next_leg. Its rotation up to t is stored first. */
void cs_event_follow_move(struct cs_system *system, uint32_t event, double t);

/* Writes the motion of all colliders to the view: velocity, spin, and the origin that makes
 * origin + t velocity the centre at time t. */
void cs_event_show_moves(struct cs_system *system);

/* Largest speed in m/s of a point of a turning collider; of a plane, at the particle farthest
 * from its centre. */
double cs_event_angular_speed(const struct cs_system *system);

#endif

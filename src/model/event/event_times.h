/* event_times.h - when something begins, ends or turns in a scene with events. */
#ifndef CS_EVENT_TIMES_H
#define CS_EVENT_TIMES_H

#include "model/event/event_state.h"

enum { CS_EVENT_CHORDS = 16 }; /* in which a smooth path is followed from point to point */

/* s: times nearer than that are one, or a step between them would be of rounding errors */
#define CS_EVENT_SAME 1e-9

/* t, or the time of a frame that is so near to it. */
double cs_event_time_snap(const struct cs_scene *scene, double t);

/* The path of a grab or a move: from point to point in a number of chords. n 0: none. */
struct cs_event_path {
    const struct cs_path_point *points;
    uint32_t n, n_chords;
};
struct cs_event_path cs_event_path_of(const struct cs_event *event);

/* An upper bound of the number of times. */
size_t cs_event_times_count(const struct cs_scene *scene);

/* Fills events->times (cs_event_times_count) and the begin and end of each state. A time within
 * a nanosecond of a frame is that frame's, and times so near to each other are one. */
void cs_event_times_fill(struct cs_events *events);

/* When a grab or a move is at the end of a chord of a leg, as it stands in events->times. */
double cs_event_chord_end(const struct cs_events *events, uint32_t event, uint32_t leg,
                          uint32_t chord);

#endif

/* event_times.h - the times at which something begins, ends or turns in a scene with events. */
#ifndef CS_EVENT_TIMES_H
#define CS_EVENT_TIMES_H

#include "model/event/event_state.h"

/* Chords of a smooth leg of a path, from point to point; chosen by trial. */
enum { CS_EVENT_CHORDS = 16 };

/* s: times that are nearer to each other count as one. A step between them would consist of
 * rounding errors. */
#define CS_EVENT_SAME 1e-9

/* t, or the time of the frame that lies within CS_EVENT_SAME of it. */
double cs_event_time_snap(const struct cs_scene *scene, double t);

/* The path of a grab or a move: n points, borrowed from the scene, and the chords of each
 * leg. n 0: none. */
struct cs_event_path {
    const struct cs_path_point *points;
    uint32_t n, n_chords;
};
struct cs_event_path cs_event_path_of(const struct cs_event *event);

/* An upper bound of the number of times: two per event, and one per chord. */
size_t cs_event_times_count(const struct cs_scene *scene);

/* Fills events->times (capacity cs_event_times_count) and begin and end of each state. A time
 * within CS_EVENT_SAME of a frame becomes the frame's, and times as near to each other become
 * one, the earlier. */
void cs_event_times_fill(struct cs_events *events);

/* Time in s of the end of a chord of a leg, as it stands in events->times. */
double cs_event_chord_end(const struct cs_events *events, uint32_t event, uint32_t leg,
                          uint32_t chord);

#endif

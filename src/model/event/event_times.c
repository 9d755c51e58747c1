/* event_times.c - the times at which events begin, end or turn: snapped to frames, sorted,
 * near ones merged. */
#include "model/event/event_state.h"
#include "scene/contact_keys.h"
#include "scene/force_keys.h"

#include <math.h>
#include <stdlib.h>

struct cs_event_path cs_event_path_of(const struct cs_event *event) {
    const bool moves = event->move.present;
    const struct cs_list *list = moves ? &event->move.path : &event->grab.path;
    const int32_t motion = moves ? event->move.motion : event->grab.motion;
    /* the point where the event finds what it moves: no leg leads to it */
    const uint32_t first = cs_path_starts_at(list, cs_event_begin(event));
    const struct cs_path_point *points = list->items; // NULL: no path
    return (struct cs_event_path){first ? points + first : points, list->n - first,
                                  motion == CS_MOTION_SMOOTH ? CS_EVENT_CHORDS : 1};
}

size_t cs_event_times_count(const struct cs_scene *scene) {
    const struct cs_event *events = cs_scene_events(scene);
    size_t n = !isnan(scene->contact->untangle) + (size_t)scene->seams.n;
    for (uint32_t e = 0; e < scene->events.n; e++) {
        const struct cs_event_path path = cs_event_path_of(events + e);
        n += 2 + (size_t)path.n * path.n_chords;
    }
    return n;
}

/* The end of a chord in s: the leg's duration in equal parts, the last exactly at its point. */
static double chord_end(const struct cs_event *event, uint32_t leg, uint32_t chord) {
    const struct cs_event_path path = cs_event_path_of(event);
    const double begin = leg ? path.points[leg - 1].at : cs_event_begin(event);
    const double end = path.points[leg].at;
    return chord + 1 == path.n_chords
               ? end
               : begin + (end - begin) * ((chord + 1) / (double)path.n_chords);
}

double cs_event_time_snap(const struct cs_scene *scene, double t) {
    const double frame = floor(t * scene->time.fps + 0.5) / scene->time.fps;
    return fabs(frame - t) <= CS_EVENT_SAME ? frame : t;
}

/* Ascending order, for qsort. */
static int compare(const void *left, const void *right) {
    const double a = *(const double *)left, b = *(const double *)right;
    return (a > b) - (a < b);
}

/* The time of the list that t became when near times were merged: the nearest, by bisection. */
static double entry_of(const struct cs_events *events, double t) {
    uint32_t low = 0, high = events->n_times;
    while (high - low > 1) {
        const uint32_t middle = low + (high - low) / 2;
        *(events->times[middle] <= t ? &low : &high) = middle;
    }
    /* the one below, unless the one above is nearer */
    const double *times = events->times;
    return low + 1 < events->n_times && times[low + 1] - t < t - times[low] ? times[low + 1]
                                                                            : times[low];
}

/* All times of the scene's events, snapped to frames, unsorted; returns how many. */
static uint32_t collect(const struct cs_scene *scene, double *times) {
    const struct cs_event *list = cs_scene_events(scene);
    uint32_t n = 0;
    for (uint32_t e = 0; e < scene->events.n; e++) {
        if (cs_event_is_picture(list + e))
            continue;
        times[n++] = cs_event_time_snap(scene, cs_event_begin(list + e));
        times[n++] = cs_event_time_snap(scene, cs_event_end(list + e));
        const struct cs_event_path path = cs_event_path_of(list + e);
        for (uint32_t leg = 0; leg < path.n; leg++)
            for (uint32_t c = 0; c < path.n_chords; c++)
                times[n++] = cs_event_time_snap(scene, chord_end(list + e, leg, c));
    }
    return n;
}

void cs_event_times_fill(struct cs_events *events) {
    const struct cs_event *list = cs_scene_events(&events->scene);
    const uint32_t n = collect(&events->scene, events->times);
    double *times = events->times;
    /* none: the first segment has no end */
    if (n == 0)
        times[0] = HUGE_VAL;
    qsort(times, n, sizeof *times, compare);
    events->n_times = 1;
    for (uint32_t k = 1; k < n; k++)
        if (times[k] - times[events->n_times - 1] > CS_EVENT_SAME)
            times[events->n_times++] = times[k];
    for (uint32_t e = 0; e < events->scene.events.n; e++) {
        const bool never = cs_event_is_picture(list + e);
        events->states[e].begin =
            never ? (double)NAN : entry_of(events, cs_event_begin(list + e));
        events->states[e].end = never ? (double)NAN : entry_of(events, cs_event_end(list + e));
    }
}

double cs_event_times_add(struct cs_events *events, double t) {
    double *times = events->times;
    t = cs_event_time_snap(&events->scene, t);
    uint32_t k = times[0] < HUGE_VAL ? events->n_times : 0;
    if (k && fabs(entry_of(events, t) - t) <= CS_EVENT_SAME)
        return entry_of(events, t);
    events->n_times = k + 1;
    for (; k && times[k - 1] > t; k--)
        times[k] = times[k - 1];
    events->end = k ? events->end : t;
    return times[k] = t;
}

double cs_event_chord_end(const struct cs_events *events, uint32_t event, uint32_t leg,
                          uint32_t chord) {
    return entry_of(events, chord_end(cs_scene_events(&events->scene) + event, leg, chord));
}

/* event_path.c - follows the paths of grabs and moves, chord by chord.
 *
 * A smooth leg from p0 to p1 is p0 + (p1 - p0) w(s), w(s) = 3 s^2 - 2 s^3, s from 0 to 1: it
 * starts and ends at rest. It is cut into CS_EVENT_CHORDS chords of equal duration and
 * constant velocity. A method then sees no acceleration of the pinned particles within a
 * segment. */
#include "model/event/event_path.h"

#include "model/event/event_times.h"

#include <math.h>
#include <string.h>

/* The point at the end of the running chord; at the end of a leg its point exactly. */
static void chord_point(const struct cs_event_path *path, const struct cs_event_state *state,
                        double out[3]) {
    const double *point = path->points[state->leg].point;
    const double s = (state->chord + 1) / (double)CS_EVENT_CHORDS;
    const bool whole = state->chord + 1 == path->n_chords;
    for (int c = 0; c < 3; c++)
        out[c] = whole ? point[c]
                       : state->leg_start[c] +
                             (point[c] - state->leg_start[c]) * (s * s * (3 - 2 * s));
}

void cs_event_begin_path(struct cs_event_state *state, double t) {
    /* the end of a leg before the first: cs_event_next_leg goes on from there */
    memcpy(state->leg_start, state->chord_to, sizeof state->leg_start);
    state->leg = 0;
    state->chord = UINT32_MAX;
    state->chord_end = t;
}

void cs_event_next_leg(struct cs_events *events, uint32_t event, double t) {
    struct cs_event_state *state = events->states + event;
    const struct cs_event_path path = cs_event_path_of(cs_scene_events(&events->scene) + event);
    if (state->begin > t || state->chord_end > t)
        return;
    memcpy(state->chord_from, state->chord_to, sizeof state->chord_from);
    memset(state->rate, 0, sizeof state->rate);
    state->chord_begin = t;
    state->chord_end = HUGE_VAL;
    /* the leg is done: the next one begins where it ends */
    if (++state->chord == path.n_chords) {
        memcpy(state->leg_start, state->chord_to, sizeof state->leg_start);
        state->chord = 0;
        state->leg++;
    }
    /* after the last point it stays there */
    if (state->leg >= path.n)
        return;
    chord_point(&path, state, state->chord_to);
    state->chord_end = cs_event_chord_end(events, event, state->leg, state->chord);
    for (int c = 0; c < 3; c++)
        state->rate[c] = (state->chord_to[c] - state->chord_from[c]) / (state->chord_end - t);
}

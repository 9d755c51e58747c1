/* Paths of grabs and moves, followed chord by chord: smooth legs are cut into chords of
 * constant velocity, so that a method sees no bend within a segment. */
#include "model/event/event_path.h"

#include "model/event/event_times.h"

#include <math.h>
#include <string.h>

/* the point at the end of the chord that the state is in */
static void chord_point(const struct cs_event_path *path, const struct cs_event_state *state,
                        double out[3]) {
    const double *point = path->points[state->leg].point;
    const double s = (state->chord + 1) / (double)CS_EVENT_CHORDS;
    const bool whole = state->chord + 1 == path->chords;
    for (int c = 0; c < 3; c++)
        out[c] = whole
                     ? point[c]
                     : state->corner[c] + (point[c] - state->corner[c]) * (s * s * (3 - 2 * s));
}

void cs_event_begin_path(struct cs_event_state *state, double t) {
    /* the end of a leg before the first: cs_event_turn goes on from there */
    memcpy(state->corner, state->to, sizeof state->corner);
    state->leg = 0;
    state->chord = UINT32_MAX;
    state->until = t;
}

void cs_event_turn(struct cs_events *events, uint32_t event, double t) {
    struct cs_event_state *state = events->states + event;
    const struct cs_event_path path = cs_event_path_of(cs_scene_events(&events->scene) + event);
    if (state->begin > t || state->until > t)
        return;
    memcpy(state->from, state->to, sizeof state->from);
    memset(state->rate, 0, sizeof state->rate);
    state->since = t;
    state->until = HUGE_VAL;
    /* the leg is done: the next one begins where it ends */
    if (++state->chord == path.chords) {
        memcpy(state->corner, state->to, sizeof state->corner);
        state->chord = 0;
        state->leg++;
    }
    /* behind the last point it stays there */
    if (state->leg >= path.n)
        return;
    chord_point(&path, state, state->to);
    state->until = cs_event_chord_end(events, event, state->leg, state->chord);
    for (int c = 0; c < 3; c++)
        state->rate[c] = (state->to[c] - state->from[c]) / (state->until - t);
}

/* event_state.h - the state of the events of a run: times, holders, values in transition.
 *
 * All of it goes into a checkpoint (event_serialise.h), but for the pointers. */
#ifndef CS_EVENT_STATE_H
#define CS_EVENT_STATE_H

#include "model/system/system.h"

/* One event. A grab or a move follows a path of legs, from point to point; a leg has one chord,
 * or CS_EVENT_CHORDS of constant velocity if it is smooth. */
struct cs_event_state {
    /* s, out of events->times; equal for an event that happens at once */
    double begin, end;
    /* between begin and end */
    bool active;
    /* Ramp: the number that it changes, in events->scene, and its values at begin and at end.
     * Gust: value is NULL, first and last are the strengths. */
    double *value, first, last;
    /* Gust: unit directions at begin and at end. */
    double wind_ends[2][3];
    /* Path: numbers of the running leg, and of the chord in it. */
    uint32_t leg, chord;
    /* s, of that chord; the end is HUGE_VAL after the last point */
    double chord_begin, chord_end;
    /* m, m and m/s: both ends of the chord, and its velocity */
    double chord_from[3], chord_to[3], rate[3];
    /* m, the point where the leg began */
    double leg_start[3];
    /* Move: m, the shift of the collider at its begin; the path is relative to it. */
    double origin[3];
};

struct cs_viewpoint_forces;

/* The events of a run. All arrays are the system's arena's. */
struct cs_events {
    /* The scene with the values of now; system->scene points to it. Its lists of bodies and
     * colliders are copies, the other lists are shared with the scene that was read. */
    struct cs_scene scene;
    /* (n_times) s, ascending and distinct; `next` is the number of the segment's end. */
    double *times;
    uint32_t n_times, next;
    /* s, of the segment; end is HUGE_VAL after the last time */
    double begin, end;
    /* (scene.events.n) in the scene's order */
    struct cs_event_state *states;
    /* (n) number of the event that holds the particle, plus 1; 0: none */
    uint32_t *held_by;
    /* (n) scratch: the particles that an event selects */
    bool *work;
    /* (3,n) m, from the point of the path to each grabbed particle; NULL without grabs */
    double *offsets;
    /* NULL without viewpoint forces */
    struct cs_viewpoint_forces *viewpoint_forces;
    double next_test;          /* s, of the next visibility test; HUGE_VAL: none */
    double values_time;        /* s, of the ramps' values */
    bool has_ramps, has_grabs; /* some are active in the segment; gusts count as ramps */
};

#endif

/* event_state.h - where the events of a run stand: times, holders, values under way. */
#ifndef CS_EVENT_STATE_H
#define CS_EVENT_STATE_H

#include "model/system/system.h"

/* one event of the scene, in the scene's order */
struct cs_event_state {
    double begin, end;             /* s; the same for what happens at once */
    bool active;                   /* between begin and end */
    double *value, first, last;    /* of a ramp: the number, at begin and at end */
    double wind_ends[2][3];        /* of a gust: vectors at begin and at end */
    uint32_t leg, chord;           /* of a grab or a move: where it is on its path */
    double chord_begin, chord_end; /* s, of that chord */
    double chord_from[3], chord_to[3], rate[3]; /* m, m, m/s: its ends and its velocity */
    double leg_start[3];                        /* m, where the leg began */
    double origin[3]; /* m, of a move: the shift that its path starts from */
};

struct cs_viewpoint_forces;

struct cs_events {
    struct cs_scene scene; /* the scene's values now; system->scene points to it */
    double *times;         /* (n_times) ascending */
    uint32_t n_times, next;
    double begin, end;             /* s, of the segment; end HUGE_VAL behind the last time */
    struct cs_event_state *states; /* (scene.events.n) */
    uint32_t *held_by;             /* (n) number of the event that holds a particle + 1, or 0 */
    bool *work;                    /* (n) work */
    double *offsets; /* (3,n) in m, from the point of the path; NULL without grabs */
    struct cs_viewpoint_forces *viewpoint_forces; /* NULL without */
    double next_test;          /* s, of the next visibility test; HUGE_VAL: none */
    double values_time;        /* s, of the ramps' values */
    bool has_ramps, has_grabs; /* some are under way in the segment */
};

#endif

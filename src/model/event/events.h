/* events.h - the events of a run: when they are, and what they do to state, pins and values.
 *
 * The times at which something begins, ends or turns cut a run into segments. The frame loop
 * advances a method within a segment only; between two of them it calls cs_events_apply and
 * restarts the method. Within a segment ramps are linear in time and grabbed particles move at
 * constant velocity. What ramps move is a copy of the scene's values, which takes the scene's
 * place in the system. A scene without events has none of this.
 */
#ifndef CS_EVENTS_H
#define CS_EVENTS_H

#include "model/system/system.h"

/* one event of the scene, in the scene's order */
struct cs_event_state {
    double begin, end;              /* s; the same for what happens at once */
    bool active;                    /* between begin and end */
    double *value, first, last;     /* of a ramp: the number, at begin and at end */
    double winds[2][3];             /* of a gust: vectors at begin and at end */
    uint32_t leg, chord;            /* of a grab: where it is on its path */
    double since, until;            /* s, of that chord */
    double from[3], to[3], rate[3]; /* m, m, m/s: its ends and its velocity */
    double corner[3];               /* m, where the leg began */
};

struct cs_prods;

struct cs_events {
    struct cs_scene scene; /* the scene's values now; system->scene points to it */
    double *times;         /* (n_times) ascending */
    uint32_t n_times, next;
    double begin, end;             /* s, of the segment; end HUGE_VAL behind the last time */
    struct cs_event_state *states; /* (scene.events.n) */
    uint32_t *holders;             /* (n) number of the event that holds a particle + 1, or 0 */
    bool *marks;                   /* (n) work */
    double *offsets;        /* (3,n) in m, from the point of the path; NULL without grabs */
    struct cs_prods *prods; /* NULL without */
    double look;            /* s, when a prod looks anew; HUGE_VAL: never */
    double now;             /* s, of the ramps' values */
    bool ramps, grabs;      /* some are under way in the segment */
};

/* Bytes that the events of a scene with n particles take. */
size_t cs_events_bytes(const struct cs_scene *scene, uint32_t n);

/* Makes the events of a system whose arrays are all there. CS_ERR_MEMORY. */
enum cs_status cs_events_build(struct cs_system *system, struct cs_error *error);

/* Sets the system's bounds (bounds.h) to the largest that its ramps and releases can reach.
 * work has 2n doubles. */
void cs_events_set_bounds(struct cs_system *system, double *work);

/* When something happens next that has not happened yet, in s: the segment ends, or within it a
 * prod looks anew. */
double cs_events_next(const struct cs_events *events);

/* Everything that happens at t: ends before beginnings, each in the scene's order, then looks
 * of prods. Changes the system's state, pins and values; where the segment ended, opens the one
 * from t to events->end. false if nothing changed: prods looked, and saw the same. */
bool cs_events_apply(struct cs_system *system, double t);

/* Times up to t, besides those of frames, at which a method may have to stop, or more. */
uint32_t cs_events_cuts(const struct cs_events *events, double t);

/* Sets ramped values to those at t, or at the begin of the segment if t lies before it. Behind
 * its end they go on at the same rate: a stage of a method may lie there, and a bend within its
 * step would cost the method its order. */
void cs_events_move_values(struct cs_system *system, double t);

/* Largest velocity in m/s of a path in the segment. */
double cs_events_speed(const struct cs_events *events);

/* Puts the grabbed particles where they are at t, with the velocity of their path. */
void cs_events_place(const struct cs_system *system, double t, double *x, double *v);

#endif

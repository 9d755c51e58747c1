/* meeting.h - which bodies keep off each other, and how: made once from a scene. */
#ifndef CS_PAIR_MEETING_H
#define CS_PAIR_MEETING_H

#include "model/system/surfaces.h"

/* Share of a body's shortest edge that its thickness is where none is given: in a flat grid no
 * two triangles that do not touch are nearer than 0.7 of an edge. */
#define CS_THICKNESS_SHARE 0.4

/* Two bodies, one with itself, or one and an obstacle. */
struct cs_meeting {
    double range; /* m, of the law; 0: they do not meet */
    double k;     /* N/m a pair */
    double mu;    /* friction */
};

/* Of the range, that of edges with edges: over surfaces that lie on each other their number
 * changes, and so points alone hold these apart; edges are there so that nothing goes through.
 */
#define CS_MEETING_EDGES 0.5

/* m, within which pairs of points and triangles, or of edges, are felt. */
static inline double cs_meeting_range(const struct cs_meeting *meeting, bool edges) {
    return meeting->range * (edges ? CS_MEETING_EDGES : 1);
}

struct cs_meetings {
    uint32_t n_bodies;     /* as in surfaces.h: with obstacles */
    struct cs_meeting *of; /* (n_bodies, n_bodies), symmetric */
    bool *any;             /* (n_bodies) the body meets one */
    double widest, least;  /* m, of all ranges */
    uint64_t rubbed;       /* how often a friction changed */
};

/* Needs system->surfaces. Memory from the system's arena. CS_ERR_SCENE: no thickness or no
 * stiffness to be had; CS_ERR_MEMORY. */
enum cs_status cs_meetings_build(struct cs_system *system, struct cs_meetings *meetings,
                                 struct cs_error *error);

/* Takes the friction of obstacles as the scene has it now: events may change it. */
void cs_meetings_rub(const struct cs_system *system, struct cs_meetings *meetings);

static inline const struct cs_meeting *cs_meeting_of(const struct cs_meetings *meetings,
                                                     uint32_t a, uint32_t b) {
    return meetings->of + (size_t)a * meetings->n_bodies + b;
}

#endif

/* body_pair_params.h - which bodies keep off each other, and how: made once from a scene. */
#ifndef CS_CONTACT_BODY_PAIR_PARAMS_H
#define CS_CONTACT_BODY_PAIR_PARAMS_H

#include "model/system/surfaces.h"

/* Share of a body's shortest edge that its thickness is where none is given: in a flat grid no
 * two triangles that do not touch are nearer than 0.7 of an edge. */
#define CS_THICKNESS_SHARE 0.4

/* Two bodies, one with itself, or one and an obstacle. */
struct cs_body_pair_params {
    double range;    /* m, of the law; 0: they do not meet */
    double k;        /* N/m a pair */
    double friction; /* friction */
};

/* Of the range, that of edges with edges: over surfaces that lie on each other their number
 * changes, and so points alone hold these apart; edges are there so that nothing goes through.
 */
#define CS_EDGE_RANGE_RATIO 0.5

/* m, within which pairs of points and triangles, or of edges, are felt. */
static inline double cs_body_pair_params_range(const struct cs_body_pair_params *meeting,
                                               bool edges) {
    return meeting->range * (edges ? CS_EDGE_RANGE_RATIO : 1);
}

struct cs_body_pair_table {
    uint32_t n_bodies;                  /* as in surfaces.h: with obstacles */
    struct cs_body_pair_params *params; /* (n_bodies, n_bodies), symmetric */
    bool *has_partner;                  /* (n_bodies) the body meets one */
    double range_max, range_min;        /* m, of all ranges */
    uint64_t friction_version;          /* how often a friction changed */
};

/* Needs system->surfaces. Memory from the system's arena. CS_ERR_SCENE: no thickness or no
 * stiffness to be had; CS_ERR_MEMORY. */
enum cs_status cs_body_pair_table_build(struct cs_system *system,
                                        struct cs_body_pair_table *body_pairs,
                                        struct cs_error *error);

/* Takes the friction of obstacles as the scene has it now: events may change it. */
void cs_body_pair_table_update_friction(const struct cs_system *system,
                                        struct cs_body_pair_table *body_pairs);

static inline const struct cs_body_pair_params *
cs_body_pair_params_of(const struct cs_body_pair_table *body_pairs, uint32_t a, uint32_t b) {
    return body_pairs->params + (size_t)a * body_pairs->n_bodies + b;
}

#endif

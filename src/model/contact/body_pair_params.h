/* body_pair_params.h - contact range, stiffness and friction for each pair of bodies; built
 * once per scene. */
#ifndef CS_CONTACT_BODY_PAIR_PARAMS_H
#define CS_CONTACT_BODY_PAIR_PARAMS_H

#include "model/system/surfaces.h"

/* Default thickness in units of a body's shortest edge. In a flat grid, triangles without a
 * common vertex are at least 0.7 of an edge apart, so that a sheet at rest does not touch
 * itself. */
#define CS_THICKNESS_FRACTION 0.4

/* Parameters of two bodies, of one with itself, or of a body and a collider. */
struct cs_body_pair_params {
    /* m, range D of the law; 0: no contact */
    double range;
    /* N/m per point-triangle pair */
    double k;
    /* coefficient of friction (1) */
    double friction;
    /* 1/kg, 1/M of restitution (point_contact.h): 1/a of a body's mean free particle before a
     * collider, 2 (1/a + 1/b) between bodies, which are pushed from both sides */
    double inverse_mass;
};

/* Fraction of the range at which edges act on edges. The number of crossing edges changes as
 * surfaces slide on each other. Point-triangle pairs alone therefore carry the load, and
 * edge-edge pairs only prevent crossings. */
#define CS_EDGE_RANGE_RATIO 0.5

/* m, range of point-triangle pairs, or of edge-edge pairs. */
static inline double cs_body_pair_params_range(const struct cs_body_pair_params *params,
                                               bool edges) {
    return params->range * (edges ? CS_EDGE_RANGE_RATIO : 1);
}

/* N/m, stiffness of point-triangle pairs, or of edge-edge pairs. Edges have 4 k, because the
 * energy of the law at one fraction of the range is proportional to k D^2: both kinds then take
 * up the same before surfaces cross. */
static inline double cs_body_pair_params_stiffness(const struct cs_body_pair_params *params,
                                                   bool edges) {
    return params->k * (edges ? 1 / (CS_EDGE_RANGE_RATIO * CS_EDGE_RANGE_RATIO) : 1);
}

/* Parameters of all pairs; the system's arena owns the arrays. */
struct cs_body_pair_table {
    /* bodies and mesh colliders, as in surfaces.h */
    uint32_t n_bodies;
    struct cs_body_pair_params *params; /* (n_bodies, n_bodies), symmetric */
    /* (n_bodies) the body has contact with another or itself */
    bool *has_partner;
    /* m, largest and smallest range of pairs with contact */
    double range_max, range_min;
    /* N/m, softest spring or membrane, from which stiffnesses are derived */
    double softest;
    /* number of changes of params after the build */
    uint64_t params_version;
};

/* Builds the table from the scene; system->surfaces must exist. CS_ERR_SCENE: a thickness or
 * stiffness is neither given nor to be derived; CS_ERR_MEMORY. */
enum cs_status cs_body_pair_table_build(struct cs_system *system,
                                        struct cs_body_pair_table *body_pairs,
                                        struct cs_error *error);

/* Sets the range in m, at most that of the build, of two surfaces that have contact; their
 * stiffness follows unless the scene gives it. */
void cs_body_pair_table_set_range(const struct cs_system *system,
                                  struct cs_body_pair_table *body_pairs, uint32_t a, uint32_t b,
                                  double range);

/* Reads the friction of colliders from the scene again, because events may change it. */
void cs_body_pair_table_update_friction(const struct cs_system *system,
                                        struct cs_body_pair_table *body_pairs);

static inline const struct cs_body_pair_params *
/* Parameters of bodies a and b, in either order. */
cs_body_pair_params_of(const struct cs_body_pair_table *body_pairs, uint32_t a, uint32_t b) {
    return body_pairs->params + (size_t)a * body_pairs->n_bodies + b;
}

#endif

/* point_query.h - force, derivative, matrix and bound of contact at one point. A particle is a
 * sample point of one vertex with the weight 1, so that both have one evaluation. */
#ifndef CS_CONTACT_POINT_QUERY_H
#define CS_CONTACT_POINT_QUERY_H

#include "model/contact/contact_samples.h"
#include "model/force/term.h"

/* Quantity that is asked for, of points or of pairs. */
enum cs_contact_query {
    CS_QUERY_FORCE,
    CS_QUERY_JVP, /* of the force */
    CS_QUERY_APPROACH,
    CS_QUERY_ENERGY,
    CS_QUERY_MATRIX,
    CS_QUERY_BOUND,
    CS_QUERY_LAGGED /* friction, stored by lagged_friction.h */
};

/* A query over many points; all pointers are borrowed. */
struct cs_point_query {
    const struct cs_system *system;
    enum cs_contact_query asked;
    struct cs_eval eval;
    const struct cs_matrix *matrix; /* of CS_QUERY_MATRIX and CS_QUERY_APPROACH */
};

/* A query for the matrix or the approach of a step. */
static inline struct cs_point_query cs_point_matrix_query(const struct cs_system *system,
                                                          enum cs_contact_query asked,
                                                          const struct cs_matrix *matrix) {
    const struct cs_eval at = {
        .t = matrix->t, .x = matrix->x, .v = matrix->v, .parts = CS_PART_ALL};
    return (struct cs_point_query){system, asked, at, matrix};
}

/* Answer at one point; what was not asked for is unspecified. */
struct cs_point_answer {
    double vector[3];          /* N: force, its change, or the approach */
    double block[6];           /* of the matrix: xx, xy, xz, yy, yz, zz */
    double stiffness, damping; /* N/m, N s/m: bounds */
    double energy;             /* J; with a force in W, the power that the collider gives */
    struct cs_point_contact contact;
};

/* Answers for a point, a sample or a particle, which is a sample of one vertex with the weight
 * 1, against collider `number`.
 * Returns false if it is out of range, and for energies and friction if it cannot move. */
bool cs_point_evaluate(const struct cs_point_query *query,
                       const struct cs_posed_collider_law *law, uint32_t number,
                       const struct cs_contact_sample_point *point,
                       struct cs_point_answer *answer);

/* Members that all terms of contact have in common. */
#define CS_CONTACT_TERM                                                                        \
    .part_bits = CS_PART_POTENTIAL | CS_PART_DISSIPATIVE, .rampable_keys = cs_contact_ramps,   \
    .energy_kind = CS_ENERGY_OTHER, .energy_column = "other", .work_column = "friction"
extern const char *const cs_contact_ramps[];

#endif

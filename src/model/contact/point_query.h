/* point_query.h - force, derivative, matrix and bound of contact at one point. A particle is a
 * sample point of one vertex with the weight 1, so that both have one evaluation. */
#ifndef CS_CONTACT_POINT_QUERY_H
#define CS_CONTACT_POINT_QUERY_H

#include "model/contact/contact_samples.h"
#include "model/force/term.h"

/* Quantity that is asked for. */
enum cs_point_quantity {
    CS_POINT_FORCE,
    CS_POINT_JVP, /* of the force */
    CS_POINT_APPROACH,
    CS_POINT_ENERGY,
    CS_POINT_MATRIX,
    CS_POINT_BOUND,
    CS_POINT_LAGGED /* friction, stored by lagged_friction.h */
};

/* A query over many points; all pointers are borrowed. */
struct cs_point_query {
    const struct cs_system *system;
    enum cs_point_quantity quantity;
    struct cs_eval eval;
    const struct cs_matrix *matrix; /* of CS_POINT_MATRIX and CS_POINT_APPROACH */
};

/* A query for the matrix or the approach of a step. */
static inline struct cs_point_query cs_point_matrix_query(const struct cs_system *system,
                                                          enum cs_point_quantity quantity,
                                                          const struct cs_matrix *matrix) {
    const struct cs_eval at = {
        .t = matrix->t, .x = matrix->x, .v = matrix->v, .parts = CS_PART_ALL};
    return (struct cs_point_query){system, quantity, at, matrix};
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
 * 1, against collider `number`. A particle in impact answers for its flight (rebound.h).
 * Returns false if it is out of range, and for energies and friction if it cannot move. */
bool cs_point_evaluate(const struct cs_point_query *query,
                       const struct cs_posed_collider_law *law, uint32_t number,
                       const struct cs_contact_sample_point *point,
                       struct cs_point_answer *answer);

#endif

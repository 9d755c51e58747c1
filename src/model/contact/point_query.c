/* The law of point_contact.h with friction that sticks (bristle_law.h) or acts by its
 * chord (friction_chord.h), at one point. */
#include "model/contact/point_query.h"

#include "model/contact/bristle_law.h"
#include "model/contact/friction_chord.h"

#include <math.h>

/* Accelerations of a point in the step of a matrix with matrix->chord. */
static struct cs_contact_pull pull_on(const struct cs_point_query *query,
                                      const struct cs_contact_sample_point *point) {
    const struct cs_system *system = query->system;
    struct cs_contact_pull pull = cs_contact_pull_begin(query->matrix);
    for (uint32_t k = 0; k < point->n && query->matrix->chord; k++)
        cs_contact_pull_add(&pull, query->matrix, system->view.n, point->particles[k],
                            system->inv_mass[point->particles[k]], point->w[k]);
    return pull;
}

static void find_vector(const struct cs_point_query *query,
                        const struct cs_posed_collider_law *law,
                        const struct cs_contact_sample_point *point, const double v[3],
                        const struct cs_bristle *bristle, struct cs_point_answer *answer) {
    const struct cs_contact_force_parts parts = cs_force_parts_of(query->eval.parts);
    const struct cs_point_contact *contact = &answer->contact;
    const bool rubs = bristle && parts.friction > 0;
    double *f = answer->vector;
    if (query->asked == CS_QUERY_JVP) {
        double dp[3], dv[3];
        cs_contact_sample_interpolate(point, query->system->view.n, query->eval.dx, dp);
        cs_contact_sample_interpolate(point, query->system->view.n, query->eval.dv, dv);
        const struct cs_point_contact_motion motion = cs_posed_collider_law_motion(law, dp, dv);
        cs_point_contact_jvp(contact, parts, &motion, f);
        if (rubs)
            cs_bristle_add_jvp(contact, bristle, &motion, f);
    } else if (query->asked == CS_QUERY_APPROACH) {
        cs_point_contact_approach(contact, query->matrix, f);
        if (query->matrix->chord && contact->friction > 0) {
            const struct cs_contact_pull pull = pull_on(query, point);
            cs_friction_chord_add_approach(contact, &pull, f);
        }
        if (bristle)
            cs_bristle_add_approach(contact, bristle, query->matrix, f);
    } else {
        cs_point_contact_force(contact, parts, f);
        if (rubs)
            cs_bristle_add_force(contact, bristle, f);
        // contact->v is v - u
        answer->energy = 0;
        for (int c = 0; c < 3; c++)
            answer->energy += f[c] * (v[c] - contact->v[c]);
    }
}

static void find_matrix(const struct cs_point_query *query,
                        const struct cs_contact_sample_point *point,
                        const struct cs_bristle *bristle, struct cs_point_answer *answer) {
    const struct cs_contact_pull pull = pull_on(query, point);
    for (int e = 0; e < 6; e++)
        answer->block[e] = 0;
    if (query->matrix->chord)
        cs_friction_chord_add_block(&answer->contact, query->matrix, &pull, answer->block);
    else
        cs_point_contact_add_block(&answer->contact, query->matrix, answer->block);
    if (bristle)
        cs_bristle_add_matrix(&answer->contact, bristle, query->matrix, &pull, answer->block);
}

static void find_bound(const struct cs_bristle *bristle, struct cs_point_answer *answer) {
    cs_point_contact_bound(&answer->contact, &answer->stiffness, &answer->damping);
    if (!bristle)
        return;
    // they act at right angles to each other, so the larger one counts
    answer->stiffness = fmax(answer->stiffness, bristle->stiffness);
    answer->damping = fmax(answer->damping, bristle->damping);
}

bool cs_point_evaluate(const struct cs_point_query *query,
                       const struct cs_posed_collider_law *law, uint32_t number,
                       const struct cs_contact_sample_point *point,
                       struct cs_point_answer *answer) {
    const struct cs_system *system = query->system;
    const bool stored = query->asked == CS_QUERY_ENERGY || query->asked == CS_QUERY_LAGGED;
    struct cs_bristle found;
    double p[3], v[3];
    cs_contact_sample_interpolate(point, system->view.n, query->eval.x, p);
    cs_contact_sample_interpolate(point, system->view.n, stored ? NULL : query->eval.v, v);
    if (cs_contact_sample_is_tangled(system, point) ||
        !cs_posed_collider_law_in_range(law, p, v, &answer->contact))
        return false;
    if (stored) {
        const struct cs_point_contact *contact = &answer->contact;
        answer->energy = cs_barrier_energy(contact->d, contact->range, contact->k);
        return cs_contact_sample_mass(system, point) < HUGE_VAL;
    }
    const bool sticks = cs_bristle_of_point(system, number, law, point, p, &found);
    const struct cs_bristle *bristle = sticks ? &found : NULL;
    if (query->asked == CS_QUERY_MATRIX)
        find_matrix(query, point, bristle, answer);
    else if (query->asked == CS_QUERY_BOUND)
        find_bound(bristle, answer);
    else
        find_vector(query, law, point, v, bristle, answer);
    return true;
}

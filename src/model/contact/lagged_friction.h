/* lagged_friction.h - friction with the normal forces and directions of earlier positions.
 *
 * Coulomb's friction has no potential, because its limit mu N changes with the positions. With
 * N and the normal n of each contact taken at lagged positions it has one in the velocities (Li
 * et al. 2020, sec. 5):
 *
 *   R(v) = sum mu N (sqrt(T.T + ev^2) - ev),   T = V - n (n.V),   V = sum w_k v_k - surface
 *   f_k = -dR/dv_k = -w_k mu N T / sqrt(T.T + ev^2)
 *
 * A method that minimises can then use R as part of its merit function. While friction is
 * lagged, the contact forces leave out their own friction, and this term adds that of the
 * stored contacts. The true force acts again after cs_lagged_friction_end. */
#ifndef CS_CONTACT_LAGGED_FRICTION_H
#define CS_CONTACT_LAGGED_FRICTION_H

#include "model/contact/contact_set.h"
#include "model/contact/point_contact.h"
#include "model/system/particle_system.h"

/* All stored contacts of a system; the arena that it was built in owns them. */
struct cs_lagged_friction {
    const struct cs_system *system; /* borrowed */
    struct cs_contact_set set;      /* particles, weights, forces and blocks */
    bool is_active;                 /* it acts, instead of the friction of the contact forces */
    struct cs_matrix matrix;        /* of the last set-up of the solver */
    bool is_overwritten;            /* the set's blocks are those of another matrix */
};

/* Prepares an empty store for the contact forces of a built system, appends its term to
 * system->terms and sets system->lagged_friction. CS_ERR_MEMORY. */
enum cs_status cs_lagged_friction_build(struct cs_system *system, struct cs_arena *arena,
                                        struct cs_error *error);

/* Stores all contacts at positions x (3,n) and time t, and lets their friction act. With all
 * threads. */
void cs_lagged_friction_begin(struct cs_lagged_friction *lagged, double t, const double *x);

/* Lets the friction of the contact forces act again. */
void cs_lagged_friction_end(struct cs_lagged_friction *lagged);

/* R in W at velocities v (3,n); f (3,n) is set to the lagged friction alone, 0 on pinned
 * particles. With all threads. */
double cs_lagged_friction_potential(struct cs_lagged_friction *lagged, const double *v,
                                    double *f);

/* Returns true while lagged friction replaces that of the contact forces. */
static inline bool cs_lagged_friction_acts(const struct cs_system *system) {
    return system->lagged_friction && system->lagged_friction->is_active;
}

/* Stores one contact of n particles or points with their weights. contact: as evaluated at the
 * lagged positions for particles at rest, so that its velocity is that of the colliders.
 * Nothing is stored without a load. One thread at a time per chunk. */
void cs_lagged_friction_store(struct cs_lagged_friction *lagged, uint32_t chunk,
                              const struct cs_point_contact *contact, uint32_t n,
                              const uint32_t *particles, const double *weights);

#endif

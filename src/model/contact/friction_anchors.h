/* friction_anchors.h - anchors of friction that sticks (bristle_law.h), as a part of the state.
 *
 * Every particle and every contact sample has an anchor on every collider with friction that
 * is no mesh. Anchors stay where they are in the frame of their collider, which
 * carries them along, during a step with all its trials. After each accepted step, in commit,
 * the anchor of a point that slips follows it, and the anchor of a point out of range is the
 * point itself. Checkpoints and hashes of a state contain them. */
#ifndef CS_FRICTION_ANCHORS_H
#define CS_FRICTION_ANCHORS_H

#include "model/contact/bristle_law.h"
#include "model/contact/collider_params.h"

struct cs_contact_sample_point;

/* Anchors of all points on colliders, in m in the frame of their collider. The system's arena
 * owns the arrays. */
struct cs_friction_anchors {
    /* (n_values) all anchors: what a checkpoint and the hash of a state contain */
    double *values;
    size_t n_values;
    /* (colliders) for each (3,n) of the particles within values; NULL: no friction there */
    double **particles;
    /* (3, points) of contact samples within values; NULL: there are none */
    double *samples;
};

/* Allocates system->friction_anchors for a scene with contact.friction_law "stick", after its
 * forces are built. CS_ERR_MEMORY. */
enum cs_status cs_friction_anchors_build(struct cs_system *system, struct cs_error *error);

/* Puts all anchors where their points are at t: the start of a run. Nothing without anchors.
 */
void cs_friction_anchors_start(const struct cs_system *system, double t, const double *x);

/* Moves the anchors of points that slip or are out of range, after an accepted step that ended
 * in (x, v) at t. With all threads. Nothing without anchors. */
void cs_friction_anchors_commit(const struct cs_system *system, double t, const double *x,
                                const double *v);

/* Sets the bristle of a particle at x (3,n), or of a contact sample at p, on a collider.
 * Returns false if there is no friction or the collider is a mesh. */
bool cs_bristle_of_particle(const struct cs_system *system, uint32_t collider,
                            const struct cs_posed_collider_law *near, const double *x,
                            size_t particle, struct cs_bristle *bristle);
bool cs_bristle_of_sample(const struct cs_system *system,
                          const struct cs_posed_collider_law *near,
                          const struct cs_contact_sample_point *point, const double p[3],
                          struct cs_bristle *bristle);

#endif

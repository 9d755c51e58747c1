/* bristle_law.h - friction with a memory (contact.friction_law "stick"): a contact point hangs
 * on an anchor in the collider by a spring and a damper, and slips at Coulomb's limit.
 *
 * With the place x of the point, its anchor a, the sliding velocity T = P V, P = I - g g^T/g.g,
 * the load N = F |g| and the law of point_contact.h for F and g:
 *
 *   trial = k_t P (x - a) + c_t T      f = -trial min(1, mu N/|trial|)
 *
 * k_t = k, the stiffness of the contact, and c_t = 2 sqrt(k_t m) damps a point of mass m
 * critically: without it explicit methods ring on at some 10 mm/s. Below the limit the point
 * rests exactly; above it the force is mu N, whatever the speed. After a step in which it slips
 * the anchor follows (below), so that
 *
 *   k_t |P (x - a)| <= mu N
 *
 * Where sliding is straight that changes no force, which is smooth within a step. Where it
 * turns or stops the direction of the spring lags behind by up to a step: methods have order 1
 * there.
 *
 * The limit is the spring's, not that of spring and damper together, k_t (x - a) + c_t T = mu
 * N. With the latter an anchor runs ahead of a fast point and pulls it on when it stops, and
 * friction falls below mu N for methods that evaluate forces at a velocity of half a step
 * before.
 *
 * The work against springs and dampers is friction's. What a spring stores, |trial|^2/(2 k_t)
 * at rest, is not part of the energy.
 *
 * Source: a spring and a slider across the normal, Cundall, Strack 1979. */
#ifndef CS_BRISTLE_LAW_H
#define CS_BRISTLE_LAW_H

#include "model/contact/collider_params.h"
#include "model/contact/friction_chord.h"

/* The bristle of one contact point. */
struct cs_bristle {
    /* x - a in m */
    double stretch[3];
    /* mu (1), k_t (N/m), c_t (N s/m) */
    double friction, stiffness, damping;
};

/* f += the force of friction in N. */
void cs_bristle_add_force(const struct cs_point_contact *contact,
                          const struct cs_bristle *bristle, double f[3]);

/* df += its exact change along a motion. At the limit it is that of slip where the point goes
 * on sliding, else that of rest. */
void cs_bristle_add_jvp(const struct cs_point_contact *contact,
                        const struct cs_bristle *bristle,
                        const struct cs_point_contact_motion *motion, double df[3]);

/* The same for any matrix. One with matrix->chord, of a method that is linear in a step, has
 * friction by the chord from now to the end of the step (friction_chord.h), and pull is what
 * acts on the point. With T_free = T + h (P F/m + s trial/m), q = k_t P (x - a), B = h k_t +
 * c_t and mu N as it is now, implicit Euler ends at
 *
 *   phi = z min(1, mu N/|z|),  z = (q + B T_free)/(1 + h B/m)     friction
 *   u = T_free - h phi/m                                          sliding velocity
 *
 * and the block h (r r^T/(r.d) + p (P - d d^T/d.d)) takes the linear step there, also where
 * sliding turns: d = u - T, r = phi - s trial - h K T with the K of cs_bristle_add_approach, p
 * = B min(1, mu N/|q + B u|). Friction is the gradient of a convex function of u, so r.d > 0
 * but for what the chord leaves out; the block is then cut to p alone. By the slope at the
 * begin of the step a point that slips and would come to rest is thrown back beyond it, to and
 * fro. */
void cs_bristle_add_matrix(const struct cs_point_contact *contact,
                           const struct cs_bristle *bristle, const struct cs_matrix *matrix,
                           const struct cs_contact_pull *pull, double b[6]);

/* y += ck df/dx V with df/dx as in the block: the anchor goes with the collider, so the bristle
 * is stretched by the relative velocity (cs_point_contact_approach). */
void cs_bristle_add_approach(const struct cs_point_contact *contact,
                             const struct cs_bristle *bristle, const struct cs_matrix *matrix,
                             double y[3]);

/* Returns true if the point slips and the spring alone is above the limit; *stretch is then
 * the P (x - a) that an anchor must leave. */
bool cs_bristle_slips(const struct cs_point_contact *contact, const struct cs_bristle *bristle,
                      double stretch[3]);

/* Anchors of friction that sticks, as a part of the state.
 *
 * Every particle and every contact sample has an anchor on every collider with friction that
 * is no mesh. Anchors stay where they are in the frame of their collider, which
 * carries them along, during a step with all its trials. After each accepted step, in commit,
 * the anchor of a point that slips follows it, and the anchor of a point out of range is the
 * point itself. Checkpoints and hashes of a state contain them. */

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

/* Moves the anchors of points that slip or are out of range, after an accepted step that ended
 * in (x, v) at t. v NULL: puts all anchors where their points are, at the start of a run.
 * Nothing without anchors. */
void cs_friction_anchors_commit(const struct cs_system *system, double t, const double *x,
                                const double *v);

/* Sets the bristle of a point at p, a particle or a contact sample, on a collider. Returns
 * false if there is no friction or the collider is a mesh. */
bool cs_bristle_of_point(const struct cs_system *system, uint32_t collider,
                         const struct cs_posed_collider_law *law,
                         const struct cs_contact_sample_point *point, const double p[3],
                         struct cs_bristle *bristle);

#endif

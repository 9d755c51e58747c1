/* approach.h - the energy with which two surfaces may meet, estimated from the start of a scene
 * and its events.
 *
 * The speed at which bodies a and b, or a body and a collider, may meet is the larger of
 *
 *   sqrt(|v_a - v_b|^2 + 2 g h)   the fastest initial velocities, spin included, and the drop h
 *   u_a + u_b                     speeds of grabs and moved colliders along their paths, and
 *                                 the largest speed of a vertex on key frames
 *
 * and for two bodies, or a body and itself, the largest of these with whatever either of them
 * meets, since a body that is struck meets others, and itself, as fast as that.
 *
 * h is the gap along gravity between the bounding boxes at the start, where one lies above the
 * other; of two bodies, or a body and itself, at least the drop of either to the nearest
 * collider, from where they may be stopped one by one. Nothing below means no drop. A body that
 * is pinned for good drops at most its own diagonal. Wind, impacts and springs that unload are
 * left out: it is an estimate, not a bound.
 *
 * Everything is + - * / and sqrt of numbers of the scene, so that it is the same on every
 * machine. */
#ifndef CS_CONTACT_APPROACH_H
#define CS_CONTACT_APPROACH_H

#include "model/system/particle_system.h"

/* The default stiffness is k = 40 m v^2/D^2 = 80 E/D^2, for the kinetic energy E = m v^2/2 of
 * the heaviest particle that meets: it comes to rest near half the range, psi(0.48 D) = k
 * D^2/80, and steps that resolve the motion, some D/v long, resolve the contact too. */
#define CS_APPROACH_STIFFNESS 80.0

/* A barrier must hold this many times the energy that comes: steps pass unseen over what is
 * below CS_UNRESOLVED_ENERGY_MAX = 1/50 of it (step_check.h), and would come to an end at the
 * surface. */
#define CS_APPROACH_MARGIN 50.0

/* Builds system->approach in the system's arena, once: later calls do nothing. Bodies must have
 * their states and masses. O(particles + surfaces^2). CS_ERR_MEMORY. */
enum cs_status cs_approach_build(struct cs_system *system, struct cs_error *error);

/* J, the energy E of one particle with which body a meets b: a itself, another body, or the
 * collider b - n_bodies of the scene. 0 where nothing comes. */
double cs_approach_energy(const struct cs_system *system, uint32_t a, uint32_t b);

/* m/s, the speed at which they meet. */
double cs_approach_speed(const struct cs_system *system, uint32_t a, uint32_t b);

/* N/m: contact.stiffness if the scene gives it, else the larger of the softest stretch spring
 * and 80 E/D^2. E in J, range in m. */
double cs_approach_stiffness(const struct cs_system *system, double softest, double energy,
                             double range);

#endif

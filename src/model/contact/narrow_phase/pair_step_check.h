/* pair_step_check.h - tests whether a step resolves the contact between bodies that it passes
 * through. The step is rejected if force and stiffness at its start predict the contact energy
 * along it too badly. */
#ifndef CS_NARROW_PHASE_PAIR_STEP_CHECK_H
#define CS_NARROW_PHASE_PAIR_STEP_CHECK_H

#include "model/contact/narrow_phase/contact_pairs.h"

/* As cs_collider_contact_resolves_step (contact/step_check.h), for pairs that move straight
 * from x0 at t0 to x1 at t1. Samples are at most half a range of relative motion apart. The
 * energy that is not predicted must stay below CS_UNRESOLVED_ENERGY_MAX of the energy of the
 * pair: psi(d), the kinetic energy of its contact points, and psi at half the range, so that
 * pairs that barely touch do not decide. Returns false too if bodies near each other move too
 * far for cs_candidates_cover_step. With all threads. */
bool cs_contact_pairs_resolve_step(struct cs_pairs *pairs, double t0, const double *x0,
                                   double t1, const double *x1);

#endif

/* pair_step_check.h - whether a step has gone into contact of bodies further than it can know.
 */
#ifndef CS_NARROW_PHASE_PAIR_STEP_CHECK_H
#define CS_NARROW_PHASE_PAIR_STEP_CHECK_H

#include "model/contact/narrow_phase/contact_pairs.h"

/* As cs_collider_contact_resolves_step (contact/step_check.h), for pairs: along the straight
 * way of a pair's particles from x0 at t0 to x1 at t1, at points that are at most half a range
 * of motion apart, the energy that force and stiffness at x0 do not foretell is below
 * CS_UNRESOLVED_ENERGY_MAX of what the pair has: psi(d), the kinetic energy of its contact
 * points against each other, and psi of half the range, since pairs that only just touch matter
 * to none. false as well where bodies that are near move too far for cs_candidates_cover_step.
 * With all threads. */
bool cs_contact_pairs_resolve_step(struct cs_pairs *pairs, double t0, const double *x0,
                                   double t1, const double *x1);

#endif

/* seen.h - whether a step has gone into contact of bodies further than it can know. */
#ifndef CS_PAIR_SEEN_H
#define CS_PAIR_SEEN_H

#include "model/pair/pairs.h"

/* As cs_contact_is_seen (contact/share.h), for pairs: along the straight way of a pair's
 * particles from x0 at t0 to x1 at t1, at points that are at most half a range of motion apart,
 * the energy that force and stiffness at x0 do not foretell is below CS_SHARE_UNSEEN of what
 * the pair has: psi(d), the kinetic energy of its contact points against each other, and psi of
 * half the range, since pairs that only just touch matter to none. false as well where bodies
 * that are near move too far for cs_search_cover. With all threads. */
bool cs_pairs_are_seen(struct cs_pairs *pairs, double t0, const double *x0, double t1,
                       const double *x1);

#endif

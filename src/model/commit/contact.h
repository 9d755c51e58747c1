/* contact.h - projection contact with the colliders, after a step. */
#ifndef CS_CONTACT_H
#define CS_CONTACT_H

#include "model/system/system.h"

struct cs_contact_counts {
    uint64_t tests, pushed;
};

/* For every free particle behind the surface (moved out by the thickness) of a collider: put it
 * on the surface along the normal n (cloth thesis, eq. 5.27-5.31); if it moves inwards, take
 * away `absorption` of the normal velocity, v -= ka (v.n) n (eq. 5.32 as meant; a negative ka
 * turns the normal velocity round and multiplies it by |ka|); then Coulomb friction: the
 * tangential velocity loses at most `friction` times the normal velocity that was changed.
 * Velocities are those against the collider as it moves at t. Each particle meets the colliders
 * in the scene's order. Returns what was done. */
struct cs_contact_counts cs_contact_resolve(const struct cs_system *system, double t, double *x,
                                            double *v);

#endif

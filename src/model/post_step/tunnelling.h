/* tunnelling.h - colliders that a particle passes in one step. */
#ifndef CS_TUNNELLING_H
#define CS_TUNNELLING_H

#include "model/contact/posed_collider.h"

/* Returns whether a collider of the scene has an other side. */
bool cs_tunnelling_is_possible(const struct cs_scene *scene);

/* Radius in m of the largest ball inside a collider with its thickness; HUGE_VAL for a
 * half-space, and a mesh. Whoever passes the middle of a collider has a longer way. */
double cs_tunnelling_inner_radius(const struct cs_posed_collider *collider);

/* Returns whether a particle that moves from `from` to `to` passes the collider, posed before
 * and after the step (which may be the same): its way relative to the collider is longer than
 * the inner radius, and leads through it to another side than that at which it entered. *gap
 * (m, < 0) and n are then those of the half-space at the entry, to which the nearest surface
 * point would be no guide. O(1): about 150 distances, but only for such ways. */
bool cs_tunnelling_find(const struct cs_posed_collider *before,
                        const struct cs_posed_collider *after, const double from[3],
                        const double to[3], double *gap, double n[3]);

/* Returns whether the particle passes the collider, or comes deeper behind its surface than
 * CS_TUNNELLING_DEPTH of the inner radius on a way that is longer than that. */
#define CS_TUNNELLING_DEPTH 0.25
bool cs_tunnelling_is_deep(const struct cs_posed_collider *before,
                           const struct cs_posed_collider *after, const double from[3],
                           const double to[3]);

#endif

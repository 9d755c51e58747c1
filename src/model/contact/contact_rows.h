/* contact_rows.h - contact force of spheres and planes on rows of particles, vectorised. */
#ifndef CS_CONTACT_ROWS_H
#define CS_CONTACT_ROWS_H

#include "model/contact/collider_query.h"
#include "model/force/term.h"

/* Returns whether a collider is a plane or sphere without rotation, whose matter moves at one
 * velocity. */
bool cs_contact_rows_supported(const struct cs_posed_collider_law *near);

/* f (3,n) += the force of point_contact.h at the particles of at->block; equal to it but for
 * rounding. */
void cs_contact_rows_add(const struct cs_posed_collider_law *near, size_t n,
                         const struct cs_eval *at, struct cs_contact_force_parts parts,
                         double *f);

/* sums += the bounds of point_contact.h at all particles, likewise. */
void cs_contact_rows_add_bounds(const struct cs_posed_collider_law *near, size_t n,
                                const struct cs_eval *at, const struct cs_gershgorin *sums);

#endif

/* contact_rows.h - the force of contact on a row of particles at once, in vectors. */
#ifndef CS_CONTACT_ROWS_H
#define CS_CONTACT_ROWS_H

#include "model/contact/collider_query.h"
#include "model/force/term.h"

/* Spheres and planes whose matter moves at one velocity: nothing else is as cheap. */
bool cs_contact_rows_supported(const struct cs_posed_collider_law *near);

/* f (3,n) += the force of touch.h at the particles of at->block: the same but for rounding. */
void cs_contact_rows_add(const struct cs_posed_collider_law *near, size_t n,
                         const struct cs_eval *at, struct cs_contact_force_parts parts,
                         double *f);

/* sums += the bounds of touch.h at all particles, likewise. */
void cs_contact_rows_add_bounds(const struct cs_posed_collider_law *near, size_t n,
                                const struct cs_eval *at, const struct cs_gershgorin *sums);

#endif

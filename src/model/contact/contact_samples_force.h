/* contact_samples_force.h - what the points of contact_samples.h do to the corners of their
 * edges and triangles. */
#ifndef CS_CONTACT_SAMPLES_FORCE_H
#define CS_CONTACT_SAMPLES_FORCE_H

#include "model/contact/contact_samples.h"

/* Sets covers->now to the forces at a state, or with at->dx or at->dv to their change. With all
 * threads, as all here. */
void cs_contact_samples_set(struct cs_contact_samples *samples, const struct cs_eval *at);

/* J, of the elastic part. */
double cs_contact_samples_energy(struct cs_contact_samples *samples, const struct cs_eval *at);

/* Sets covers->blocks to the shares of a matrix. kept: in covers->matrix, for products; else in
 * covers->now, and with matrix->bound for their blocks alone. */
void cs_contact_samples_set_matrix(struct cs_contact_samples *samples,
                                   const struct cs_matrix *matrix, bool kept);

/* Adds the sums of norms in the rows of df/dx and df/dv at a state. */
void cs_contact_samples_add_bound(struct cs_contact_samples *samples, const struct cs_eval *at,
                                  double *stiffness, double *damping);

#endif

/* contact_samples_force.h - forces, energies, matrices and bounds of contact samples on the
 * vertices of their edges and triangles. All functions use all threads. */
#ifndef CS_CONTACT_SAMPLES_FORCE_H
#define CS_CONTACT_SAMPLES_FORCE_H

#include "model/contact/contact_samples.h"

/* Sets samples->current_set to the forces at a state, or to their change if at->dx or at->dv is
 * set. */
void cs_contact_samples_set(struct cs_contact_samples *samples, const struct cs_eval *at);

/* Elastic energy in J. */
double cs_contact_samples_energy(struct cs_contact_samples *samples, const struct cs_eval *at);

/* Sets samples->blocks to the matrix. kept: samples->matrix, for products; otherwise
 * current_set, for blocks alone, which bound the whole matrix if matrix->bound is set. */
void cs_contact_samples_set_matrix(struct cs_contact_samples *samples,
                                   const struct cs_matrix *matrix, bool kept);

/* Adds the Gershgorin row sums of df/dx (N/m) and df/dv (N s/m) at a state. */
void cs_contact_samples_add_bound(struct cs_contact_samples *samples, const struct cs_eval *at,
                                  double *stiffness, double *damping);

#endif

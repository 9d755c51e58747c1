/* membrane_matrix.h - energies and bounds of membranes, and their part of the solver's matrix.
 */
#ifndef CS_MEMBRANE_MATRIX_H
#define CS_MEMBRANE_MATRIX_H

#include "model/elastic/membranes.h"

/* Elastic energy in J; that of all triangles at twice their rest lengths. */
double cs_membranes_energy(const struct cs_system *system, const double *x);
double cs_membranes_energy_at_twice(const struct cs_system *system);

/* Adds a membrane's row sums (struct cs_gershgorin of term.h) to stiffness and damping (n), at
 * the state `at`, or for NULL at rest. Masses are divided among the triangles at a particle.
 * With these, the stiffness of a triangle along its edges has frequencies of at most w; each
 * corner gets w^2 times its mass, and 2 |t| of the edges that end there. */
void cs_membranes_add_bound(const struct cs_system *system, const struct cs_eval *at,
                            double *stiffness, double *damping);

/* --- in the solver's matrix --- */

/* Finds the diagonal blocks at the matrix's state; kept: its products too. All threads. */
void cs_membranes_prepare_matrix(const struct cs_system *system, const struct cs_matrix *matrix,
                                 bool kept);
/* y += the kept matrix times p, without its diagonal blocks. All threads. */
void cs_membranes_add_product(const struct cs_system *system, const double *p, double *y);
/* y += the elastic part of the kept matrix times v. */
void cs_membranes_add_approach(const struct cs_system *system, const struct cs_matrix *matrix,
                               double *y);

#endif

/* bending_forces.h - forces of bending, their energy and bounds, and their matrix. */
#ifndef CS_BENDING_FORCES_H
#define CS_BENDING_FORCES_H

#include "model/elastic/bendings.h"

/* Computes the moments of positions, or of a direction of the derivative, by all threads. */
void cs_bendings_prepare(const struct cs_system *system, const struct cs_eval *at);
/* f (3,n) -= K x at a block after prepare: the force or its derivative. */
void cs_bendings_add(const struct cs_system *system, const struct cs_eval *at, double *f);

/* Energy in J. */
double cs_bendings_energy(const struct cs_system *system, const double *x);

/* Adds the row sums of |K| to sums (n) in N/m. */
void cs_bendings_add_bound(const struct cs_system *system, double *sums);

/* The part of the solver's matrix, -ck K: as in membrane_matrix.h. */
void cs_bendings_prepare_matrix(const struct cs_system *system, const struct cs_matrix *matrix,
                                bool kept);
void cs_bendings_add_product(const struct cs_system *system, const double *p, double *y);
void cs_bendings_add_approach(const struct cs_system *system, const double *v, double *y);

#endif

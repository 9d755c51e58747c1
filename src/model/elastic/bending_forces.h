/* bending_forces.h - forces of bending, and their matrix. */
#ifndef CS_BENDING_FORCES_H
#define CS_BENDING_FORCES_H

#include "model/elastic/bendings.h"

/* Computes the forces on stencils for the chosen parts, with at->dx or at->dv their derivative,
 * by all threads. */
void cs_bendings_prepare(const struct cs_system *system, const struct cs_eval *at);
/* f (3,n) += what was computed last, at a block. */
void cs_bendings_add(const struct cs_system *system, const struct cs_eval *at, double *f);

/* The part of the solver's matrix, cd df/dv + ck df/dx: as in membrane_matrix.h. */
void cs_bendings_prepare_matrix(const struct cs_system *system, const struct cs_matrix *matrix,
                                bool kept);
void cs_bendings_add_blocks(const struct cs_system *system, size_t begin, size_t end,
                            double *blocks);
void cs_bendings_add_product(const struct cs_system *system, const double *p, double *y);
void cs_bendings_add_approach(const struct cs_system *system, const struct cs_matrix *matrix,
                              double *y);

#endif

/* membrane_surrogate.h - springs that stand for a membrane in the levels of the solver's
 * preconditioner, which knows springs alone.
 *
 * The matrix of a triangle is sum over i, j of 2 kappa K_ij g_i g_j^T, g_i the gradient of edge
 * i times d_i, and tensions s_i (membrane_matrix.c). With a_i = d_i.u_i and l_i the rest
 * lengths, |2 a_i a_j| <= a_i^2 l_j/l_i + a_j^2 l_i/l_j bounds it from above by springs along
 * the edges:
 *
 *   s = max(s_i, 0),   w = sqrt(2 kappa k_i) d_i,   k_i = sum over j of |K_ij| l_j / l_i
 *
 * summed over the triangles at an edge. Products with the matrix do not use them. */
#ifndef CS_MEMBRANE_SURROGATE_H
#define CS_MEMBRANE_SURROGATE_H

#include "model/elastic/membranes.h"

/* Makes the runs of all membranes. CS_ERR_MEMORY. */
enum cs_status cs_membrane_surrogate_build(struct cs_system *system, struct cs_error *error);

/* Edges of all membranes; 0 without any, or without a solver. */
uint32_t cs_membrane_surrogate_count(const struct cs_system *system);

/* Sets the factors of the runs (4 doubles a spring, as cs_springs_factor) for the matrix kept
 * last. All threads. */
void cs_membrane_surrogate_factor(const struct cs_system *system, double *factors);

#endif

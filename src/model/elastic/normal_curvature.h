/* normal_curvature.h - bending by the curvature along the normal of a stencil: of bodies that
 * are curved at rest, and the damping of all.
 *
 * With the vectors k_a of bendings.h, two differences d, e across the stencil, and the length
 * L0 of their cross product at rest:
 *
 *   n = d x e/L    kappa_a = k_a.n   its rate  kappa_a' = k_a'.n + k_a.n'
 *   s_a = kappa_a - rest_a   (0 for a body that is flat at rest: bendings.h has its energy)
 *   W   = A/2 sum of D_ab s_a s_b      M_a = A sum of D_ab (s_b + tau kappa_b')
 *   f_j = -sum of b_aj M_a n           and on the ends of d and e  -e x m,  -m x d
 *   m   = sum of M_a (k_a - c kappa_a n)/L
 *
 *   flat at rest     L = L0,                              c = 0
 *   curved at rest   L^2 = c (|d x e|^2 + q L0^2),        c = 1/(1 + q),  q = 1/100
 *
 * The forces are M times the gradients of kappa, which no rigid motion changes: they have no
 * moment, and damping brakes no sheet that turns. L never vanishes, so no state is singular
 * (docs/notes/singular-states.md bounds the rate of the damping). Of a flat sheet kappa is a
 * polynomial. A curved one cannot have L0: its curvature would change with stretch alone, and a
 * cylinder would buckle at a load that falls as the mesh is refined. A hinge of angle theta
 * counts as sin(theta): a mesh folded by more than a right angle at an edge yields. (Curvature
 * by heights over a triangle: Onate, Flores 2005.) */
#ifndef CS_NORMAL_CURVATURE_H
#define CS_NORMAL_CURVATURE_H

#include "model/elastic/bendings.h"

/* Allocates what bodies need that are curved or damped; nothing without one. CS_ERR_MEMORY. */
enum cs_status cs_normal_curvature_build(struct cs_system *system, struct cs_error *error);

/* Computes the forces on the points of all stencils for the chosen parts, with at->dx or at->dv
 * their derivative, by all threads. */
void cs_normal_curvature_prepare(const struct cs_system *system, const struct cs_eval *at);
/* Likewise a product of the matrix kept last and p; elastic: without its damping. */
void cs_normal_curvature_prepare_product(const struct cs_system *system, const double *p,
                                         bool elastic);
/* y (3,n) += factor times what was computed last, at a block. */
void cs_normal_curvature_add(const struct cs_system *system, const struct cs_block *block,
                             double factor, double *y);

/* Energy in J of the bodies that are curved at rest. */
double cs_normal_curvature_energy(const struct cs_system *system, const double *x);
/* Adds row sums at a state. */
void cs_normal_curvature_add_bound(const struct cs_system *system, const double *x,
                                   double *stiffness, double *damping);
/* Sets the diagonal blocks (6,n) of cd df/dv + ck df/dx at the matrix's state, and stores the
 * state if it is kept; with matrix->bound and not kept, their upper bound. */
void cs_normal_curvature_prepare_matrix(const struct cs_system *system,
                                        const struct cs_matrix *matrix, bool kept);

#endif

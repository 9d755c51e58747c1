/* normal_stencil.h - bending by normals: one stencil, its curvatures, and the forces on its
 * points with their derivative. */
#ifndef CS_NORMAL_STENCIL_H
#define CS_NORMAL_STENCIL_H

#include "model/elastic/bendings.h"

/* q of the formulas below: with stretch alone kappa changes by 1 % of what it would with L0. */
#define CS_NORMAL_FLOOR 0.01

/* Numbers of a stencil's forces. */
enum { CS_NORMAL_FORCES = 3 * CS_BENDING_POINTS };

/* Sums of weights times a vector of positions or velocities, and the two differences. */
struct cs_normal_sums {
    double k[3][3], d[2][3];
};

/* A stencil at a state. */
struct cs_normal_state {
    struct cs_normal_sums x, v;
    double length;           /* m2: L of the formulas below */
    double length_slope;     /* c there: L changes by c n.(change of d x e) */
    double normal[3];        /* n */
    double rate[3], turn[3]; /* of d x e in m2/s, and of n in 1/s */
    double kappa[3], kappa_rate[3];
};

/* Moments M = A D (kappa (kappa_a - rest_a) + rate kappa_a'), and in a derivative their change
 * A D (change d kappa_a + change_rate d kappa_a'). */
struct cs_normal_factors {
    double kappa, rate, change, change_rate;
};

/* Sums of an array (3,n); NULL: 0. */
void cs_normal_stencil_sums(const struct cs_bending_stencil *of, size_t n, const double *p,
                            struct cs_normal_sums *sums);
/* v may be NULL: 0. */
void cs_normal_stencil_state(const struct cs_bending_stencil *of, size_t n, const double *x,
                             const double *v, struct cs_normal_state *state);
/* A D times the curvatures less those at rest, and their rates, by the factors. */
void cs_normal_stencil_moments(const struct cs_bending_stencil *of,
                               const struct cs_normal_state *state, struct cs_normal_factors by,
                               double M[3]);
/* Forces on the points, times -1. */
void cs_normal_stencil_force(const struct cs_bending_stencil *of,
                             const struct cs_normal_state *state, struct cs_normal_factors by,
                             double out[CS_NORMAL_FORCES]);
/* Their change with positions by dx and velocities by dv. */
void cs_normal_stencil_derivative(const struct cs_bending_stencil *of,
                                  const struct cs_normal_state *state,
                                  struct cs_normal_factors by, const struct cs_normal_sums *dx,
                                  const struct cs_normal_sums *dv,
                                  double out[CS_NORMAL_FORCES]);

/* Bending by the curvature along the normal of a stencil: of bodies that
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

/* Sets the diagonal blocks (6,n) of cd df/dv + ck df/dx at the matrix's state, and stores the
 * state if it is kept; with matrix->bound and not kept, their upper bound. */
void cs_normal_curvature_prepare_matrix(const struct cs_system *system,
                                        const struct cs_matrix *matrix, bool kept);

/* Energy and bounds of bending. */

/* Energy in J. */
double cs_bendings_energy(const struct cs_system *system, const double *x);

/* Adds the row sums at positions x to stiffness (n) in N/m and damping (n) in N s/m. */
void cs_bendings_add_bound(const struct cs_system *system, const double *x, double *stiffness,
                           double *damping);

/* Finds diagonal and row sums of K where the moduli are not those that they were found for. */
void cs_bendings_update_rows(const struct cs_system *system);

/* Forces of bending, and their matrix. */

/* Computes the forces on stencils for the chosen parts, with at->dx or at->dv their derivative,
 * by all threads. */
void cs_bendings_prepare(const struct cs_system *system, const struct cs_eval *at);
/* f (3,n) += what was computed last, at a block. */
void cs_bendings_add(const struct cs_system *system, const struct cs_eval *at, double *f);

/* The part of the solver's matrix, cd df/dv + ck df/dx: as in membrane_forces.h. */
void cs_bendings_prepare_matrix(const struct cs_system *system, const struct cs_matrix *matrix,
                                bool kept);
void cs_bendings_add_blocks(const struct cs_system *system, const struct cs_matrix *matrix,
                            size_t begin, size_t end, double *blocks);
void cs_bendings_add_product(const struct cs_system *system, const double *p, double *y);
void cs_bendings_add_approach(const struct cs_system *system, const struct cs_matrix *matrix,
                              double *y);

#endif

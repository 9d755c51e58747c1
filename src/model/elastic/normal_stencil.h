/* normal_stencil.h - one stencil of normal_curvature.h: its curvatures, and the forces on its
 * points with their derivative. */
#ifndef CS_NORMAL_STENCIL_H
#define CS_NORMAL_STENCIL_H

#include "model/elastic/bendings.h"

/* q of normal_curvature.h: with stretch alone kappa changes by 1 % of what it would with L0. */
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
    double length;           /* m2: L of normal_curvature.h */
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

#endif

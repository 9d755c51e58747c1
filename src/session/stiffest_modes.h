/* stiffest_modes.h - finds the stiffest modes of a system, which limit the step: their
 * frequency and damping.
 *
 * K = -df/dx and C = -df/dv are the matrices of springs, dampers, drag and contact by force at
 * one state with zero velocity; friction is in its static state. For p of unit length in the
 * masses, p^T M p = 1, the Rayleigh quotients
 *   square = p^T K p,  rate = p^T C p
 * describe a motion along p: s'' + rate s' + square s = 0.
 *
 * The wanted p maximises a square + b rate. It belongs to the largest eigenvalue of the pencil
 * (a K + b C, M), or with q = M^1/2 p to that of the symmetric matrix
 *   A = M^-1/2 (a K + b C) M^-1/2.
 * Pinned particles have inverse mass 0, hence zero rows and columns in A.
 *
 * By Courant's minimax principle a Rayleigh quotient never exceeds the largest eigenvalue. The
 * search therefore approaches the eigenvalue from below, and the step limit from above. */
#ifndef CS_STIFFEST_MODES_H
#define CS_STIFFEST_MODES_H

#include "model/system/particle_system.h"

/* A direction of motion, described by its Rayleigh quotients. */
struct cs_mode {
    double omega_squared; /* 1/s2; below 0: the state is not stable there */
    double damping_rate;  /* 1/s */
    uint32_t particle;    /* that moves most */
    double participation; /* of the motion's kinetic energy in it, 0..1 */
};

/* Memory of the search; zeroed: empty. */
struct cs_stiffest_modes {
    struct cs_system *system; /* borrowed; products give it another scene for their time */
    double t;                 /* s, at which forces are taken */
    double *basis;            /* (CS_STIFFEST_MODES_BASIS + 1, 3n) */
    double *dx, *dv, *zeros;  /* (3,n) each: arguments of the products */
    double *root;             /* (n) root of 1/m */
    double *last_vector;      /* (3,n) the motion found last, where the next starts */
    bool has_start;
    double pass_seconds, *pot; /* nominal s of a product, and where it is subtracted, or NULL */
    struct cs_arena arena;
};
/* Vectors of the Krylov space per restart; each costs one product with the Jacobian and one
 * (3,n) array. */
enum { CS_STIFFEST_MODES_BASIS = 24 };

/* Allocates for the particles of the system, which is borrowed. Returns CS_ERR_MEMORY; the
 * object is then empty. */
enum cs_status cs_stiffest_modes_init(struct cs_stiffest_modes *modes, struct cs_system *system,
                                      struct cs_error *error);
/* Frees all arrays; a zeroed object is allowed. */
void cs_stiffest_modes_finish(struct cs_stiffest_modes *modes);

/* Finds the motion with the largest a square + b rate at the positions x (3,n) in m, without
 * smooth friction.
 *
 * Power iteration accelerated over its Krylov space (Lanczos 1950; Golub and Van Loan 2013, ch.
 * 10), restarted with the best vector until the value changes by less than a relative 1e-4.
 * Starts from the result of the last search, with a little noise. Uses + - * / sqrt only, so
 * all machines get the same bits. Does not fail: without free particles all figures are 0. */
struct cs_mode cs_stiffest_modes_largest(struct cs_stiffest_modes *modes, const double *x,
                                         double a, double b);

#endif

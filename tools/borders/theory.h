/* theory.h - computes the largest stable step of a method on a system by linear theory.
 *
 * The system is linearised at one state: M x'' + C x' + K x = 0. Along a direction p of unit
 * length in the masses the motion is a damped oscillator with square = p^T K p and rate = p^T C
 * p (stiffest_modes.h). The reduction is exact where p is an eigenvector of both matrices, for
 * example without damping. Elsewhere it is the Rayleigh-Ritz projection on one degree of
 * freedom.
 *
 * A step h is stable for the oscillator if the point (h^2 square, h rate) is in a set S of the
 * plane. S depends on the method only; its border is measured by theory.h. The limit of
 * the system is the smallest limit over all p.
 *
 * The mode with the smallest limit is not always the fastest one. explicit-euler for example
 * has the border h square = rate: the mode with the least damping for its stiffness limits it.
 * Therefore the search follows the outward normal (n1, n2) of S at the current border point.
 * For fixed h and convex S the worst p maximises
 *   n1 h^2 p^T K p + n2 h p^T C p,
 * the largest eigenvalue of a K + b C with a = n1 h^2 and b = n2 h. The search alternates
 * between this eigenvalue problem and the normal at the new limit.
 *
 * Smooth friction is left out of modes, dampers of contact are not. Its slope is up to mu
 * N/ev, but its force is bounded by mu N: whatever the step h, it changes a velocity by mu N
 * h/m at most, which is mu times what the load does. In steps that are too long for it a
 * velocity along the surface turns round in each, and stays at half of that change. */
#ifndef CS_THEORY_H
#define CS_THEORY_H

#include "base/status.h"
#include "session/stiffest_modes.h"

/* Measures the amplification matrix of one step of a method on a damped
 * oscillator.
 *
 * A one-step method maps (s, h w), with w = s', linearly on s'' + rate s' + square s = 0:
 *   (s, h w)' = A(z1, z2) (s, h w),  z1 = h^2 square,  z2 = h rate,
 * with a 2x2 matrix A that depends on the two products only. The step is stable if the spectral
 * radius of A is at most 1. Two examples:
 *
 *   velocity-verlet, z2 = 0:  A = (1 - z1/2, 1; -z1 (1 - z1/4), 1 - z1/2)
 *   explicit-euler:           A = (1, 1; -z1, 1 - z2)
 * The first has determinant 1 and is stable while |trace| <= 2, that is for h <= 2 /
 * sqrt(square). The second has determinant 1 - z2 + z1: without damping no step is stable, with
 * it h <= rate / square is necessary.
 *
 * A is measured, not derived: a spring between a pinned and a free particle is stepped by the
 * method itself, once from each unit vector. The results are the columns of A. Nothing has to
 * be known about the method, and theory describes the code that runs.
 *
 * If two steps differ from A^2, the method remembers more than the state (velocity-verlet keeps
 * an acceleration, a multistep method past states). Then the matrix between steps 8 and 24 is
 * measured, when the start is forgotten: its spectral radius is the 16th power of the growth
 * per step. */

/* The method whose steps are measured. */
struct cs_amplification {
    const struct cs_integrator *integrator; /* borrowed */
    const void *options;                    /* filled; borrowed; its dt is not used */
    double growth; /* 1/s, of a motion that still counts as stable; 0: none */
    double *pot;   /* where the nominal s of measurements are subtracted, or NULL */
};

/* Measures the spectral radius of A for a step of h s, square in 1/s2, rate in 1/s: the largest
 * growth per step. *radius is HUGE_VAL if the method blows up or fails. Returns CS_ERR_SCENE if
 * the method refuses the scene, or CS_ERR_MEMORY. */
enum cs_status cs_amplification_measure(const struct cs_amplification *amplification, double h,
                                        double square, double rate, double *radius,
                                        struct cs_error *error);

/* Finds the largest stable step in s for one oscillator. A geometric search with the factor
 * 2^(1/4) from 1e-4 / w, where w = max(sqrt(square), rate), finds the first unstable step; 12
 * bisections refine it to (2^(1/4) - 1) / 2^12 = 5e-5 of itself. *limit is 0 if already the
 * shortest step is unstable, and HUGE_VAL if none is up to 1e4 / w. */
enum cs_status cs_amplification_limit(const struct cs_amplification *amplification,
                                      double square, double rate, double *limit,
                                      struct cs_error *error);

/* Search state of the limits of one method on one system. */
struct cs_theory {
    /* the method, and the growth rate that still counts as stable */
    struct cs_amplification amplification;
    /* the system, and the workspace of the eigenvalue search */
    struct cs_stiffest_modes modes;
    /* (a, b) of the eigenvalue search: a square + b rate is maximised; |a| + |b| / h = 1 */
    double stiffness_damping_direction[2];
};

/* A step limit and the motion that sets it. */
struct cs_theory_limit {
    double dt; /* s; 0: no step is stable; HUGE_VAL: theory knows no limit */
    struct cs_mode mode;
};

/* Allocates the workspace. integrator, options and system are borrowed. growth in 1/s: slower
 * growth of a mode counts as stable; 0: none does.
 *
 * The system is read at each request of a limit. It may be rebuilt in between from the same
 * scene. Returns CS_ERR_MEMORY; the object is then empty. */
enum cs_status cs_theory_init(struct cs_theory *theory, struct cs_system *system,
                              const struct cs_integrator *integrator, const void *options,
                              double growth, struct cs_error *error);

/* Frees the workspace; a zeroed object is allowed. */
void cs_theory_finish(struct cs_theory *theory);

/* Lowers *dt (s) to the limit by Gershgorin bounds, with and without damping, whichever is
 * smaller.
 *
 * The bounds of springs and dampers hold while no spring is shorter than half its rest length.
 * The bound of contact by force holds at the positions x (3,n) in m, with friction in its
 * static state. Needs no eigenvalue search and is never longer than the limit of the worst mode
 * within these bounds. Errors: those of cs_amplification_limit; *dt is then unchanged. */
enum cs_status cs_theory_gershgorin(struct cs_theory *theory, const double *x, double *dt,
                                    struct cs_error *error);

/* Finds at the positions x (3,n) in m the motion with the smallest limit. Two searches start
 * from pure damping (a, b) = (0, 1) and pure stiffness (1, 0); the smaller result wins. *limit
 * has dt = HUGE_VAL if no motion has a limit. Errors: those of cs_amplification_limit; *limit
 * is then undefined. */
enum cs_status cs_theory_at(struct cs_theory *theory, const double *x,
                            struct cs_theory_limit *limit, struct cs_error *error);

/* Lowers *limit if a motion at x has a smaller one. Costs one search, from the direction and
 * mode of the last one: meant for successive states of a trajectory. with_dampers: those of
 * contact are searched by themselves too. Without a finite limit nothing happens. */
enum cs_status cs_theory_tighten(struct cs_theory *theory, const double *x, bool with_dampers,
                                 struct cs_theory_limit *limit, struct cs_error *error);

#endif

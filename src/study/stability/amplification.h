/* amplification.h - measures the amplification matrix of one step of a method on a damped
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
#ifndef CS_AMPLIFICATION_H
#define CS_AMPLIFICATION_H

#include "base/status.h"

#include <clothsim/integrator.h>

/* The method whose steps are measured. */
struct cs_amplification {
    const struct cs_integrator *integrator; /* borrowed */
    const void *options;                    /* filled; borrowed; its dt is not used */
    double growth; /* 1/s, of a motion that still counts as stable; 0: none */
};

/* Measures the spectral radius of A for a step of h s, square in 1/s2, rate in 1/s: the largest
 * growth per step. *radius is HUGE_VAL if the method blows up or fails. Returns CS_ERR_SCENE if
 * the method refuses the scene, or CS_ERR_MEMORY. */
enum cs_status cs_amplification_measure(const struct cs_amplification *amplify, double h,
                                        double square, double rate, double *radius,
                                        struct cs_error *error);

/* Finds the largest stable step in s for one oscillator. A geometric search with the factor
 * 2^(1/4) from 1e-4 / w, where w = max(sqrt(square), rate), finds the first unstable step; 12
 * bisections refine it to (2^(1/4) - 1) / 2^12 = 5e-5 of itself. *limit is 0 if already the
 * shortest step is unstable, and HUGE_VAL if none is up to 1e4 / w. */
enum cs_status cs_amplification_limit(const struct cs_amplification *amplify, double square,
                                      double rate, double *limit, struct cs_error *error);

/* Outward normal of the stable set in the plane (h^2 square, h rate) near its border: the
 * gradient of the spectral radius by forward differences of 1 %. Not scaled; infinite or NAN
 * where the method blows up. square > 0. */
enum cs_status cs_amplification_normal(const struct cs_amplification *amplify, double h,
                                       double square, double rate, double normal[2],
                                       struct cs_error *error);

#endif

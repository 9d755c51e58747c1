/* amplification.h - what one step of a method does to a damped oscillator, measured.
 *
 * A spring between a pinned and a free particle is stepped by the method itself: the columns of
 * the 2x2 matrix that takes (s, h w) to the next step are two such runs. Nothing has to be
 * known of the method, and what is compared with theory is the code that runs. Where two steps
 * are not the square of one, the method remembers more than the state (velocity-verlet keeps an
 * acceleration): then the matrix is that between steps 8 and 24.
 */
#ifndef CS_AMPLIFICATION_H
#define CS_AMPLIFICATION_H

#include "base/status.h"

#include <clothsim/integrator.h>

struct cs_amplification {
    const struct cs_integrator *integrator; /* borrowed */
    const void *options;                    /* filled; borrowed; its dt is not used */
    double growth; /* 1/s, of a motion that still counts as stable; 0: none */
};

/* Largest growth of |(s, h w)| in one step of length h on s'' + rate s' + square s = 0, the
 * spectral radius of the matrix; HUGE_VAL where the method blows up or fails.  CS_ERR_SCENE or
 * CS_ERR_MEMORY. */
enum cs_status cs_amplification_measure(const struct cs_amplification *amplify, double h,
                                        double square, double rate, double *radius,
                                        struct cs_error *error);

/* The largest stable step for one oscillator: found between powers of 2^(1/4), then bisected.
 * 0: no step is stable; HUGE_VAL: none found that is not, up to 1e4 / w. */
enum cs_status cs_amplification_limit(const struct cs_amplification *amplify, double square,
                                      double rate, double *limit, struct cs_error *error);

/* Outward normal (a, b) of the stable set of the plane (h^2 square, h rate) near its border. */
enum cs_status cs_amplification_normal(const struct cs_amplification *amplify, double h,
                                       double square, double rate, double normal[2],
                                       struct cs_error *error);

#endif

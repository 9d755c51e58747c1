/* spectral_bounds.h - bounds on frequencies and damping rates, for automatic steps.
 *
 * Gershgorin's theorem with 3x3 blocks instead of numbers (Golub, Van Loan 2013): every
 * eigenvalue of M^-1 K has a magnitude of at most
 *
 *   max over the particles i of (sum over j of |K_ij|) / m_i
 *
 * with the spectral norm of the blocks. omega^2 is that of K = df/dx, and delta is half of that
 * of df/dv: the modes of M x'' = K x + D x' have angular frequencies of at most omega and
 * damping rates of at most 2 delta. */
#ifndef CS_SPECTRAL_BOUNDS_H
#define CS_SPECTRAL_BOUNDS_H

#include "model/system/system.h"

/* Bounds from all forces, omega in 1/s and delta in 1/s. at: at that state; NULL: for the whole
 * run, as far as forces have such bounds (springs of at least half their rest length, dampers,
 * drag). work has 2n doubles. */
void cs_spectral_bounds_at(const struct cs_system *system, const struct cs_eval *at,
                           double *work, double *omega, double *delta);

/* The view's bounds, increased by those of forces that have bounds only at a state
 * (add_state_bound without add_bound in struct cs_term), such as contact. work as above. */
void cs_spectral_bounds_rate(const struct cs_system *system, const struct cs_eval *at,
                             double *work, double *omega, double *delta);
/* Tells whether the scene has such forces. */
bool cs_spectral_bounds_depend_on_state(const struct cs_system *system);

/* Sets view.omega and view.delta to the bounds for the whole run. */
void cs_spectral_bounds_set(struct cs_system *system, double *work);

#endif

/* step_limit.h - admissible fraction of a step with respect to unresolved contact and to
 * surface crossings. */
#ifndef CS_STEP_LIMIT_H
#define CS_STEP_LIMIT_H

#include "base/text.h"
#include "model/system/particle_system.h"

/* Returns whether contact by force or crossings limit steps; otherwise every step may be whole.
 */
bool cs_step_limit_applies(const struct cs_system *system);

/* Admissible fraction of the step from x0 (3,n) at t0 to x1 at t1: 1, or less if it must be
 * rejected. Unresolved contact gives 0.5, a step to try next, because it has no fraction of its
 * own; it is not tested if t1 is t0, as within an iteration. */
double cs_step_limit_fraction(const struct cs_system *system, double t0, const double *x0,
                              double t1, const double *x1);

/* Returns whether contact ran out of memory: forces are incomplete, and the run must end. */
bool cs_step_limit_failed(const struct cs_system *system);

/* Returns whether the scene ends the run at the first crossing and x (3,n) at t has one. Then
 * one line about it is appended to *why. */
bool cs_step_limit_ends_run(const struct cs_system *system, double t, const double *x,
                            struct cs_text *why);

#endif

/* strain_limit.h - strain limiting after a step. */
#ifndef CS_STRAIN_LIMIT_H
#define CS_STRAIN_LIMIT_H

#include "model/system/system.h"

/* Shortens every stretch spring of a body with a strain limit that is longer than strain_limit
 * times its rest length: both ends move along it by their inverse masses (Provot 1995; cloth
 * thesis, sec. 5.3), and their velocities change by the move over dt or the time of a frame,
 * whichever is longer, so that a sheet too weak for its weight is held, and a short step of an
 * adaptive method does not turn a small move into a blow. At most strain_limit_sweeps passes,
 * every other one backwards; fewer where a pass finds nothing. A pass goes over a grid as
 * strain_limit_grid.h says, over a mesh in the order of forces. Returns the number of moves.
 *
 * Stretch springs only: with shear and bend springs limited too, the passes work against each
 * other and pump energy into a hanging sheet at dt = 1/60. */
uint64_t cs_strain_limit_apply(const struct cs_system *system, double dt, double *x, double *v);

#endif

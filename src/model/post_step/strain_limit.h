/* strain_limit.h - limits the strain of stretch springs after a step (Provot 1995). */
#ifndef CS_STRAIN_LIMIT_H
#define CS_STRAIN_LIMIT_H

#include "model/system/system.h"

/* Shortens every stretch spring of a body with a strain limit that is longer than strain_limit
 * times its rest length. Its ends move along it by their inverse masses (Provot 1995; cloth
 * thesis, sec. 5.3):
 *
 *   x_a += w_a (l - s L) / (w_a + w_b) u,   x_b -= w_b (l - s L) / (w_a + w_b) u
 *
 * Velocities change by the displacement over max(dt, a frame): a sheet too weak for its weight
 * is held, and a short step of an adaptive method does not turn a small displacement into a
 * blow. At most strain_limit_sweeps passes, every other one backwards; fewer if a pass finds
 * nothing. A pass over a grid has the order of strain_limit_grid.h, over a mesh that of the
 * springs. Returns the number of corrections. x, v (3,n) in m and m/s are changed in place.
 *
 * Only stretch springs are limited: with shear and bend springs too, the passes work against
 * each other and pump energy into a hanging sheet at dt = 1/60 s. */
uint64_t cs_strain_limit_apply(const struct cs_system *system, double dt, double *x, double *v);

#endif

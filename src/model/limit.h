/* limit.h - strain limiting after a step. */
#ifndef CS_LIMIT_H
#define CS_LIMIT_H

#include "model/system.h"

/* Shortens, spring by spring in the order of forces, every spring of a body with a strain limit
 * that is longer than strain_limit times its rest length: both ends move along it by their
 * inverse masses (Provot 1995; cloth thesis, sec. 5.3), and their velocities change by the move
 * over dt. At most strain_limit_sweeps passes; fewer where a pass finds nothing. Returns the
 * number of moves. */
uint64_t cs_limit_apply(const struct cs_system *system, double dt, double *x, double *v);

#endif

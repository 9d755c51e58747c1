/* bounds.h - how stiff a system is at rest, for automatic steps. */
#ifndef CS_BOUNDS_H
#define CS_BOUNDS_H

#include "model/system/system.h"

/* Sets view.omega and view.delta by row sums (Gershgorin): omega^2 = max over free particles of
 * 2 sum k / m, valid while no spring is shorter than half its rest length; delta = max of
 * (sum d + drag / 2) / m, for half the largest damping rate. work has 2n doubles. */
void cs_bounds_set(struct cs_system *system, double *work);

#endif

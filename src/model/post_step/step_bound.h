/* step_bound.h - longest step for which projection stays a small correction. */
#ifndef CS_STEP_BOUND_H
#define CS_STEP_BOUND_H

#include "model/contact/posed_collider.h"

/* Admissible depth in m behind a surface after a step: a tenth of the shortest spring. HUGE_VAL
 * without springs, because nothing is deformed by a push then. */
double cs_step_bound_depth(const struct cs_system *system);

/* Longest step in s from (x, v) after which no free particle is deeper than `depth` behind a
 * collider of `colliders` (scene->colliders.n, at the same time), or than it is already plus
 * `depth`. Each particle is taken to fall freely and straight towards the surface. HUGE_VAL if
 * none approaches. */
double cs_step_bound_step(const struct cs_system *system,
                          const struct cs_posed_collider *colliders, double depth,
                          const double *x, const double *v);

#endif

/* step_bound.h - how far a step may go before contact has too much to undo. */
#ifndef CS_STEP_BOUND_H
#define CS_STEP_BOUND_H

#include "model/contact/posed_collider.h"

/* Depth in m to which a step may bring a particle behind a surface: a tenth of the shortest
 * spring. HUGE_VAL without springs: nothing is then pushed out of shape. */
double cs_step_bound_depth(const struct cs_system *system);

/* Longest step in s from (x, v) at t after which no free particle is deeper than `depth`, or
 * than it is and `depth` more, behind an obstacle of obstacles (scene->colliders.n, at t), were
 * each to fall freely and straight towards it. HUGE_VAL: none comes nearer. */
double cs_step_bound_step(const struct cs_system *system,
                          const struct cs_posed_collider *colliders, double depth,
                          const double *x, const double *v);

#endif

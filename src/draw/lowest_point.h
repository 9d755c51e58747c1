/* lowest_point.h - how low the bodies of a scene can come. */
#ifndef CS_DRAW_LOWEST_POINT_H
#define CS_DRAW_LOWEST_POINT_H

#include "model/contact/posed_collider.h"
#include "model/system/system.h"

/* The height in m that nothing of a scene goes below as long as its springs are at most a tenth
 * longer than at rest; obstacles (scene->colliders.n) at the start. NAN where something may
 * fall without end: a body that no pin holds, or that a release may set free. */
double cs_lowest_point(const struct cs_system *system,
                       const struct cs_posed_collider *colliders);

#endif

/* lowest_point.h - lower bound of the height that the bodies of a scene can reach. */
#ifndef CS_DRAW_LOWEST_POINT_H
#define CS_DRAW_LOWEST_POINT_H

#include "model/contact/posed_collider.h"
#include "model/system/system.h"

/* Returns a height in m that nothing of a scene falls below, as long as its springs are at most
 * a tenth longer than at rest; colliders (scene->colliders.n) at the start. NaN if something
 * may fall without end: a body that no pin holds, or that a release may set free. */
double cs_lowest_point(const struct cs_system *system,
                       const struct cs_posed_collider *colliders);

#endif

/* scene_extent.h - size of a scene: a bounding sphere, and the largest cell of its bodies. */
#ifndef CS_DRAW_SCENE_EXTENT_H
#define CS_DRAW_SCENE_EXTENT_H

#include "draw/view.h"
#include "model/contact/posed_collider.h"
#include "model/system/particle_system.h"

/* Returns a sphere around the particles at x (3,n) and the visible colliders
 * (scene->colliders.n) but planes: around their bounding box, with a radius of 1 mm at least.
 */
struct cs_bounding_sphere cs_scene_extent_solid(const struct cs_system *system, const double *x,
                                                const struct cs_posed_collider *colliders);

/* The largest distance of neighbours in the bodies at rest, in m; 0 for lone particles. */
double cs_scene_extent_cell(const struct cs_system *system);

#endif

/* body_pairs.h - pairs of surfaces of a scene that are in contact.
 *
 * Surfaces are numbered: first the bodies, then, if any collider is a mesh, all colliders.
 * Those of other shapes have no triangles and no pairs. */
#ifndef CS_SCENE_BODY_PAIRS_H
#define CS_SCENE_BODY_PAIRS_H

#include "scene/scene.h"

/* Returns the number of surfaces. */
uint32_t cs_scene_surfaces(const struct cs_scene *scene);
/* Returns the collider of a surface; NULL if it is a body. */
const struct cs_collider *cs_scene_obstacle(const struct cs_scene *scene, uint32_t surface);

/* Returns true if two surfaces, or one with itself, may be in contact; *friction is then the
 * coefficient of the pair. */
bool cs_scene_bodies_collide(const struct cs_scene *scene, uint32_t a, uint32_t b,
                             double *friction);
/* Returns true if any two may. */
bool cs_scene_has_body_contact(const struct cs_scene *scene);

#endif

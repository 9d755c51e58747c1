/* body_pairs.h - which surfaces of a scene keep off each other.
 *
 * The surfaces are the bodies and then, where a collider is a mesh, the colliders: those of
 * other kinds have no triangles. */
#ifndef CS_SCENE_BODY_PAIRS_H
#define CS_SCENE_BODY_PAIRS_H

#include "scene/scene.h"

/* Their number. */
uint32_t cs_scene_surfaces(const struct cs_scene *scene);
/* The collider that is a surface; NULL: a body is. */
const struct cs_collider *cs_scene_obstacle(const struct cs_scene *scene, uint32_t surface);

/* Whether two surfaces, or one with itself, keep off each other, and at which coefficient of
 * friction (where they do). */
bool cs_scene_bodies_collide(const struct cs_scene *scene, uint32_t a, uint32_t b,
                             double *friction);
/* Whether any do. */
bool cs_scene_has_body_contact(const struct cs_scene *scene);

#endif

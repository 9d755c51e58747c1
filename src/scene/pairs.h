/* pairs.h - which bodies of a scene keep off each other. */
#ifndef CS_SCENE_PAIRS_H
#define CS_SCENE_PAIRS_H

#include "scene/scene.h"

/* Whether two bodies, or one with itself, keep off each other, and at which coefficient of
 * friction (where they do). */
bool cs_scene_bodies_meet(const struct cs_scene *scene, uint32_t a, uint32_t b,
                          double *friction);
/* Whether any do. */
bool cs_scene_any_meet(const struct cs_scene *scene);

#endif

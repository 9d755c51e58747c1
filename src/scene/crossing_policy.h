/* crossing_policy.h - treatment of edges that go through triangles, as the scene wants it. */
#ifndef CS_SCENE_CROSSING_POLICY_H
#define CS_SCENE_CROSSING_POLICY_H

#include "scene/body_pairs.h"

/* Treatment of crossings; each includes the count but the first. */
enum cs_crossings_policy {
    CS_CROSSINGS_IGNORE, /* nothing: they are not looked for */
    CS_CROSSINGS_COUNT,  /* counted after each frame */
    CS_CROSSINGS_LIMIT,  /* counted, and steps that would make one are cut */
    CS_CROSSINGS_STOP    /* counted after each step: the first ends the run */
};

/* Returns true if the scene leaves it open and has bodies in contact: they get `limit`. */
static inline bool cs_scene_crossings_by_pairs(const struct cs_scene *scene) {
    return scene->crossings < 0 && cs_scene_has_body_contact(scene);
}

/* Returns the policy of a scene. */
static inline enum cs_crossings_policy cs_scene_crossings(const struct cs_scene *scene) {
    if (cs_scene_crossings_by_pairs(scene))
        return CS_CROSSINGS_LIMIT;
    return scene->crossings < 0 ? CS_CROSSINGS_IGNORE
                                : (enum cs_crossings_policy)scene->crossings;
}

#endif

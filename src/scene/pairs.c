/* Which bodies keep off each other, by the table of pairs and by each body's own key. */
#include "scene/pairs.h"

bool cs_scene_bodies_meet(const struct cs_scene *scene, uint32_t a, uint32_t b,
                          double *friction) {
    const struct cs_pair_keys *pairs = scene->pairs.list.items;
    const struct cs_body *body = cs_scene_bodies(scene) + a;
    if (a == b) {
        *friction = body->friction;
        return body->self_contact;
    }
    for (uint32_t p = 0; p < scene->pairs.list.n; p++) {
        const int64_t *bodies = pairs[p].bodies;
        if ((bodies[0] == a && bodies[1] == b) || (bodies[0] == b && bodies[1] == a)) {
            *friction = pairs[p].friction;
            return true;
        }
    }
    *friction = scene->pairs.friction;
    return scene->pairs.among == CS_PAIRS_ALL;
}

bool cs_scene_any_meet(const struct cs_scene *scene) {
    bool any =
        scene->pairs.list.n > 0 || (scene->pairs.among == CS_PAIRS_ALL && scene->bodies.n > 1);
    for (uint32_t b = 0; b < scene->bodies.n; b++)
        any = any || cs_scene_bodies(scene)[b].self_contact;
    return any;
}

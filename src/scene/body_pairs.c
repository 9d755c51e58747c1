/* Decides which surfaces are in contact: by the list of pairs, by each body's own key for
 * itself, and by the colliders that are meshes. */
#include "scene/body_pairs.h"

#include "mesh/vertex_paths.h"
#include "scene/body_keys.h"
#include "scene/collider_keys.h"
#include "scene/contact_keys.h"
#include "scene/event_key.h"
#include "scene/force_keys.h"

#include <math.h>

uint32_t cs_scene_surfaces(const struct cs_scene *scene) {
    for (uint32_t c = 0; c < scene->colliders.n; c++)
        if (cs_scene_colliders(scene)[c].mesh)
            return scene->bodies.n + scene->colliders.n;
    return scene->bodies.n;
}

bool cs_scene_carries_pins(const struct cs_scene *scene, bool by_key_frames) {
    const struct cs_collider *colliders = cs_scene_colliders(scene);
    for (uint32_t b = 0; b < scene->bodies.n; b++) {
        const struct cs_list *list = &cs_scene_bodies(scene)[b].pins;
        const struct cs_pin *pins = list->items;
        for (uint32_t p = 0; p < list->n; p++)
            if (pins[p].to && (!by_key_frames || colliders[pins[p].to->collider].paths))
                return true;
    }
    const struct cs_seam *seams = scene->seams.items;
    for (uint32_t s = 0; s < scene->seams.n; s++)
        if (seams[s].to.collider >= 0 &&
            (!by_key_frames || colliders[seams[s].to.collider].paths))
            return true;
    return false;
}

bool cs_scene_sews(const struct cs_scene *scene, bool to_collider) {
    const struct cs_seam *seams = scene->seams.items;
    uint32_t s = 0;
    while (s < scene->seams.n && (seams[s].to.collider >= 0) != to_collider)
        s++;
    return s < scene->seams.n;
}

bool cs_scene_has_key_frames(const struct cs_scene *scene) {
    bool any = false;
    for (uint32_t c = 0; c < scene->colliders.n; c++)
        any = any || cs_scene_colliders(scene)[c].paths;
    return any;
}

double cs_scene_key_frame_speed(const struct cs_scene *scene) {
    double most = 0;
    for (uint32_t c = 0; c < scene->colliders.n; c++) {
        const struct cs_vertex_paths *paths = cs_scene_colliders(scene)[c].paths;
        most = paths && paths->speed > most ? paths->speed : most;
    }
    return most;
}

const struct cs_collider *cs_scene_collider_at(const struct cs_scene *scene, uint32_t surface) {
    return surface < scene->bodies.n ? NULL
                                     : cs_scene_colliders(scene) + (surface - scene->bodies.n);
}

/* Contact of a body with a collider that is a mesh, with the collider's friction. */
static bool hits_obstacle(const struct cs_scene *scene, uint32_t a, uint32_t b,
                          double *friction) {
    const struct cs_collider *collider = cs_scene_collider_at(scene, a < b ? b : a);
    *friction = collider->friction;
    return collider->mesh && (a < scene->bodies.n || b < scene->bodies.n);
}

bool cs_scene_bodies_collide(const struct cs_scene *scene, uint32_t a, uint32_t b,
                             double *friction) {
    const struct cs_body_pair_keys *pairs = scene->pairs->list.items;
    if (a >= scene->bodies.n || b >= scene->bodies.n)
        return hits_obstacle(scene, a, b, friction);
    if (a == b) {
        *friction = cs_scene_bodies(scene)[a].friction;
        return cs_scene_bodies(scene)[a].self_contact;
    }
    for (uint32_t p = 0; p < scene->pairs->list.n; p++) {
        const int64_t *bodies = pairs[p].bodies;
        if ((bodies[0] == a && bodies[1] == b) || (bodies[0] == b && bodies[1] == a)) {
            *friction = pairs[p].friction;
            return true;
        }
    }
    *friction = scene->pairs->friction;
    return scene->pairs->among == CS_PAIRS_ALL;
}

bool cs_scene_has_body_contact(const struct cs_scene *scene) {
    bool any = scene->pairs->list.n > 0 ||
               (scene->pairs->among == CS_PAIRS_ALL && scene->bodies.n > 1) ||
               cs_scene_surfaces(scene) > scene->bodies.n;
    for (uint32_t b = 0; b < scene->bodies.n; b++)
        any = any || cs_scene_bodies(scene)[b].self_contact;
    return any;
}

bool cs_scene_sticks_to(const struct cs_scene *scene, uint32_t collider) {
    const struct cs_collider *to = cs_scene_colliders(scene) + collider;
    return scene->contact->law == CS_CONTACT_FORCE &&
           scene->contact->friction_law == CS_FRICTION_BRISTLES && !to->mesh &&
           cs_event_key_acts(scene, to->friction, ".friction");
}

bool cs_scene_has_friction(const struct cs_scene *scene) {
    const struct cs_body_pair_keys *pairs = scene->pairs->list.items;
    bool any = scene->pairs->friction > 0;
    for (uint32_t c = 0; c < scene->colliders.n; c++)
        any = any || cs_scene_colliders(scene)[c].friction > 0;
    for (uint32_t b = 0; b < scene->bodies.n; b++)
        any = any || cs_scene_bodies(scene)[b].friction > 0;
    for (uint32_t p = 0; p < scene->pairs->list.n; p++)
        any = any || pairs[p].friction > 0;
    return any;
}

bool cs_scene_friction_sticks(const struct cs_scene *scene) {
    for (uint32_t c = 0; c < scene->colliders.n; c++)
        if (cs_scene_sticks_to(scene, c))
            return true;
    return false;
}

void cs_scene_remove_corrections(struct cs_scene *scene) {
    if (scene->contact->law == CS_CONTACT_PROJECT)
        scene->colliders.n = 0;
    scene->forces->velocity_loss = 0;
    for (uint32_t b = 0; b < scene->bodies.n; b++)
        cs_scene_bodies(scene)[b].strain_limit = (double)NAN;
}

bool cs_scene_contact_is_force(const struct cs_scene *scene) {
    return scene->contact->law == CS_CONTACT_FORCE;
}

bool cs_scene_crossings_by_pairs(const struct cs_scene *scene) {
    return scene->crossings < 0 && cs_scene_has_body_contact(scene);
}

enum cs_crossings_policy cs_scene_crossings(const struct cs_scene *scene) {
    if (cs_scene_crossings_by_pairs(scene))
        return CS_CROSSINGS_LIMIT;
    return scene->crossings < 0 ? CS_CROSSINGS_IGNORE
                                : (enum cs_crossings_policy)scene->crossings;
}

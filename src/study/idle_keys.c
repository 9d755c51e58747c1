/* Finds keys that nothing reads in the scene that gives them.
 *
 * A key is given if its value is not the default. Each key of a scene belongs to one rule, the
 * first whose pattern begins its path, and the rule tells from the scene whether it acts. */
#include "study/idle_keys.h"

#include "base/options.h"
#include "scene/body_pairs.h"
#include "scene/event_key.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Tells whether a key acts; k: the first index of its path. */
typedef bool acts(const struct cs_scene *scene, uint32_t k);

static bool is_force(const struct cs_scene *scene) {
    return scene->contact.law == CS_CONTACT_FORCE;
}
static const struct cs_body *body_at(const struct cs_scene *scene, uint32_t k) {
    return cs_scene_bodies(scene) + k;
}

static bool springs_act(const struct cs_scene *scene, uint32_t k) {
    return !cs_scene_springs_left_out(body_at(scene, k));
}
static bool shear_acts(const struct cs_scene *scene, uint32_t k) {
    const struct cs_cloth *cloth = &body_at(scene, k)->cloth;
    return springs_act(scene, k) && cloth->present && cloth->grid[0] > 1 && cloth->grid[1] > 1;
}
static bool bend_acts(const struct cs_scene *scene, uint32_t k) {
    const struct cs_cloth *cloth = &body_at(scene, k)->cloth;
    return springs_act(scene, k) &&
           (!cloth->present || cloth->grid[0] > 2 || cloth->grid[1] > 2);
}
static bool damps(const struct cs_scene *scene, uint32_t k) {
    return springs_act(scene, k) &&
           cs_event_key_acts(scene, body_at(scene, k)->springs.damping, "springs.damping");
}
static bool limits_strain(const struct cs_scene *scene, uint32_t k) {
    return !isnan(body_at(scene, k)->strain_limit);
}
static bool meets_itself(const struct cs_scene *scene, uint32_t k) {
    return body_at(scene, k)->self_contact;
}
/* A body meets itself, another one or a mesh: then its surface has a thickness. */
static bool has_surface(const struct cs_scene *scene, uint32_t k) {
    double friction;
    bool any = false;
    for (uint32_t b = 0; b < scene->bodies.n + scene->colliders.n; b++)
        any = any || ((b < scene->bodies.n || cs_scene_obstacle(scene, b)->mesh.present) &&
                      cs_scene_bodies_collide(scene, k, b, &friction));
    return is_force(scene) && any;
}
static bool draws_nearest(const struct cs_scene *scene, uint32_t k) {
    return body_at(scene, k)->network.placement == CS_PLACEMENT_NEAREST;
}
static bool has_clusters(const struct cs_scene *scene, uint32_t k) {
    return body_at(scene, k)->shape_matching.clusters > 1;
}
static bool has_texture(const struct cs_scene *scene, uint32_t k) {
    return *body_at(scene, k)->material.texture;
}
static bool shines(const struct cs_scene *scene, uint32_t k) {
    return body_at(scene, k)->material.specular > 0;
}
static bool is_projected(const struct cs_scene *scene, uint32_t k) {
    (void)k;
    return !is_force(scene);
}
static bool is_drawn(const struct cs_scene *scene, uint32_t k) {
    return cs_scene_colliders(scene)[k].visible;
}
static bool has_contact(const struct cs_scene *scene, uint32_t k) {
    (void)k;
    return scene->colliders.n || cs_scene_has_body_contact(scene);
}
static bool is_contact_force(const struct cs_scene *scene, uint32_t k) {
    return is_force(scene) && has_contact(scene, k);
}
static bool is_smooth_friction(const struct cs_scene *scene, uint32_t k) {
    return is_contact_force(scene, k) && scene->contact.friction_law == CS_FRICTION_SMOOTH &&
           (cs_scene_has_friction(scene) || cs_event_key_changes(scene, "friction"));
}
static bool sticks(const struct cs_scene *scene, uint32_t k) {
    (void)k;
    return cs_scene_friction_sticks(scene);
}
static bool has_pairs(const struct cs_scene *scene, uint32_t k) {
    (void)k;
    return scene->bodies.n > 1;
}
static bool are_all_pairs(const struct cs_scene *scene, uint32_t k) {
    return has_pairs(scene, k) && scene->pairs.among == CS_PAIRS_ALL;
}
static bool has_drag(const struct cs_scene *scene, uint32_t k) {
    (void)k;
    return cs_event_key_acts(scene, scene->forces.drag, "forces.drag");
}
static bool blows(const struct cs_scene *scene, uint32_t k) {
    (void)k;
    bool any = cs_event_key_acts(scene, scene->forces.wind.strength, "forces.wind.strength");
    for (uint32_t e = 0; e < scene->events.n; e++)
        any = any || cs_scene_events(scene)[e].wind.present;
    return any;
}
static bool has_range(const struct cs_scene *scene, uint32_t k) {
    (void)k;
    return scene->render.look == CS_LOOK_FORCE || scene->render.look == CS_LOOK_STRAIN;
}

static bool has_young(const struct cs_scene *scene, uint32_t k) {
    return !isnan(body_at(scene, k)->elastic.membrane.young);
}
static bool has_warp(const struct cs_scene *scene, uint32_t k) {
    return !isnan(body_at(scene, k)->elastic.membrane.warp);
}
static bool bends_alike(const struct cs_scene *scene, uint32_t k) {
    return !isnan(body_at(scene, k)->elastic.bending.stiffness);
}
static bool bends_by_warp(const struct cs_scene *scene, uint32_t k) {
    return !isnan(body_at(scene, k)->elastic.bending.warp);
}

/* acts NULL: always. In the order of the tables, single keys before the tables they are in. */
static const struct {
    const char *key;
    acts *acts;
    const char *expected;
} rules[] = {
    {"about", NULL, NULL},
    {"source", NULL, NULL},
    {"bodies[].cloth", NULL, NULL},
    {"bodies[].mesh", NULL, NULL},
    {"bodies[].network.candidates", draws_nearest, "it belongs to placement \"nearest\""},
    {"bodies[].network", NULL, NULL},
    {"bodies[].shape_matching.overlap", has_clusters, "it belongs to several clusters"},
    {"bodies[].shape_matching", NULL, NULL},
    {"bodies[].mass", NULL, NULL},
    {"bodies[].springs.shear", shear_acts, "there are no diagonal springs of a grid"},
    {"bodies[].springs.bend", bend_acts, "there are no such springs"},
    {"bodies[].springs.damping_model", damps, "springs.damping is 0"},
    {"bodies[].springs", springs_act,
     "elastic replaces the springs, and shape_matching without shape_matching.springs true"},
    {"bodies[].elastic.membrane.poisson", has_young, "it belongs to young"},
    {"bodies[].elastic.membrane.coupling", has_warp, "it belongs to warp"},
    {"bodies[].elastic.bending.poisson", bends_alike, "it belongs to stiffness"},
    {"bodies[].elastic.bending.coupling", bends_by_warp, "it belongs to warp"},
    {"bodies[].elastic", NULL, NULL},
    {"bodies[].pins", NULL, NULL},
    {"bodies[].self_contact", NULL, NULL},
    {"bodies[].thickness", has_surface,
     "the body meets no surface, expected self_contact true, pairs, or contact.law force with "
     "a mesh"},
    {"bodies[].friction", meets_itself,
     "it is of the body on itself, expected self_contact true; for other bodies "
     "pairs.friction, for obstacles colliders[].friction"},
    {"bodies[].strain_limit_sweeps", limits_strain, "expected strain_limit"},
    {"bodies[].strain_limit", NULL, NULL},
    {"bodies[].material.texture_repeat", has_texture, "expected material.texture"},
    {"bodies[].material.shininess", shines, "material.specular is 0"},
    {"bodies[].material", NULL, NULL},
    {"colliders[].absorption", is_projected,
     "it belongs to contact.law project; contact.damping slows a contact by force"},
    {"colliders[].colour", is_drawn, "visible is false"},
    {"colliders[]", NULL, NULL},
    {"contact.start", has_contact, "nothing is in contact, expected colliders or pairs"},
    {"contact.law", has_contact, "nothing is in contact, expected colliders or pairs"},
    {"contact.friction_speed", is_smooth_friction,
     "expected contact.law force, friction_law smooth and a coefficient of friction"},
    {"contact.friction_law", sticks, "expected friction on a collider that is no mesh"},
    {"contact", is_contact_force, "it belongs to contact.law force"},
    {"crossings", NULL, NULL},
    {"pairs.friction", are_all_pairs, "it belongs to pairs \"all\" of several bodies"},
    {"pairs", has_pairs, "the scene has one body, expected self_contact true"},
    {"forces.drag_unit", has_drag, "forces.drag is 0"},
    {"forces.wind", blows, "forces.wind.strength is 0"},
    {"forces", NULL, NULL},
    {"events[]", NULL, NULL},
    {"seams", NULL, NULL},
    {"time", NULL, NULL},
    {"camera", NULL, NULL},
    {"light", NULL, NULL},
    {"render.range", has_range, "it belongs to the looks \"force\" and \"strain\""},
    {"render", NULL, NULL},
};

int cs_idle_keys_rule(const char *key) {
    for (size_t r = 0; r < sizeof rules / sizeof *rules; r++) {
        const size_t length = strlen(rules[r].key);
        if (!strncmp(key, rules[r].key, length) && (!key[length] || strchr(".[", key[length])))
            return (int)r;
    }
    return -1;
}

/* A place in a scene: the path with its indices, and without. */
struct place {
    char path[CS_TEXT_MAX], key[CS_TEXT_MAX];
    uint32_t first; /* first index of the path */
};

static void print_rule(const struct cs_scene *scene, const struct place *at,
                       struct cs_text *out) {
    const int rule = cs_idle_keys_rule(at->key);
    if (rule >= 0 && rules[rule].acts && !rules[rule].acts(scene, at->first))
        cs_text_add(out, "%s has no effect: %s\n", at->path, rules[rule].expected);
}

/* True for a number that switches its key off: it may be so where there is nothing. */
static bool is_zero(const struct cs_option *row, const void *field) {
    double value = 1;
    if (row->type == CS_REAL)
        memcpy(&value, field, sizeof value);
    return value == 0;
}

static void walk(const struct cs_scene *scene, const struct cs_table *table, const void *object,
                 const struct place *above, struct cs_text *out);

/* Walks one row: a table, each element of a list, or a value. */
static void walk_row(const struct cs_scene *scene, const struct cs_option *row,
                     const void *object, const struct place *above, struct cs_text *out) {
    const void *field = (const char *)object + row->offset;
    const char *point = *above->path ? "." : "";
    const struct cs_list *list = field;
    struct place at = *above;
    snprintf(at.path, sizeof at.path, "%.200s%s%s", above->path, point, row->name);
    snprintf(at.key, sizeof at.key, "%.200s%s%s", above->key, point, row->name);
    if (row->type == CS_TABLE)
        walk(scene, row->table, field, &at, out);
    for (uint32_t k = 0; row->type == CS_LIST && k < list->n; k++) {
        struct place item = at;
        snprintf(item.path, sizeof item.path, "%.200s[%u]", at.path, k);
        snprintf(item.key, sizeof item.key, "%.200s[]", at.key);
        item.first = strchr(above->path, '[') ? above->first : k;
        walk(scene, row->table, (const char *)list->items + k * row->table->size, &item, out);
    }
    if (!row->table && !cs_option_is_default(row, object) && !is_zero(row, field))
        print_rule(scene, &at, out);
}

static void walk(const struct cs_scene *scene, const struct cs_table *table, const void *object,
                 const struct place *above, struct cs_text *out) {
    for (uint32_t r = 0; r < table->n; r++)
        if (cs_option_is_set(table->rows + r, object))
            walk_row(scene, table->rows + r, object, above, out);
}

void cs_idle_keys_print(const struct cs_scene *scene, struct cs_text *out) {
    walk(scene, &cs_scene_table, scene, &(struct place){0}, out);
}

/* Finds keys that nothing reads in the scene that gives them, and mistakes in paths.
 *
 * A key is given if its value is not the default. Each key of a scene belongs to one rule, the
 * first whose pattern begins its path, and the rule tells from the scene whether it acts.
 *
 * A grab's points are positions, a move's are shifts, unless `relative` says otherwise: a path
 * written as the other kind begins with a jump. A grabbed particle that is faster than waves in
 * its springs, c = L sqrt(k/m), stretches them to twice their length and more. */
#include "session/scene_findings.h"

#include "base/options.h"
#include "base/vec3.h"
#include "model/contact/posed_collider.h"
#include "model/event/event_state.h"
#include "scene/body_keys.h"
#include "scene/body_pairs.h"
#include "scene/collider_keys.h"
#include "scene/contact_keys.h"
#include "scene/event_key.h"
#include "scene/picture_keys.h"

#include <stdio.h>
#include <string.h>

/* Tells whether a key acts; k: the first index of its path. */
typedef bool acts(const struct cs_scene *scene, uint32_t k);

static bool is_force(const struct cs_scene *scene) {
    return scene->contact->law == CS_CONTACT_FORCE;
}
static const struct cs_body *body_at(const struct cs_scene *scene, uint32_t k) {
    return cs_scene_bodies(scene) + k;
}

/* Conditions of one value each: of the scene, or of its body k. */
#define OF_SCENE(name, condition)                                                              \
    static bool name(const struct cs_scene *scene, uint32_t k) {                               \
        return (void)k, condition;                                                             \
    }
#define OF_BODY(name, condition)                                                               \
    static bool name(const struct cs_scene *scene, uint32_t k) {                               \
        const struct cs_body *body = body_at(scene, k);                                        \
        return condition;                                                                      \
    }
OF_SCENE(is_projected, !is_force(scene))
OF_SCENE(has_contact, scene->colliders.n || cs_scene_has_body_contact(scene))
OF_SCENE(sticks, cs_scene_friction_sticks(scene))
OF_SCENE(has_pairs, scene->bodies.n > 1)
OF_SCENE(are_all_pairs, scene->bodies.n > 1 && scene->pairs->among == CS_PAIRS_ALL)
OF_SCENE(is_drawn, cs_scene_colliders(scene)[k].visible)
OF_SCENE(has_range, scene->render->look == CS_LOOK_FORCE ||
                        scene->render->look == CS_LOOK_STRAIN ||
                        scene->render->look == CS_LOOK_STRESS)
OF_SCENE(has_drag, cs_event_key_acts(scene, scene->forces->drag, "forces.drag"))
OF_SCENE(flows, scene->forces->wind.present && !isnan(scene->forces->wind.velocity[0]))
OF_BODY(springs_act, !cs_scene_springs_left_out(body))
OF_BODY(damps, springs_act(scene, k) &&
                   cs_event_key_acts(scene, body->springs.damping, "springs.damping"))
OF_BODY(limits_strain, !isnan(body->strain_limit))
OF_BODY(meets_itself, body->self_contact)
OF_BODY(draws_nearest, body->network.placement == CS_PLACEMENT_NEAREST)
OF_BODY(has_clusters, body->shape_matching.clusters > 1)
OF_BODY(has_texture, *body->material.texture)
OF_BODY(shines, body->material.specular > 0)
OF_BODY(has_young, !isnan(body->elastic.membrane.young))
OF_BODY(has_warp, !isnan(body->elastic.membrane.warp))
OF_BODY(bends_alike, !isnan(body->elastic.bending.stiffness))
OF_BODY(bends_by_warp, !isnan(body->elastic.bending.warp))
#undef OF_SCENE
#undef OF_BODY

static bool shear_acts(const struct cs_scene *scene, uint32_t k) {
    const struct cs_cloth *cloth = &body_at(scene, k)->cloth;
    return springs_act(scene, k) && cloth->present && cloth->grid[0] > 1 && cloth->grid[1] > 1;
}
static bool bend_acts(const struct cs_scene *scene, uint32_t k) {
    const struct cs_cloth *cloth = &body_at(scene, k)->cloth;
    return springs_act(scene, k) &&
           (!cloth->present || cloth->grid[0] > 2 || cloth->grid[1] > 2);
}
/* A body meets itself, another one or a mesh: then its surface has a thickness. */
static bool has_surface(const struct cs_scene *scene, uint32_t k) {
    double friction;
    bool any = false;
    for (uint32_t b = 0; b < scene->bodies.n + scene->colliders.n; b++)
        any = any || ((b < scene->bodies.n || cs_scene_collider_at(scene, b)->mesh) &&
                      cs_scene_bodies_collide(scene, k, b, &friction));
    return is_force(scene) && any;
}
static bool is_contact_force(const struct cs_scene *scene, uint32_t k) {
    return is_force(scene) && has_contact(scene, k);
}
static bool is_smooth_friction(const struct cs_scene *scene, uint32_t k) {
    return is_contact_force(scene, k) && scene->contact->friction_law == CS_FRICTION_SMOOTH &&
           (cs_scene_has_friction(scene) || cs_event_key_changes(scene, "friction"));
}
static bool has_samples(const struct cs_scene *scene, uint32_t k) {
    bool any = false;
    for (uint32_t c = 0; c < scene->colliders.n; c++)
        any = any || cs_shape_needs_points(cs_collider_shape(cs_scene_colliders(scene) + c));
    return any && is_contact_force(scene, k);
}
static bool blows(const struct cs_scene *scene, uint32_t k) {
    (void)k;
    bool any = flows(scene, k) ||
               cs_event_key_acts(scene, scene->forces->wind.strength, "forces.wind.strength");
    for (uint32_t e = 0; e < scene->events.n; e++)
        any = any || cs_scene_events(scene)[e].wind.present;
    return any;
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
    {"bodies[].pressure", NULL, NULL},
    {"bodies[].outer_pressure", NULL, NULL},
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
     "it belongs to contact.law project; contact.restitution acts in a contact by force"},
    {"colliders[].colour", is_drawn, "visible is false"},
    {"colliders[]", NULL, NULL},
    {"contact.start", has_contact, "nothing is in contact, expected colliders or pairs"},
    {"contact.untangle", has_contact, "expected colliders"},
    {"contact.law", has_contact, "nothing is in contact, expected colliders or pairs"},
    {"contact.friction_speed", is_smooth_friction,
     "expected contact.law force, friction_law smooth and a coefficient of friction"},
    {"contact.friction_law", sticks, "expected friction on a collider that is no mesh"},
    {"contact.sample_stretch", has_samples, "expected a sphere, capsule or box, by force"},
    {"contact", is_contact_force, "it belongs to contact.law force"},
    {"crossings", NULL, NULL},
    {"pairs.friction", are_all_pairs, "it belongs to pairs \"all\" of several bodies"},
    {"pairs", has_pairs, "the scene has one body, expected self_contact true"},
    {"forces.drag_unit", has_drag, "forces.drag is 0"},
    {"forces.wind.density", flows, "it belongs to forces.wind.velocity"},
    {"forces.wind.drag", flows, "it belongs to forces.wind.velocity"},
    {"forces.wind", blows, "forces.wind.strength is 0"},
    {"forces", NULL, NULL},
    {"events[]", NULL, NULL},
    {"seams", NULL, NULL},
    {"time", NULL, NULL},
    {"camera", NULL, NULL},
    {"light", NULL, NULL},
    {"lights[]", NULL, NULL},
    {"render.range", has_range, "it belongs to the looks \"force\", \"strain\" and \"stress\""},
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

/* True if all rules about a key and what is in it say that it always acts. */
static bool always_acts(const char *key) {
    bool found = false;
    for (size_t r = 0; r < sizeof rules / sizeof *rules; r++)
        if (!strncmp(rules[r].key, key, strlen(key))) {
            if (rules[r].acts)
                return false;
            found = true;
        }
    return found;
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
    const void *field = cs_option_value(row, object);
    const char *point = *above->path ? "." : "";
    const struct cs_list *list = field;
    struct place at = *above;
    if (!row->table && (cs_option_is_default(row, object) || is_zero(row, field)))
        return;
    snprintf(at.path, sizeof at.path, "%.200s%s%s", above->path, point, row->name);
    snprintf(at.key, sizeof at.key, "%.200s%s%s", above->key, point, row->name);
    // events and paths may be many
    if (row->table && always_acts(at.key))
        return;
    if (row->type == CS_TABLE && field)
        walk(scene, row->table, field, &at, out);
    for (uint32_t k = 0; row->type == CS_LIST && k < list->n; k++) {
        struct place item = at;
        snprintf(item.path, sizeof item.path, "%.200s[%u]", at.path, k);
        snprintf(item.key, sizeof item.key, "%.200s[]", at.key);
        item.first = strchr(above->path, '[') ? above->first : k;
        walk(scene, row->table, (const char *)list->items + k * row->table->size, &item, out);
    }
    if (!row->table)
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

/* A first leg longer than the obstacle within so many frames is a jump. */
#define JUMP_FRAMES 1.5

void cs_findings_print(const struct cs_system *system, uint32_t n, cs_finding *check,
                       const void *arg, struct cs_text *out) {
    struct cs_text line = {0};
    uint32_t more = 0;
    for (uint32_t k = 0; k < n; k++) {
        struct cs_text found = {0};
        check(system, k, arg, line.length ? &found : &line);
        more += found.length > 0;
        line.failed |= found.failed;
        cs_text_finish(&found);
    }
    if (line.length && more)
        cs_text_add(&line, "; the same holds for %u more", more);
    if (line.length)
        cs_text_add(out, "%s\n", cs_text_get(&line));
    out->failed |= line.failed;
    cs_text_finish(&line);
}

double cs_findings_first_speed(const struct cs_event *event, const struct cs_path_point *to,
                               const double from[3]) {
    return cs_vec3_distance(to->point, from) / (to->at - cs_event_begin(event));
}

double cs_findings_box_of(const double *x, size_t n, size_t count, double low[3],
                          double high[3]) {
    for (size_t c = 0; c < 3; c++, x += n) {
        low[c] = high[c] = x[0];
        for (size_t i = 1; i < count; i++) {
            low[c] = fmin(low[c], x[i]);
            high[c] = fmax(high[c], x[i]);
        }
    }
    return cs_vec3_distance(high, low);
}

double cs_findings_box(const struct cs_system *system, uint32_t b, double low[3],
                       double high[3]) {
    const struct cs_body_range *range = system->bodies + b;
    return cs_findings_box_of(system->state + range->first, system->view.n, range->count, low,
                              high);
}

/* m, of a collider without a plane: the diagonal of its box. */
static double size_of(const struct cs_posed_collider *collider) {
    const struct cs_trimesh *mesh = collider->collider->geometry;
    double sides[3], low[3] = {0}, high[3] = {0};
    if (mesh)
        cs_findings_box_of(mesh->positions, mesh->n, mesh->n, low, high);
    for (size_t c = 0; c < 3; c++)
        sides[c] = 2 * collider->half_sizes[c] + (high[c] - low[c]);
    return 2 * collider->radius + cs_vec3_length(sides);
}

/* A collider that is led by more than its size per frame. */
static void check_move(const struct cs_system *system, uint32_t e, const void *arg,
                       struct cs_text *out) {
    const struct cs_event *event = cs_scene_events(system->scene) + e;
    const struct cs_move *move = &event->move;
    const struct cs_event_path path = cs_event_path_of(event);
    const struct cs_path_point *to = path.points;
    struct cs_posed_collider collider;
    (void)arg;
    if (!move->present || !path.n || !system->motions)
        return;
    cs_posed_collider_at(system, (uint32_t)move->collider, 0, &collider);
    if (cs_shape_is_endless(collider.shape))
        return;
    const double still[3] = {0}, *from = move->relative ? still : collider.centre;
    const double speed = cs_findings_first_speed(event, to, from);
    const double size = size_of(&collider);
    const double fastest = size * system->scene->time.fps / JUMP_FRAMES;
    if (speed > fastest)
        cs_text_add(out,
                    "events[%u].move.path[0] is reached at %.3g m/s, by more than the size of "
                    "colliders[%u], %.3g m, per frame: expected at = %.3g s or later%s",
                    e, speed, (uint32_t)move->collider, size,
                    cs_event_begin(event) + (to->at - cs_event_begin(event)) * speed / fastest,
                    move->relative ? ", or \"relative\": false if its points are positions"
                                   : "");
}

void cs_path_findings_print(const struct cs_system *system, struct cs_text *out) {
    cs_findings_print(system, system->scene->events.n, check_move, NULL, out);
}

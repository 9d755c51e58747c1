/* Finds the number that a ramp changes, and refuses keys that cannot change in a run. */
#include "scene/event_key.h"

#include "base/options.h"
#include "base/vec3.h"
#include "scene/body_keys.h"
#include "scene/body_particles.h"
#include "scene/contact_keys.h"
#include "scene/force_keys.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Paths without indices of numbers that may change. Numbers of `forces` may too, unless `fixed`
 * names them. */
static const char *const changeable[] = {"bodies.springs.stretch",
                                         "bodies.springs.shear",
                                         "bodies.springs.bend",
                                         "bodies.springs.damping",
                                         "bodies.strain_limit",
                                         "bodies.mass.particle",
                                         "bodies.mass.total",
                                         "bodies.mass.degree",
                                         "bodies.mass.areal_density",
                                         "colliders.friction",
                                         "colliders.absorption",
                                         "colliders.sphere.radius",
                                         "colliders.capsule.radius",
                                         "colliders.thickness",
                                         "bodies.pressure",
                                         "bodies.shape_matching.alpha",
                                         "bodies.shape_matching.beta",
                                         "bodies.elastic.membrane.young",
                                         "bodies.elastic.membrane.shear",
                                         "bodies.elastic.bending.stiffness",
                                         "bodies.elastic.bending.twist",
                                         "bodies.elastic.bending.damping",
                                         "bodies.elastic.damping",
                                         NULL};

/* Numbers of the pictures that may change, by the start of their paths without indices. */
static const char *const pictured[] = {"bodies.material.colour",
                                       "bodies.material.back_colour",
                                       "bodies.material.ambient",
                                       "bodies.material.diffuse",
                                       "bodies.material.specular",
                                       "bodies.material.shininess",
                                       "colliders.colour",
                                       "camera.fov",
                                       "light.",
                                       "lights.",
                                       "render.background.colour",
                                       "render.background.below",
                                       NULL};

/* Prefixes of keys that cannot change, and why; the first that fits counts. */
static const struct {
    const char *start, *why;
} fixed[] = {
    {"forces.wind.direction", "use the event wind"},
    {"bodies.cloth", "it defines the start of the body"},
    {"bodies.mesh", "it defines the start of the body"},
    {"bodies.network", "springs are created at the start"},
    {"bodies.shape_matching", "clusters are made at the start"},
    {"bodies.thickness", "ranges of contact are set at the start"},
    {"bodies.pins", "use the events pin and release"},
    {"bodies.material", "textures are read at the start"},
    {"camera", "use camera.path"},
    {"render", "it holds for all pictures"},
    {"time", "frames are evenly spaced"},
    {"colliders.visible", "it holds for all pictures"},
    {"colliders", "use the event move"},
    {"contact", "the contact law is fixed during a run"},
    {"events", "events cannot change events"},
};

/* State of the descent along a path through the tables and the structs. */
struct walk {
    const char *path, *rest;      /* the whole path; the part that is left */
    const struct cs_table *table; /* rows of `object` */
    char *object;                 /* the struct, in the end the number, in the scene */
    char plain[CS_TEXT_MAX];      /* the path so far without indices */
    struct cs_error *error;
};

/* Refuses a name that the table does not have, and proposes the nearest. */
static enum cs_status refuse_key(struct walk *walk, const char *name) {
    if (!*name)
        return cs_fail(walk->error, CS_ERR_SCENE, "\"%.120s\": expected a key", walk->path);
    const char *nearest = cs_option_nearest(walk->table, name);
    return cs_fail(walk->error, CS_ERR_SCENE, "no key \"%.60s\" in \"%.120s\"%s%s%s", name,
                   walk->path, nearest ? "; did you mean \"" : "", nearest ? nearest : "",
                   nearest ? "\"?" : "");
}

/* Returns the row of the next name and moves past it; NULL, with an error, if there is none. */
static const struct cs_option *next_row(struct walk *walk) {
    char name[64] = "";
    const size_t length = strcspn(walk->rest, ".[");
    memcpy(name, walk->rest, length < sizeof name ? length : sizeof name - 1);
    const struct cs_option *row = cs_option_find(walk->table, name);
    if (!row) {
        refuse_key(walk, name);
        return NULL;
    }
    walk->rest += length;
    if (*walk->plain)
        strcat(walk->plain, ".");
    strcat(walk->plain, name);
    return row;
}

/* Reads an index "[3]" below n. Leading zeros are refused: one spelling per number. */
static bool next_index(struct walk *walk, uint32_t n, uint32_t *index) {
    char *end;
    const char *digits = walk->rest + 1;
    const unsigned long value = *walk->rest == '[' ? strtoul(digits, &end, 10) : 0;
    if (*walk->rest != '[' || *digits < '0' || *digits > '9' ||
        (*digits == '0' && end != digits + 1) || *end != ']' || value >= n) {
        if (n)
            cs_fail(walk->error, CS_ERR_SCENE, "\"%.120s\": expected an index 0..%u after %s",
                    walk->path, n - 1, walk->plain);
        else
            cs_fail(walk->error, CS_ERR_SCENE, "\"%.120s\": the scene has no %s", walk->path,
                    walk->plain);
        return false;
    }
    *index = (uint32_t)value;
    walk->rest = end + 1;
    return true;
}

/* Descends to a row that is neither table nor list, and to one element of a vector. Returns the
 * row, or NULL with an error. */
static const struct cs_option *descend(struct walk *walk) {
    for (;;) {
        const struct cs_option *row = next_row(walk);
        uint32_t index = 0;
        if (!row)
            return NULL;
        // a table that stands apart may be absent: the way ends without a number
        walk->object = walk->object ? cs_option_field(row, walk->object) : NULL;
        if (row->type == CS_LIST) {
            const struct cs_list none = {0},
                                 *list = walk->object ? (void *)walk->object : &none;
            if (!next_index(walk, list->n, &index))
                return NULL;
            walk->object = (char *)list->items + index * row->table->size;
        } else if (cs_value_kind_of(row)->several) {
            if (!next_index(walk, row->count, &index))
                return NULL;
            walk->object += walk->object ? index * cs_value_kind_of(row)->size : 0;
        }
        /* the end of the way down: the path must end here too */
        if (!row->table) {
            if (*walk->rest)
                refuse_key(walk, walk->rest);
            return *walk->rest ? NULL : row;
        }
        walk->table = row->table;
        if (*walk->rest != '.') {
            refuse_key(walk, "");
            return NULL;
        }
        walk->rest++;
    }
}

/* Returns true if a path without indices is of a number of the pictures. */
static bool is_pictured(const char *plain) {
    for (uint32_t k = 0; pictured[k]; k++)
        if (!strncmp(plain, pictured[k], strlen(pictured[k])))
            return true;
    return false;
}

/* Returns true for a key of the pictures: a ramp of it changes neither steps nor states, and
 * pictures take its value at their time (session/frame_picture.h). */
static bool is_picture_key(const char *path) {
    char plain[CS_TEXT_MAX];
    size_t n = 0;
    bool inside = false;
    for (; *path && n + 1 < sizeof plain; path++) {
        inside = *path == '[' || (inside && *path != ']');
        if (!inside && *path != ']')
            plain[n++] = *path;
    }
    plain[n] = '\0';
    return is_pictured(plain);
}

bool cs_event_is_picture(const struct cs_event *event) {
    return event->ramp.present && is_picture_key(event->ramp.key);
}

/* Checks that the number may change during a run. */
static enum cs_status check_changeable(const struct walk *walk, const struct cs_option *row) {
    for (uint32_t k = 0; changeable[k]; k++)
        if (!strcmp(walk->plain, changeable[k]))
            return CS_OK;
    if (is_pictured(walk->plain) && (row->type == CS_REAL || row->type == CS_VECTOR))
        return CS_OK;
    for (uint32_t k = 0; k < sizeof fixed / sizeof *fixed; k++)
        if (!strncmp(walk->plain, fixed[k].start, strlen(fixed[k].start)))
            return cs_fail(walk->error, CS_ERR_SCENE, "%.120s cannot change: %s", walk->path,
                           fixed[k].why);
    if (!strncmp(walk->plain, "forces.", 7) && (row->type == CS_REAL || row->type == CS_VECTOR))
        return CS_OK;
    return cs_fail(walk->error, CS_ERR_SCENE,
                   "%.120s cannot be ramped (see clothsim-scene(5), Events)", walk->path);
}

/* The body whose struct the number lies in. */
static const struct cs_body *body_of(const struct walk *walk, const struct cs_scene *scene) {
    const char *first = scene->bodies.items;
    return cs_scene_bodies(scene) + (size_t)(walk->object - first) / sizeof(struct cs_body);
}

/* Checks that the springs exist: a stiffness of 0 at the start makes none. */
static enum cs_status check_springs(const struct walk *walk, const struct cs_body *body,
                                    double value) {
    const bool shear = !strcmp(walk->plain, "bodies.springs.shear");
    const bool damping = !strcmp(walk->plain, "bodies.springs.damping");
    const char *why = body->elastic.present             ? "elastic replaces the springs"
                      : cs_scene_springs_left_out(body) ? "shape_matching disables the springs"
                      : shear && body->mesh             ? "a mesh has none"
                      : !damping && value <= 0          ? "it is 0: there are no such springs"
                                                        : NULL;
    return why ? cs_fail(walk->error, CS_ERR_SCENE, "%.120s cannot change: %s", walk->path, why)
               : CS_OK;
}

/* Returns true for a path of a collider's radius or thickness. */
static bool grows(const char *path) {
    return !strncmp(path, "colliders", 9) &&
           (strstr(path, ".radius") || strstr(path, ".thickness"));
}

/* Checks that the scene has the number: an absent one cannot appear during a run. */
static enum cs_status check_there(const struct walk *walk, const struct cs_scene *scene) {
    const double value = *(const double *)(const void *)walk->object;
    if (isnan(value))
        return cs_fail(walk->error, CS_ERR_SCENE, "%.120s cannot change: the scene has none",
                       walk->path);
    if (grows(walk->plain) && scene->contact->law != CS_CONTACT_FORCE)
        return cs_fail(walk->error, CS_ERR_SCENE,
                       "%.120s cannot change: contact.law project bounds the energy of pushes; "
                       "expected contact.law force",
                       walk->path);
    if (!strcmp(walk->plain, "forces.wind.strength") && !scene->forces->wind.present)
        return cs_fail(walk->error, CS_ERR_SCENE,
                       "%.120s cannot change: the scene has no forces.wind", walk->path);
    if (!strcmp(walk->plain, "bodies.pressure") && !cs_body_is_closed(body_of(walk, scene)))
        return cs_fail(walk->error, CS_ERR_SCENE,
                       "%.120s cannot change: expected a closed mesh whose faces look outwards",
                       walk->path);
    return strncmp(walk->plain, "bodies.springs.", 15)
               ? CS_OK
               : check_springs(walk, body_of(walk, scene), value);
}

enum cs_status cs_event_key_find(struct cs_scene *scene, const char *path,
                                 struct cs_event_key *key, struct cs_error *error) {
    struct walk walk = {.path = path,
                        .rest = path,
                        .table = &cs_scene_table,
                        .object = (char *)scene,
                        .error = error};
    const struct cs_option *row = descend(&walk);
    if (!row || check_changeable(&walk, row) || check_there(&walk, scene))
        return error->status;
    *key = (struct cs_event_key){row, (double *)(void *)walk.object};
    return CS_OK;
}

bool cs_event_key_changes(const struct cs_scene *scene, const char *key) {
    const struct cs_event *events = cs_scene_events(scene);
    for (uint32_t e = 0; e < scene->events.n; e++)
        if (events[e].ramp.present && events[e].ramp.value != 0 &&
            strstr(events[e].ramp.key, key))
            return true;
    return false;
}

bool cs_event_releases_any(const struct cs_scene *scene) {
    for (uint32_t e = 0; e < scene->events.n; e++)
        if (cs_scene_events(scene)[e].release.present)
            return true;
    return false;
}

bool cs_event_key_acts(const struct cs_scene *scene, double value, const char *key) {
    return value != 0 || cs_event_key_changes(scene, key);
}

bool cs_event_grows(const struct cs_event *event) {
    return event->ramp.present && grows(event->ramp.key);
}

bool cs_event_changes_mass(const struct cs_event *event) {
    return event->ramp.present && strstr(event->ramp.key, "].mass.");
}

/* Finds views without a direction, or without a way up. */

const char *cs_viewpoint_fault(const double eye[3], const double target[3], const double up[3],
                               const char **key) {
    const double view[3] = {target[0] - eye[0], target[1] - eye[1], target[2] - eye[2]};
    double side[3];
    cs_vec3_cross(view, up, side);
    *key = "target";
    if (cs_vec3_length(view) < 1e-9)
        return "is the same point as the eye";
    // parallel to the view up to rounding: no picture plane can be built
    *key = "up";
    if (cs_vec3_length(side) < 1e-9 * cs_vec3_length(view))
        return "is along the view or zero, expected another direction";
    return NULL;
}

/* Memory of a scene, and copies whose numbers change apart from it. No table of the root that
 * stands apart may be absent. */

enum cs_status cs_scene_init(struct cs_scene *scene, struct cs_error *error) {
    *scene = (struct cs_scene){0};
    for (const struct cs_option *row = cs_scene_table.rows;
         row < cs_scene_table.rows + cs_scene_table.n; row++)
        if (row->type == CS_TABLE && row->table->apart) {
            void **section = (void *)((char *)scene + row->offset);
            *section = cs_arena_alloc(&scene->arena, row->table->size, error);
        }
    if (!error->status)
        cs_options_default(&cs_scene_table, scene);
    return error->status;
}

/* Replaces items by a copy; without memory they are shared. */
static void copy_items(void **items, size_t bytes, struct cs_arena *arena,
                       struct cs_error *error) {
    void *copy = bytes ? cs_arena_alloc(arena, bytes, error) : NULL;
    if (copy)
        *items = memcpy(copy, *items, bytes);
}

enum cs_status cs_scene_copy(struct cs_scene *copy, const struct cs_scene *scene,
                             struct cs_arena *arena, struct cs_error *error) {
    *copy = *scene;
    copy->arena = (struct cs_arena){0};
    for (const struct cs_option *row = cs_scene_table.rows;
         row < cs_scene_table.rows + cs_scene_table.n; row++) {
        void *field = (char *)copy + row->offset;
        struct cs_list *list = field;
        if (row->type == CS_TABLE && row->table->apart)
            copy_items(field, row->table->size, arena, error);
        if (row->type == CS_LIST && row->table != &cs_event_table)
            copy_items(&list->items, list->n * row->table->size, arena, error);
    }
    return error->status;
}

void cs_scene_finish(struct cs_scene *scene) {
    struct cs_arena arena = scene->arena;
    cs_arena_finish(&arena);
    *scene = (struct cs_scene){0};
}

/* scene.h - a scene as plain structs, every value present: the contents of the JSON file. Its
 * sections have headers of their own, so that a new key compiles what reads its section.
 *
 * The tables in scene_tables.c and NAME_keys.c name, type, default and bound each field. The
 * reader fills the structs by them, and no other code knows the JSON. cs_scene_check adds
 * conditions that ranges cannot express.
 *
 * Absent: an optional table has `present` false, a number is NAN, a choice or an index is -1.
 */
#ifndef CS_SCENE_H
#define CS_SCENE_H

#include "base/arena.h"
#include "base/status.h"

#include <clothsim/option.h>

struct cs_body;
struct cs_collider;
struct cs_event;
struct cs_body_pairs_keys;
struct cs_camera;
struct cs_contact_keys;
struct cs_forces;
struct cs_light;
struct cs_render;

struct cs_time {
    double fps; /* frame k shows t = k / fps */
};

/* An option of the integrator as text; checked when the integrator is known. */
struct cs_setting {
    const char *name, *value, *place; /* of the scene's arena; place: "FILE:line:column: " */
    bool is_text;                     /* value was in quotes */
};

/* A scene: sections, whose structs are each in a header of its own (body_keys.h ...).
 * cs_scene_finish releases it. */
struct cs_scene {
    char about[CS_TEXT_MAX], source[CS_TEXT_MAX];
    struct cs_list bodies;    /* struct cs_body, at least one */
    struct cs_list colliders; /* struct cs_collider */
    struct cs_contact_keys *contact;
    int32_t crossings; /* enum cs_crossings_policy, -1: absent: see body_pairs.h */
    struct cs_body_pairs_keys *pairs;
    struct cs_list seams; /* struct cs_seam */
    struct cs_forces *forces;
    struct cs_list events; /* struct cs_event */
    struct cs_time time;
    struct cs_camera *camera;
    struct cs_light *light;
    struct cs_list lights; /* struct cs_light, beside it */
    struct cs_render *render;

    char integrator[64];                /* the "integrator" object is read apart */
    struct cs_list integrator_settings; /* struct cs_setting */

    /* provenance */
    const char *path, *folder; /* as given; base of relative paths */
    const char *text;          /* the file's text, for places in messages */
    size_t text_bytes;
    struct cs_arena arena; /* owns everything that the scene points to */
};

/* The root of the scene's tables, and names of its choices. */
extern const struct cs_table cs_scene_table, cs_pin_table, cs_event_table, cs_seam_table;
extern const struct cs_table cs_spring_table, cs_elastic_table;
extern const char *const cs_pin_names[];
extern const char *const cs_mesh_shape_names[];
/* the method of a scene that names none: session/session.c chooses it by the scene */
#define CS_INTEGRATOR_DEFAULT "automatic"
/* Typed access to the lists of a scene. */
static inline struct cs_body *cs_scene_bodies(const struct cs_scene *scene) {
    return scene->bodies.items;
}
static inline struct cs_collider *cs_scene_colliders(const struct cs_scene *scene) {
    return scene->colliders.items;
}

static inline const struct cs_event *cs_scene_events(const struct cs_scene *scene) {
    return scene->events.items;
}
/* largest number of particles, 4096 x 4096: about 10 GB with springs and solver */
#define CS_PARTICLES_MAX 16777216.0

/* Returns true for a file in the scene's folder or below: a scene must not open others. */
bool cs_scene_is_below(const char *file);

/* Checks conditions that single ranges cannot express: pins exist, one kind of mass, a size
 * that fits in memory, a camera that looks somewhere, and others. Normalises directions and
 * quaternions. Fails with CS_ERR_SCENE; *path_out (CS_TEXT_MAX bytes) then holds the JSON path
 * of the faulty value, from which the caller finds its place in the file. *error's message goes
 * after it. */
enum cs_status cs_scene_check(struct cs_scene *scene, char *path_out, struct cs_error *error);

/* Takes the structs that a scene points to, in its arena, with the defaults of all rows.
 * CS_ERR_MEMORY; *scene can then be finished. */
enum cs_status cs_scene_init(struct cs_scene *scene, struct cs_error *error);

/* Copies a scene, with structs and lists of its own in `arena`, so that its numbers can change.
 * The events, and what items of lists point to, are shared: the scene must outlive the copy.
 * `arena` may be that of the copy, which is empty. CS_ERR_MEMORY. */
enum cs_status cs_scene_copy(struct cs_scene *copy, const struct cs_scene *scene,
                             struct cs_arena *arena, struct cs_error *error);

/* Frees the arena; safe on a zeroed scene. */
void cs_scene_finish(struct cs_scene *scene);

#endif

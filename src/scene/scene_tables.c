/* The rows of the scene's root, and of `time`. Each section has its rows in NAME_keys.c, beside
 * its structs in NAME_keys.h. Parsing, --set, --resolved, the schema and the man page all come
 * from these tables. A default outside its range (NAN, -1) means: absent unless given. */
#include "scene/picture_keys.h"
#include "scene/scene.h"
#include "scene/table_rows.h"

static const struct cs_option time_rows[] = {
    REAL(struct cs_time, fps, "1/s", 60, 1e-3, 1e6,
         "frames per second; frame k shows t = k / fps"),
};
static const struct cs_table time_table = {ROWS(time_rows), .size = sizeof(struct cs_time)};

static const char *const crossings_names[] = {"ignore", "count", "limit", "stop", NULL};
static const struct cs_option scene_rows[] = {
    TEXT(struct cs_scene, about, "description of the scene"),
    TEXT(struct cs_scene, source, "source of the scene"),
    LIST(struct cs_scene, bodies, cs_body_table, "moving bodies; at least one"),
    LIST(struct cs_scene, colliders, cs_collider_table,
         "shapes that bodies rest on and slide off"),
    TABLE(struct cs_scene, contact, cs_contact_table, "contact of bodies with colliders"),
    CHOICE(
        struct cs_scene, crossings, crossings_names, -1,
        "edges of bodies that cross triangles: ignore: the same as absent; count: after each "
        "frame; limit: also shorten steps that would make a crossing; stop: the first one "
        "ends the run"),
    TABLE(struct cs_scene, pairs, cs_pairs_table,
          "bodies that do not pass through each other; for contact.law force"),
    LIST(struct cs_scene, seams, cs_seam_table,
         "stitches between particles and bodies, or within one body"),
    TABLE(struct cs_scene, forces, cs_force_table, "from outside, on every particle"),
    LIST(struct cs_scene, events, cs_event_table, "changes at a time or over an interval"),
    TABLE(struct cs_scene, time, time_table, "frames"),
    TABLE(struct cs_scene, camera, cs_camera_table, "look-at camera"),
    TABLE(struct cs_scene, light, cs_light_table,
          "the first light, at a point or from a direction"),
    LIST(struct cs_scene, lights, cs_lights_table, "up to 3 further lights"),
    TABLE(struct cs_scene, render, cs_render_table, "picture"),
};
const struct cs_table cs_scene_table = {ROWS(scene_rows), .size = sizeof(struct cs_scene)};

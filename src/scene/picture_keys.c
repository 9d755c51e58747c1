/* The rows of what a scene says of its pictures, and the check of coloured faces. */
#include "scene/picture_keys.h"
#include "scene/body_keys.h"
#include "scene/body_particles.h"
#include "scene/force_keys.h"
#include "scene/table_rows.h"

#include <stdio.h>

static const double zero3[3] = {0, 0, 0};
static const double up3[3] = {0, 1, 0};
static const double absent3[3] = {ABSENT, ABSENT, ABSENT};

static const double eye[3] = {1.2, 0.7, 2.2};
static const char *const frame_names[] = {"given", "auto", "start", NULL};
static const char *const projection_names[] = {"perspective", "orthographic", NULL};
static const char *const camera_motions[] = {"linear", "smooth", NULL};
static const struct cs_option key_rows[] = {
    REAL(struct cs_camera_key, at, "s", ABSENT, 0, BIG, "later than the previous key"),
    VECTOR(struct cs_camera_key, eye, 3, "m", NULL, -BIG, BIG, "position of the camera then"),
    VECTOR(struct cs_camera_key, target, 3, "m", NULL, -BIG, BIG,
           "point that the camera looks at then"),
};
static const struct cs_table key_table = {ROWS(key_rows), .size = sizeof(struct cs_camera_key)};
static const struct cs_option camera_rows[] = {
    CHOICE(struct cs_camera, frame, frame_names, CS_FRAME_GIVEN,
           "given: the camera stands at eye; auto: it keeps that direction, from a position "
           "where the bodies fill the picture; start: likewise, where all that there is at the "
           "start, all paths of colliders and what there is of the bodies later fit, or beside "
           "the collider that goes far; the default without frame, eye, target and path"),
    VECTOR(struct cs_camera, eye, 3, "m", eye, -BIG, BIG, "position of the camera"),
    VECTOR(struct cs_camera, target, 3, "m", zero3, -BIG, BIG,
           "point that the camera looks at"),
    VECTOR(struct cs_camera, up, 3, "", up3, -BIG, BIG, "direction that is up in the picture"),
    REAL(struct cs_camera, fov, "degrees", 40, 1, 170, "vertical field of view"),
    CHOICE(struct cs_camera, projection, projection_names, CS_PROJECTION_PERSPECTIVE,
           "orthographic: the scale equals the perspective scale at the target"),
    LIST(struct cs_camera, path, key_table,
         "eye and target at given times, instead of fixed ones"),
    CHOICE(struct cs_camera, motion, camera_motions, CS_MOTION_LINEAR,
           "linear: at constant velocity from key to key; smooth: at rest at each key"),
};
const struct cs_table cs_camera_table = {ROWS(camera_rows), .size = sizeof(struct cs_camera),
                                         .apart = true, .shorthand_text = "frame"};

static const double dim[3] = {0.16, 0.17, 0.19};
static const double bright[3] = {1, 0.97, 0.92};
/* rows of every light; only the first has an ambient one between them */
#define PLACE_ROWS                                                                             \
    VECTOR(struct cs_light, point, 3, "m", absent3, -BIG, BIG, "position of a lamp"),          \
        VECTOR(struct cs_light, direction, 3, "", absent3, -BIG, BIG,                          \
               "direction in which sunlight travels, instead of point")
#define COLOUR_ROWS                                                                            \
    VECTOR(struct cs_light, diffuse, 3, "", bright, 0, 10, "intensity id, linear RGB"),        \
        VECTOR(struct cs_light, specular, 3, "", bright, 0, 10, "intensity is, linear RGB"),   \
        REAL(struct cs_light, strength, "", 1, 0, 1000, "factor of diffuse and specular"),     \
        BOOL(struct cs_light, shadow, 1, "it casts shadows")
static const struct cs_option light_rows[] = {
    PLACE_ROWS,
    VECTOR(struct cs_light, ambient, 3, "", dim, 0, 10, "intensity ia, linear RGB"),
    COLOUR_ROWS,
};
static const struct cs_option further_rows[] = {PLACE_ROWS, COLOUR_ROWS};
const struct cs_table cs_light_table = {ROWS(light_rows), .size = sizeof(struct cs_light),
                                        .apart = true};
const struct cs_table cs_lights_table = {ROWS(further_rows), .size = sizeof(struct cs_light)};

#define X(NAME, name) #name,
const char *const cs_look_names[] = {CS_LOOK_LIST(X) NULL};
#undef X
static const double vga[2] = {640, 480};
static const double paper[3] = {0.82, 0.86, 0.91};
static const char *const background_names[] = {"gradient", "flat", "none", NULL};
static const struct cs_option background_rows[] = {
    CHOICE(struct cs_background, kind, background_names, CS_BACKGROUND_GRADIENT,
           "gradient: brighter above; flat: one colour; none: nothing, in pictures with alpha"),
    VECTOR(
        struct cs_background, colour, 3, "", paper, 0, 1,
        "linear RGB; with none, colour of the paper that lines and figures must contrast with"),
    VECTOR(struct cs_background, below, 3, "", absent3, 0, 1,
           "of a gradient at the lower edge, with colour at the upper edge; absent: a slight "
           "gradient with colour in the middle"),
};
static const struct cs_table background_table = {
    ROWS(background_rows), .size = sizeof(struct cs_background), .shorthand_text = "kind",
    .shorthand_list = "colour"};
static const char *const palette_names[] = {"auto", "green-red", NULL};
static const char *const ground_names[] = {"auto", "none", "shadow", "grid", NULL};
static const struct cs_option mark_rows[] = {
    INT(struct cs_marks, body, "", 0, 0, 4294967295.0, "number of the body from 0"),
    LIST(struct cs_marks, particles, cs_pin_table, "of the body, named as in its pins"),
};
static const struct cs_table mark_table = {ROWS(mark_rows), .size = sizeof(struct cs_marks)};
static const struct cs_option render_rows[] = {
    COUNTS(struct cs_render, size, 2, "pixels", vga, 16, 8192, "width and height"),
    INT(struct cs_render, samples, "", 8, 1, 8, "of each pixel: 1, 4 or 8"),
    CHOICE(struct cs_render, look, cs_look_names, CS_LOOK_LIT, "content of the picture"),
    VECTOR(struct cs_render, range, 2, "N or 1", absent3, -BIG, BIG,
           "force or strain at the ends of the colours; absent: the range of each frame, from "
           "0 or symmetric about 0, without the hundredth of the particles farthest from 0"),
    CHOICE(struct cs_render, palette, palette_names, CS_PALETTE_AUTO,
           "colours of force, strain and stress; green-red: from green over yellow to red"),
    BOOL(struct cs_render, pins, 1,
         "draw pegs at pinned particles with a free neighbour, and rods between them"),
    TABLE(struct cs_render, background, background_table, "background behind everything"),
    BOOL(struct cs_render, viewpoint_forces, 0,
         "draw the particles that active viewpoint forces see, and their rectangles from their "
         "eyes"),
    CHOICE(
        struct cs_render, ground, ground_names, CS_GROUND_AUTO,
        "auto: squares on a visible floor, or on a ground below what cannot fall without end, "
        "shadows alone where the background is none; grid: lines instead of squares; shadow: a "
        "ground of shadows alone; none: no ground, and plain floors"),
    REAL(struct cs_render, ground_height, "m", ABSENT, -BIG, BIG,
         "y of the ground; absent: the floor's y, or below everything that moves"),
    TABLE(struct cs_render, marks, mark_table,
          "particles to mark by red discs, the first by a larger one"),
};
const struct cs_table cs_render_table = {ROWS(render_rows), .size = sizeof(struct cs_render),
                                         .apart = true};

enum cs_status cs_check_faces(const struct cs_check *check, const char *body,
                              const struct cs_body *of) {
    const struct cs_face_colour *faces = of->material.faces.items;
    char path[128], fault[256];
    snprintf(path, sizeof path, "%s.material.faces", body);
    /* the colours are drawn as a texture of their own */
    if (of->material.faces.n && *of->material.texture)
        return cs_check_refuse(check, path, "expected a texture or faces, found both");
    for (uint32_t k = 0; k < of->material.faces.n; k++) {
        snprintf(path, sizeof path, "%s.material.faces[%u].set", body, k);
        if (cs_body_set_fault(of, faces[k].set, fault, sizeof fault))
            return cs_check_refuse(check, path, "%s", fault);
    }
    return CS_OK;
}

/* scene.h - a scene as plain structs, every value present: the contents of the JSON file.
 *
 * The tables in scene_tables.c name, type, default and bound each field. The reader fills the
 * structs by them, and no other code knows the JSON. cs_scene_check adds conditions that ranges
 * cannot express.
 *
 * Absent: an optional table has `present` false, a number is NAN, a choice or an index is -1.
 */
#ifndef CS_SCENE_H
#define CS_SCENE_H

#include "base/arena.h"
#include "base/status.h"
#include "mesh/spring_network.h"
#include "mesh/vertex_paths.h"
#include "scene/body_keys.h"
#include "scene/elastic_keys.h"
#include "scene/picture_keys.h"

#include <clothsim/option.h>

enum cs_mesh_unit { CS_MESH_M, CS_MESH_CM, CS_MESH_MM, CS_MESH_INCH, CS_MESH_FOOT };
enum cs_mesh_up { CS_MESH_UP_Y, CS_MESH_UP_Z };

/* Triangle mesh of a body or a collider: from a file or generated. */
struct cs_mesh_source {
    bool present;
    char file[CS_TEXT_MAX]; /* OBJ, relative to the scene file; "" = none */
    int32_t shape;          /* enum cs_mesh_shape, -1: none */
    int64_t detail;         /* divisions of a generated shape (trimesh_shape.c) */
    double scale[3];        /* factors of the coordinates of file or shape */
    int32_t units;          /* enum cs_mesh_unit, of the scaled coordinates */
    int32_t up;             /* enum cs_mesh_up */
    bool weld;              /* join vertices in one place at open edges */
    char set[CS_TEXT_MAX];  /* of the file: group, object or material that is read; "": all */
    struct cs_pose place;
    double velocity[3];              /* m/s, of every free particle at time 0 */
    double spin[3];                  /* rad/s, about place.translate */
    struct cs_key_frames key_frames; /* of a collider */
    /* not in the tables: made by the reader, owned by the scene's arena; shared and constant */
    const struct cs_trimesh *geometry;
    const struct cs_vertex_paths *paths; /* NULL without key frames */
};

struct cs_shape_clusters;
/* A body that is drawn to its shape (Mueller et al. 2005) instead of held by springs. */
struct cs_shape_matching {
    bool present;
    double alpha;      /* fraction of the way to the goals per step; 1: rigid */
    double beta;       /* fraction of the linear deformation in the goals */
    double alpha_step; /* s, length of that step; 0: alpha holds for a step of any length */
    int64_t clusters;  /* parts that each keep their shape */
    double overlap;    /* of neighbouring parts, as a fraction of a part's longest side */
    bool springs;      /* the body's springs act too */
    /* not in the tables: made by the reader, owned by the scene's arena */
    const struct cs_shape_clusters *parts;
};

/* Mass of a body's particles; exactly one is not NAN. */
struct cs_mass {
    double particle;      /* kg each */
    double areal_density; /* kg/m2, times each particle's area */
    double total;         /* kg, divided equally */
    double degree;        /* kg per spring at the particle */
};
enum cs_damping_model { CS_DAMPING_RELATIVE, CS_DAMPING_AXIAL };
enum cs_stiffness_unit { CS_STIFFNESS_N_PER_M, CS_STIFFNESS_N };

/* Springs of a body. A stiffness in N is divided by the rest length of the spring. */
struct cs_spring_law {
    double stretch, shear,
        bend;               /* N/m, or N (divided by the rest length); 0: no such springs */
    double damping;         /* N s/m per spring */
    int32_t damping_model;  /* enum cs_damping_model */
    int32_t stiffness_unit; /* enum cs_stiffness_unit */
};

/* A deformable body: its shape, masses, springs, pins, contact and look. */
struct cs_body {
    struct cs_cloth cloth; /* either this or the mesh */
    struct cs_mesh_source mesh;
    struct cs_spring_network network;
    struct cs_shape_matching shape_matching;
    struct cs_mass mass;
    struct cs_spring_law springs;
    struct cs_elastic elastic; /* instead of springs */
    struct cs_list pins;       /* struct cs_pin */
    bool self_contact;         /* contact with itself; needs contact.law force */
    double thickness;    /* m, range of its contact with bodies; 0: a fraction of its edges */
    double friction;     /* Coulomb coefficient of self-contact */
    double strain_limit; /* max length of a stretch spring / rest length; NAN: none */
    int64_t strain_limit_sweeps;     /* passes over the springs per step */
    double pressure, outer_pressure; /* Pa: inside over outside; outside, NAN: a pump */
    struct cs_material material;
};

/* Keys of the collider shapes; distances are in shape_NAME.c. */
struct cs_sphere {
    bool present;
    double centre[3], radius; /* m */
};
struct cs_plane {
    bool present;
    double point[3], normal[3]; /* m; normal is made a unit vector by cs_scene_check */
    double extent;              /* m, half the side of the square that is drawn */
};
struct cs_floor {
    bool present;
    double height; /* m: the plane y = height */
    double extent; /* m, as above */
};
/* A collider; the box that selects pins is struct cs_box. */
struct cs_cuboid {
    bool present;
    double centre[3], size[3]; /* m: whole sides, along its own axes */
    double rotate[4];          /* quaternion x, y, z, w; normalised by cs_scene_check */
    double radius;             /* m, of its edges; cs_scene_check fills an absent one */
};
struct cs_capsule {
    bool present;
    double from[3], to[3]; /* m, centres of the round ends */
    double radius;         /* m */
};
/* X(name, keys, text): the shapes of colliders. A shape has its keys here, and all else in its
 * own file: struct cs_table cs_NAME_keys and struct cs_shape cs_shape_NAME (collider.h). A mesh
 * has its keys with those of bodies. */
#define CS_SHAPE_LIST(X)                                                                       \
    X(sphere, cs_sphere, "a sphere")                                                           \
    X(plane, cs_plane, "an infinite plane")                                                    \
    X(floor, cs_floor, "an infinite horizontal plane")                                         \
    X(box, cs_cuboid, "a box with rounded edges")                                              \
    X(capsule, cs_capsule, "a rod with round ends")                                            \
    X(mesh, cs_mesh_source,                                                                    \
      "triangles, in contact with points, edges and triangles; for contact.law force")

/* An obstacle, at rest or moved by events, and by key frames if it is a mesh. */
struct cs_collider {
#define X(name, keys, text) struct keys name; /* exactly one is present */
    CS_SHAPE_LIST(X)
#undef X
    double friction;   /* Coulomb coefficient */
    double absorption; /* fraction of the inward normal velocity removed; < 0: restitution */
    double thickness;  /* m, layer in front of the surface */
    double colour[3];  /* linear RGB */
    bool visible;
};

enum cs_contact_law { CS_CONTACT_PROJECT, CS_CONTACT_FORCE };
/* Contact between particles and all colliders. */
struct cs_contact_keys {
    int32_t law; /* enum cs_contact_law */
    /* not in the tables: the scene names no law (cs_plan_choose_contact_law) */
    bool law_is_default;
    bool damping_is_default; /* nor a damping: cs_session_build sets it */
    int32_t start;    /* enum cs_contact_start_policy, of what starts inside or within range */
    double untangle;  /* s, in which particles that start inside are moved out; NAN: refused */
    double stiffness; /* N/m per particle, by force; NAN: from what may come (approach.h) */
    double damping;   /* s, times the stiffness of the contact: N s/m */
    double restitution; /* (1) speed after an impact over that before; NAN: not asked */
    /* not in the tables, set by cs_session_build: the factor alpha of the loss, and kg, M */
    double loss, mass;
    double friction_speed; /* m/s at which friction is 0.7 of its limit */
    int32_t friction_law;  /* enum cs_friction_law */
};

enum cs_wind_unit { CS_WIND_PA, CS_WIND_N };
/* Uniform wind; strength in Pa (times each particle's area) or in N per particle. */
struct cs_wind {
    bool present;
    double direction[3]; /* made a unit vector by cs_scene_check; along velocity if absent */
    double strength;
    int32_t strength_unit; /* enum cs_wind_unit */
    double velocity[3];    /* m/s, of air past the cloth; first component NAN: none */
    double density;        /* kg/m3 */
    double drag;           /* coefficient of the pressure across the surface */
};
enum cs_drag_unit { CS_DRAG_PARTICLE, CS_DRAG_AREA };

/* X(key, unit, help): numbers of `forces` that each belong to one force of
 * model/force/term_NAME.c; 0 if absent. Such a key needs nothing but its row. */
#define CS_FORCE_NUMBERS(X) X(drag, "N s/m or Pa s/m", "force of still air: -drag * v")

/* External forces of the whole scene. */
struct cs_forces {
    double gravity[3]; /* m/s2 */
#define X(key, unit, help) double key;
    CS_FORCE_NUMBERS(X)
#undef X
    int32_t drag_unit;    /* enum cs_drag_unit */
    double velocity_loss; /* fraction of the velocity removed after every internal step */
    struct cs_wind wind;
};

/* Particles that an event acts on. */
struct cs_event_target {
    int64_t body;             /* -1: every body */
    struct cs_list particles; /* struct cs_pin; none: all of them */
};

/* An impulse at one moment. */
struct cs_impact {
    bool present;
    struct cs_event_target target;
    double direction[3]; /* made a unit vector by cs_scene_check */
    double impulse;      /* N s, on all of them together */
};
/* A change of the wind, at once or linearly over the event's interval. */
struct cs_wind_change {
    bool present;
    double direction[3]; /* first component NAN: as it was */
    double strength;     /* NAN: as it was */
};
/* A change of one number of the scene (event_key.h), at once or linearly. */
struct cs_ramp {
    bool present;
    char key[CS_TEXT_MAX]; /* forces.gravity[1] */
    double value;          /* NAN: not given, refused */
};
/* Viewpoint of a picture that may differ from the camera's. cs_scene_check fills absent values
 * with those of the camera and of the picture. */
struct cs_viewpoint {
    double eye[3], target[3], up[3]; /* m; first component NAN: absent */
    double fov;                      /* degrees, vertical; NAN: absent */
    double aspect;                   /* width over height; NAN: absent */
};
/* A force on the particles that are visible from a viewpoint in a rectangle of its picture. */
struct cs_viewpoint_force {
    bool present;
    struct cs_viewpoint viewpoint;
    double rectangle[4]; /* left, top, right, bottom: fractions of the picture, from its top
                            left */
    double force;        /* N on each visible particle; NAN: not given, refused */
    double duration;     /* s, of a force at one moment; NAN: absent */
    double refresh;      /* 1/s, rate of visibility tests; 0: at the start only; NAN: absent */
    int64_t body;        /* -1: every body */
};
/* A point of a path and its time. */
struct cs_path_point {
    double at;       /* s; NAN: not given, refused */
    double point[3]; /* m */
};
/* Returns 1 if the first point of a path is that of its beginning at t: it lies where the event
 * finds what it moves, and no leg leads to it; else 0. */
static inline uint32_t cs_path_starts_at(const struct cs_list *path, double t) {
    const struct cs_path_point *first = path->items;
    return path->n && first->at > t - 1e-6 && first->at < t + 1e-6;
}
enum cs_motion { CS_MOTION_LINEAR, CS_MOTION_SMOOTH };
/* Holds particles and moves them along a path. */
struct cs_grab {
    bool present;
    struct cs_event_target target;
    struct cs_list path; /* struct cs_path_point, at least one */
    int32_t motion;      /* enum cs_motion */
    bool relative;       /* points are shifts from where it was grabbed */
    struct cs_holder to; /* instead of a path */
    double spin[3];      /* rad/s, about the centre, which follows the path */
    double centre[3];    /* m, at the beginning; first component NAN: the particles' mean */
};
/* Pins particles, or releases them. */
struct cs_pin_change {
    bool present;
    struct cs_event_target target;
};

/* Moves a collider along a path, or turns it. */
struct cs_move {
    bool present, relative; /* relative: points are shifts from where it was at the beginning */
    int64_t collider;       /* -1: not given, refused */
    struct cs_list path;    /* struct cs_path_point */
    int32_t motion;         /* enum cs_motion */
    double spin[3];         /* rad/s, about the centre */
    double centre[3];       /* m, at the beginning; first component NAN: the collider's */
};

/* Opens a seam. */
struct cs_unsew {
    bool present;
    int64_t seam; /* -1: not given, refused */
};

/* An event: exactly one of impact ... unsew; with `at`, or with `from` and `to`. */
struct cs_event {
    double at, from, to; /* s; NAN: absent */
    struct cs_impact impact;
    struct cs_wind_change wind;
    struct cs_viewpoint_force viewpoint_force;
    struct cs_ramp ramp;
    struct cs_grab grab;
    struct cs_pin_change pin, release;
    struct cs_move move;
    struct cs_unsew unsew;
};

struct cs_time {
    double fps; /* frame k shows t = k / fps */
};

/* An option of the integrator as text; checked when the integrator is known. */
struct cs_setting {
    const char *name, *value, *place; /* of the scene's arena; place: "FILE:line:column: " */
    bool is_text;                     /* value was in quotes */
};

/* A scene. cs_scene_finish releases it. */
struct cs_scene {
    char about[CS_TEXT_MAX], source[CS_TEXT_MAX];
    struct cs_list bodies;    /* struct cs_body, at least one */
    struct cs_list colliders; /* struct cs_collider */
    struct cs_contact_keys contact;
    int32_t crossings; /* enum cs_crossings_policy, -1: absent: see body_pairs.h */
    struct cs_body_pairs_keys pairs;
    struct cs_list seams; /* struct cs_seam */
    struct cs_forces forces;
    struct cs_list events; /* struct cs_event */
    struct cs_time time;
    struct cs_camera camera;
    struct cs_light light;
    struct cs_list lights; /* struct cs_light, beside it */
    struct cs_render render;

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
/* the method of a scene that names none: study/session.c chooses it by the scene */
#define CS_INTEGRATOR_DEFAULT "automatic"
/* Typed access to the lists of a scene. */
static inline struct cs_body *cs_scene_bodies(const struct cs_scene *scene) {
    return scene->bodies.items;
}
static inline struct cs_collider *cs_scene_colliders(const struct cs_scene *scene) {
    return scene->colliders.items;
}

/* Returns true if the body has no springs: it is drawn to its shape instead, or elastic. */
static inline bool cs_scene_springs_left_out(const struct cs_body *body) {
    return body->elastic.present ||
           (body->shape_matching.present && !body->shape_matching.springs);
}

/* Returns the first body that is drawn to its shape; bodies.n if there is none. */
static inline uint32_t cs_scene_first_matched(const struct cs_scene *scene) {
    uint32_t b = 0;
    while (b < scene->bodies.n && !cs_scene_bodies(scene)[b].shape_matching.present)
        b++;
    return b;
}

/* Returns the first body that is elastic; bodies.n if there is none. */
static inline uint32_t cs_scene_first_elastic(const struct cs_scene *scene) {
    uint32_t b = 0;
    while (b < scene->bodies.n && !cs_scene_bodies(scene)[b].elastic.present)
        b++;
    return b;
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

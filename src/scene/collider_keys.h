/* collider_keys.h - keys of colliders, and the list of their shapes. */
#ifndef CS_COLLIDER_KEYS_H
#define CS_COLLIDER_KEYS_H

#include "scene/scene.h"

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
 * has its keys with those of bodies, in mesh_keys.h. */
#define CS_SOLID_LIST(X)                                                                       \
    X(sphere, cs_sphere, "a sphere")                                                           \
    X(plane, cs_plane, "an infinite plane")                                                    \
    X(floor, cs_floor, "an infinite horizontal plane")                                         \
    X(box, cs_cuboid, "a box with rounded edges")                                              \
    X(capsule, cs_capsule, "a rod with round ends")
#define CS_SHAPE_LIST(X)                                                                       \
    CS_SOLID_LIST(X)                                                                           \
    X(mesh, cs_mesh_source,                                                                    \
      "triangles, in contact with points, edges and triangles; for contact.law force")

struct cs_mesh_source;
struct cs_trimesh;
struct cs_vertex_paths;

/* An obstacle, at rest or moved by events, and by key frames if it is a mesh. */
struct cs_collider {
#define X(name, keys, text) struct keys name; /* one of these is present, or the mesh */
    CS_SOLID_LIST(X)
#undef X
    struct cs_mesh_source *mesh; /* NULL: none */
    /* of the mesh, not in the tables: made by the reader, owned by the scene's arena; constant
     */
    const struct cs_trimesh *geometry;
    const struct cs_vertex_paths *paths; /* NULL without key frames */
    double friction;                     /* Coulomb coefficient */
    double absorption; /* fraction of the inward normal velocity removed; < 0: restitution */
    double thickness;  /* m, layer in front of the surface */
    double colour[3];  /* linear RGB */
    bool visible;
};

struct cs_shape;
#define X(name, keys, text)                                                                    \
    extern const struct cs_table cs_##name##_keys;                                             \
    extern const struct cs_shape cs_shape_##name;
CS_SHAPE_LIST(X)
#undef X

/* The shape of a collider: the one whose keys are present; NULL if none is. */
static inline const struct cs_shape *cs_collider_shape(const struct cs_collider *collider) {
#define X(name, keys, text)                                                                    \
    if (collider->name.present)                                                                \
        return &cs_shape_##name;
    CS_SOLID_LIST(X)
#undef X
    return collider->mesh ? &cs_shape_mesh : NULL;
}

#endif

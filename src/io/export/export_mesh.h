/* export_mesh.h - what is exported: bodies, or colliders, as points joined to triangles and
 * lines. */
#ifndef CS_EXPORT_EXPORT_MESH_H
#define CS_EXPORT_EXPORT_MESH_H

#include "base/arena.h"
#include "model/contact/posed_collider.h"
#include "model/system/system.h"

/* Values of all points, as they are at the sample taken last. */
struct cs_export_field {
    const char *name, *plural; /* of one point's value, of all */
    uint32_t components;
    uint64_t *words; /* (n, components) doubles as of base/little_endian.h */
};

enum { CS_EXPORT_FIELDS = 4 };

/* Points of bodies are the particles, in their order. The arrays are the arena's. */
struct cs_export_mesh {
    const char *name, *item; /* of files: "bodies"; of one of them: "body" */
    uint32_t n, n_triangles, n_lines, n_items;
    uint32_t *triangles; /* (n_triangles, 3), counter-clockwise from outside */
    uint32_t *lines;     /* (n_lines, 2): bodies that are a row of particles */
    float
        *uv; /* (n_triangles, 3, 2) of corners, v upwards, NAN where a body has none; or NULL */
    uint32_t *items;                                     /* (n_items) numbers in the scene */
    uint32_t *first_point, *first_triangle, *first_line; /* (n_items + 1) */
    double *local_positions; /* (n, 3) places in the frames of colliders; NULL of bodies */
    bool is_moving;
    uint32_t n_fields;
    struct cs_export_field fields[CS_EXPORT_FIELDS]; /* the first: positions in m */
};

/* Takes a field of so many components a point. */
struct cs_export_field *cs_export_mesh_add_field(struct cs_export_mesh *skin,
                                                 const char *const names[2],
                                                 uint32_t components, struct cs_arena *arena,
                                                 struct cs_error *error);

/* All bodies of a system. */
enum cs_status cs_export_mesh_of_bodies(struct cs_export_mesh *skin,
                                        const struct cs_system *system, struct cs_arena *arena,
                                        struct cs_error *error);

/* The visible colliders: meshes as they are, planes and floors as the square that is drawn of
 * them, spheres, boxes and capsules with points on their surface. Empty where no collider is
 * visible. */
enum cs_status cs_export_mesh_of_colliders(struct cs_export_mesh *skin,
                                           const struct cs_system *system,
                                           struct cs_arena *arena, struct cs_error *error);

/* Sets their positions at a time. */
void cs_export_mesh_pose_colliders(struct cs_export_mesh *skin, const struct cs_system *system,
                                   double t);

/* uv (n): texture coordinates of each point, where skin->uv is there: those of its first
 * corner, which are all that it has but at seams; 0 where it has none. */
void cs_export_mesh_point_uv(const struct cs_export_mesh *skin, float (*uv)[2]);

/* Sets a field from an array (components, n). */
void cs_export_mesh_set(const struct cs_export_mesh *skin, const struct cs_export_field *field,
                        const double *values);

#endif

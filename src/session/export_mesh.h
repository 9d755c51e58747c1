/* export_mesh.h - bodies, or colliders, of a system as one mesh of triangles and lines with
 * values of its points: what exports write. */
#ifndef CS_EXPORT_MESH_H
#define CS_EXPORT_MESH_H

#include "base/arena.h"
#include "model/force/diagnostics.h"
#include "model/system/particle_system.h"
#include "model/system/seams.h"

/* A value of all points at the last sample, stored as it is written to files. */
struct cs_export_field {
    const char *name, *plural; /* "velocity", "velocities" */
    uint32_t components;       /* 1 or 3 */
    uint64_t *words;           /* (n, components) little-endian doubles (base/serialise.h) */
};

enum { CS_EXPORT_FIELDS = 5 };

/* Points of bodies are the particles, in their order. All arrays belong to the arena. */
struct cs_export_mesh {
    const char *name, *item; /* of the files: "bodies"; of a part: "body" */
    uint32_t n, n_triangles, n_lines, n_items;
    uint32_t *triangles; /* (n_triangles, 3), counter-clockwise from outside */
    uint32_t *lines;     /* (n_lines, 2): bodies that are a row of particles */
    float
        *uv; /* (n_triangles, 3, 2) of corners, v upwards, NAN where a body has none; or NULL */
    uint32_t *items;                                     /* (n_items) indices in the scene */
    uint32_t *first_point, *first_triangle, *first_line; /* (n_items + 1) ranges of the items */
    double *local_positions;      /* (n, 3) m, in the frames of colliders; NULL: bodies */
    bool is_moving;               /* false: the positions of the first sample stay */
    const struct cs_seams *seams; /* of bodies; NULL: none */
    uint32_t n_fields;
    struct cs_export_field fields[CS_EXPORT_FIELDS]; /* the first: positions in m */
};

/* Adds a field with so many components per point; returns it. On failure error is set. */
struct cs_export_field *cs_export_mesh_add_field(struct cs_export_mesh *mesh,
                                                 const char *const names[2],
                                                 uint32_t components, struct cs_arena *arena,
                                                 struct cs_error *error);

/* Makes the mesh of all bodies of a system: topology and texture coordinates. */
enum cs_status cs_export_mesh_of_bodies(struct cs_export_mesh *mesh,
                                        const struct cs_system *system, struct cs_arena *arena,
                                        struct cs_error *error);

/* Makes the mesh of the visible colliders: meshes as they are, planes and floors as the square
 * that is drawn, other shapes with points on their surface. Empty if no collider
 * is visible. */
enum cs_status cs_export_mesh_of_colliders(struct cs_export_mesh *mesh,
                                           const struct cs_system *system,
                                           struct cs_arena *arena, struct cs_error *error);

/* Sets the positions of colliders at time t in s. */
void cs_export_mesh_pose_colliders(struct cs_export_mesh *mesh, const struct cs_system *system,
                                   double t);

/* Fills uv (n) with one texture coordinate per point, if mesh->uv exists: that of its first
 * corner, which differs from the others at seams only; 0 if it has none. */
void cs_export_mesh_point_uv(const struct cs_export_mesh *mesh, float (*uv)[2]);

/* Sets a field from an array (components, n). */
void cs_export_mesh_set(const struct cs_export_mesh *mesh, const struct cs_export_field *field,
                        const double *values);

#endif

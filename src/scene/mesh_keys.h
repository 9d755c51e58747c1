/* mesh_keys.h - keys that bodies, colliders and events share: meshes, placements, holders. */
#ifndef CS_MESH_KEYS_H
#define CS_MESH_KEYS_H

#include "mesh/vertex_paths.h"

#include <clothsim/option.h>

/* A rigid placement x = R p + translate; R from the matrix, or from the quaternion. */
struct cs_pose {
    double translate[3]; /* m */
    double rotate[4];    /* quaternion x, y, z, w; normalised by cs_scene_check */
    double matrix[9];    /* rows of a rotation matrix; first element NAN: absent */
};

/* A collider that carries particles along. */
struct cs_holder {
    bool present;
    int64_t collider; /* -1: not given, refused */
};

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

#endif

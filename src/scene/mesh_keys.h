/* mesh_keys.h - keys of the meshes of bodies and colliders, and of their key frames. */
#ifndef CS_MESH_KEYS_H
#define CS_MESH_KEYS_H

#include "scene/check.h"

#include <clothsim/option.h>

/* Positions of the vertices at equal intervals of time, in files. */
struct cs_key_frames {
    bool present;
    char file[CS_TEXT_MAX];  /* PC2, NPZ, or OBJ with # for the digits of a number */
    char array[CS_TEXT_MAX]; /* of an NPZ; "": positions */
    int64_t first, count;    /* of OBJ files; count 0: not given */
    double rate;             /* 1/s */
    double start;            /* s, time of the first key frame */
    int32_t end;             /* enum cs_paths_end */
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
};

#endif

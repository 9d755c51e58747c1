/* collider.h - the shapes of colliders: all that is asked of one, each shape in a file of its
 * own.
 *
 * Every shape but planes and meshes is a core - a point, a segment or a box - and all points
 * within `radius` of it: sphere, capsule, box with rounded edges. A floor is a plane. A mesh
 * has no distance here: bodies meet its parts in pairs (model/pair), and where its vertices are
 * model/contact/surface_points.h says.
 *
 * A new shape: its keys and its line in CS_SHAPE_LIST (scene.h), shape_NAME.c with
 * cs_NAME_keys and cs_shape_NAME, and that file in meson.build.
 */
#ifndef CS_COLLIDER_H
#define CS_COLLIDER_H

#include "base/vec3.h"
#include "mesh/trimesh.h"
#include "scene/check.h"

/* One collider as it is at one time. */
struct cs_posed_collider {
    const struct cs_shape *shape;
    const struct cs_collider *collider; /* borrowed from the system's scene: friction, ... */
    double centre[3];  /* m; of a plane: a point on it; of a mesh: the origin of its places */
    double axes[3][3]; /* unit vectors of its own frame, right-handed; a plane's normal and a
                          capsule's axis are axes[1] */
    double half_sizes[3]; /* m, half sizes of the core along the axes: 0 of a sphere, core[1] of
                       a capsule */
    double radius;        /* m, of what lies about the core; 0 of a plane */
    double velocity[3];   /* m/s, of the pivot */
    double spin[3];       /* rad/s */
    double rotation_centre[3]; /* m, what it turns about: the centre */
};

/* What bounds a shape, which hot loops ask first. */
enum cs_shape_bounds {
    CS_BOUNDS_SPHERE,     /* it is the sphere of its radius */
    CS_BOUNDS_HALF_SPACE, /* it is all behind a plane */
    CS_BOUNDS_BOX,        /* it is within the radius about the box of its core */
    CS_BOUNDS_MESH        /* triangles, felt in pairs alone */
};

/* Calls may be NULL where said. Those with an obstacle take one of this shape. */
struct cs_shape {
    enum cs_shape_bounds bounds;
    bool is_core; /* it is all within the radius of its core: pictures draw it smooth */

    /* Checks what single ranges cannot say, and fills absent keys; path: of the collider. NULL:
     * nothing to check. */
    enum cs_status (*check)(const struct cs_check *at, const char *path,
                            struct cs_collider *collider);

    /* Sets centre, axes, core and radius where they are neither 0 nor the world's axes. */
    void (*pose)(const struct cs_collider *collider, struct cs_posed_collider *out);

    /* cs_posed_collider_distance (model/contact/posed_collider.h) less `skin` in m. */
    double (*distance)(const struct cs_posed_collider *obstacle, double skin, const double p[3],
                       double n[3]);

    /* cs_posed_collider_smooth_distance. */
    double (*smooth)(const struct cs_posed_collider *obstacle, const double p[3],
                     double gradient[3], double hessian[6]);

    /* cs_posed_collider_hits_segment. */
    bool (*meets_line)(const struct cs_posed_collider *obstacle, const double from[3],
                       const double way[3], double share);

    /* Depth in m by which a chord of `cell` m between two points of the surface cuts into it.
     * NULL: 0. */
    double (*chord_depth)(const struct cs_posed_collider *obstacle, double cell);

    /* Makes its surface in its own frame, counter-clockwise seen from outside. CS_ERR_MEMORY.
     */
    enum cs_status (*triangles)(const struct cs_posed_collider *obstacle,
                                struct cs_trimesh *mesh, struct cs_arena *arena,
                                struct cs_error *error);
};

#define X(name, keys, text)                                                                    \
    extern const struct cs_table cs_##name##_keys;                                             \
    extern const struct cs_shape cs_shape_##name;
CS_SHAPE_LIST(X)
#undef X

/* The one that is present. */
static inline const struct cs_shape *cs_collider_shape(const struct cs_collider *collider) {
#define X(name, keys, text)                                                                    \
    if (collider->name.present)                                                                \
        return &cs_shape_##name;
    CS_SHAPE_LIST(X)
#undef X
    return NULL;
}

/* It has no end: a plane or a floor. */
static inline bool cs_shape_is_endless(const struct cs_shape *shape) {
    return shape->bounds == CS_BOUNDS_HALF_SPACE;
}

/* It may come in between particles, so that edges and triangles need points of their own
 * (model/contact/contact_samples.h). */
static inline bool cs_shape_needs_points(const struct cs_shape *shape) {
    return shape->bounds == CS_BOUNDS_SPHERE || shape->bounds == CS_BOUNDS_BOX;
}

/* x = p in the obstacle's own frame, in m. */
static inline void cs_collider_to_local(const struct cs_posed_collider *obstacle,
                                        const double p[3], double x[3]) {
    const double from[3] = {p[0] - obstacle->centre[0], p[1] - obstacle->centre[1],
                            p[2] - obstacle->centre[2]};
    for (int k = 0; k < 3; k++)
        x[k] = cs_vec3_dot(obstacle->axes[k], from);
}

/* A point of the obstacle's own frame in the world's, in m. */
static inline void cs_collider_to_world(const struct cs_posed_collider *obstacle,
                                        const double own[3], double out[3]) {
    for (int c = 0; c < 3; c++)
        out[c] = obstacle->centre[c] + obstacle->axes[0][c] * own[0] +
                 obstacle->axes[1][c] * own[1] + obstacle->axes[2][c] * own[2];
}

/* A vector of the own frame in the world's. */
static inline void cs_collider_rotate(const struct cs_posed_collider *obstacle,
                                      const double own[3], double out[3]) {
    for (int c = 0; c < 3; c++)
        out[c] = own[0] * obstacle->axes[0][c] + own[1] * obstacle->axes[1][c] +
                 own[2] * obstacle->axes[2][c];
}

#endif

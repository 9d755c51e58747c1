/* collider.h - the interface of collider shapes; each shape has a file of its own.
 *
 * Every shape but planes and meshes is a core - a point, a segment or a box - and all points
 * within `radius` of it: sphere, capsule, box with rounded edges. A floor is a plane. A mesh
 * has no distance here: bodies meet its features in pairs (model/contact/narrow_phase), and
 * model/contact/contact_samples.h gives the positions of its vertices.
 *
 * A new shape needs: its keys and its line in CS_SOLID_LIST (collider_keys.h), shape_NAME.c
 * with cs_NAME_keys and cs_shape_NAME, and that file in meson.build.
 */
#ifndef CS_COLLIDER_H
#define CS_COLLIDER_H

#include "base/status.h"
#include "base/vec3.h"
#include "mesh/trimesh.h"
#include "mesh/vertex_paths.h"

struct cs_check;
struct cs_collider;

/* One collider at one time: a shape with its pose and its motion. */
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
    double growth;        /* m/s, of the radius and the thickness by ramps */
    double rotation_centre[3];   /* m, what it turns about: the centre, or that of a move */
    struct cs_path_weights path; /* of a mesh with key frames: at its time; else 0 */
};

/* Simple bound of a shape, which hot loops test first. */
enum cs_shape_bounds {
    CS_BOUNDS_SPHERE,     /* it is the sphere of its radius */
    CS_BOUNDS_HALF_SPACE, /* it is all behind a plane */
    CS_BOUNDS_BOX,        /* it is within the radius about the box of its core */
    CS_BOUNDS_MESH        /* triangles, felt in pairs alone */
};

/* Calls of one shape. They may be NULL where said. Those with a posed collider take one of this
 * shape; m are metres of the world. */
struct cs_shape {
    enum cs_shape_bounds bounds;
    bool is_core; /* it is all within the radius of its core: pictures draw it smooth */

    /* Checks what single ranges cannot say, and fills absent keys; path: of the collider. NULL:
     * nothing to check. */
    enum cs_status (*check)(const struct cs_check *at, const char *path,
                            struct cs_collider *collider);

    /* Sets centre, axes, core and radius where they are neither 0 nor the world's axes. */
    void (*pose)(const struct cs_collider *collider, struct cs_posed_collider *out);

    /* cs_posed_collider_distance (model/contact/posed_collider.h) less `skin` in m; n: unit
     * normal. Exact: negative inside. */
    double (*distance)(const struct cs_posed_collider *posed, double skin, const double p[3],
                       double n[3]);

    /* cs_posed_collider_smooth_distance, which says how smooth it is: gradient (3), Hessian
     * (xx, xy, xz, yy, yz, zz) in 1/m. */
    double (*smooth)(const struct cs_posed_collider *posed, const double p[3],
                     double gradient[3], double hessian[6]);

    /* cs_posed_collider_hits_segment: true if the segment from..from + share way comes
     * inside. */
    bool (*meets_line)(const struct cs_posed_collider *posed, const double from[3],
                       const double way[3], double share);

    /* Depth in m by which a chord of `cell` m between two points of the surface cuts into it.
     * NULL: 0. */
    double (*chord_depth)(const struct cs_posed_collider *posed, double cell);

    /* Makes its surface in its own frame, counter-clockwise seen from outside; memory from the
     * arena. Fails with CS_ERR_MEMORY.
     */
    enum cs_status (*triangles)(const struct cs_posed_collider *posed, struct cs_trimesh *mesh,
                                struct cs_arena *arena, struct cs_error *error);
};

/* Asserts that a shape has the calls that may not be NULL. */
static inline void cs_shape_assert(const struct cs_shape *shape) {
    CS_ASSERT(shape->pose && shape->distance && shape->smooth && shape->meets_line &&
              shape->triangles);
}

/* Returns true if it has no end: a plane or a floor. */
static inline bool cs_shape_is_endless(const struct cs_shape *shape) {
    return shape->bounds == CS_BOUNDS_HALF_SPACE;
}

/* Returns true if it may come in between particles. Edges and triangles of bodies then need
 * contact samples of their own (model/contact/contact_samples.h). */
static inline bool cs_shape_needs_points(const struct cs_shape *shape) {
    return shape->bounds == CS_BOUNDS_SPHERE || shape->bounds == CS_BOUNDS_BOX;
}

/* Sets x = p in the collider's own frame, in m. */
static inline void cs_collider_to_local(const struct cs_posed_collider *collider,
                                        const double p[3], double x[3]) {
    const double from[3] = {p[0] - collider->centre[0], p[1] - collider->centre[1],
                            p[2] - collider->centre[2]};
    for (int k = 0; k < 3; k++)
        x[k] = cs_vec3_dot(collider->axes[k], from);
}

/* Sets own = position in m of vertex i of a mesh in its own frame, at its time if it has key
 * frames. */
void cs_collider_mesh_vertex(const struct cs_posed_collider *collider, uint32_t i,
                             double own[3]);

/* Sets positions (3,n) of all vertices likewise. */
void cs_collider_mesh_vertices(const struct cs_posed_collider *collider, double *positions);

/* Sets out = a point of the collider's own frame in the world, in m. */
static inline void cs_collider_to_world(const struct cs_posed_collider *collider,
                                        const double own[3], double out[3]) {
    for (int c = 0; c < 3; c++)
        out[c] = collider->centre[c] + collider->axes[0][c] * own[0] +
                 collider->axes[1][c] * own[1] + collider->axes[2][c] * own[2];
}

/* Sets out = a vector of the own frame in the world; no translation. */
static inline void cs_collider_rotate(const struct cs_posed_collider *collider,
                                      const double own[3], double out[3]) {
    for (int c = 0; c < 3; c++)
        out[c] = own[0] * collider->axes[0][c] + own[1] * collider->axes[1][c] +
                 own[2] * collider->axes[2][c];
}

#endif

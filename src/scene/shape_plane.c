/* The plane, and the floor: a horizontal plane.
 *
 * With a point c and the unit normal n the signed distance is d(p) = n.(p - c), negative behind
 * the plane. Its gradient is n and its Hessian 0: exact and smooth distance are the same. */
#include "base/vec3.h"
#include "scene/check.h"
#include "scene/collider.h"
#include "scene/collider_keys.h"
#include "scene/shape_core.h"
#include "scene/table_rows.h"

#include <stdio.h>
#include <string.h>

static const double zero3[3] = {0, 0, 0};
static const double up3[3] = {0, 1, 0};
static const struct cs_option plane_rows[] = {
    VECTOR(struct cs_plane, point, 3, "m", zero3, -BIG, BIG, "a point of the plane"),
    VECTOR(struct cs_plane, normal, 3, "", up3, -BIG, BIG,
           "points to the free side; of any non-zero length"),
    REAL(struct cs_plane, extent, "m", 1, 1e-6, 1e6,
         "half the side of the square in exports and, unless it is a floor, in pictures"),
};
const struct cs_table cs_plane_keys = {ROWS(plane_rows), .size = sizeof(struct cs_plane),
                                       .optional = true};
static const struct cs_option floor_rows[] = {
    REAL(struct cs_floor, height, "m", 0, -BIG, BIG, "the plane y = height"),
    REAL(struct cs_floor, extent, "m", 3, 1e-6, 1e6,
         "half the side of the square in exports; pictures show it to the horizon"),
};
const struct cs_table cs_floor_keys = {ROWS(floor_rows), .size = sizeof(struct cs_floor),
                                       .optional = true};

/* Makes the normal a unit vector; refuses the zero vector. */
static enum cs_status check(const struct cs_check *at, const char *path,
                            struct cs_collider *collider) {
    char key[CS_TEXT_MAX];
    snprintf(key, sizeof key, "%s.plane.normal", path);
    return cs_check_unit(at, key, collider->plane.normal, 3);
}

/* The normal is axes[1]; the two others only orient the square that is drawn. */
static void pose_plane(const struct cs_collider *collider, struct cs_posed_collider *out) {
    memcpy(out->centre, collider->plane.point, sizeof out->centre);
    memcpy(out->axes[1], collider->plane.normal, sizeof out->axes[1]);
    cs_core_complete_axes(out->axes);
}

static void pose_floor(const struct cs_collider *collider, struct cs_posed_collider *out) {
    out->centre[1] = collider->floor.height;
    cs_core_complete_axes(out->axes);
}

static double plane_distance(const struct cs_posed_collider *collider, double skin,
                             const double p[3], double n[3]) {
    memcpy(n, collider->axes[1], 3 * sizeof *n);
    double distance = -skin;
    for (int c = 0; c < 3; c++)
        distance += n[c] * (p[c] - collider->centre[c]);
    return distance;
}

static double smooth(const struct cs_posed_collider *collider, const double p[3], double g[3],
                     double h[6]) {
    memset(h, 0, 6 * sizeof *h);
    return plane_distance(collider, 0, p, g);
}

/* Returns true if an end of the line is behind the plane: d is linear along it. */
static bool meets_line(const struct cs_posed_collider *collider, const double from[3],
                       const double way[3], double share) {
    const double *normal = collider->axes[1];
    double distance = 0;
    for (int c = 0; c < 3; c++)
        distance += normal[c] * (from[c] - collider->centre[c]);
    return distance < 0 || distance + share * cs_vec3_dot(normal, way) < 0;
}

/* Makes the square that is drawn, of half side `extent`, in the plane y = 0 of its own frame.
 */
static enum cs_status triangles(const struct cs_posed_collider *plane, struct cs_trimesh *mesh,
                                struct cs_arena *arena, struct cs_error *error) {
    static const signed char signs[4][2] = {{-1, -1}, {-1, 1}, {1, 1}, {1, -1}};
    static const uint32_t corners[6] = {0, 1, 2, 0, 2, 3};
    const struct cs_collider *collider = plane->collider;
    const double extent =
        collider->plane.present ? collider->plane.extent : collider->floor.extent;
    if (cs_trimesh_init(mesh, 4, 2, false, arena, error))
        return error->status;
    for (size_t i = 0; i < 4; i++) {
        mesh->positions[i] = signs[i][0] * extent;
        mesh->positions[8 + i] = signs[i][1] * extent;
    }
    memcpy(mesh->triangles, corners, sizeof corners);
    return CS_OK;
}

const struct cs_shape cs_shape_plane = {
    .bounds = CS_BOUNDS_HALF_SPACE,
    .check = check,
    .pose = pose_plane,
    .distance = plane_distance,
    .smooth = smooth,
    .meets_line = meets_line,
    .triangles = triangles,
};

const struct cs_shape cs_shape_floor = {
    .bounds = CS_BOUNDS_HALF_SPACE,
    .pose = pose_floor,
    .distance = plane_distance,
    .smooth = smooth,
    .meets_line = meets_line,
    .triangles = triangles,
};

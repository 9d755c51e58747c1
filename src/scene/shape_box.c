/* The box with rounded edges: all points within a radius of a smaller box, its core.
 *
 * With half sizes c of the core and o_i = |x_i| - c_i in the own frame
 *   d = |max(o, 0)| + min(max_i o_i, 0) - r.
 * The gradient is the unit vector from the nearest point of the core; inside the core it is the
 * normal of the nearest face. shape_core.c has the smoothed distance and its derivatives. */
#include "scene/body_particles.h"
#include "scene/check.h"
#include "scene/collider_keys.h"
#include "scene/shape_core.h"
#include "scene/table_rows.h"

#include <stdio.h>
#include <string.h>

static const double no_turn[4] = {0, 0, 0, 1};
static const struct cs_option cuboid_rows[] = {
    VECTOR(struct cs_cuboid, centre, 3, "m", NULL, -BIG, BIG, "centre"),
    VECTOR(struct cs_cuboid, size, 3, "m", NULL, 1e-6, 1e6,
           "length of its edges along x, y and z, before the rotation"),
    VECTOR(struct cs_cuboid, rotate, 4, "", no_turn, -BIG, BIG,
           "rotation about the centre as a quaternion x, y, z, w of any length"),
    REAL(struct cs_cuboid, radius, "m", ABSENT, 1e-9, BIG,
         "rounds edges and corners, within size; absent: a twentieth of the shortest edge"),
};
const struct cs_table cs_box_keys = {ROWS(cuboid_rows), .size = sizeof(struct cs_cuboid),
                                     .optional = true};

/* Fills an absent radius, a twentieth of the shortest edge, and refuses one above half of it.
 */
static enum cs_status check(const struct cs_check *at, const char *path,
                            struct cs_collider *collider) {
    struct cs_cuboid *box = &collider->box;
    const double least = 0.5 * fmin(box->size[0], fmin(box->size[1], box->size[2]));
    char key[CS_TEXT_MAX];
    snprintf(key, sizeof key, "%s.box.radius", path);
    if (isnan(box->radius))
        box->radius = 0.1 * least;
    if (box->radius > least)
        return cs_check_refuse(at, key, "%.9g m is more than half the shortest edge, %.9g m",
                               box->radius, least);
    snprintf(key, sizeof key, "%s.box.rotate", path);
    return cs_check_unit(at, key, box->rotate, 4);
}

/* The core is the box shrunk by the radius; the outer faces are where `size` says. */
static void pose(const struct cs_collider *collider, struct cs_posed_collider *out) {
    const struct cs_cuboid *box = &collider->box;
    double r[9];
    out->radius = box->radius;
    memcpy(out->centre, box->centre, sizeof out->centre);
    cs_quaternion_matrix(box->rotate, r);
    for (int k = 0; k < 3; k++) {
        out->half_sizes[k] = fmax(0.5 * box->size[k] - box->radius, 0);
        for (int c = 0; c < 3; c++)
            out->axes[k][c] = r[3 * c + k];
    }
}

/* Exact distance; inside the core the nearest face leads out. */
static double box_distance(const struct cs_posed_collider *box, double skin, const double p[3],
                           double n[3]) {
    double x[3], out[3];
    if (!cs_core_holds(box, p, x, out))
        return cs_core_beyond(box, out, n) - skin;
    const int face = cs_core_nearest_face(box, x);
    for (int c = 0; c < 3; c++)
        n[c] = x[face] < 0 ? -box->axes[face][c] : box->axes[face][c];
    return fabs(x[face]) - box->half_sizes[face] - box->radius - skin;
}

/* Height of a chord of one cell over a sharp right-angled edge, at most a quarter of the
 * smallest half size. */
static double chord_depth(const struct cs_posed_collider *box, double cell) {
    const double *core = box->half_sizes;
    const double least = fmin(core[0], fmin(core[1], core[2])) + box->radius;
    return fmin(0.5 * cell, least / 4);
}

const struct cs_shape cs_shape_box = {
    .bounds = CS_BOUNDS_BOX,
    .is_core = true,
    .check = check,
    .pose = pose,
    .distance = box_distance,
    .smooth = cs_core_smooth,
    .meets_line = cs_core_meets_line,
    .chord_depth = chord_depth,
    .triangles = cs_core_triangles,
};

/* The capsule: all points within a radius of a segment.
 *
 * In the own frame the segment runs along axis 1 from -c to c, so the core's other half sizes
 * are 0. The distance is d = |(x_0, sign(x_1) max(|x_1| - c, 0), x_2)| - r; its gradient is
 * that vector divided by its length (shape_core.c). */
#include "base/vec3.h"
#include "scene/check.h"
#include "scene/collider_keys.h"
#include "scene/shape_core.h"
#include "scene/table_rows.h"

#include <stdio.h>

static const struct cs_option capsule_rows[] = {
    VECTOR(struct cs_capsule, from, 3, "m", NULL, -BIG, BIG, "centre of one round end"),
    VECTOR(struct cs_capsule, to, 3, "m", NULL, -BIG, BIG, "centre of the other"),
    REAL(struct cs_capsule, radius, "m", 0.05, 1e-9, BIG, "of the ends and of the rod"),
};
const struct cs_table cs_capsule_keys = {ROWS(capsule_rows), .size = sizeof(struct cs_capsule),
                                         .optional = true};

/* Refuses a segment shorter than 1e-9 m, which has no direction. */
static enum cs_status check(const struct cs_check *at, const char *path,
                            struct cs_collider *collider) {
    const struct cs_capsule *capsule = &collider->capsule;
    const double axis[3] = {capsule->to[0] - capsule->from[0],
                            capsule->to[1] - capsule->from[1],
                            capsule->to[2] - capsule->from[2]};
    char key[CS_TEXT_MAX];
    snprintf(key, sizeof key, "%s.capsule", path);
    return cs_check_length(axis, 3) > 1e-9
               ? CS_OK
               : cs_check_refuse(at, key, "from and to are the same, expected a sphere");
}

/* Centre and half length of the segment, and a frame along it. */
static void pose(const struct cs_collider *collider, struct cs_posed_collider *out) {
    const struct cs_capsule *capsule = &collider->capsule;
    out->radius = capsule->radius;
    for (int c = 0; c < 3; c++) {
        out->centre[c] = 0.5 * (capsule->from[c] + capsule->to[c]);
        out->axes[1][c] = capsule->to[c] - capsule->from[c];
    }
    out->half_sizes[1] = 0.5 * sqrt(cs_vec3_dot(out->axes[1], out->axes[1]));
    cs_vec3_normalise(out->axes[1]);
    cs_core_complete_axes(out->axes);
}

/* Exact distance; on the segment itself, where any direction leads out, the normal is up. */
static double capsule_distance(const struct cs_posed_collider *capsule, double skin,
                               const double p[3], double n[3]) {
    double x[3], out[3];
    if (!cs_core_holds(capsule, p, x, out))
        return cs_core_beyond(capsule, out, n) - skin;
    n[0] = n[2] = 0;
    n[1] = 1;
    return -capsule->radius - skin;
}

const struct cs_shape cs_shape_capsule = {
    .bounds = CS_BOUNDS_BOX,
    .is_core = true,
    .check = check,
    .pose = pose,
    .distance = capsule_distance,
    .smooth = cs_core_smooth,
    .meets_line = cs_core_meets_line,
    .chord_depth = cs_core_chord_depth,
    .triangles = cs_core_triangles,
};

/* The sphere, with centre c and radius r. With l = |p - c|:
 *   d = l - r,   gradient n = (p - c) / l,   Hessian (I - n n^T) / l
 * In the centre the normal is up and the Hessian 0. */
#include "base/vec3.h"
#include "scene/collider_keys.h"
#include "scene/shape_core.h"
#include "scene/table_rows.h"

#include <string.h>

/* parts of an edge of the icosahedron whose faces become triangles (trimesh_shape.c) */
enum { DETAIL = 8 };

static const struct cs_option sphere_rows[] = {
    VECTOR(struct cs_sphere, centre, 3, "m", NULL, -BIG, BIG, "centre"),
    REAL(struct cs_sphere, radius, "m", 0.3, 1e-9, BIG, "radius"),
};
const struct cs_table cs_sphere_keys = {ROWS(sphere_rows), .size = sizeof(struct cs_sphere),
                                        .optional = true};

static void pose(const struct cs_collider *collider, struct cs_posed_collider *out) {
    out->radius = collider->sphere.radius;
    memcpy(out->centre, collider->sphere.centre, sizeof out->centre);
}

static double sphere_distance(const struct cs_posed_collider *sphere, double skin,
                              const double p[3], double n[3]) {
    return cs_core_from_point(p, sphere->centre, n) - sphere->radius - skin;
}

/* The exact distance is smooth: there are no features to blend. */
static double smooth(const struct cs_posed_collider *sphere, const double p[3], double g[3],
                     double h[6]) {
    const double length = cs_core_from_point(p, sphere->centre, g);
    memset(h, 0, 6 * sizeof *h);
    for (int e = 0; e < 6 && length > 0; e++) {
        const int r = cs_sym3_row[e], s = cs_sym3_column[e];
        h[e] = ((r == s) - g[r] * g[s]) / length;
    }
    return length - sphere->radius;
}

/* Returns true if the line comes nearer to the centre than the radius. Its nearest point is at
 * the fraction (c - from).way / way^2, limited to 0..share. */
static bool meets_line(const struct cs_posed_collider *sphere, const double from[3],
                       const double way[3], double share) {
    const double to[3] = {sphere->centre[0] - from[0], sphere->centre[1] - from[1],
                          sphere->centre[2] - from[2]};
    const double at = fmin(fmax(cs_vec3_dot(to, way) / cs_vec3_dot(way, way), 0), share);
    double squared = 0;
    for (int c = 0; c < 3; c++)
        squared += (at * way[c] - to[c]) * (at * way[c] - to[c]);
    return squared < sphere->radius * sphere->radius;
}

static enum cs_status triangles(const struct cs_posed_collider *sphere, struct cs_trimesh *mesh,
                                struct cs_arena *arena, struct cs_error *error) {
    if (cs_trimesh_make(mesh, CS_MESH_SPHERE, DETAIL, arena, error))
        return error->status;
    for (size_t k = 0; k < 3 * (size_t)mesh->n; k++)
        mesh->positions[k] *= 2 * sphere->radius;
    return CS_OK;
}

const struct cs_shape cs_shape_sphere = {
    .bounds = CS_BOUNDS_SPHERE,
    .pose = pose,
    .distance = sphere_distance,
    .smooth = smooth,
    .meets_line = meets_line,
    .chord_depth = cs_core_chord_depth,
    .triangles = triangles,
};

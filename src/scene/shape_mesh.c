/* The mesh as a collider. A line is held against it triangle by triangle (Moeller, Trumbore
 * 1997). Its keys are with those of bodies, scene_tables.c. */
#include "base/vec3.h"
#include "scene/collider.h"
#include "scene/shape.h"

#include <math.h>
#include <string.h>

static enum cs_status check(const struct cs_check *at, const char *path,
                            struct cs_collider *collider) {
    return cs_check_pose(at, path, "mesh", &collider->mesh.place);
}

static void pose(const struct cs_collider *collider, struct cs_posed_collider *out) {
    const struct cs_mesh_source *mesh = &collider->mesh;
    double r[9];
    memcpy(out->centre, mesh->place.translate, sizeof out->centre);
    cs_pose_rotation(&mesh->place, r);
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++)
            out->axes[k][c] = r[3 * c + k];
}

static double distance(const struct cs_posed_collider *mesh, double skin, const double p[3],
                       double n[3]) {
    (void)skin, (void)p;
    memcpy(n, mesh->axes[1], sizeof mesh->axes[1]);
    return HUGE_VAL;
}

static double smooth(const struct cs_posed_collider *mesh, const double p[3], double g[3],
                     double h[6]) {
    memset(h, 0, 6 * sizeof *h);
    return distance(mesh, 0, p, g);
}

/* a line in its own frame goes through its triangle t, rims included */
static bool meets_triangle(const struct cs_trimesh *mesh, uint32_t t, const double from[3],
                           const double way[3], double share) {
    const uint32_t *corners = mesh->triangles + 3 * (size_t)t;
    double u[3], v[3], to[3], across[3], turned[3];
    for (size_t c = 0; c < 3; c++) {
        const double *places = mesh->positions + c * mesh->n;
        u[c] = places[corners[1]] - places[corners[0]];
        v[c] = places[corners[2]] - places[corners[0]];
        to[c] = from[c] - places[corners[0]];
    }
    cs_vec3_cross(way, v, across);
    cs_vec3_cross(to, u, turned);
    const double whole = cs_vec3_dot(u, across), sign = whole < 0 ? -1 : 1;
    const double a = sign * cs_vec3_dot(to, across), b = sign * cs_vec3_dot(way, turned);
    const double at = sign * cs_vec3_dot(v, turned), size = sign * whole;
    return a >= 0 && b >= 0 && a + b <= size && at >= 0 && at < share * size;
}

static bool meets_line(const struct cs_posed_collider *obstacle, const double from[3],
                       const double way[3], double share) {
    const struct cs_trimesh *mesh = obstacle->collider->mesh.geometry;
    double own[3], own_way[3];
    bool meets = false;
    cs_collider_to_local(obstacle, from, own);
    for (int k = 0; k < 3; k++)
        own_way[k] = cs_vec3_dot(obstacle->axes[k], way);
    for (uint32_t t = 0; t < mesh->n_triangles && !meets; t++)
        meets = meets_triangle(mesh, t, own, own_way, share);
    return meets;
}

/* borrowed */
static enum cs_status triangles(const struct cs_posed_collider *obstacle,
                                struct cs_trimesh *mesh, struct cs_arena *arena,
                                struct cs_error *error) {
    (void)arena, (void)error;
    *mesh = *obstacle->collider->mesh.geometry;
    return CS_OK;
}

const struct cs_shape cs_shape_mesh = {
    .bounds = CS_BOUNDS_MESH,
    .check = check,
    .pose = pose,
    .distance = distance,
    .smooth = smooth,
    .meets_line = meets_line,
    .triangles = triangles,
};

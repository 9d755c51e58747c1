/* The mesh as a collider. It has no distance: its triangles meet bodies in pairs
 * (model/contact/narrow_phase).
 *
 * A line from + s way meets a triangle p0, p0 + u, p0 + v (Moeller, Trumbore 1997) if
 *   from - p0 + s way = a u + b v,   a, b >= 0,   a + b <= 1,   0 <= s < share.
 * Cramer's rule gives a, b and s over one determinant. The code compares the numerators with it
 * instead of dividing, so a line in the plane of the triangle needs no special case.
 *
 * The keys of the mesh are with those of bodies, in mesh_keys.c. */
#include "base/vec3.h"
#include "scene/body_particles.h"
#include "scene/collider.h"
#include "scene/collider_keys.h"
#include "scene/mesh_keys.h"

#include <string.h>

void cs_collider_mesh_vertex(const struct cs_posed_collider *collider, uint32_t i,
                             double own[3]) {
    const struct cs_trimesh *geometry = collider->collider->geometry;
    const struct cs_vertex_paths *paths = collider->collider->paths;
    for (size_t c = 0; c < 3 && !paths; c++)
        own[c] = geometry->positions[c * geometry->n + i];
    if (paths)
        cs_vertex_paths_sum(paths, &collider->path, collider->path.position, i, own);
}

void cs_collider_mesh_vertices(const struct cs_posed_collider *collider, double *positions) {
    const uint32_t n = collider->collider->geometry->n;
    for (uint32_t i = 0; i < n; i++) {
        double own[3];
        cs_collider_mesh_vertex(collider, i, own);
        for (size_t c = 0; c < 3; c++)
            positions[c * n + i] = own[c];
    }
}

static enum cs_status check(const struct cs_check *at, const char *path,
                            struct cs_collider *collider) {
    return cs_check_pose(at, path, "mesh", &collider->mesh->place);
}

static void pose(const struct cs_collider *collider, struct cs_posed_collider *out) {
    const struct cs_mesh_source *mesh = collider->mesh;
    double r[9];
    memcpy(out->centre, mesh->place.translate, sizeof out->centre);
    cs_pose_rotation(&mesh->place, r);
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++)
            out->axes[k][c] = r[3 * c + k];
}

/* Infinite: contact by distance never acts on a mesh. */
static double mesh_distance(const struct cs_posed_collider *mesh, double skin,
                            const double p[3], double n[3]) {
    (void)skin, (void)p;
    memcpy(n, mesh->axes[1], sizeof mesh->axes[1]);
    return HUGE_VAL;
}

static double smooth(const struct cs_posed_collider *mesh, const double p[3], double g[3],
                     double h[6]) {
    memset(h, 0, 6 * sizeof *h);
    return mesh_distance(mesh, 0, p, g);
}

/* Returns true if a line in the mesh's own frame goes through triangle t, edges included. */
static bool meets_triangle(const struct cs_posed_collider *collider, uint32_t t,
                           const double from[3], const double way[3], double share) {
    const uint32_t *vertices = collider->collider->geometry->triangles + 3 * (size_t)t;
    double corners[3][3], u[3], v[3], to[3], across[3], turned[3];
    for (size_t k = 0; k < 3; k++)
        cs_collider_mesh_vertex(collider, vertices[k], corners[k]);
    for (size_t c = 0; c < 3; c++) {
        u[c] = corners[1][c] - corners[0][c];
        v[c] = corners[2][c] - corners[0][c];
        to[c] = from[c] - corners[0][c];
    }
    cs_vec3_cross(way, v, across);
    cs_vec3_cross(to, u, turned);
    const double whole = cs_vec3_dot(u, across), sign = whole < 0 ? -1 : 1;
    const double a = sign * cs_vec3_dot(to, across), b = sign * cs_vec3_dot(way, turned);
    const double at = sign * cs_vec3_dot(v, turned), size = sign * whole;
    return a >= 0 && b >= 0 && a + b <= size && at >= 0 && at < share * size;
}

/* Tests the triangles one by one until one is met. */
static bool meets_line(const struct cs_posed_collider *collider, const double from[3],
                       const double way[3], double share) {
    const struct cs_trimesh *mesh = collider->collider->geometry;
    double own[3], own_way[3];
    bool meets = false;
    cs_collider_to_local(collider, from, own);
    for (int k = 0; k < 3; k++)
        own_way[k] = cs_vec3_dot(collider->axes[k], way);
    for (uint32_t t = 0; t < mesh->n_triangles && !meets; t++)
        meets = meets_triangle(collider, t, own, own_way, share);
    return meets;
}

/* Copies the struct; its arrays stay those of the scene, but for positions that change. */
static enum cs_status triangles(const struct cs_posed_collider *collider,
                                struct cs_trimesh *mesh, struct cs_arena *arena,
                                struct cs_error *error) {
    *mesh = *collider->collider->geometry;
    if (!collider->collider->paths)
        return CS_OK;
    mesh->positions = cs_arena_alloc_array(arena, mesh->n, 3 * sizeof *mesh->positions, error);
    if (mesh->positions)
        cs_collider_mesh_vertices(collider, mesh->positions);
    return error->status;
}

const struct cs_shape cs_shape_mesh = {
    .bounds = CS_BOUNDS_MESH,
    .check = check,
    .pose = pose,
    .distance = mesh_distance,
    .smooth = smooth,
    .meets_line = meets_line,
    .triangles = triangles,
};

/* Makes colliders of triangles: each in its own frame once, then placed at every sample.
 *
 * A box and a capsule are a cube's lattice blown up to a ball and pulled apart: a direction d
 * stands for the point sign(d) core + radius d of the surface. The lines of the lattice are
 * evenly spaced by angle, and the line in the middle of a face is there twice, once of each
 * sign; where the core has no extent, both are one. */
#include "io/export/export_colliders.h"

#include "base/little_endian.h"
#include "base/portable_sine.h"
#include "base/vec3.h"
#include "mesh/trimesh.h"

enum { BALL_DETAIL = 8, PARTS = 6, LINES = 2 * PARTS + 1 };

static enum cs_status make_square(const struct cs_collider *collider, struct cs_trimesh *mesh,
                                  struct cs_arena *arena, struct cs_error *error) {
    static const signed char signs[4][2] = {{-1, -1}, {-1, 1}, {1, 1}, {1, -1}};
    static const uint32_t corners[6] = {0, 1, 2, 0, 2, 3};
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

static enum cs_status make_ball(double radius, struct cs_trimesh *mesh, struct cs_arena *arena,
                                struct cs_error *error) {
    if (cs_trimesh_make(mesh, CS_MESH_SPHERE, BALL_DETAIL, arena, error))
        return error->status;
    for (size_t k = 0; k < 3 * (size_t)mesh->n; k++)
        mesh->positions[k] *= 2 * radius;
    return CS_OK;
}

/* tan(step / PARTS * 45 degrees) */
static double tangent(int step) {
    const double r = (step < 0 ? -step : step) / (2.0 * PARTS);
    const double t = cs_quarter_sine(r) / cs_quarter_sine(1 - r);
    return step < 0 ? -t : t;
}

static void bend(const struct cs_posed_collider *obstacle, struct cs_trimesh *mesh) {
    const size_t n = mesh->n;
    for (size_t i = 0; i < n; i++) {
        double d[3], side[3];
        for (size_t k = 0; k < 3; k++) {
            /* the number of the line, whose places run from -0.5 to 0.5 */
            const int line = (int)((mesh->positions[k * n + i] + 0.5) * LINES + 0.5);
            side[k] = line > PARTS ? 1 : -1;
            d[k] = tangent(line > PARTS ? line - PARTS - 1 : line - PARTS);
        }
        cs_vec3_normalise(d);
        for (size_t k = 0; k < 3; k++)
            mesh->positions[k * n + i] =
                side[k] * obstacle->half_sizes[k] + obstacle->radius * d[k];
    }
}

static bool is_same(const struct cs_trimesh *mesh, size_t i, size_t j) {
    const double *p = mesh->positions;
    const size_t n = mesh->n;
    return p[i] == p[j] && p[n + i] == p[n + j] && p[2 * n + i] == p[2 * n + j];
}

/* Points at one place become one, and triangles without area go. */
static enum cs_status weld(struct cs_trimesh *mesh, struct cs_arena *arena,
                           struct cs_error *error) {
    uint32_t *to = cs_arena_alloc_array(arena, mesh->n, sizeof *to, error), kept = 0, left = 0;
    double *places = cs_arena_alloc_array(arena, mesh->n, 3 * sizeof *places, error);
    if (error->status)
        return error->status;
    for (uint32_t i = 0; i < mesh->n; i++) {
        uint32_t j = 0;
        while (j < i && !is_same(mesh, i, j))
            j++;
        to[i] = j < i ? to[j] : kept++;
        for (size_t k = 0; k < 3; k++)
            places[3 * (size_t)to[i] + k] = mesh->positions[k * mesh->n + i];
    }
    for (size_t t = 0; t < mesh->n_triangles; t++) {
        const uint32_t *old = mesh->triangles + 3 * t;
        const uint32_t a = to[old[0]], b = to[old[1]], c = to[old[2]];
        if (a == b || b == c || c == a)
            continue;
        uint32_t *new = mesh->triangles + 3 * (size_t)left++;
        new[0] = a, new[1] = b, new[2] = c;
    }
    mesh->n = kept;
    mesh->n_triangles = left;
    for (size_t i = 0; i < kept; i++)
        for (size_t k = 0; k < 3; k++)
            mesh->positions[k * kept + i] = places[3 * i + k];
    return CS_OK;
}

/* of a collider in its own frame */
static enum cs_status make(const struct cs_posed_collider *obstacle, struct cs_trimesh *mesh,
                           struct cs_arena *arena, struct cs_error *error) {
    if (obstacle->kind == CS_COLLIDER_MESH)
        *mesh = *obstacle->collider->mesh.geometry;
    else if (obstacle->kind == CS_COLLIDER_PLANE)
        make_square(obstacle->collider, mesh, arena, error);
    else if (obstacle->kind == CS_COLLIDER_SPHERE)
        make_ball(obstacle->radius, mesh, arena, error);
    else if (!cs_trimesh_make(mesh, CS_MESH_BOX, LINES, arena, error)) {
        bend(obstacle, mesh);
        weld(mesh, arena, error);
    }
    return error->status;
}

static void fill(struct cs_export_mesh *skin, uint32_t item, const struct cs_trimesh *mesh) {
    const uint32_t first = skin->first_point[item];
    for (size_t i = 0; i < mesh->n; i++)
        for (size_t k = 0; k < 3; k++)
            skin->local_positions[3 * (first + i) + k] = mesh->positions[k * mesh->n + i];
    uint32_t *corner = skin->triangles + 3 * (size_t)skin->first_triangle[item];
    for (size_t k = 0; k < 3 * (size_t)mesh->n_triangles; k++)
        corner[k] = first + mesh->triangles[k];
}

/* meshes (colliders.n) of those that are visible */
static enum cs_status join(struct cs_export_mesh *skin,
                           const struct cs_posed_collider *obstacles,
                           const struct cs_trimesh *meshes, struct cs_arena *arena,
                           struct cs_error *error) {
    skin->local_positions =
        cs_arena_alloc_array(arena, skin->n, 3 * sizeof *skin->local_positions, error);
    if (cs_export_mesh_set_values(skin, false, arena, error))
        return error->status;
    for (uint32_t k = 0, item = 0; item < skin->n_items; k++) {
        if (!obstacles[k].collider->visible)
            continue;
        skin->items[item] = k;
        skin->first_point[item + 1] = skin->first_point[item] + meshes[k].n;
        skin->first_triangle[item + 1] = skin->first_triangle[item] + meshes[k].n_triangles;
        fill(skin, item++, meshes + k);
    }
    return CS_OK;
}

enum cs_status cs_export_mesh_of_colliders(struct cs_export_mesh *skin,
                                           const struct cs_system *system,
                                           struct cs_arena *arena, struct cs_error *error) {
    const uint32_t n = system->scene->colliders.n;
    struct cs_arena making = {0};
    struct cs_posed_collider *obstacles =
        cs_arena_alloc_array(&making, n, sizeof *obstacles, error);
    struct cs_trimesh *meshes = cs_arena_alloc_array(&making, n, sizeof *meshes, error);
    *skin = (struct cs_export_mesh){
        .name = "colliders", .item = "collider", .is_moving = system->motions != NULL};
    if (!error->status)
        cs_posed_colliders_at(system, 0, obstacles);
    for (uint32_t k = 0; k < n && !error->status; k++) {
        if (!obstacles[k].collider->visible || make(obstacles + k, meshes + k, &making, error))
            continue;
        skin->n += meshes[k].n;
        skin->n_triangles += meshes[k].n_triangles;
        skin->n_items++;
    }
    if (!error->status)
        join(skin, obstacles, meshes, arena, error);
    cs_arena_finish(&making);
    return error->status;
}

void cs_export_mesh_pose_colliders(struct cs_export_mesh *skin, const struct cs_system *system,
                                   double t) {
    uint64_t *out = skin->fields[0].words;
    for (uint32_t item = 0; item < skin->n_items; item++) {
        struct cs_posed_collider at;
        cs_posed_collider_at(system, skin->items[item], t, &at);
        for (size_t i = skin->first_point[item]; i < skin->first_point[item + 1]; i++)
            for (size_t c = 0; c < 3; c++) {
                const double *own = skin->local_positions + 3 * i;
                out[3 * i + c] =
                    cs_double_to_le64(at.centre[c] + at.axes[0][c] * own[0] +
                                      at.axes[1][c] * own[1] + at.axes[2][c] * own[2]);
            }
    }
}

/* Joins the particles of all bodies to triangles and lines, and makes triangles of colliders. A
 * collider's triangles are made once in its own frame, then posed at every sample, where key
 * frames change its points. */
#include "session/export_mesh.h"

#include "base/serialise.h"
#include "model/contact/posed_collider.h"
#include "model/system/surfaces.h"
#include "scene/collider_keys.h"

#include <math.h>
#include <string.h>

/* Allocates topology, uv if asked for, and the field of positions. */
static enum cs_status allocate_mesh(struct cs_export_mesh *mesh, bool uv,
                                    struct cs_arena *arena, struct cs_error *error) {
    static const char *const positions[2] = {"position", "positions"};
    const size_t corners = 3 * (size_t)mesh->n_triangles, items = mesh->n_items;
    mesh->triangles = cs_arena_alloc_array(arena, corners, sizeof *mesh->triangles, error);
    CS_ARENA_ARRAY(arena, mesh->lines, 2 * (size_t)mesh->n_lines, error);
    mesh->items = cs_arena_alloc_array(arena, items, sizeof *mesh->items, error);
    CS_ARENA_ARRAY(arena, mesh->first_point, items + 1, error);
    mesh->first_triangle = cs_arena_alloc_array(arena, items + 1, sizeof(uint32_t), error);
    mesh->first_line = cs_arena_alloc_array(arena, items + 1, sizeof *mesh->first_line, error);
    if (uv)
        mesh->uv = cs_arena_alloc_array(arena, corners, 2 * sizeof *mesh->uv, error);
    cs_export_mesh_add_field(mesh, positions, 3, arena, error);
    return error->status;
}

struct cs_export_field *cs_export_mesh_add_field(struct cs_export_mesh *mesh,
                                                 const char *const names[2],
                                                 uint32_t components, struct cs_arena *arena,
                                                 struct cs_error *error) {
    CS_ASSERT(mesh->n_fields < CS_EXPORT_FIELDS);
    struct cs_export_field *field = mesh->fields + mesh->n_fields++;
    *field = (struct cs_export_field){
        .name = names[0],
        .plural = names[1],
        .components = components,
        .words = cs_arena_alloc_array(arena, mesh->n, components * sizeof(uint64_t), error)};
    return field;
}

void cs_export_mesh_set(const struct cs_export_mesh *mesh, const struct cs_export_field *field,
                        const double *values) {
    const size_t n = mesh->n, components = field->components;
    for (size_t i = 0; i < n; i++)
        for (size_t c = 0; c < components; c++)
            field->words[i * components + c] = cs_double_to_le64(values[c * n + i]);
}

/* Lines of a body: only a single row or column of particles, which has no triangles. */
static uint32_t count_lines(const struct cs_body_range *body) {
    return body->mesh || cs_faces_count(body) ? 0 : body->count - 1;
}

/* Texture coordinates of a triangle, v upwards: of a grid 0..1 across and up; of a mesh those
 * of its file, whose v points down here; NaN if it has none. */
static void set_uv(const struct cs_body_range *body, uint32_t t, const uint32_t corners[3],
                   float uv[6]) {
    const struct cs_trimesh *mesh = body->mesh;
    for (size_t k = 0; k < 3; k++) {
        float *at = uv + 2 * k;
        if (mesh && mesh->uv) {
            at[0] = mesh->uv[6 * (size_t)t + 2 * k];
            at[1] = 1 - mesh->uv[6 * (size_t)t + 2 * k + 1];
        } else if (mesh) {
            at[0] = at[1] = (float)NAN;
        } else {
            const uint32_t column = corners[k] % body->columns,
                           row = corners[k] / body->columns;
            at[0] = (float)((double)column / (body->columns - 1));
            at[1] = (float)(1 - (double)row / (body->rows - 1));
        }
    }
}

void cs_export_mesh_point_uv(const struct cs_export_mesh *mesh, float (*uv)[2]) {
    memset(uv, 0, mesh->n * sizeof *uv);
    for (size_t corner = 3 * (size_t)mesh->n_triangles; corner-- > 0;)
        if (!isnan(mesh->uv[2 * corner]))
            memcpy(uv[mesh->triangles[corner]], mesh->uv + 2 * corner, sizeof *uv);
}

/* Writes triangles, texture coordinates and lines of body b with the particles' numbers. */
static void fill_body(struct cs_export_mesh *mesh, const struct cs_body_range *body,
                      uint32_t b) {
    for (uint32_t t = 0; t < cs_faces_count(body); t++) {
        const size_t at = 3 * (size_t)(mesh->first_triangle[b] + t);
        uint32_t corners[3];
        cs_face_corners(body, t, corners);
        for (size_t k = 0; k < 3; k++)
            mesh->triangles[at + k] = body->first + corners[k];
        if (mesh->uv)
            set_uv(body, t, corners, mesh->uv + 2 * at);
    }
    for (uint32_t i = 0; i < count_lines(body); i++)
        for (uint32_t end = 0; end < 2; end++)
            mesh->lines[2 * (size_t)(mesh->first_line[b] + i) + end] = body->first + i + end;
}

enum cs_status cs_export_mesh_of_bodies(struct cs_export_mesh *mesh,
                                        const struct cs_system *system, struct cs_arena *arena,
                                        struct cs_error *error) {
    const uint32_t n_bodies = system->scene->bodies.n;
    bool uv = false;
    *mesh = (struct cs_export_mesh){.name = "bodies",
                                    .item = "body",
                                    .n = system->view.n,
                                    .n_items = n_bodies,
                                    .is_moving = true,
                                    .seams = system->seams};
    for (uint32_t b = 0; b < n_bodies; b++) {
        const struct cs_body_range *body = system->bodies + b;
        mesh->n_triangles += cs_faces_count(body);
        mesh->n_lines += count_lines(body);
        uv |= body->mesh ? body->mesh->uv != NULL : cs_faces_count(body) > 0;
    }
    if (allocate_mesh(mesh, uv, arena, error))
        return error->status;
    for (uint32_t b = 0; b < n_bodies; b++) {
        const struct cs_body_range *body = system->bodies + b;
        mesh->items[b] = b;
        mesh->first_point[b + 1] = body->first + body->count;
        mesh->first_triangle[b + 1] = mesh->first_triangle[b] + cs_faces_count(body);
        mesh->first_line[b + 1] = mesh->first_line[b] + count_lines(body);
        fill_body(mesh, body, b);
    }
    return CS_OK;
}

/* Copies the points of a collider in its own frame, and its triangles with shifted numbers. */
static void fill_collider(struct cs_export_mesh *export, uint32_t item,
                          const struct cs_trimesh *mesh) {
    const uint32_t first = export->first_point[item];
    for (size_t i = 0; i < mesh->n; i++)
        for (size_t k = 0; k < 3; k++)
            export->local_positions[3 * (first + i) + k] = mesh->positions[k * mesh->n + i];
    uint32_t *corner = export->triangles + 3 * (size_t) export->first_triangle[item];
    for (size_t k = 0; k < 3 * (size_t)mesh->n_triangles; k++)
        corner[k] = first + mesh->triangles[k];
}

/* Joins the visible ones of meshes (colliders.n), each in its own frame, to one mesh. */
static enum cs_status join(struct cs_export_mesh *mesh,
                           const struct cs_posed_collider *colliders,
                           const struct cs_trimesh *meshes, struct cs_arena *arena,
                           struct cs_error *error) {
    mesh->local_positions =
        cs_arena_alloc_array(arena, mesh->n, 3 * sizeof *mesh->local_positions, error);
    if (allocate_mesh(mesh, false, arena, error))
        return error->status;
    for (uint32_t k = 0, item = 0; item < mesh->n_items; k++) {
        if (!colliders[k].collider->visible)
            continue;
        mesh->items[item] = k;
        mesh->first_point[item + 1] = mesh->first_point[item] + meshes[k].n;
        mesh->first_triangle[item + 1] = mesh->first_triangle[item] + meshes[k].n_triangles;
        fill_collider(mesh, item++, meshes + k);
    }
    return CS_OK;
}

enum cs_status cs_export_mesh_of_colliders(struct cs_export_mesh *mesh,
                                           const struct cs_system *system,
                                           struct cs_arena *arena, struct cs_error *error) {
    const uint32_t n = system->scene->colliders.n;
    struct cs_arena making = {0};
    struct cs_posed_collider *colliders =
        cs_arena_alloc_array(&making, n, sizeof *colliders, error);
    struct cs_trimesh *meshes = cs_arena_alloc_array(&making, n, sizeof *meshes, error);
    *mesh = (struct cs_export_mesh){
        .name = "colliders", .item = "collider", .is_moving = system->motions != NULL};
    if (!error->status)
        cs_posed_colliders_at(system, 0, colliders);
    for (uint32_t k = 0; k < n && !error->status; k++) {
        if (!colliders[k].collider->visible ||
            colliders[k].shape->triangles(colliders + k, meshes + k, &making, error))
            continue;
        mesh->n += meshes[k].n;
        mesh->n_triangles += meshes[k].n_triangles;
        mesh->n_items++;
    }
    if (!error->status)
        join(mesh, colliders, meshes, arena, error);
    cs_arena_finish(&making);
    return error->status;
}

void cs_export_mesh_pose_colliders(struct cs_export_mesh *mesh, const struct cs_system *system,
                                   double t) {
    uint64_t *out = mesh->fields[0].words;
    for (uint32_t item = 0; item < mesh->n_items; item++) {
        struct cs_posed_collider collider;
        cs_posed_collider_at(system, mesh->items[item], t, &collider);
        for (size_t i = mesh->first_point[item]; i < mesh->first_point[item + 1]; i++) {
            double place[3];
            if (collider.collider->paths)
                cs_collider_mesh_vertex(&collider, (uint32_t)(i - mesh->first_point[item]),
                                        mesh->local_positions + 3 * i);
            cs_collider_to_world(&collider, mesh->local_positions + 3 * i, place);
            for (size_t c = 0; c < 3; c++)
                out[3 * i + c] = cs_double_to_le64(place[c]);
        }
    }
}

/* Joins the particles of all bodies to triangles and lines, and makes triangles of colliders. A
 * collider's triangles are made once in its own frame, then posed at every sample, where key
 * frames change its points. */
#include "io/export/writer.h"

#include "base/serialise.h"
#include "model/system/surfaces.h"

#include <math.h>
#include <string.h>

/* Allocates topology, uv if asked for, and the field of positions. */
static enum cs_status take(struct cs_export_mesh *skin, bool uv, struct cs_arena *arena,
                           struct cs_error *error) {
    static const char *const positions[2] = {"position", "positions"};
    const size_t corners = 3 * (size_t)skin->n_triangles, items = skin->n_items;
    skin->triangles = cs_arena_alloc_array(arena, corners, sizeof *skin->triangles, error);
    CS_ARENA_ARRAY(arena, skin->lines, 2 * (size_t)skin->n_lines, error);
    skin->items = cs_arena_alloc_array(arena, items, sizeof *skin->items, error);
    CS_ARENA_ARRAY(arena, skin->first_point, items + 1, error);
    skin->first_triangle = cs_arena_alloc_array(arena, items + 1, sizeof(uint32_t), error);
    skin->first_line = cs_arena_alloc_array(arena, items + 1, sizeof *skin->first_line, error);
    if (uv)
        skin->uv = cs_arena_alloc_array(arena, corners, 2 * sizeof *skin->uv, error);
    cs_export_mesh_add_field(skin, positions, 3, arena, error);
    return error->status;
}

struct cs_export_field *cs_export_mesh_add_field(struct cs_export_mesh *skin,
                                                 const char *const names[2],
                                                 uint32_t components, struct cs_arena *arena,
                                                 struct cs_error *error) {
    CS_ASSERT(skin->n_fields < CS_EXPORT_FIELDS);
    struct cs_export_field *field = skin->fields + skin->n_fields++;
    *field = (struct cs_export_field){
        .name = names[0],
        .plural = names[1],
        .components = components,
        .words = cs_arena_alloc_array(arena, skin->n, components * sizeof(uint64_t), error)};
    return field;
}

void cs_export_mesh_set(const struct cs_export_mesh *skin, const struct cs_export_field *field,
                        const double *values) {
    const size_t n = skin->n, components = field->components;
    for (size_t i = 0; i < n; i++)
        for (size_t c = 0; c < components; c++)
            field->words[i * components + c] = cs_double_to_le64(values[c * n + i]);
}

/* Lines of a body: only a single row or column of particles, which has no triangles. */
static uint32_t count_lines(const struct cs_body_range *body) {
    return body->mesh || cs_faces_count(body) ? 0 : body->count - 1;
}

static bool has_uv(const struct cs_body_range *body) {
    return body->mesh ? body->mesh->uv != NULL : cs_faces_count(body) > 0;
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

void cs_export_mesh_point_uv(const struct cs_export_mesh *skin, float (*uv)[2]) {
    memset(uv, 0, skin->n * sizeof *uv);
    for (size_t corner = 3 * (size_t)skin->n_triangles; corner-- > 0;)
        if (!isnan(skin->uv[2 * corner]))
            memcpy(uv[skin->triangles[corner]], skin->uv + 2 * corner, sizeof *uv);
}

/* Writes triangles, texture coordinates and lines of body b with the particles' numbers. */
static void fill_body(struct cs_export_mesh *skin, const struct cs_body_range *body,
                      uint32_t b) {
    for (uint32_t t = 0; t < cs_faces_count(body); t++) {
        const size_t at = 3 * (size_t)(skin->first_triangle[b] + t);
        uint32_t corners[3];
        cs_face_corners(body, t, corners);
        for (size_t k = 0; k < 3; k++)
            skin->triangles[at + k] = body->first + corners[k];
        if (skin->uv)
            set_uv(body, t, corners, skin->uv + 2 * at);
    }
    for (uint32_t i = 0; i < count_lines(body); i++)
        for (uint32_t end = 0; end < 2; end++)
            skin->lines[2 * (size_t)(skin->first_line[b] + i) + end] = body->first + i + end;
}

enum cs_status cs_export_mesh_of_bodies(struct cs_export_mesh *skin,
                                        const struct cs_system *system, struct cs_arena *arena,
                                        struct cs_error *error) {
    const uint32_t n_bodies = system->scene->bodies.n;
    bool uv = false;
    *skin = (struct cs_export_mesh){.name = "bodies",
                                    .item = "body",
                                    .n = system->view.n,
                                    .n_items = n_bodies,
                                    .is_moving = true};
    for (uint32_t b = 0; b < n_bodies; b++) {
        skin->n_triangles += cs_faces_count(system->bodies + b);
        skin->n_lines += count_lines(system->bodies + b);
        uv = uv || has_uv(system->bodies + b);
    }
    if (take(skin, uv, arena, error))
        return error->status;
    for (uint32_t b = 0; b < n_bodies; b++) {
        const struct cs_body_range *body = system->bodies + b;
        skin->items[b] = b;
        skin->first_point[b + 1] = body->first + body->count;
        skin->first_triangle[b + 1] = skin->first_triangle[b] + cs_faces_count(body);
        skin->first_line[b + 1] = skin->first_line[b] + count_lines(body);
        fill_body(skin, body, b);
    }
    return CS_OK;
}

/* Copies the points of a collider in its own frame, and its triangles with shifted numbers. */
static void fill_collider(struct cs_export_mesh *skin, uint32_t item,
                          const struct cs_trimesh *mesh) {
    const uint32_t first = skin->first_point[item];
    for (size_t i = 0; i < mesh->n; i++)
        for (size_t k = 0; k < 3; k++)
            skin->local_positions[3 * (first + i) + k] = mesh->positions[k * mesh->n + i];
    uint32_t *corner = skin->triangles + 3 * (size_t)skin->first_triangle[item];
    for (size_t k = 0; k < 3 * (size_t)mesh->n_triangles; k++)
        corner[k] = first + mesh->triangles[k];
}

/* Joins the visible ones of meshes (colliders.n), each in its own frame, to one mesh. */
static enum cs_status join(struct cs_export_mesh *skin,
                           const struct cs_posed_collider *obstacles,
                           const struct cs_trimesh *meshes, struct cs_arena *arena,
                           struct cs_error *error) {
    skin->local_positions =
        cs_arena_alloc_array(arena, skin->n, 3 * sizeof *skin->local_positions, error);
    if (take(skin, false, arena, error))
        return error->status;
    for (uint32_t k = 0, item = 0; item < skin->n_items; k++) {
        if (!obstacles[k].collider->visible)
            continue;
        skin->items[item] = k;
        skin->first_point[item + 1] = skin->first_point[item] + meshes[k].n;
        skin->first_triangle[item + 1] = skin->first_triangle[item] + meshes[k].n_triangles;
        fill_collider(skin, item++, meshes + k);
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
        if (!obstacles[k].collider->visible ||
            obstacles[k].shape->triangles(obstacles + k, meshes + k, &making, error))
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
        for (size_t i = skin->first_point[item]; i < skin->first_point[item + 1]; i++) {
            double place[3];
            if (at.collider->mesh.paths)
                cs_collider_mesh_vertex(&at, (uint32_t)(i - skin->first_point[item]),
                                        skin->local_positions + 3 * i);
            cs_collider_to_world(&at, skin->local_positions + 3 * i, place);
            for (size_t c = 0; c < 3; c++)
                out[3 * i + c] = cs_double_to_le64(place[c]);
        }
    }
}

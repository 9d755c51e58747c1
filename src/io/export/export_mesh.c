/* Joins the particles of all bodies to triangles and lines. */
#include "io/export/export_mesh.h"

#include "base/little_endian.h"
#include "model/system/faces.h"

#include <math.h>
#include <string.h>

enum cs_status cs_export_mesh_set_values(struct cs_export_mesh *skin, bool uv,
                                         struct cs_arena *arena, struct cs_error *error) {
    static const char *const positions[2] = {"position", "positions"};
    const size_t corners = 3 * (size_t)skin->n_triangles, items = skin->n_items;
    skin->triangles = cs_arena_alloc_array(arena, corners, sizeof *skin->triangles, error);
    skin->lines =
        cs_arena_alloc_array(arena, 2 * (size_t)skin->n_lines, sizeof *skin->lines, error);
    skin->items = cs_arena_alloc_array(arena, items, sizeof *skin->items, error);
    skin->first_point =
        cs_arena_alloc_array(arena, items + 1, sizeof *skin->first_point, error);
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

/* a row or column of particles has no triangles */
static uint32_t count_lines(const struct cs_body_range *body) {
    return body->mesh || cs_faces_count(body) ? 0 : body->count - 1;
}

static bool has_uv(const struct cs_body_range *body) {
    return body->mesh ? body->mesh->uv != NULL : cs_faces_count(body) > 0;
}

/* of a grid from 0 to 1 across and upwards; of a mesh those of its file */
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
    if (cs_export_mesh_set_values(skin, uv, arena, error))
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

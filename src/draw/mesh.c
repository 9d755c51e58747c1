#include "draw/mesh.h"

#include "draw/matrix.h"

// drawing a particle farther away than this only upsets the rasteriser
static const double bound = 1e5;

void cs_mesh_place(uint32_t n, const double *x, uint32_t i, double place[3]) {
    for (uint32_t axis = 0; axis < 3; axis++) {
        const double c = x[(size_t)axis * n + i];
        // a comparison with NAN is false, which leaves 0
        place[axis] = c > bound ? bound : c < -bound ? -bound : c == c ? c : 0;
    }
}

static void fill_indices(struct cs_mesh *mesh) {
    const uint32_t columns = mesh->range.columns;
    uint32_t *out = mesh->indices;
    for (uint32_t row = 0; row + 1 < mesh->range.rows; row++)
        for (uint32_t column = 0; column + 1 < columns; column++) {
            const uint32_t top = row * columns + column, below = top + columns;
            *out++ = top, *out++ = below, *out++ = top + 1;
            *out++ = top + 1, *out++ = below, *out++ = below + 1;
        }
}

enum cs_status cs_mesh_init(struct cs_mesh *mesh, const struct cs_body_range *range, bool flat,
                            struct cs_arena *arena, struct cs_error *error) {
    const bool has_cells = range->columns > 1 && range->rows > 1;
    mesh->range = *range;
    mesh->flat = flat;
    mesh->n_indices = has_cells ? 6 * (range->columns - 1) * (range->rows - 1) : 0;
    mesh->n_vertices = flat ? mesh->n_indices : range->count;
    mesh->vertices = cs_arena_take_n(arena, mesh->n_vertices, sizeof *mesh->vertices, error);
    mesh->indices = cs_arena_take_n(arena, mesh->n_indices, sizeof *mesh->indices, error);
    mesh->normals = cs_arena_take_n(arena, range->count, 3 * sizeof *mesh->normals, error);
    if (error->status == CS_OK)
        fill_indices(mesh);
    return error->status;
}

static void triangle_normal(const struct cs_mesh *mesh, uint32_t n, const double *x,
                            const uint32_t *corner, double normal[3]) {
    double p[3][3], along[3], across[3];
    for (int i = 0; i < 3; i++)
        cs_mesh_place(n, x, mesh->range.first + corner[i], p[i]);
    cs_subtract(p[1], p[0], along);
    cs_subtract(p[2], p[0], across);
    cs_cross(along, across, normal);
}

static void set_vertex(struct cs_vertex *vertex, const double place[3], const double normal[3],
                       double value) {
    double unit[3] = {normal[0], normal[1], normal[2]};
    cs_normalise(unit);
    // a collapsed triangle has no normal: any will do, but not zero
    if (cs_dot(unit, unit) == 0)
        unit[2] = 1;
    for (int i = 0; i < 3; i++) {
        vertex->place[i] = (float)place[i];
        vertex->normal[i] = (float)unit[i];
    }
    vertex->value = (float)value;
}

static double scaled(const double *values, uint32_t i, const double range[2]) {
    if (!values || !(range[1] > range[0]))
        return 0;
    const double t = (values[i] - range[0]) / (range[1] - range[0]);
    return t > 1 ? 1 : t > 0 ? t : 0;
}

static void update_smooth(struct cs_mesh *mesh, uint32_t n, const double *x,
                          const double *values, const double range[2]) {
    memset(mesh->normals, 0, 3 * sizeof *mesh->normals * mesh->range.count);
    for (uint32_t k = 0; k < mesh->n_indices; k += 3) {
        double normal[3];
        triangle_normal(mesh, n, x, mesh->indices + k, normal);
        for (uint32_t corner = 0; corner < 3; corner++)
            for (uint32_t i = 0; i < 3; i++)
                mesh->normals[3 * mesh->indices[k + corner] + i] += normal[i];
    }
    for (uint32_t i = 0; i < mesh->range.count; i++) {
        double place[3];
        cs_mesh_place(n, x, mesh->range.first + i, place);
        set_vertex(mesh->vertices + i, place, mesh->normals + 3 * (size_t)i,
                   scaled(values, mesh->range.first + i, range));
    }
}

void cs_mesh_update(struct cs_mesh *mesh, uint32_t n, const double *x, const double *values,
                    const double range[2]) {
    if (!mesh->flat) {
        update_smooth(mesh, n, x, values, range);
        return;
    }
    for (uint32_t k = 0; k < mesh->n_indices; k += 3) {
        double normal[3];
        triangle_normal(mesh, n, x, mesh->indices + k, normal);
        for (uint32_t corner = 0; corner < 3; corner++) {
            const uint32_t particle = mesh->range.first + mesh->indices[k + corner];
            double place[3];
            cs_mesh_place(n, x, particle, place);
            set_vertex(mesh->vertices + k + corner, place, normal,
                       scaled(values, particle, range));
        }
    }
}

void cs_mesh_uv(const struct cs_mesh *mesh, const double repeat[2], float *uv) {
    const uint32_t columns = mesh->range.columns, rows = mesh->range.rows;
    for (uint32_t k = 0; k < mesh->n_vertices; k++) {
        const uint32_t i = mesh->flat ? mesh->indices[k] : k;
        const double u = columns > 1 ? (double)(i % columns) / (columns - 1) : 0;
        const double v = rows > 1 ? (double)(i / columns) / (rows - 1) : 0;
        uv[2 * (size_t)k] = (float)(u * repeat[0]);
        uv[2 * (size_t)k + 1] = (float)(v * repeat[1]);
    }
}

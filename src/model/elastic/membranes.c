/* Builds the membranes of a system: triangles, their rest shapes, and the lists of meshes. */
#include "model/elastic/membranes.h"

#include "base/vec3.h"
#include "mesh/trimesh.h"
#include "scene/body_keys.h"

#include <math.h>

/* Sets P and the squares of L from the rest edges of a triangle in the cloth's axes. The rows
 * of R are quadratic in the edges, so they are divided by the area before R is inverted. */
static void set_rest(const double X[3], const double Y[3], size_t stride, double *rest) {
    const double area = fabs(X[0] * Y[1] - X[1] * Y[0]) / 2;
    double R[3][3];
    for (int i = 0; i < 3; i++) {
        R[i][0] = X[i] * X[i] / area;
        R[i][1] = Y[i] * Y[i] / area;
        R[i][2] = X[i] * Y[i] / area;
    }
    const double scale = sqrt(area / 2) / area;
    double cross[3][3], determinant = 0;
    for (int i = 0; i < 3; i++)
        cs_vec3_cross(R[(i + 1) % 3], R[(i + 2) % 3], cross[i]);
    determinant = cs_vec3_dot(R[0], cross[0]);
    /* column i of the inverse is the product of the two other rows over the determinant */
    for (int a = 0; a < 3; a++)
        for (int i = 0; i < 3; i++)
            rest[(size_t)(3 * a + i) * stride] = scale * cross[i][a] / determinant;
    for (int i = 0; i < 3; i++)
        rest[(size_t)(CS_MEMBRANE_P + i) * stride] = X[i] * X[i] + Y[i] * Y[i];
}

/* Lays a triangle of a mesh into a plane: X along the mesh's x axis, or along its y axis where
 * the triangle faces along x. p: corners at rest. */
static void lay_flat(double p[3][3], double X[3], double Y[3]) {
    double d[3][3], normal[3], warp[3], weft[3];
    for (int i = 0; i < 3; i++)
        for (int c = 0; c < 3; c++)
            d[i][c] = p[(i + 1) % 3][c] - p[i][c];
    cs_vec3_cross(d[0], d[1], normal);
    cs_vec3_normalise(normal);
    const int axis = fabs(normal[0]) > 0.9;
    for (int c = 0; c < 3; c++)
        warp[c] = (c == axis) - normal[axis] * normal[c];
    cs_vec3_normalise(warp);
    cs_vec3_cross(normal, warp, weft);
    for (int i = 0; i < 3; i++) {
        X[i] = cs_vec3_dot(d[i], warp);
        Y[i] = cs_vec3_dot(d[i], weft);
    }
}

static void set_mesh_rest(struct cs_membrane *membrane, const struct cs_trimesh *mesh) {
    for (uint32_t t = 0; t < membrane->n; t++) {
        double p[3][3], X[3], Y[3];
        for (size_t k = 0; k < 3; k++)
            for (size_t c = 0; c < 3; c++)
                p[k][c] = mesh->positions[c * mesh->n + mesh->triangles[3 * (size_t)t + k]];
        lay_flat(p, X, Y);
        set_rest(X, Y, membrane->n, membrane->rest + t);
    }
}

/* Lists the triangles at each particle of a mesh, with the corner that it is. */
static void list_incident(struct cs_membrane *membrane) {
    uint32_t *begin = membrane->incident_begin;
    for (size_t k = 0; k < 3 * (size_t)membrane->n; k++)
        begin[membrane->triangles[k] + 1]++;
    for (uint32_t i = 0; i < membrane->count; i++)
        begin[i + 1] += begin[i];
    /* filling moves each start to the next, and back at the end */
    for (uint32_t k = 0; k < 3 * membrane->n; k++)
        membrane->incident[begin[membrane->triangles[k]]++] = 4 * (k / 3) + k % 3;
    for (uint32_t i = membrane->count; i > 0; i--)
        begin[i] = begin[i - 1];
    begin[0] = 0;
}

static enum cs_status build_mesh(struct cs_membrane *membrane, const struct cs_trimesh *mesh,
                                 struct cs_arena *arena, struct cs_error *error) {
    membrane->n = mesh->n_triangles;
    membrane->triangles = mesh->triangles;
    membrane->rest =
        cs_arena_alloc_array(arena, membrane->n, CS_MEMBRANE_REST * sizeof(double), error);
    membrane->forces = cs_arena_alloc_array(arena, membrane->n, 9 * sizeof(double), error);
    CS_ARENA_ARRAY(arena, membrane->incident_begin, membrane->count + 1, error);
    CS_ARENA_ARRAY(arena, membrane->incident, 3 * (size_t)membrane->n, error);
    if (error->status)
        return error->status;
    set_mesh_rest(membrane, mesh);
    list_incident(membrane);
    return CS_OK;
}

static enum cs_status build_grid(struct cs_membrane *membrane, const struct cs_cloth *cloth,
                                 struct cs_arena *arena, struct cs_error *error) {
    membrane->columns = (uint32_t)cloth->grid[0];
    membrane->rows = (uint32_t)cloth->grid[1];
    membrane->n = 2 * (membrane->columns - 1) * (membrane->rows - 1);
    membrane->rest = cs_arena_alloc_array(arena, CS_MEMBRANE_REST, sizeof(double), error);
    const double dx = cloth->size[0] / (membrane->columns - 1);
    const double dy = cloth->size[1] / (membrane->rows - 1);
    if (membrane->rest)
        set_rest((const double[3]){dx, -dx, 0}, (const double[3]){0, dy, -dy}, 1,
                 membrane->rest);
    return error->status;
}

/* The shortest edge at rest in m. */
static double shortest_of(const struct cs_membrane *membrane) {
    const uint32_t n = membrane->columns ? 1 : membrane->n;
    double squared = HUGE_VAL;
    for (size_t k = CS_MEMBRANE_P * (size_t)n; k < CS_MEMBRANE_REST * (size_t)n; k++)
        squared = fmin(squared, membrane->rest[k]);
    return sqrt(squared);
}

/* Allocates what bounds and the solver's matrix need. */
static enum cs_status alloc_matrix(struct cs_membranes *membranes, struct cs_system *system,
                                   struct cs_error *error) {
    struct cs_arena *arena = &system->arena;
    const size_t n = system->view.n;
    membranes->blocks = cs_arena_alloc_array(arena, 6 * n, sizeof(double), error);
    membranes->n_around = cs_arena_alloc_array(arena, n, sizeof *membranes->n_around, error);
    for (uint32_t b = 0; !error->status && b < membranes->n; b++)
        for (uint32_t t = 0; t < membranes->bodies[b].n; t++) {
            uint32_t corners[3];
            cs_membrane_corners(membranes->bodies + b, t, corners);
            for (int k = 0; k < 3; k++)
                membranes->n_around[corners[k]]++;
        }
    if (!system->plan.rows[CS_FEATURE_SOLVER].built)
        return error->status;
    membranes->x = cs_arena_alloc_array(arena, 3 * n, sizeof(double), error);
    membranes->kept = cs_arena_alloc_array(arena, 6 * n, sizeof(double), error);
    CS_ARENA_ARRAY(arena, membranes->tensions, 3 * (size_t)membranes->n_triangles, error);
    return error->status;
}

enum cs_status cs_membranes_build(struct cs_system *system, struct cs_error *error) {
    const struct cs_body *bodies = cs_scene_bodies(system->scene);
    struct cs_arena *arena = &system->arena;
    struct cs_membranes *membranes = cs_arena_alloc_array(arena, 1, sizeof *membranes, error);
    if (!membranes)
        return error->status;
    CS_ARENA_ARRAY(arena, membranes->bodies, system->scene->bodies.n, error);
    membranes->shortest = HUGE_VAL;
    for (uint32_t b = 0; b < system->scene->bodies.n && !error->status; b++) {
        if (!bodies[b].elastic.present)
            continue;
        // triangles of all bodies are numbered one after the other
        struct cs_membrane *membrane = membranes->bodies + membranes->n++;
        *membrane = (struct cs_membrane){.body = b,
                                         .first = system->bodies[b].first,
                                         .count = system->bodies[b].count,
                                         .begin = membranes->n_triangles};
        if (bodies[b].mesh ? build_mesh(membrane, bodies[b].geometry, arena, error)
                           : build_grid(membrane, &bodies[b].cloth, arena, error))
            break;
        membranes->n_triangles += membrane->n;
        membrane->shortest = shortest_of(membrane);
        membranes->shortest = fmin(membranes->shortest, membrane->shortest);
    }
    system->membranes = membranes;
    return error->status ? error->status : alloc_matrix(membranes, system, error);
}

/* Triangles of cell (r, c) are 2 k and 2 k + 1 with k = r (columns - 1) + c: top left, top
 * right, bottom left; and turned by half a turn bottom right, bottom left, top right. */
void cs_membrane_corners(const struct cs_membrane *membrane, uint32_t t, uint32_t corners[3]) {
    if (!membrane->columns) {
        for (size_t k = 0; k < 3; k++)
            corners[k] = membrane->first + membrane->triangles[3 * (size_t)t + k];
        return;
    }
    const uint32_t cells = membrane->columns - 1, row = t / 2 / cells, column = t / 2 % cells;
    const uint32_t top = membrane->first + row * membrane->columns + column,
                   below = top + membrane->columns;
    corners[0] = t % 2 ? below + 1 : top;
    corners[1] = t % 2 ? below : top + 1;
    corners[2] = t % 2 ? top + 1 : below;
}

uint32_t cs_membrane_incident(const struct cs_membrane *membrane, uint32_t i, uint32_t grid[6],
                              const uint32_t **around) {
    /* cell by its offset, its triangle, the corner that the particle is there */
    static const struct {
        uint32_t up, left, half, corner;
    } places[6] = {{1, 1, 1, 0}, {1, 0, 0, 2}, {1, 0, 1, 1},
                   {0, 1, 0, 1}, {0, 1, 1, 2}, {0, 0, 0, 0}};
    uint32_t n = 0;
    if (!membrane->columns) {
        *around = membrane->incident + membrane->incident_begin[i];
        return membrane->incident_begin[i + 1] - membrane->incident_begin[i];
    }
    const uint32_t row = i / membrane->columns, column = i % membrane->columns;
    for (int k = 0; k < 6; k++) {
        const uint32_t r = row - places[k].up, c = column - places[k].left;
        /* beyond the first row or column the numbers wrap to the largest */
        if (r < membrane->rows - 1 && c < membrane->columns - 1)
            grid[n++] =
                4 * (2 * (r * (membrane->columns - 1) + c) + places[k].half) + places[k].corner;
    }
    *around = grid;
    return n;
}

void cs_membrane_stiffness(const struct cs_membrane *membrane, uint32_t t,
                           const struct cs_moduli *moduli, double K[6]) {
    const size_t stride = membrane->columns ? 1 : membrane->n;
    const double *P = membrane->rest + (membrane->columns ? 0 : t);
    size_t m = 0;
    for (size_t i = 0; i < 3; i++) {
        const double X = P[i * stride], Y = P[(3 + i) * stride], XY = P[(6 + i) * stride];
        const double sX = moduli->warp * X + moduli->coupling * Y;
        const double sY = moduli->coupling * X + moduli->weft * Y;
        const double sXY = moduli->shear * XY;
        for (size_t j = i; j < 3; j++)
            K[m++] = sX * P[j * stride] + sY * P[(3 + j) * stride] + sXY * P[(6 + j) * stride];
    }
}

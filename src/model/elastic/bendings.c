/* Builds the stencils of bending. */
#include "model/elastic/bendings.h"

#include "base/vec3.h"
#include "mesh/trimesh.h"
#include "scene/body_keys.h"
#include "scene/event_key.h"

#include <math.h>
#include <string.h>

/* --- meshes --- */

/* A triangle of a mesh and the three points beyond its edges, laid into its plane. */
struct patch {
    uint32_t points[CS_BENDING_POINTS]; /* corners, then beyond edge k: corner k to k + 1 */
    bool is_rim[3];
    double X[CS_BENDING_POINTS], Y[CS_BENDING_POINTS]; /* m, along warp and weft */
    double area, normal[3];                            /* m2; of length 1 */
    bool is_curved;
};

/* The corner beyond an edge of triangle t, from corner a to b: of the triangle that has the
 * edge the other way. Returns false at a rim. */
static bool find_beyond(const struct cs_trimesh *mesh, uint32_t a, uint32_t b,
                        uint32_t *beyond) {
    for (uint32_t k = cs_trimesh_around_begin(mesh, b); k < mesh->vertex_triangles_end[b];
         k++) {
        const uint32_t *corner = mesh->triangles + 3 * (size_t)mesh->vertex_triangles[k];
        for (int i = 0; i < 3; i++)
            if (corner[i] == b && corner[(i + 1) % 3] == a) {
                *beyond = corner[(i + 2) % 3];
                return true;
            }
    }
    return false;
}

static void find_points(const struct cs_trimesh *mesh, uint32_t t, struct patch *patch) {
    const uint32_t *corner = mesh->triangles + 3 * (size_t)t;
    memcpy(patch->points, corner, 3 * sizeof *corner);
    for (size_t k = 0; k < 3; k++) {
        patch->points[3 + k] = corner[0];
        patch->is_rim[k] =
            !find_beyond(mesh, corner[k], corner[(k + 1) % 3], patch->points + 3 + k);
    }
}

/* Turns the point beyond edge k about that edge into the plane of the triangle. d: the points
 * from corner 0 on; normal: the unit normal. */
static void unfold(double d[CS_BENDING_POINTS][3], size_t k, const double normal[3]) {
    const double *from = d[k], *to = d[(k + 1) % 3];
    double edge[3], beyond[3], out[3], along, across = 0;
    for (int c = 0; c < 3; c++) {
        edge[c] = to[c] - from[c];
        beyond[c] = d[3 + k][c] - from[c];
    }
    cs_vec3_normalise(edge);
    cs_vec3_cross(edge, normal, out);
    along = cs_vec3_dot(beyond, edge);
    for (int c = 0; c < 3; c++)
        across += (beyond[c] - along * edge[c]) * (beyond[c] - along * edge[c]);
    for (int c = 0; c < 3; c++)
        d[3 + k][c] = from[c] + along * edge[c] + sqrt(across) * out[c];
}

/* Axes as those of a membrane (membranes.c): the warp along x, or along y where the triangle
 * faces along x. Points beyond an edge that lie off the plane, by more than the rounding of a
 * file's numbers, are unfolded into it. */
static void lay_flat(const struct cs_trimesh *mesh, struct patch *patch) {
    double d[CS_BENDING_POINTS][3], normal[3], warp[3], weft[3];
    for (size_t k = 0; k < CS_BENDING_POINTS; k++)
        for (size_t c = 0; c < 3; c++)
            d[k][c] = mesh->positions[c * mesh->n + patch->points[k]] -
                      mesh->positions[c * mesh->n + patch->points[0]];
    // the area is half the length of the normal
    cs_vec3_cross(d[1], d[2], normal);
    patch->area = sqrt(cs_vec3_dot(normal, normal)) / 2;
    cs_vec3_normalise(normal);
    const int axis = fabs(normal[0]) > 0.9;
    for (int c = 0; c < 3; c++)
        warp[c] = (c == axis) - normal[axis] * normal[c];
    cs_vec3_normalise(warp);
    cs_vec3_cross(normal, warp, weft);
    patch->is_curved = false;
    for (size_t k = 0; k < CS_BENDING_POINTS; k++) {
        const bool is_off = fabs(cs_vec3_dot(d[k], normal)) > 1e-6 * sqrt(patch->area);
        if (is_off)
            unfold(d, k - 3, normal);
        patch->is_curved |= is_off;
        patch->X[k] = cs_vec3_dot(d[k], warp);
        patch->Y[k] = cs_vec3_dot(d[k], weft);
    }
    memcpy(patch->normal, normal, sizeof normal);
}

/* Solves Q^T u = e, 6x6, by elimination with pivots; Q is destroyed. Returns false if Q is
 * singular, which six points on a conic make it. */
static bool solve(double Q[6][6], double e[3][6]) {
    for (int k = 0; k < 6; k++) {
        // the largest entry of column k of Q^T comes to row k
        int pivot = k;
        for (int i = k + 1; i < 6; i++)
            if (fabs(Q[k][i]) > fabs(Q[k][pivot]))
                pivot = i;
        if (fabs(Q[k][pivot]) < 1e-9)
            return false;
        for (int j = 0; j < 6; j++) {
            const double swap = Q[j][k];
            Q[j][k] = Q[j][pivot];
            Q[j][pivot] = swap;
        }
        for (int r = 0; r < 3; r++) {
            const double swap = e[r][k];
            e[r][k] = e[r][pivot];
            e[r][pivot] = swap;
        }
        for (int i = 0; i < 6; i++) {
            const double factor = i == k ? 0 : Q[k][i] / Q[k][k];
            for (int j = k; j < 6 && factor != 0; j++)
                Q[j][i] -= factor * Q[j][k];
            for (int r = 0; r < 3 && factor != 0; r++)
                e[r][i] -= factor * e[r][k];
        }
    }
    for (int r = 0; r < 3; r++)
        for (int k = 0; k < 6; k++)
            e[r][k] /= Q[k][k];
    return true;
}

/* Weights of the second derivatives of the quadratic 1, u, v, u^2/2, v^2/2, u v/2 through the
 * six points, in units of the triangle's size. */
static bool fit_quadratic(const struct patch *patch, double weights[3][CS_BENDING_POINTS]) {
    const double size = sqrt(patch->area);
    const double X = (patch->X[0] + patch->X[1] + patch->X[2]) / 3,
                 Y = (patch->Y[0] + patch->Y[1] + patch->Y[2]) / 3;
    double Q[6][6], e[3][6] = {{0}};
    for (int j = 0; j < 6; j++) {
        const double u = (patch->X[j] - X) / size, v = (patch->Y[j] - Y) / size;
        const double row[6] = {1, u, v, u * u / 2, v * v / 2, u * v / 2};
        memcpy(Q[j], row, sizeof row);
    }
    /* curvature a of values y is row 3 + a of Q^-1 y: weights w with Q^T w = unit vector */
    for (int a = 0; a < 3; a++)
        e[a][3 + a] = 1;
    if (patch->is_rim[0] || patch->is_rim[1] || patch->is_rim[2] || !solve(Q, e))
        return false;
    for (int a = 0; a < 3; a++)
        for (int j = 0; j < 6; j++)
            weights[a][j] = e[a][j] / (size * size);
    return true;
}

/* Cotangent of the angle at point k between points i and j. */
static double cotangent(const struct patch *patch, size_t k, size_t i, size_t j) {
    const double ax = patch->X[i] - patch->X[k], ay = patch->Y[i] - patch->Y[k];
    const double bx = patch->X[j] - patch->X[k], by = patch->Y[j] - patch->Y[k];
    return (ax * bx + ay * by) / fabs(ax * by - ay * bx);
}

/* Weights of the sum of hinges. The jump of the slope over an edge, times its length, has the
 * cotangent weights of Bergou et al. 2006. */
static void sum_hinges(const struct patch *patch, double weights[3][CS_BENDING_POINTS]) {
    memset(weights, 0, 3 * sizeof *weights);
    for (size_t k = 0; k < 3; k++) {
        const size_t a = k, b = (k + 1) % 3, c = (k + 2) % 3, o = 3 + k;
        if (patch->is_rim[k])
            continue;
        const double ac = cotangent(patch, a, b, c), ao = cotangent(patch, a, b, o);
        const double bc = cotangent(patch, b, a, c), bo = cotangent(patch, b, a, o);
        const double X = patch->X[b] - patch->X[a], Y = patch->Y[b] - patch->Y[a];
        const double squared = X * X + Y * Y;
        const double normal[3] = {Y * Y / squared, X * X / squared, -2 * X * Y / squared};
        for (int m = 0; m < 3; m++) {
            const double factor = -normal[m] / (2 * patch->area);
            weights[m][a] += factor * (bc + bo);
            weights[m][b] += factor * (ac + ao);
            weights[m][c] -= factor * (ac + bc);
            weights[m][o] -= factor * (ao + bo);
        }
    }
}

/* Lists the stencils at each particle; points that a rim lacks are the first, with weights 0.
 */
static enum cs_status list_incident(struct cs_bending *bending, struct cs_arena *arena,
                                    struct cs_error *error) {
    const struct cs_moduli any = {1, 1, 0, 1};
    const size_t count = bending->count;
    uint32_t *begin = cs_arena_alloc_array(arena, count + 1, sizeof *begin, error);
    uint32_t *incident = cs_arena_alloc_array(arena, CS_BENDING_POINTS * (size_t)bending->n,
                                              sizeof *incident, error);
    for (int fill = 0; fill < 2 && !error->status; fill++) {
        for (uint32_t s = 0; s < bending->n; s++) {
            struct cs_bending_stencil of;
            cs_bending_stencil_at(bending, &any, s, &of);
            for (uint32_t j = 0; j < of.n; j++) {
                const uint32_t i = of.at[j] - bending->first;
                if (fill)
                    incident[begin[i]++] = 8 * s + j;
                else
                    begin[i + 1]++;
            }
        }
        /* counts become starts; filling moves each start to the next, and back at the end */
        for (size_t i = 0; !fill && i < count; i++)
            begin[i + 1] += begin[i];
        for (size_t i = count; fill && i > 0; i--)
            begin[i] = begin[i - 1];
    }
    if (!error->status)
        begin[0] = 0;
    bending->incident_begin = begin;
    bending->incident = incident;
    return error->status;
}

/* Curvatures at rest along the normal. */
static void find_rest(const struct cs_trimesh *mesh, const struct patch *patch,
                      double weights[3][CS_BENDING_POINTS], double rest[3]) {
    for (size_t a = 0; a < 3; a++)
        for (size_t j = 1; j < CS_BENDING_POINTS; j++)
            for (size_t c = 0; c < 3; c++)
                rest[a] += weights[a][j] * patch->normal[c] *
                           (mesh->positions[c * mesh->n + patch->points[j]] -
                            mesh->positions[c * mesh->n + patch->points[0]]);
}

static void fill_mesh(struct cs_bending *bending, const struct cs_trimesh *mesh) {
    bool is_curved = false;
    for (uint32_t t = 0; t < bending->n; t++) {
        struct patch patch;
        double weights[3][CS_BENDING_POINTS];
        find_points(mesh, t, &patch);
        lay_flat(mesh, &patch);
        if (!fit_quadratic(&patch, weights))
            sum_hinges(&patch, weights);
        memcpy(bending->points + CS_BENDING_POINTS * (size_t)t, patch.points,
               sizeof patch.points);
        memcpy(bending->weights + CS_BENDING_WEIGHTS * (size_t)t, weights, sizeof weights);
        bending->areas[t] = patch.area;
        find_rest(mesh, &patch, weights, bending->rest + 3 * (size_t)t);
        is_curved |= patch.is_curved;
    }
    if (!is_curved)
        bending->rest = NULL;
}

static enum cs_status build_mesh(struct cs_bending *bending, const struct cs_trimesh *mesh,
                                 struct cs_arena *arena, struct cs_error *error) {
    const size_t n = bending->n = mesh->n_triangles;
    CS_ARENA_ARRAY(arena, bending->points, CS_BENDING_POINTS * n, error);
    CS_ARENA_ARRAY(arena, bending->weights, CS_BENDING_WEIGHTS * n, error);
    bending->areas = cs_arena_alloc_array(arena, n, sizeof(double), error);
    bending->moments = cs_arena_alloc_array(arena, 9 * n, sizeof(double), error);
    bending->rest = cs_arena_alloc_array(arena, 3 * n, sizeof(double), error);
    if (!error->status)
        fill_mesh(bending, mesh);
    return error->status ? error->status : list_incident(bending, arena, error);
}

/* --- grids, and all --- */

static enum cs_status build_grid(struct cs_bending *bending, const struct cs_cloth *cloth,
                                 struct cs_arena *arena, struct cs_error *error) {
    bending->columns = (uint32_t)cloth->grid[0];
    bending->rows = (uint32_t)cloth->grid[1];
    bending->n = 2 * bending->count;
    for (int k = 0; k < 2; k++)
        bending->spacing[k] = cloth->size[k] / (double)(cloth->grid[k] - 1);
    return bending->damped ? list_incident(bending, arena, error) : CS_OK;
}

enum cs_status cs_bendings_build(struct cs_system *system, struct cs_error *error) {
    const struct cs_body *bodies = cs_scene_bodies(system->scene);
    const uint32_t n_bodies = system->scene->bodies.n;
    struct cs_arena *arena = &system->arena;
    struct cs_bendings *bendings = cs_arena_alloc_array(arena, 1, sizeof *bendings, error);
    if (!bendings)
        return error->status;
    bendings->bodies = cs_arena_alloc_array(arena, n_bodies, sizeof *bendings->bodies, error);
    bendings->moduli = cs_arena_alloc_array(arena, n_bodies, sizeof *bendings->moduli, error);
    bendings->diagonal = cs_arena_alloc_array(arena, system->view.n, sizeof(double), error);
    bendings->blocks = cs_arena_alloc_array(arena, system->view.n, sizeof(double), error);
    bendings->row_sums = cs_arena_alloc_array(arena, system->view.n, sizeof(double), error);
    for (uint32_t b = 0; b < n_bodies && !error->status; b++) {
        if (!cs_elastic_bends(&bodies[b].elastic))
            continue;
        // bodies without bending take no room
        struct cs_bending *bending = bendings->bodies + bendings->n++;
        *bending = (struct cs_bending){
            .body = b,
            .first = system->bodies[b].first,
            .count = system->bodies[b].count,
            .damped = cs_event_key_acts(system->scene, bodies[b].elastic.bending.damping,
                                        "bodies.elastic.bending.damping")};
        if (bodies[b].mesh)
            build_mesh(bending, bodies[b].geometry, arena, error);
        else
            build_grid(bending, &bodies[b].cloth, arena, error);
    }
    system->bendings = bendings;
    return error->status;
}

/* Second differences at particle i, in the order centre, left, right, up, down. A free rim has
 * no moment across it: the curvature along it then meets D_11 - D_12^2/D_22 alone. */
static void particle_stencil(const struct cs_bending *bending, const struct cs_moduli *moduli,
                             uint32_t i, struct cs_bending_stencil *stencil) {
    const uint32_t w = bending->columns, row = i / w, column = i % w, at = bending->first + i;
    const bool along = column > 0 && column + 1 < w,
               across = row > 0 && row + 1 < bending->rows;
    const double dx = bending->spacing[0], dy = bending->spacing[1];
    const double p = along ? 1 / (dx * dx) : 0, q = across ? 1 / (dy * dy) : 0;
    // half a cell belongs to a particle of a rim
    const double area = dx * dy * (along ? 1 : 0.5) * (across ? 1 : 0.5);
    const double coupling = moduli->coupling, other = coupling * coupling;
    const bool rim = !along || !across;
    *stencil = (struct cs_bending_stencil){
        .n = 5,
        // beyond a rim the particle itself, with the weight 0
        .at = {at, at - (column > 0), at + (column + 1 < w), row > 0 ? at - w : at,
               row + 1 < bending->rows ? at + w : at},
        .ends = {1, 2, 3, 4},
        .product = dx * dy * (along ? 2 : 1) * (across ? 2 : 1),
        .weights = {{-2 * p, p, p, 0, 0}, {-2 * q, 0, 0, q, q}},
        .moduli = {.warp = area * (moduli->warp - (rim ? other / moduli->weft : 0)),
                   .weft = area * (moduli->weft - (rim ? other / moduli->warp : 0)),
                   .coupling = rim ? 0 : area * coupling}};
}

/* 2 x_XY of the cell to the right of and below particle i; no point beyond the grid. */
static void cell_stencil(const struct cs_bending *bending, const struct cs_moduli *moduli,
                         uint32_t i, struct cs_bending_stencil *stencil) {
    const uint32_t w = bending->columns, row = i / w, column = i % w, at = bending->first + i;
    const double area = bending->spacing[0] * bending->spacing[1], k = 2 / area;
    *stencil = (struct cs_bending_stencil){0};
    if (row + 1 == bending->rows || column + 1 == w)
        return;
    *stencil = (struct cs_bending_stencil){.n = 4,
                                           .at = {at, at + 1, at + w, at + w + 1},
                                           .ends = {0, 3, 2, 1},
                                           .product = 2 * area,
                                           .weights = {{0}, {0}, {k, -k, -k, k}},
                                           .moduli = {.shear = area * moduli->shear}};
}

void cs_bending_stencil_at(const struct cs_bending *bending, const struct cs_moduli *moduli,
                           uint32_t s, struct cs_bending_stencil *stencil) {
    if (bending->columns && s < bending->count) {
        particle_stencil(bending, moduli, s, stencil);
        return;
    }
    if (bending->columns) {
        cell_stencil(bending, moduli, s - bending->count, stencil);
        return;
    }
    // of a mesh: as stored
    const double area = bending->areas[s];
    *stencil =
        (struct cs_bending_stencil){.n = CS_BENDING_POINTS,
                                    .ends = {0, 1, 0, 2},
                                    .product = 2 * area,
                                    .moduli = {area * moduli->warp, area * moduli->weft,
                                               area * moduli->coupling, area * moduli->shear}};
    for (size_t j = 0; j < CS_BENDING_POINTS; j++)
        stencil->at[j] = bending->first + bending->points[CS_BENDING_POINTS * (size_t)s + j];
    memcpy(stencil->weights, bending->weights + CS_BENDING_WEIGHTS * (size_t)s,
           sizeof stencil->weights);
    stencil->is_curved = bending->rest;
    if (bending->rest)
        memcpy(stencil->rest, bending->rest + 3 * (size_t)s, sizeof stencil->rest);
}

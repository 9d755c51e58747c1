/* Normals of particles, from the neighbours in a grid or the triangles of a mesh, and their
 * derivative.
 *
 * With N the vector product (or sum of products) and n = N / |N|, the derivative along dx is
 *
 *   dn = (I - n n^T) dN / |N|,   d(a x b) = da x b + a x db */
#include "model/force/terms.h"
#include "scene/scene.h"

#include "base/vec3.h"
#include "base/vector.h"
#include "mesh/trimesh.h"

#include <clothsim/clones.h>

#include <float.h>
#include <math.h>

/* Neighbours of a particle in its grid; the particle itself where there is none. */
struct neighbours {
    uint32_t left, right, up, down;
};

/* At a border the particle itself stands in, which makes the difference one-sided. */
static struct neighbours neighbours_of(const struct cs_body_range *body, uint32_t i) {
    const uint32_t row = (i - body->first) / body->columns,
                   column = (i - body->first) % body->columns;
    return (struct neighbours){
        .left = column > 0 ? i - 1 : i,
        .right = column + 1 < body->columns ? i + 1 : i,
        .up = row > 0 ? i - body->columns : i,
        .down = row + 1 < body->rows ? i + body->columns : i,
    };
}

/* out = p_to - p_from. */
static void difference(const double *p, uint32_t n, uint32_t from, uint32_t to, double out[3]) {
    for (size_t c = 0; c < 3; c++)
        out[c] = p[c * n + to] - p[c * n + from];
}

/* N of particle i of a mesh: the sum of the normals of its triangles. */
static void mesh_product(const struct cs_body_range *body, uint32_t i, size_t n,
                         const double *x, double product[3]) {
    const struct cs_trimesh *mesh = body->mesh;
    const uint32_t end = mesh->vertex_triangles_end[i - body->first];
    product[0] = product[1] = product[2] = 0;
    for (uint32_t k = cs_trimesh_around_begin(mesh, i - body->first); k < end; k++) {
        double normal[3];
        cs_trimesh_normal(mesh, mesh->vertex_triangles[k], x, n, body->first, normal);
        for (int c = 0; c < 3; c++)
            product[c] += normal[c];
    }
}

/* Arguments of the loop over particles. */
struct update {
    const struct cs_system *system;
    const double *x;
};

/* n = N / |N| of particle i; DBL_MIN makes 0 of a vector N = 0 instead of dividing by 0. */
CS_INLINE void set_normal(double *restrict normals, size_t n, size_t i,
                          const double product[3]) {
    const double inverse = 1 / sqrt(product[0] * product[0] + product[1] * product[1] +
                                    product[2] * product[2] + DBL_MIN);
    for (size_t c = 0; c < 3; c++)
        normals[c * n + i] = product[c] * inverse;
}

/* Normals of particles i to i + count - 1 of a grid, whose neighbours lie as those of the
 * first: N = (right - left) x (up - down). */
CS_CLONES static void grid_normals(double *restrict normals, size_t n, size_t i, size_t count,
                                   struct neighbours of_first, const double *restrict x) {
    for (size_t k = 0; k < count; k++) {
        double across[3], upwards[3], product[3];
        for (size_t c = 0; c < 3; c++) {
            across[c] = x[c * n + of_first.right + k] - x[c * n + of_first.left + k];
            upwards[c] = x[c * n + of_first.up + k] - x[c * n + of_first.down + k];
        }
        cs_vec3_cross(across, upwards, product);
        set_normal(normals, n, i + k, product);
    }
}

/* Normals of particles [begin, end) of a body. */
static void update_range(const struct update *update, const struct cs_body_range *body,
                         uint32_t begin, uint32_t end) {
    const size_t n = update->system->view.n;
    double *normals = update->system->normals, product[3];
    for (uint32_t i = begin; i < end && body->mesh; i++) {
        mesh_product(body, i, n, update->x, product);
        set_normal(normals, n, i, product);
    }
    // the first and the last of a row, and those between, each have neighbours of their own
    for (uint32_t i = begin, count; i < end && !body->mesh; i += count) {
        const uint32_t column = (i - body->first) % body->columns, last = body->columns - 1;
        count = column == 0 || column == last ? 1 : last - column;
        count = count < end - i ? count : end - i;
        grid_normals(normals, n, i, count, neighbours_of(body, i), update->x);
    }
}

/* Cuts a range of all particles by bodies. */
static void update_part(void *arg, size_t begin, size_t end) {
    const struct update *update = arg;
    const struct cs_system *system = update->system;
    for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
        const struct cs_body_range *body = system->bodies + b;
        const size_t last = (size_t)body->first + body->count;
        if (begin < last && body->first < end)
            update_range(update, body, begin > body->first ? (uint32_t)begin : body->first,
                         (uint32_t)(end < last ? end : last));
    }
}

void cs_normals_update(const struct cs_system *system, const double *x) {
    struct update update = {system, x};
    cs_vector_parallel_for(system->view.n, update_part, &update);
}

/* A vector and its change along dx. */
struct change {
    double of[3], by[3];
};

/* The vector from one particle to another. */
static struct change change_of(const struct cs_eval *at, uint32_t n, uint32_t from,
                               uint32_t to) {
    struct change edge;
    difference(at->x, n, from, to, edge.of);
    difference(at->dx, n, from, to, edge.by);
    return edge;
}

/* sum += a x b, with the product rule for its change. */
static void add_product(const struct change *a, const struct change *b, struct change *sum) {
    double whole[3], first[3], second[3];
    cs_vec3_cross(a->of, b->of, whole);
    cs_vec3_cross(a->by, b->of, first);
    cs_vec3_cross(a->of, b->by, second);
    for (int c = 0; c < 3; c++) {
        sum->of[c] += whole[c];
        sum->by[c] += first[c] + second[c];
    }
}

/* N of particle i of a grid with its change. */
static void grid_change(const struct cs_body_range *body, uint32_t i, uint32_t n,
                        const struct cs_eval *at, struct change *sum) {
    const struct neighbours beside = neighbours_of(body, i);
    const struct change across = change_of(at, n, beside.left, beside.right);
    const struct change upwards = change_of(at, n, beside.down, beside.up);
    add_product(&across, &upwards, sum);
}

/* N of particle i of a mesh with its change. */
static void mesh_change(const struct cs_body_range *body, uint32_t i, uint32_t n,
                        const struct cs_eval *at, struct change *sum) {
    const struct cs_trimesh *mesh = body->mesh;
    const uint32_t end = mesh->vertex_triangles_end[i - body->first], first = body->first;
    for (uint32_t k = cs_trimesh_around_begin(mesh, i - first); k < end; k++) {
        const uint32_t *corner = mesh->triangles + 3 * (size_t)mesh->vertex_triangles[k];
        const struct change a = change_of(at, n, first + corner[0], first + corner[1]);
        const struct change b = change_of(at, n, first + corner[0], first + corner[2]);
        add_product(&a, &b, sum);
    }
}

void cs_normal_product(const struct cs_system *system, const struct cs_body_range *body,
                       uint32_t i, const struct cs_eval *at, double product[3]) {
    struct change sum = {{0}, {0}};
    if (!at->dx) {
        mesh_product(body, i, system->view.n, at->x, product);
        return;
    }
    mesh_change(body, i, system->view.n, at, &sum);
    for (int c = 0; c < 3; c++)
        product[c] = sum.by[c];
}

void cs_normal_derivative(const struct cs_system *system, const struct cs_body_range *body,
                          uint32_t i, const struct cs_eval *at, double dn[3]) {
    struct change sum = {{0}, {0}};
    double normal[3], along = 0;
    (body->mesh ? mesh_change : grid_change)(body, i, system->view.n, at, &sum);
    const double inverse = 1 / sqrt(sum.of[0] * sum.of[0] + sum.of[1] * sum.of[1] +
                                    sum.of[2] * sum.of[2] + DBL_MIN);
    for (int c = 0; c < 3; c++) {
        normal[c] = sum.of[c] * inverse;
        along += normal[c] * sum.by[c];
    }
    // (I - n n^T) dN: a unit vector changes only across itself
    for (int c = 0; c < 3; c++)
        dn[c] = (sum.by[c] - along * normal[c]) * inverse;
}

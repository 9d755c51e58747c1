/* Springs along the edges of membranes for the preconditioner. */
#include "model/elastic/membrane_forces.h"

#include "base/pool.h"
#include "model/system/surfaces.h"

#include <math.h>

/* Adds a run whose springs lead from particle a + i to b + i. */
static void add_run(struct cs_membranes *membranes, const struct cs_membrane *membrane,
                    uint32_t a, uint32_t b, uint32_t count) {
    membranes->runs[membranes->n_runs++] = (struct cs_spring_run){.first_a = a,
                                                                  .first_b = b,
                                                                  .count = count,
                                                                  .body = membrane->body,
                                                                  .first = membranes->n_edges,
                                                                  .stiffness = 1};
    membranes->n_edges += count;
}

/* Adds the sides of one edge. */
static void add_sides(struct cs_membranes *membranes, uint32_t *n, uint32_t first,
                      uint32_t second) {
    membranes->sides[2 * (size_t)*n] = first;
    membranes->sides[2 * (size_t)*n + 1] = second;
    ++*n;
}

/* Edges of a grid row by row: along the row, down, and the diagonals. Triangle 2 k of cell k
 * has them as its edges 0, 2 and 1, as triangle 2 k + 1 the opposite ones (membranes.c). */
static void list_grid(struct cs_membranes *membranes, struct cs_membrane *membrane) {
    const uint32_t w = membrane->columns, cells = w - 1;
    for (uint32_t r = 0; r < membrane->rows; r++) {
        const uint32_t row = membrane->first + r * w, below = row + w;
        const bool has_next = r + 1 < membrane->rows;
        uint32_t n = membranes->n_edges;
        // t: the first triangle of the row's first cell
        const uint32_t t = 8 * r * cells, up = t - 8 * cells;
        for (uint32_t c = 0; c < cells; c++)
            add_sides(membranes, &n, has_next ? t + 8 * c : CS_NO_SIDE,
                      r > 0 ? up + 8 * c + 4 : CS_NO_SIDE);
        add_run(membranes, membrane, row, row + 1, cells);
        if (!has_next)
            break;
        for (uint32_t c = 0; c < w; c++)
            add_sides(membranes, &n, c < cells ? t + 8 * c + 2 : CS_NO_SIDE,
                      c > 0 ? t + 8 * (c - 1) + 4 + 2 : CS_NO_SIDE);
        add_run(membranes, membrane, row, below, w);
        for (uint32_t c = 0; c < cells; c++)
            add_sides(membranes, &n, t + 8 * c + 1, t + 8 * c + 4 + 1);
        add_run(membranes, membrane, row + 1, below, cells);
    }
}

static void list_mesh(struct cs_membranes *membranes, struct cs_membrane *membrane,
                      const struct cs_trimesh *mesh) {
    uint32_t *sides = membranes->sides + 2 * (size_t)membranes->n_edges;
    for (size_t k = 0; k < 2 * (size_t)mesh->n_edges; k++)
        sides[k] = CS_NO_SIDE;
    for (uint32_t t = 0; t < membrane->n; t++)
        for (uint32_t i = 0; i < 3; i++) {
            const uint32_t *corner = membrane->triangles + 3 * (size_t)t;
            const uint32_t e =
                cs_edge_find(mesh->edges, 0, mesh->n_edges, corner[i], corner[(i + 1) % 3]);
            sides[2 * (size_t)e + (sides[2 * (size_t)e] != CS_NO_SIDE)] = 4 * t + i;
        }
    add_run(membranes, membrane, membrane->first, membrane->first, mesh->n_edges);
    membranes->runs[membranes->n_runs - 1].ends = mesh->edges;
}

enum cs_status cs_membrane_surrogate_build(struct cs_system *system, struct cs_error *error) {
    struct cs_membranes *membranes = system->membranes;
    size_t n_runs = 0, n_edges = 0;
    if (!system->plan.rows[CS_FEATURE_SOLVER].built)
        return CS_OK;
    // upper bounds: three runs and edges a row and a particle of a grid
    for (uint32_t b = 0; b < membranes->n; b++) {
        const struct cs_trimesh *mesh = system->bodies[membranes->bodies[b].body].mesh;
        n_runs += mesh ? 1 : 3 * (size_t)membranes->bodies[b].rows;
        n_edges += mesh ? mesh->n_edges : 3 * (size_t)membranes->bodies[b].count;
    }
    CS_ARENA_ARRAY(&system->arena, membranes->runs, n_runs, error);
    CS_ARENA_ARRAY(&system->arena, membranes->sides, 2 * n_edges, error);
    for (uint32_t b = 0; b < membranes->n && !error->status; b++) {
        struct cs_membrane *membrane = membranes->bodies + b;
        const struct cs_trimesh *mesh = system->bodies[membrane->body].mesh;
        if (mesh)
            list_mesh(membranes, membrane, mesh);
        else
            list_grid(membranes, membrane);
    }
    // the factors of springs come first
    system->springs.n_factors =
        cs_springs_order_factors(membranes->runs, membranes->n_runs, system->springs.n_factors);
    return error->status;
}

/* k_i of edge i of triangle t, from the squares of the lengths at rest. */
static double stiffness_of(const struct cs_membrane *membrane, const struct cs_moduli *moduli,
                           uint32_t t, size_t i) {
    static const int entry[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    const size_t stride = membrane->columns ? 1 : membrane->n;
    const double *squared =
        membrane->rest + CS_MEMBRANE_P * stride + (membrane->columns ? 0 : t);
    double K[6], sum = 0;
    cs_membrane_stiffness(membrane, t, moduli, K);
    for (size_t j = 0; j < 3; j++)
        sum += fabs(K[entry[i][j]]) * sqrt(squared[j * stride] / squared[i * stride]);
    return sum;
}

/* Arguments of the loop over runs. */
struct factoring {
    const struct cs_system *system;
    double *factors;
};

/* Sets the factors of one run. */
static void factor_run(void *arg, uint32_t number) {
    const struct factoring *factoring = arg;
    const struct cs_membranes *membranes = factoring->system->membranes;
    const struct cs_spring_run *run = membranes->runs + number;
    const struct cs_membrane *membrane = membranes->bodies;
    const size_t n = factoring->system->view.n;
    while (membrane->body != run->body)
        membrane++;
    const struct cs_elastic *elastic = cs_scene_elastic(factoring->system->scene, run->body);
    const struct cs_moduli moduli = cs_membrane_moduli(elastic);
    const double kappa = -membranes->ck - membranes->cd * elastic->damping;
    double *to = factoring->factors + run->factors;
    for (uint32_t i = 0; i < run->count; i++) {
        double tension = 0, stiffness = 0;
        // one triangle at a rim, else two
        for (size_t k = 0; k < 2; k++) {
            const uint32_t side = membranes->sides[2 * ((size_t)run->first + i) + k];
            if (side == CS_NO_SIDE)
                continue;
            const size_t t = side / 4, edge = side % 4;
            tension += fmax(
                membranes->tensions[edge * membranes->n_triangles + membrane->begin + t], 0);
            stiffness += stiffness_of(membrane, &moduli, (uint32_t)t, edge);
        }
        const double root = sqrt(2 * kappa * stiffness);
        to[i] = tension;
        to[run->count + i] = root;
        for (size_t c = 0; c < 3 && run->ends; c++)
            to[(1 + c) * run->count + i] = root * (membranes->x[c * n + cs_spring_b(run, i)] -
                                                   membranes->x[c * n + cs_spring_a(run, i)]);
    }
}

void cs_membrane_surrogate_factor(const struct cs_system *system, double *factors) {
    struct factoring factoring = {system, factors};
    cs_pool_run(system->membranes->n_runs, factor_run, &factoring);
}

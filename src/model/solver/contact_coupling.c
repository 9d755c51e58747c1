/* Extra springs of bodies in contact: from contact pairs to the first level, and from level to
 * level. */
#include "model/solver/contact_coupling.h"

#include "model/contact/narrow_phase/contact_pairs.h"
#include "model/solver/extra_springs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The padding of a grid has no parents: CS_GRAPH_NONE. A mesh has its own from its matching. */
static void find_parents(struct cs_level *fine, const struct cs_level *coarse) {
    uint32_t *parents = fine->joint_parents + fine->first;
    memset(parents, 0xff, fine->n * sizeof *parents);
    for (uint32_t i = 0; fine->form == CS_LEVEL_MESH && i < fine->n; i++)
        parents[i] = coarse->first + fine->parents[i];
    for (uint32_t row = 0; row < fine->rows; row++)
        for (uint32_t column = 0; column < fine->columns; column++)
            parents[fine->begin + row * fine->pitch + column] =
                coarse->first + coarse->begin + row / 2 * coarse->pitch + column / 2;
}

/* Lists the cells of each parent: a counting sort. Counts are stored two places further on, so
 * that filling moves the starts to where they belong. */
static void find_children(struct cs_level *fine, const struct cs_level *coarse) {
    const uint32_t *parents = fine->joint_parents + fine->first;
    uint32_t *starts = fine->children_begin;
    for (uint32_t i = 0; i < fine->n; i++)
        if (parents[i] != CS_GRAPH_NONE)
            starts[parents[i] - coarse->first + 2]++;
    for (uint32_t i = 2; i < coarse->n + 2; i++)
        starts[i] += starts[i - 1];
    for (uint32_t i = 0; i < fine->n; i++)
        if (parents[i] != CS_GRAPH_NONE)
            fine->children[starts[parents[i] - coarse->first + 1]++] = i;
}

/* Fills the parents and children of a level. */
static void add_pair_springs(struct cs_level *fine, const struct cs_level *coarse,
                             struct cs_arena *arena, struct cs_error *error) {
    fine->children = cs_arena_alloc_array(arena, fine->n, sizeof *fine->children, error);
    CS_ARENA_ARRAY(arena, fine->children_begin, coarse->n + (size_t)2, error);
    if (error->status)
        return;
    find_parents(fine, coarse);
    find_children(fine, coarse);
}

/* The lists themselves are empty until the first matrix with contact. */
enum cs_status cs_coupling_init(struct cs_hierarchy *hierarchy, struct cs_arena *arena,
                                struct cs_error *error) {
    for (uint32_t k = 0; k < hierarchy->n_levels && !error->status; k++) {
        struct cs_level *level = hierarchy->levels + k;
        CS_ARENA_ARRAY(arena, level->extra_springs, 1, error);
        if (!error->status &&
            !cs_extra_springs_init(level->extra_springs, level->first, level->n, arena,
                                   error) &&
            k + 1 < hierarchy->n_levels)
            add_pair_springs(level, level + 1, arena, error);
    }
    return error->status;
}

/* --- the blocks --- */
/* The four points of a pair; numbers from view.n on belong to colliders. */
static const uint32_t *points_of(const struct cs_pairs *pairs, uint32_t chunk, size_t pair) {
    return pairs->solver_matrix.contacts->chunks[chunk].points[pair];
}

/* block = along g g^T + rub C, with C = `of` the friction block. Component by component, for
 * speed. */
static void set_block(const double g[3], double along, double rub, const double of[6],
                      double block[6]) {
    block[0] = along * (g[0] * g[0]) + rub * of[0];
    block[1] = along * (g[0] * g[1]) + rub * of[1];
    block[2] = along * (g[0] * g[2]) + rub * of[2];
    block[3] = along * (g[1] * g[1]) + rub * of[3];
    block[4] = along * (g[1] * g[2]) + rub * of[4];
    block[5] = along * (g[2] * g[2]) + rub * of[5];
}

/* Sets both blocks of the terms. With gradients g_k, normal stiffness c and friction block F:
 *
 *   diagonal     c g_v g_v^T + w_v^2 F      at the vertex v
 *   unit weight  c g_m g_m^T / w_m^2 + F    at the vertex m of the largest weight
 *
 * Where the distance is not bent, g_k = w_k n with one normal n, and both agree up to w_v^2. */
static void set_blocks(double g[4][3], const struct cs_pair_matrix_terms *part,
                       struct cs_pair_vertex_terms *terms) {
    const double *weight = part->weight, own = weight[terms->vertex];
    uint32_t most = 0;
    for (uint32_t k = 1; k < 4; k++)
        most = weight[k] * weight[k] > weight[most] * weight[most] ? k : most;
    memcpy(terms->weight, weight, sizeof terms->weight);
    set_block(g[terms->vertex], part->gradient_weight, own * own, part->block,
              terms->diagonal_block);
    set_block(g[most], part->gradient_weight / (weight[most] * weight[most]), 1, part->block,
              terms->unit_weight_block);
}

/* Adds the second derivative of the distance, which an exact matrix has, to the diagonal block.
 */
static void add_turn(const struct cs_pair_hessian *hessian,
                     struct cs_pair_vertex_terms *terms) {
    const uint32_t first = 3 * terms->vertex;
    for (int e = 0; e < 6; e++)
        terms->diagonal_block[e] +=
            hessian->m[first + cs_sym3_row[e]][first + cs_sym3_column[e]];
}

/* Reads the terms of a pair, of either kind of stored matrix, for one of its vertices. */
static void read_vertex(const struct cs_pairs *pairs, const struct cs_pair_vertex *vertex,
                        struct cs_pair_vertex_terms *terms) {
    const struct cs_pair_matrix *kept = &pairs->solver_matrix;
    struct cs_pair_matrix_terms part;
    double g[4][3];
    memcpy(terms->points, points_of(pairs, vertex->chunk, vertex->pair), sizeof terms->points);
    terms->vertex = vertex->vertex;
    cs_pair_factors_read(kept->contacts->chunks[vertex->chunk].kind,
                         kept->chunks[vertex->chunk].factors + vertex->pair / CS_PAIR_LANES,
                         (int)(vertex->pair % CS_PAIR_LANES), g, &part);
    set_blocks(g, &part, terms);
    if (kept->exact)
        add_turn(kept->chunks[vertex->chunk].hessians + vertex->pair, terms);
}

/* --- from pairs --- */

/* Tells whether all four points of a pair are particles, not vertices of a collider. */
static bool is_inner(const struct cs_pairs *pairs, const uint32_t at[4]) {
    bool inner = true;
    for (uint32_t k = 0; k < 4; k++)
        inner = inner && at[k] < pairs->system->view.n;
    return inner;
}

/* The joint number of the first level's cell of a particle. */
static uint32_t cell_of(const struct cs_coupling *coupling, uint32_t particle) {
    const struct cs_hierarchy *hierarchy =
        coupling->hierarchies + coupling->pairs->candidates.body[particle];
    const uint32_t i = particle - hierarchy->first, row = i / hierarchy->columns;
    return hierarchy->levels->first + hierarchy->levels->begin +
           row * hierarchy->levels->pitch + i % hierarchy->columns;
}

/* The particle of a body's cell; UINT32_MAX in the padding. */
static uint32_t particle_of(const struct cs_hierarchy *hierarchy, uint32_t cell) {
    const struct cs_level *level = hierarchy->levels;
    if (cell < level->begin || cell >= level->end)
        return UINT32_MAX;
    const uint32_t row = (cell - level->begin) / level->pitch;
    const uint32_t column = (cell - level->begin) % level->pitch;
    const uint32_t i = row * hierarchy->columns + column;
    return column < hierarchy->columns && i < hierarchy->count ? hierarchy->first + i
                                                               : UINT32_MAX;
}

/* internal_blocks of a particle += factor times a block. */
static void count_in(const struct cs_coupling *coupling, uint32_t particle,
                     const double block[6], double factor) {
    const size_t n = coupling->pairs->system->view.n;
    for (size_t c = 0; c < 6; c++)
        coupling->internal_blocks[c * n + particle] += factor * block[c];
}

/* Adds the springs from one vertex of a pair to the others: -w_i w_k C to each free particle k.
 * A pinned particle does not move, so its spring stays in the diagonal block; it is not counted
 * as internal. So does a weak spring, which mass outweighs: most springs are weak, and each
 * costs every sweep of the smoother. A negative one of them is left out: the diagonal must stay
 * positive. Both ends decide alike, because the product of two weights has no order. */
static void add_springs(const struct cs_coupling *coupling,
                        struct cs_extra_springs_chunk *chunk,
                        const struct cs_pair_vertex_terms *terms) {
    const double *whole = terms->unit_weight_block;
    float block[6];
    for (int c = 0; c < 6; c++)
        block[c] = (float)(coupling->scale * whole[c]);
    for (uint32_t k = 0; k < 4; k++) {
        const double stiff = -terms->weight[terms->vertex] * terms->weight[k];
        const double trace = stiff * (whole[0] + whole[3] + whole[5]);
        const uint32_t other = terms->points[k];
        if (k == terms->vertex || stiff == 0)
            continue;
        if (coupling->inv_mass[other] > 0 && fabs(trace) >= coupling->trace_min)
            cs_extra_springs_add(chunk, cell_of(coupling, other), block, (float)stiff);
        else if (trace > 0)
            count_in(coupling, terms->points[terms->vertex], whole, -stiff);
    }
}

/* Adds one vertex of a pair: its diagonal block to the internal blocks, and its springs. Weak
 * pairs, none of whose springs can be strong, are skipped, except those that are subtracted
 * (negative trace): they must not remain where the pairs that they are subtracted from do not.
 */
static void add_corner(const struct cs_coupling *coupling, struct cs_extra_springs_chunk *chunk,
                       const struct cs_pair_vertex *vertex) {
    struct cs_pair_vertex_terms terms;
    read_vertex(coupling->pairs, vertex, &terms);
    const double trace =
        terms.unit_weight_block[0] + terms.unit_weight_block[3] + terms.unit_weight_block[5];
    if (!is_inner(coupling->pairs, terms.points) || (trace >= 0 && trace < coupling->trace_min))
        return;
    count_in(coupling, terms.points[terms.vertex], terms.diagonal_block, 1);
    add_springs(coupling, chunk, &terms);
}

/* Finds the springs of one cell of the first level. Each vertex of a pair is visited from its
 * own particle, so a thread writes to its own cells alone. Pinned particles have none. */
static void find_links(void *arg, struct cs_extra_springs_chunk *chunk, uint32_t cell) {
    const struct cs_coupling *coupling = arg;
    const struct cs_pair_vertices *vertices = coupling->pair_vertices;
    const size_t n = coupling->pairs->system->view.n;
    const uint32_t i = particle_of(coupling->hierarchy, cell);
    if (i == UINT32_MAX)
        return;
    for (size_t c = 0; c < 6; c++)
        coupling->internal_blocks[c * n + i] = 0;
    if (!(coupling->inv_mass[i] > 0))
        return;
    for (uint32_t e = vertices->starts[i]; e < vertices->starts[i + 1]; e++)
        add_corner(coupling, chunk, vertices->items + e);
}

/* By all threads, cell by cell. */
bool cs_coupling_load(struct cs_coupling *coupling) {
    return cs_extra_springs_make(coupling->hierarchy->levels->extra_springs, find_links,
                                 coupling);
}

/* --- from level to level --- */

/* Arguments of the loop that sums springs into the next level. */
struct coarsening {
    const struct cs_level *fine, *coarse;
};

/* Sums the springs that leave the aggregate of a coarse cell, by the aggregates of their other
 * ends. Springs inside it vanish. Unused slots, where a cell is its own neighbour, are skipped.
 */
static void sum_links(void *arg, struct cs_extra_springs_chunk *chunk, uint32_t cell) {
    const struct coarsening *coarsening = arg;
    const struct cs_level *fine = coarsening->fine, *coarse = coarsening->coarse;
    const uint32_t begin = fine->children_begin[cell], end = fine->children_begin[cell + 1];
    for (const uint32_t *child = fine->children + begin; child < fine->children + end;
         child++) {
        const struct cs_extra_springs_slots slots =
            cs_extra_springs_of(fine->extra_springs, *child / CS_LANES);
        const size_t lane = *child % CS_LANES;
        for (size_t k = 0; k < slots.n; k++) {
            const uint32_t to = slots.cells[k * CS_LANES + lane];
            float block[6];
            for (size_t c = 0; c < 6; c++)
                block[c] = slots.springs[(6 * k + c) * CS_LANES + lane];
            if (to != fine->first + *child && fine->joint_parents[to] != coarse->first + cell)
                cs_extra_springs_add(chunk, fine->joint_parents[to], block, 1);
        }
    }
}

/* Without springs on the fine level, the coarse one has none either. */
bool cs_coupling_coarsen(const struct cs_level *fine, struct cs_level *coarse) {
    struct coarsening coarsening = {fine, coarse};
    coarse->extra_springs->is_nonempty = false;
    return !fine->extra_springs->is_nonempty ||
           cs_extra_springs_make(coarse->extra_springs, sum_links, &coarsening);
}

/* Indexes the solver's contact matrix by particle and reads its blocks. */

/* Frees the arrays, which outgrow the arena. */
static void finish_coupling(void *object) {
    struct cs_pair_vertices *vertices = object;
    free(vertices->starts);
    free(vertices->items);
}

enum cs_status cs_pair_vertices_init(struct cs_pair_vertices *vertices, struct cs_arena *arena,
                                     struct cs_error *error) {
    *vertices = (struct cs_pair_vertices){0};
    cs_arena_adopt(arena, finish_coupling, vertices, error);
    return error->status;
}

size_t cs_pair_vertices_count(const struct cs_pairs *pairs) {
    return pairs->solver_matrix.contacts->n;
}

/* --- by particles --- */

/* Makes room for all vertices and zeroes the starts. Returns false if out of memory. */
static bool reserve(struct cs_pair_vertices *vertices, const struct cs_pairs *pairs) {
    const size_t n = pairs->system->view.n + (size_t)2;
    if (!CS_ARENA_REALLOC(vertices->starts, vertices->starts_capacity, n))
        return false;
    memset(vertices->starts, 0, n * sizeof *vertices->starts);
    return CS_ARENA_REALLOC(vertices->items, vertices->items_capacity,
                            4 * cs_pair_vertices_count(pairs));
}

/* Visits all vertices: counts them at `to`, and, unless `of` is NULL, stores them where `to`
 * points. */
static void visit(const struct cs_pairs *pairs, uint32_t *to, struct cs_pair_vertex *of) {
    for (uint32_t chunk = 0; chunk < pairs->candidates.n_chunks; chunk++)
        for (size_t pair = 0; pair < pairs->solver_matrix.contacts->chunks[chunk].n; pair++) {
            const uint32_t *at = points_of(pairs, chunk, pair);
            for (uint32_t k = 0; k < 4; k++) {
                // colliders are not unknowns of the matrix
                if (at[k] >= pairs->system->view.n)
                    continue;
                if (of)
                    of[to[at[k]]] = (struct cs_pair_vertex){chunk, (uint32_t)pair, k};
                to[at[k]]++;
            }
        }
}

/* A counting sort. Counts are stored two places further on, so that filling moves the starts to
 * where they belong. */
bool cs_pair_vertices_find(struct cs_pair_vertices *vertices, const struct cs_pairs *pairs) {
    if (!reserve(vertices, pairs))
        return false;
    uint32_t *starts = vertices->starts;
    visit(pairs, starts + 2, NULL);
    for (uint32_t i = 0; i < pairs->system->view.n; i++)
        starts[i + 2] += starts[i + 1];
    visit(pairs, starts + 1, vertices->items);
    return true;
}

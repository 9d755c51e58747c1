/* Indexes the stored contact matrix by particle and reads its blocks, for both kinds of matrix:
 * the positive semi-definite operator (solver_psd) and the exact one (solver_exact). */
#include "model/solver/pair_vertices.h"

#include "model/contact/narrow_phase/contact_pairs.h"

#include <stdlib.h>
#include <string.h>

/* Frees the arrays, which outgrow the arena. */
static void finish(void *object) {
    struct cs_pair_vertices *corners = object;
    free(corners->starts);
    free(corners->items);
}

enum cs_status cs_pair_vertices_init(struct cs_pair_vertices *corners, struct cs_arena *arena,
                                     struct cs_error *error) {
    *corners = (struct cs_pair_vertices){0};
    cs_arena_adopt(arena, finish, corners, error);
    return error->status;
}

size_t cs_pair_vertices_count(const struct cs_pairs *pairs) {
    return pairs->solver_psd.contacts ? pairs->solver_psd.contacts->n : pairs->solver_exact.n;
}

/* --- by particles --- */

/* Number of pairs in a chunk. */
static size_t count_in(const struct cs_pairs *pairs, uint32_t chunk) {
    return pairs->solver_psd.contacts ? pairs->solver_psd.contacts->chunks[chunk].n
                                      : pairs->solver_exact.chunks[chunk].n;
}

/* The four points of a pair; numbers from view.n on belong to colliders. */
static const uint32_t *points_of(const struct cs_pairs *pairs, uint32_t chunk, size_t pair) {
    return pairs->solver_psd.contacts ? pairs->solver_psd.contacts->chunks[chunk].points[pair]
                                      : pairs->solver_exact.chunks[chunk].pairs[pair].particles;
}

/* Makes room for all vertices and zeroes the starts. Returns false if out of memory. */
static bool reserve(struct cs_pair_vertices *corners, const struct cs_pairs *pairs) {
    const size_t n = pairs->system->view.n + (size_t)2;
    uint32_t *starts =
        cs_arena_realloc(corners->starts, &corners->starts_capacity, n, sizeof *starts);
    corners->starts = starts ? starts : corners->starts;
    struct cs_pair_vertex *of = cs_arena_realloc(corners->items, &corners->items_capacity,
                                                 4 * cs_pair_vertices_count(pairs), sizeof *of);
    corners->items = of ? of : corners->items;
    if (starts)
        memset(starts, 0, n * sizeof *starts);
    return starts && of;
}

/* Visits all vertices: counts them at `to`, and, unless `of` is NULL, stores them where `to`
 * points. */
static void visit(const struct cs_pairs *pairs, uint32_t *to, struct cs_pair_vertex *of) {
    for (uint32_t chunk = 0; chunk < pairs->candidates.n_chunks; chunk++)
        for (size_t pair = 0; pair < count_in(pairs, chunk); pair++) {
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
bool cs_pair_vertices_find(struct cs_pair_vertices *corners, const struct cs_pairs *pairs) {
    if (!reserve(corners, pairs))
        return false;
    uint32_t *starts = corners->starts;
    visit(pairs, starts + 2, NULL);
    for (uint32_t i = 0; i < pairs->system->view.n; i++)
        starts[i + 2] += starts[i + 1];
    visit(pairs, starts + 1, corners->items);
    return true;
}

/* --- the blocks --- */

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
                       struct cs_pair_vertex_terms *share) {
    const double *weight = part->weight, own = weight[share->vertex];
    uint32_t most = 0;
    for (uint32_t k = 1; k < 4; k++)
        most = weight[k] * weight[k] > weight[most] * weight[most] ? k : most;
    memcpy(share->weight, weight, sizeof share->weight);
    set_block(g[share->vertex], part->gradient_weight, own * own, part->block,
              share->diagonal_block);
    set_block(g[most], part->gradient_weight / (weight[most] * weight[most]), 1, part->block,
              share->unit_weight_block);
}

/* Adds the second derivative of the distance, which an exact matrix has, to the diagonal block.
 */
static void add_turn(const struct cs_contact_hessian *full,
                     struct cs_pair_vertex_terms *share) {
    static const uint32_t row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    const uint32_t first = 3 * share->vertex;
    for (int e = 0; e < 6; e++)
        share->diagonal_block[e] += full->m[first + row[e]][first + column[e]];
}

/* Reads a pair of the exact matrix. */
static void read_exact(const struct cs_contact_chunk *chunk, size_t pair,
                       struct cs_pair_vertex_terms *share) {
    struct cs_pair_matrix_terms part = {.gradient_weight = chunk->parts[pair].gradient_weight};
    memcpy(part.weight, chunk->parts[pair].weights, sizeof part.weight);
    memcpy(part.block, chunk->parts[pair].block, sizeof part.block);
    set_blocks(chunk->pairs[pair].vectors, &part, share);
    add_turn(chunk->hessians + pair, share);
}

void cs_pair_vertices_read(const struct cs_pairs *pairs, const struct cs_pair_vertex *corner,
                           struct cs_pair_vertex_terms *share) {
    const struct cs_psd_operator *kept = &pairs->solver_psd;
    struct cs_pair_matrix_terms part;
    double g[4][3];
    memcpy(share->points, points_of(pairs, corner->chunk, corner->pair), sizeof share->points);
    share->vertex = corner->vertex;
    if (!kept->contacts) {
        read_exact(pairs->solver_exact.chunks + corner->chunk, corner->pair, share);
        return;
    }
    cs_pair_factors_read(kept->contacts->chunks[corner->chunk].kind,
                         kept->chunks[corner->chunk].factors + corner->pair / CS_PAIR_LANES,
                         (int)(corner->pair % CS_PAIR_LANES), g, &part);
    set_blocks(g, &part, share);
}

/* The contact matrix of pairs: factors per chunk, diagonal blocks and products.
 *
 * Why P >= 0, the matrix without Hessians: a pair contributes p^T P p = c (sum g_j.p_j)^2 + V^T
 * B V with V = sum w_j p_j, and neither term is negative for c >= 0 and B >= 0.
 *
 * Bound of the diagonal of P, for a preconditioner or a decoupled solve that sees the blocks
 * alone. Cauchy's inequality gives
 *
 *   (sum g_j.p_j)^2 <= (sum |g_j|) sum (g_j.p_j)^2 / |g_j|
 *   V^T B V <= (sum |w_j|) sum |w_j| p_j^T B p_j
 *
 * so that P <= diag(blocks) with each gradient block times (sum |g_j|) / |g_k| and each B block
 * w_k^2 B times (sum |w_j|) / |w_k|: find_growth of pair_lanes.c. The product uses exact
 * blocks; diagonal_bound is for matrices whose blocks alone are wanted. */
#include "model/contact/narrow_phase/pair_matrix.h"

#include "base/pool.h"
#include "base/vector.h"

#include <stdlib.h>
#include <string.h>

static void finish_matrix(void *object) {
    struct cs_pair_matrix *matrix = object;
    for (uint32_t l = 0; l < matrix->n_chunks; l++)
        free(matrix->chunks[l].factors), free(matrix->chunks[l].hessians);
    free(matrix->diagonal);
}

enum cs_status cs_pair_matrix_init(struct cs_pair_matrix *matrix, uint32_t n_chunks,
                                   struct cs_arena *arena, struct cs_error *error) {
    *matrix = (struct cs_pair_matrix){.n_chunks = n_chunks};
    matrix->chunks = cs_arena_alloc_array(arena, n_chunks, sizeof *matrix->chunks, error);
    if (!error->status)
        cs_arena_adopt(arena, finish_matrix, matrix, error);
    return error->status;
}

/* pairs of one block: CS_PAIR_LANES but in the last */
static uint32_t count_at(const struct cs_active_chunk *chunk, size_t block) {
    const size_t left = chunk->n - block * CS_PAIR_LANES;
    return left < CS_PAIR_LANES ? (uint32_t)left : CS_PAIR_LANES;
}

/* blocks of factors of a chunk */
static size_t blocks_of(const struct cs_active_chunk *chunk) {
    return (chunk->n + CS_PAIR_LANES - 1) / CS_PAIR_LANES;
}

/* --- the matrix --- */

bool cs_pair_matrix_begin(struct cs_pair_matrix *matrix, struct cs_active_contacts *active,
                          bool exact, bool alone) {
    matrix->contacts = active;
    matrix->exact = exact;
    matrix->diagonal_bound = alone;
    return CS_ARENA_REALLOC(matrix->diagonal, matrix->diagonal_capacity,
                            6 * (size_t)active->force_gather.n_rows);
}

bool cs_pair_matrix_chunk_begin(struct cs_pair_matrix *matrix, uint32_t number) {
    struct cs_pair_matrix_chunk *chunk = matrix->chunks + number;
    const struct cs_active_chunk *pairs = matrix->contacts->chunks + number;
    chunk->failed = !CS_ARENA_REALLOC(chunk->factors, chunk->capacity, blocks_of(pairs)) ||
                    !CS_ARENA_REALLOC(chunk->hessians, chunk->hessians_capacity,
                                      matrix->exact ? pairs->n : 0);
    return !chunk->failed;
}

/* Column j is the tangent of the gradient along unit vector j. The upper triangle is used for
 * both halves, so that rounding leaves it symmetric. */
void cs_pair_matrix_set_hessian(const struct cs_pair_contact *contact,
                                const struct cs_matrix *of, struct cs_pair_hessian *hessian) {
    const struct cs_point_contact *point = &contact->contact;
    const double push = of->ck * cs_barrier_at(point->d, point->range, point->k).force;
    for (int j = 0; j < 12; j++) {
        double unit[4][3] = {{0}}, column[4][3], dw[4];
        unit[j / 3][j % 3] = 1;
        cs_pair_contact_tangent(contact, unit, column, dw);
        for (int i = 0; i <= j; i++)
            hessian->m[i][j] = hessian->m[j][i] = push * column[i / 3][i % 3];
    }
}

/* Adds the diagonal blocks of eight pairs to the rows of their points. */
static void add_own(struct cs_pair_matrix *matrix, uint32_t number, size_t block,
                    double *rows) {
    const struct cs_active_chunk *chunk = matrix->contacts->chunks + number;
    uint32_t(*to)[4] = chunk->rows + block * CS_PAIR_LANES;
    const struct cs_pair_hessian *hessian =
        matrix->exact ? matrix->chunks[number].hessians + block * CS_PAIR_LANES : NULL;
    const uint32_t n = count_at(chunk, block);
    double own[4][6][CS_PAIR_LANES];
    cs_pair_lanes_diagonal(chunk->kind, matrix->chunks[number].factors + block,
                           matrix->diagonal_bound, own);
    for (uint32_t l = 0; l < n; l++)
        for (int k = 0; k < 4; k++)
            for (int e = 0; e < 6; e++)
                rows[6 * (size_t)to[l][k] + (size_t)e] +=
                    own[k][e][l] +
                    (hessian ? hessian[l].m[3 * k + cs_sym3_row[e]][3 * k + cs_sym3_column[e]]
                             : 0);
}

void cs_pair_matrix_chunk_end(struct cs_pair_matrix *matrix, uint32_t number) {
    const struct cs_gather_chunk *chunk = matrix->contacts->force_gather.chunks + number;
    const size_t blocks = blocks_of(matrix->contacts->chunks + number);
    double *own = cs_gather_of(chunk, matrix->diagonal, 6);
    memset(own, 0, 6 * sizeof *own * chunk->n);
    for (size_t b = 0; b < blocks; b++)
        add_own(matrix, number, b, own);
}

bool cs_pair_matrix_end(struct cs_pair_matrix *matrix) {
    bool failed = false;
    for (uint32_t l = 0; l < matrix->n_chunks; l++)
        failed = failed || matrix->chunks[l].failed;
    return !failed;
}

void cs_pair_matrix_add_blocks(const struct cs_pair_matrix *matrix, size_t begin, size_t end,
                               double *blocks) {
    cs_gather_add(&matrix->contacts->force_gather, matrix->diagonal, 6, begin, end, blocks);
}

/* --- times a vector --- */

/* One product: y += (A - diagonal) p for n points; or, for an approach, the elastic part of A
 * times p. */
struct job {
    const struct cs_pair_matrix *matrix;
    const double *p;
    size_t n;
    bool approach;
    double *y;
};

/* blocks of eight pairs that are multiplied between one pass of loads and one of stores */
enum { TOGETHER = 8 };

/* vectors of four points, by lanes */
typedef double vectors[4][3][CS_PAIR_LANES];

/* out += H p for each pair of a block */
static void add_hessians(const struct cs_pair_hessian *hessian, uint32_t n, vectors p,
                         vectors out) {
    for (uint32_t l = 0; l < n; l++)
        for (int i = 0; i < 12; i++) {
            double sum = 0;
            for (int j = 0; j < 12; j++)
                sum += hessian[l].m[i][j] * p[j / 3][j % 3][l];
            out[i / 3][i % 3][l] += sum;
        }
}

/* Replaces p by the product of one block, for an approach without B. */
static void multiply_block(const struct job *job, uint32_t number, size_t block, vectors p) {
    const struct cs_active_chunk *chunk = job->matrix->contacts->chunks + number;
    const struct cs_pair_matrix_chunk *terms = job->matrix->chunks + number;
    struct cs_pair_factors elastic;
    vectors at;
    if (job->matrix->exact)
        memcpy(at, p, sizeof at);
    if (job->approach) {
        elastic = terms->factors[block];
        memset(elastic.block, 0, sizeof elastic.block);
    }
    cs_pair_lanes_multiply(chunk->kind, job->approach ? &elastic : terms->factors + block, p);
    if (job->matrix->exact)
        add_hessians(terms->hessians + block * CS_PAIR_LANES, count_at(chunk, block), at, p);
}

/* Multiplies up to TOGETHER blocks: loads all, multiplies all, adds all. A vector load directly
 * after scalar stores to the same addresses would stall. */
static void multiply_some(const struct job *job, uint32_t number, size_t first, const double *p,
                          double *sums) {
    const struct cs_active_chunk *chunk = job->matrix->contacts->chunks + number;
    uint32_t(*to)[4] = chunk->rows + first * CS_PAIR_LANES;
    const size_t left = blocks_of(chunk) - first, n = left < TOGETHER ? left : TOGETHER;
    vectors by[TOGETHER];
    for (size_t b = 0; b < n; b++)
        cs_pair_lanes_read(p, 3, to + b * CS_PAIR_LANES, count_at(chunk, first + b), by[b]);
    for (size_t b = 0; b < n; b++)
        multiply_block(job, number, first + b, by[b]);
    for (size_t b = 0; b < n; b++)
        cs_pair_lanes_add(by[b], 3, to + b * CS_PAIR_LANES, count_at(chunk, first + b), sums);
}

/* sums = -(diagonal block) p per row: the solver applies the diagonal itself. Once per row is
 * cheaper than once per pair. */
static void take_own(const double *own, const double *p, size_t n, double *sums) {
    for (size_t row = 0; row < n; row++) {
        const double *s = own + 6 * row, x = p[3 * row], y = p[3 * row + 1], z = p[3 * row + 2];
        sums[3 * row] = -(s[0] * x + s[1] * y + s[2] * z);
        sums[3 * row + 1] = -(s[1] * x + s[3] * y + s[4] * z);
        sums[3 * row + 2] = -(s[2] * x + s[4] * y + s[5] * z);
    }
}

/* Product of one chunk, into its rows. Points from job->n on have p = 0. */
static void multiply_chunk(void *arg, uint32_t number) {
    const struct job *job = arg;
    const struct cs_gather *gather = &job->matrix->contacts->force_gather;
    const struct cs_gather_chunk *chunk = gather->chunks + number;
    const size_t blocks = blocks_of(job->matrix->contacts->chunks + number);
    if (!blocks)
        return;
    const double *p = cs_gather_read(gather, number, 0, job->p, job->n);
    double *sums = cs_gather_of(chunk, gather->row_sums, 3);
    if (job->approach)
        memset(sums, 0, 3 * sizeof *sums * chunk->n);
    else
        take_own(cs_gather_of(chunk, job->matrix->diagonal, 6), p, chunk->n, sums);
    for (size_t b = 0; b < blocks; b += TOGETHER)
        multiply_some(job, number, b, p, sums);
}

static void add_part(void *arg, size_t begin, size_t end) {
    const struct job *job = arg;
    const struct cs_gather *gather = &job->matrix->contacts->force_gather;
    cs_gather_add(gather, gather->row_sums, 3, begin, end, job->y);
}

static void run(struct job *job) {
    const struct cs_pair_matrix *matrix = job->matrix;
    // Never fails: the rows were at least 6 wide when the matrix was made.
    if (!matrix->contacts->n || !cs_gather_reserve(&matrix->contacts->force_gather, 3))
        return;
    cs_pool_run(matrix->n_chunks, multiply_chunk, job);
    cs_vector_parallel_for(matrix->contacts->force_gather.n_particles, add_part, job);
}

/* Points of colliders have p = 0 and do not move. */
void cs_pair_matrix_apply(const struct cs_pair_matrix *matrix, const double *p, double *y) {
    run(&(struct job){matrix, p, matrix->contacts->force_gather.n_particles, false, y});
}

void cs_pair_matrix_approach(const struct cs_pair_matrix *matrix, size_t n_points,
                             const double *v, double *y) {
    run(&(struct job){matrix, v, n_points, true, y});
}

/* Factors of pairs in lanes, multiplied lot by lot. */
#include "model/pair/product.h"

#include "base/pool.h"
#include "base/vector.h"

#include <stdlib.h>
#include <string.h>

static void finish(void *object) {
    struct cs_product *product = object;
    for (uint32_t l = 0; l < product->n_lots; l++)
        free(product->lots[l].factors);
    free(product->own);
}

enum cs_status cs_product_init(struct cs_product *product, uint32_t n_lots,
                               struct cs_arena *arena, struct cs_error *error) {
    *product = (struct cs_product){.n_lots = n_lots};
    product->lots = cs_arena_take_n(arena, n_lots, sizeof *product->lots, error);
    if (!error->status)
        cs_arena_own(arena, finish, product, error);
    return error->status;
}

/* pairs of a lot from that of a block on, as many as there are lanes at most */
static uint32_t count_at(const struct cs_active_lot *lot, size_t block) {
    const size_t left = lot->n - block * CS_PAIR_LANES;
    return left < CS_PAIR_LANES ? (uint32_t)left : CS_PAIR_LANES;
}

static size_t blocks_of(const struct cs_active_lot *lot) {
    return (lot->n + CS_PAIR_LANES - 1) / CS_PAIR_LANES;
}

/* --- the matrix --- */

bool cs_product_begin(struct cs_product *product, struct cs_active *active, bool alone) {
    product->active = active;
    product->alone = alone;
    double *own = cs_arena_grow(product->own, &product->own_room,
                                6 * (size_t)active->gather.n_rows, sizeof *own);
    product->own = own ? own : product->own;
    return own || !active->gather.n_rows;
}

struct cs_pair_factors *cs_product_lot_begin(struct cs_product *product, uint32_t number) {
    struct cs_product_lot *lot = product->lots + number;
    struct cs_pair_factors *factors = cs_arena_grow(
        lot->factors, &lot->room, blocks_of(product->active->lots + number), sizeof *factors);
    lot->failed = !factors;
    if (!factors)
        return NULL;
    lot->factors = factors;
    return factors;
}

static void add_own(struct cs_product *product, uint32_t number, size_t block, double *rows) {
    const struct cs_active_lot *lot = product->active->lots + number;
    uint32_t(*to)[4] = lot->to + block * CS_PAIR_LANES;
    const uint32_t n = count_at(lot, block);
    double own[4][6][CS_PAIR_LANES];
    cs_pair_lanes_own(lot->kind, product->lots[number].factors + block, product->alone, own);
    for (uint32_t l = 0; l < n; l++)
        for (int k = 0; k < 4; k++)
            for (int e = 0; e < 6; e++)
                rows[6 * (size_t)to[l][k] + (size_t)e] += own[k][e][l];
}

void cs_product_lot_end(struct cs_product *product, uint32_t number) {
    const struct cs_gather_lot *rows = product->active->gather.lots + number;
    const size_t blocks = blocks_of(product->active->lots + number);
    double *own = cs_gather_of(rows, product->own, 6);
    memset(own, 0, 6 * sizeof *own * rows->n);
    for (size_t b = 0; b < blocks; b++)
        add_own(product, number, b, own);
}

bool cs_product_end(struct cs_product *product) {
    bool failed = false;
    for (uint32_t l = 0; l < product->n_lots; l++)
        failed = failed || product->lots[l].failed;
    return !failed;
}

void cs_product_add_blocks(const struct cs_product *product, size_t begin, size_t end,
                           double *blocks) {
    cs_gather_add(&product->active->gather, product->own, 6, begin, end, blocks);
}

/* --- times a vector --- */

struct job {
    const struct cs_product *product;
    const double *p;
    double *y;
};

/* blocks of eight that are multiplied together */
enum { TOGETHER = 8 };

typedef double vectors[4][3][CS_PAIR_LANES];

static void read_lanes(const double *rows, uint32_t (*to)[4], uint32_t count, vectors p) {
    for (size_t l = 0; l < count; l++)
        for (size_t k = 0; k < 4; k++)
            for (size_t c = 0; c < 3; c++)
                p[k][c][l] = rows[3 * (size_t)to[l][k] + c];
}

static void add_lanes(vectors by, uint32_t (*to)[4], uint32_t count, double *sums) {
    for (size_t l = 0; l < count; l++)
        for (size_t k = 0; k < 4; k++)
            for (size_t c = 0; c < 3; c++)
                sums[3 * (size_t)to[l][k] + c] += by[k][c][l];
}

/* step by step for several blocks: what was just written number by number is not at once read
 * as vectors */
static void multiply_some(const struct job *job, uint32_t number, size_t first, const double *p,
                          double *sums) {
    const struct cs_active_lot *lot = job->product->active->lots + number;
    struct cs_pair_factors *factors = job->product->lots[number].factors + first;
    uint32_t(*to)[4] = lot->to + first * CS_PAIR_LANES;
    const size_t left = blocks_of(lot) - first, n = left < TOGETHER ? left : TOGETHER;
    vectors by[TOGETHER];
    for (size_t b = 0; b < n; b++)
        read_lanes(p, to + b * CS_PAIR_LANES, count_at(lot, first + b), by[b]);
    for (size_t b = 0; b < n; b++)
        cs_pair_lanes_multiply(lot->kind, factors + b, by[b]);
    for (size_t b = 0; b < n; b++)
        add_lanes(by[b], to + b * CS_PAIR_LANES, count_at(lot, first + b), sums);
}

/* sums = less what the solver has by the diagonal blocks already, in each row once for all of
 * its pairs */
static void take_own(const double *own, const double *p, size_t n, double *sums) {
    for (size_t row = 0; row < n; row++) {
        const double *s = own + 6 * row, x = p[3 * row], y = p[3 * row + 1], z = p[3 * row + 2];
        sums[3 * row] = -(s[0] * x + s[1] * y + s[2] * z);
        sums[3 * row + 1] = -(s[1] * x + s[3] * y + s[4] * z);
        sums[3 * row + 2] = -(s[2] * x + s[4] * y + s[5] * z);
    }
}

/* obstacles do not move */
static void multiply_lot(void *arg, uint32_t number) {
    const struct job *job = arg;
    const struct cs_gather *gather = &job->product->active->gather;
    const struct cs_gather_lot *rows = gather->lots + number;
    const size_t blocks = blocks_of(job->product->active->lots + number);
    if (!blocks)
        return;
    const double *p = cs_gather_read(gather, number, 0, job->p, gather->n_particles);
    double *sums = cs_gather_of(rows, gather->sums, 3);
    take_own(cs_gather_of(rows, job->product->own, 6), p, rows->n, sums);
    for (size_t b = 0; b < blocks; b += TOGETHER)
        multiply_some(job, number, b, p, sums);
}

static void add_part(void *arg, size_t begin, size_t end) {
    const struct job *job = arg;
    const struct cs_gather *gather = &job->product->active->gather;
    cs_gather_add(gather, gather->sums, 3, begin, end, job->y);
}

void cs_product_add(const struct cs_product *product, const double *p, double *y) {
    struct job job = {product, p, y};
    // the room is there: rows were wider where the matrix was made
    if (!product->active->n || !cs_gather_take(&product->active->gather, 3))
        return;
    cs_pool_run(product->n_lots, multiply_lot, &job);
    cs_vector_share(product->active->gather.n_particles, add_part, &job);
}

/* Products pair by pair in lanes, and gathered by particles. */
#include "model/pair/product.h"

#include "base/pool.h"

#include <stdlib.h>
#include <string.h>

/* particles whose corners are gathered together */
enum { PARTICLES = 256 };

static void finish(void *object) {
    struct cs_product *product = object;
    for (uint32_t l = 0; l < product->set->n_lots; l++)
        free(product->lots[l].factors);
    free(product->products);
    free(product->places);
}

enum cs_status cs_product_init(struct cs_product *product, const struct cs_pair_set *set,
                               struct cs_arena *arena, struct cs_error *error) {
    *product = (struct cs_product){.set = set};
    product->lots = cs_arena_take_n(arena, set->n_lots, sizeof *product->lots, error);
    if (!error->status)
        cs_arena_own(arena, finish, product, error);
    return error->status;
}

static void put_lane(const struct cs_pair *pair, const struct cs_pair_part *part, size_t lane,
                     struct cs_pair_factors *to) {
    if (!lane)
        *to = (struct cs_pair_factors){0};
    for (int k = 0; k < 4; k++) {
        to->weight[k][lane] = part->share[k];
        for (int c = 0; c < 3; c++)
            to->g[k][c][lane] = pair->to[k][c];
    }
    to->along[lane] = part->along;
    memcpy(to->at[lane], pair->at, sizeof pair->at);
    for (int e = 0; e < 6; e++)
        to->of[e][lane] = part->of[e];
}

static void put_lot(void *arg, uint32_t number) {
    const struct cs_product *product = arg;
    const struct cs_pair_lot *from = product->set->lots + number;
    struct cs_product_lot *lot = product->lots + number;
    const size_t blocks = (from->n + CS_PAIR_LANES - 1) / CS_PAIR_LANES;
    struct cs_pair_factors *factors =
        cs_arena_grow(lot->factors, &lot->factors_room, blocks, sizeof *factors);
    lot->factors = factors ? factors : lot->factors;
    lot->failed = from->n && !factors;
    for (size_t p = 0; p < from->n && !lot->failed; p++)
        put_lane(from->pairs + p, from->parts + p, p % CS_PAIR_LANES,
                 factors + p / CS_PAIR_LANES);
}

static uint32_t pieces_of(const struct cs_pair_set *set) {
    return (set->n_particles + PARTICLES - 1) / PARTICLES;
}

/* of the particles of one piece, behind the last of them */
static size_t end_of(const struct cs_pair_set *set, size_t begin) {
    return set->n_particles - begin < PARTICLES ? set->n_particles : begin + PARTICLES;
}

static void place_ends(void *arg, uint32_t piece) {
    const struct cs_product *product = arg;
    const struct cs_pair_set *set = product->set;
    const size_t begin = (size_t)piece * PARTICLES;
    for (uint32_t e = set->starts[begin]; e < set->starts[end_of(set, begin)]; e++) {
        const struct cs_pair_end *at = set->ends + e;
        const size_t pair = (size_t)(at->pair - set->lots[at->lot].pairs);
        product->places[e] = (uint32_t)(4 * (set->lots[at->lot].first + pair) + at->corner);
    }
}

/* false: no memory */
static bool take_places(struct cs_product *product) {
    const size_t n = 4 * product->set->n;
    double(*products)[3] =
        cs_arena_grow(product->products, &product->products_room, n, sizeof *products);
    product->products = products ? products : product->products;
    uint32_t *places = cs_arena_grow(product->places, &product->places_room, n, sizeof *places);
    product->places = places ? places : product->places;
    return products && places;
}

bool cs_product_set(struct cs_product *product) {
    const struct cs_pair_set *set = product->set;
    if (!set->n)
        return true;
    if (!take_places(product))
        return false;
    cs_pool_run(set->n_lots, put_lot, product);
    bool failed = false;
    for (uint32_t l = 0; l < set->n_lots; l++)
        failed = failed || product->lots[l].failed;
    cs_pool_run(pieces_of(set), place_ends, product);
    return !failed;
}

struct job {
    const struct cs_product *product;
    const double *p;
    double *y;
};

/* blocks of eight that are multiplied together */
enum { TOGETHER = 8 };

typedef double vectors[4][3][CS_PAIR_LANES];

/* obstacles do not move */
static void read_lanes(const struct job *job, const struct cs_pair_factors *factors,
                       vectors p) {
    const size_t n = job->product->set->n_particles;
    for (size_t l = 0; l < CS_PAIR_LANES; l++)
        for (size_t k = 0; k < 4; k++)
            for (size_t c = 0; c < 3; c++)
                p[k][c][l] = factors->at[l][k] < n ? job->p[c * n + factors->at[l][k]] : 0;
}

static void write_lanes(vectors by, size_t count, double (*products)[3]) {
    for (size_t l = 0; l < count; l++)
        for (size_t k = 0; k < 4; k++)
            for (size_t c = 0; c < 3; c++)
                products[4 * l + k][c] = by[k][c][l];
}

/* step by step for several blocks: what was just written number by number is not at once read
 * as vectors */
static void multiply_lanes(const struct job *job, uint32_t number, size_t first) {
    const struct cs_pair_lot *from = job->product->set->lots + number;
    vectors by[TOGETHER];
    struct cs_pair_factors *factors = job->product->lots[number].factors + first;
    const size_t left = from->n - first * CS_PAIR_LANES;
    const size_t blocks =
        left > TOGETHER * CS_PAIR_LANES ? TOGETHER : (left + CS_PAIR_LANES - 1) / CS_PAIR_LANES;
    for (size_t b = 0; b < blocks; b++)
        read_lanes(job, factors + b, by[b]);
    for (size_t b = 0; b < blocks; b++)
        cs_pair_lanes_multiply(factors + b, by[b]);
    for (size_t b = 0; b < blocks; b++) {
        const size_t rest = left - b * CS_PAIR_LANES;
        const size_t pair = from->first + (first + b) * CS_PAIR_LANES;
        write_lanes(by[b], rest < CS_PAIR_LANES ? rest : CS_PAIR_LANES,
                    job->product->products + 4 * pair);
    }
}

static void multiply_lot(void *arg, uint32_t number) {
    const struct job *job = arg;
    const size_t n = job->product->set->lots[number].n;
    for (size_t b = 0; b * CS_PAIR_LANES < n; b += TOGETHER)
        multiply_lanes(job, number, b);
}

static void gather(void *arg, uint32_t piece) {
    const struct job *job = arg;
    const struct cs_product *product = job->product;
    const struct cs_pair_set *set = product->set;
    const size_t n = set->n_particles, begin = (size_t)piece * PARTICLES;
    const size_t end = end_of(set, begin);
    for (size_t i = begin; i < end; i++) {
        double sum[3] = {job->y[i], job->y[n + i], job->y[2 * n + i]};
        for (uint32_t e = set->starts[i]; e < set->starts[i + 1]; e++) {
            const double *by = product->products[product->places[e]];
            for (int c = 0; c < 3; c++)
                sum[c] += by[c];
        }
        for (size_t c = 0; c < 3; c++)
            job->y[c * n + i] = sum[c];
    }
}

void cs_product_add(const struct cs_product *product, const double *p, double *y) {
    struct job job = {product, p, y};
    if (!product->set->n)
        return;
    cs_pool_run(product->set->n_lots, multiply_lot, &job);
    cs_pool_run(pieces_of(product->set), gather, &job);
}

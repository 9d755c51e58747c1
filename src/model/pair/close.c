/* Candidates of a lot, measured in lanes. */
#include "model/pair/close.h"

#include "base/arena.h"
#include "base/pool.h"
#include "model/pair/lanes.h"
#include "model/pair/nearness.h"

#include <string.h>

/* eights that are measured together: what was just written number by number is not at once read
 * as vectors */
enum { TOGETHER = 4, WAITING = TOGETHER * CS_PAIR_LANES };

/* One lot at work. */
struct work {
    const struct cs_search *search;
    struct cs_search_lot *lot;
    struct cs_sieve sieve; /* first: most are held back there */
    struct cs_pair_lanes lanes[TOGETHER];
    uint32_t pairs[WAITING][2], waiting;
};

/* smooth distances of edges; of points and triangles the true ones, which facets in range are
 * not above */
static void measure_lanes(enum cs_stencil_kind kind, struct cs_pair_lanes *lanes) {
    struct cs_nearness_lanes near;
    if (kind == CS_STENCIL_EDGES) {
        cs_pair_lanes_measure(kind, lanes);
        return;
    }
    memcpy(near.p, lanes->p, sizeof near.p);
    cs_nearness_measure(kind, &near);
    for (int l = 0; l < CS_PAIR_LANES; l++)
        lanes->d[l] = sqrt(near.squared[l]);
}

static void measure(struct work *work) {
    struct cs_search_lot *lot = work->lot;
    for (uint32_t k = 0; k < work->waiting; k += CS_PAIR_LANES)
        measure_lanes(lot->kind, work->lanes + k / CS_PAIR_LANES);
    for (uint32_t k = 0; k < work->waiting; k++) {
        const struct cs_pair_lanes *lanes = work->lanes + k / CS_PAIR_LANES;
        const uint32_t l = k % CS_PAIR_LANES;
        // one that is out of range is written over
        memcpy(lot->close + 2 * lot->n_close, work->pairs[k], sizeof work->pairs[k]);
        lot->n_close += lanes->d[l] < lanes->range[l];
    }
    work->waiting = 0;
}

static void take(struct work *work, const uint32_t pair[2]) {
    const struct cs_search *search = work->search;
    const size_t n = search->system->surfaces->n_points;
    const uint32_t k = work->waiting++, l = k % CS_PAIR_LANES;
    struct cs_pair_lanes *lanes = work->lanes + k / CS_PAIR_LANES;
    uint32_t at[4];
    cs_search_corners(search->system->surfaces, work->lot->kind, pair, at);
    memcpy(work->pairs[k], pair, sizeof work->pairs[k]);
    lanes->range[l] = cs_search_range_of(search, work->lot->kind, at);
    for (size_t j = 0; j < 4; j++)
        for (size_t c = 0; c < 3; c++)
            lanes->p[j][c][l] = search->close_at[c * n + at[j]];
    if (work->waiting == WAITING)
        measure(work);
}

static void sift(struct work *work) {
    const uint32_t n = cs_sieve_run(&work->sieve, work->lot->kind == CS_STENCIL_EDGES);
    for (uint32_t l = 0; l < n; l++)
        take(work, work->sieve.pairs[l]);
}

static void put(struct work *work, const uint32_t pair[2]) {
    const struct cs_search *search = work->search;
    uint32_t at[4];
    cs_search_corners(search->system->surfaces, work->lot->kind, pair, at);
    const double reach = search->inverse * cs_search_range_of(search, work->lot->kind, at);
    if (cs_sieve_add(&work->sieve, search->rough, at, reach, pair))
        sift(work);
}

static void find_lot(void *arg, uint32_t number) {
    const struct cs_search *search = arg;
    struct cs_search_lot *lot = search->lots + number;
    struct work work;
    work.search = search;
    work.lot = lot;
    work.waiting = work.sieve.n = 0;
    uint32_t *close =
        cs_arena_grow(lot->close, &lot->close_room, lot->n, 2 * sizeof *lot->close);
    lot->n_close = 0;
    lot->failed = lot->n && !close;
    if (lot->failed)
        return;
    lot->close = close;
    for (size_t k = 0; k < lot->n; k++)
        put(&work, lot->pairs + 2 * k);
    sift(&work);
    measure(&work);
}

bool cs_close_find(struct cs_search *search, const double *x) {
    const size_t bytes = 3 * sizeof *x * search->system->surfaces->n_points;
    if (search->closed && !memcmp(search->close_at, x, bytes))
        return true;
    search->closed = false;
    if (!cs_search_update(search, x))
        return false;
    memcpy(search->close_at, x, bytes);
    if (search->n_listed)
        cs_search_round(search, x);
    cs_pool_run(search->n_lots, find_lot, search);
    bool failed = false;
    for (uint32_t l = 0; l < search->n_lots; l++)
        failed = failed || search->lots[l].failed;
    search->closed = !failed;
    search->found++;
    return !failed;
}

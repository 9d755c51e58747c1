/* Candidates of a lot, measured in lanes. */
#include "model/pair/close.h"

#include "base/arena.h"
#include "base/pool.h"
#include "model/pair/lanes.h"

#include <string.h>

/* One lot at work. */
struct work {
    const struct cs_search *search;
    struct cs_search_lot *lot;
    struct cs_pair_lanes lanes;
    uint32_t pairs[CS_PAIR_LANES][2];
};

static void measure(struct work *work) {
    struct cs_search_lot *lot = work->lot;
    struct cs_pair_lanes *lanes = &work->lanes;
    if (lanes->n)
        cs_pair_lanes_measure(lot->kind, lanes);
    for (uint32_t l = 0; l < lanes->n; l++)
        if (lanes->d[l] < lanes->range[l])
            memcpy(lot->close + 2 * lot->n_close++, work->pairs[l], sizeof work->pairs[l]);
    lanes->n = 0;
}

static void take(struct work *work, const uint32_t pair[2]) {
    const struct cs_search *search = work->search;
    const size_t n = search->system->surfaces->n_points;
    struct cs_pair_lanes *lanes = &work->lanes;
    const uint32_t l = lanes->n++;
    uint32_t at[4];
    cs_search_corners(search->system->surfaces, work->lot->kind, pair, at);
    memcpy(work->pairs[l], pair, sizeof work->pairs[l]);
    lanes->range[l] =
        cs_meeting_of(search->meetings, search->body[at[0]], search->body[at[2]])->range;
    for (size_t k = 0; k < 4; k++)
        for (size_t c = 0; c < 3; c++)
            lanes->p[k][c][l] = search->close_at[c * n + at[k]];
    if (lanes->n == CS_PAIR_LANES)
        measure(work);
}

static void find_lot(void *arg, uint32_t number) {
    const struct cs_search *search = arg;
    struct cs_search_lot *lot = search->lots + number;
    struct work work = {.search = search, .lot = lot};
    uint32_t *close =
        cs_arena_grow(lot->close, &lot->close_room, lot->n, 2 * sizeof *lot->close);
    lot->n_close = 0;
    lot->failed = lot->n && !close;
    if (lot->failed)
        return;
    lot->close = close;
    for (size_t k = 0; k < lot->n; k++)
        take(&work, lot->pairs + 2 * k);
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
    cs_pool_run(search->n_lots, find_lot, search);
    bool failed = false;
    for (uint32_t l = 0; l < search->n_lots; l++)
        failed = failed || search->lots[l].failed;
    search->closed = !failed;
    return !failed;
}

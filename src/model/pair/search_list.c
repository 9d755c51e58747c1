/* What was found of each item, lot by lot in the order of keys; places in single precision. */
#include "model/pair/search_list.h"

#include "base/pool.h"

#include <string.h>

/* pairs of the same first by their second: they are few */
static void sort_row(uint32_t *pairs, size_t n) {
    for (size_t i = 1; i < n; i++) {
        const uint32_t second = pairs[2 * i + 1];
        size_t j = i;
        for (; j > 0 && pairs[2 * j - 1] > second; j--)
            pairs[2 * j + 1] = pairs[2 * j - 1];
        pairs[2 * j + 1] = second;
    }
}

/* brings what was found into the order of keys */
static void list_lot(void *arg, uint32_t number) {
    const struct cs_search *search = arg;
    struct cs_search_lot *lot = search->lots + number;
    const struct cs_search_row *rows = search->rows[lot->kind];
    size_t n = 0;
    for (uint32_t i = lot->begin; i < lot->end; i++)
        n += rows[i].n;
    uint32_t *pairs = cs_arena_grow(lot->pairs, &lot->room, n, 2 * sizeof *pairs);
    lot->n = 0;
    lot->failed = n && !pairs;
    if (!n || !pairs)
        return;
    lot->pairs = pairs;
    for (uint32_t i = lot->begin; i < lot->end; i++) {
        if (!rows[i].n)
            continue;
        memcpy(pairs + 2 * lot->n,
               search->batches[rows[i].batch].pairs + 2 * (size_t)rows[i].begin,
               2 * rows[i].n * sizeof *pairs);
        sort_row(pairs + 2 * lot->n, rows[i].n);
        lot->n += rows[i].n;
    }
}

bool cs_search_list(struct cs_search *search) {
    bool failed = false;
    cs_pool_run(search->n_lots, list_lot, search);
    search->n_listed = 0;
    for (uint32_t l = 0; l < search->n_lots; l++) {
        failed = failed || search->lots[l].failed;
        search->n_listed += search->lots[l].n;
    }
    return !failed;
}

/* a search and the state that is rounded */
struct rounding {
    struct cs_search *search;
    const double *x;
};

/* points that are rounded together */
enum { ROUNDED = 2048 };

static void round_block(void *arg, uint32_t number) {
    const struct rounding *rounding = arg;
    const size_t n = rounding->search->system->surfaces->n_points;
    const size_t begin = (size_t)ROUNDED * number;
    cs_sieve_round(rounding->x, n, rounding->search->inverse, begin,
                   n - begin < ROUNDED ? n : begin + ROUNDED, rounding->search->rough);
}

void cs_search_round(struct cs_search *search, const double *x) {
    struct rounding rounding = {search, x};
    cs_pool_run((search->system->surfaces->n_points + ROUNDED - 1) / ROUNDED, round_block,
                &rounding);
}

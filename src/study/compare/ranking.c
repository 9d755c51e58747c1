#include "study/compare/ranking.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* below the bar nothing is known: an error counts as the bar there */
static double known_error(const struct cs_cell *cell, double bar) {
    return fmax(cell->error, bar);
}

static bool is_ranked(const struct cs_cell *cell) {
    return cs_cell_is_finished(cell) && isfinite(cell->error) && cell->cpu > 0;
}

static void mark_front(struct cs_ranking *ranking, const struct cs_cell *cells, uint32_t n,
                       double bar) {
    for (uint32_t k = 0; k < n; k++) {
        ranking->front[k] = is_ranked(cells + k);
        for (uint32_t i = 0; i < n && ranking->front[k]; i++)
            if (is_ranked(cells + i) && cells[i].cpu < cells[k].cpu &&
                known_error(cells + i, bar) <= known_error(cells + k, bar))
                ranking->front[k] = false;
    }
}

static bool is_cheaper(const struct cs_cell *cell, const struct cs_cell *than) {
    return !than || cell->cpu < than->cpu;
}

/* cheapest, and cheapest of another method, of the cells that pass */
static void choose(struct cs_rank *rank, const struct cs_compare *compare,
                   bool (*passes)(const struct cs_cell *, const struct cs_compare *, int)) {
    const struct cs_cell *cells = compare->sweep.cells;
    for (uint32_t k = 0; k < compare->sweep.n; k++)
        if (passes(cells + k, compare, rank->exponent) && is_cheaper(cells + k, rank->best))
            rank->best = cells + k;
    for (uint32_t k = 0; k < compare->sweep.n && rank->best; k++)
        if (passes(cells + k, compare, rank->exponent) && is_cheaper(cells + k, rank->next) &&
            strcmp(cells[k].method, rank->best->method) != 0)
            rank->next = cells + k;
    if (!rank->next)
        return;
    rank->factor = rank->next->cpu / rank->best->cpu;
    rank->low = rank->next->cpu_low / rank->best->cpu_high;
    rank->high = rank->next->cpu_high / rank->best->cpu_low;
}

static bool is_accurate(const struct cs_cell *cell, const struct cs_compare *compare,
                        int exponent) {
    return is_ranked(cell) &&
           known_error(cell, compare->yardstick.bar) <= pow(10, exponent) * (1 + 1e-9);
}

static bool is_at_frame_step(const struct cs_cell *cell, const struct cs_compare *compare,
                             int exponent) {
    (void)exponent;
    // events cut steps; more energy wrong than there ever is in the motion is no stability
    return cs_cell_is_finished(cell) && !cell->adaptive && !(cell->energy_error > 1) &&
           cell->steps <= compare->settings->course.frames + compare->cuts;
}

enum cs_status cs_ranking_make(struct cs_ranking *ranking, const struct cs_compare *compare,
                               struct cs_error *error) {
    const struct cs_yardstick *yardstick = &compare->yardstick;
    *ranking = (struct cs_ranking){0};
    ranking->front = calloc(compare->sweep.n + 1, sizeof *ranking->front);
    if (!ranking->front)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the ranking");
    choose(&ranking->frame, compare, is_at_frame_step);
    if (!yardstick->pointwise)
        return CS_OK;
    mark_front(ranking, compare->sweep.cells, compare->sweep.n, yardstick->bar);
    // an error as large as the motion says nothing
    for (int exponent = (int)floor(log10(0.1 * yardstick->scale));
         exponent > -16 && ranking->n < CS_RANKS_MAX; exponent--) {
        struct cs_rank rank = {.exponent = exponent};
        choose(&rank, compare, is_accurate);
        if (!rank.best)
            break;
        ranking->ranks[ranking->n++] = rank;
    }
    return CS_OK;
}

void cs_ranking_finish(struct cs_ranking *ranking) {
    free(ranking->front);
    *ranking = (struct cs_ranking){0};
}

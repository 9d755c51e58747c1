/* Finds the Pareto front and the ranks of cells. */
#include "study/compare/ranking.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Cells up to FAR times the cost of the best, by their first times, are contenders; the
 * runner-up is one up to FAR_NEXT times. Chosen by trial. */
#define FAR      1.5
#define FAR_NEXT 3

/* Criterion of a rank. */
struct choice {
    const struct cs_compare *compare;
    enum cs_norm norm;
    double bound; /* of the error */
};

/* A predicate on cells; a rank is the cheapest cell that passes. */
typedef bool passes(const struct cs_cell *cell, const struct choice *choice);

/* Times of another machine are not comparable. */
static bool is_timed_here(const struct cs_cell *cell, const struct choice *choice) {
    return cs_cell_is_finished(cell) && !strcmp(cell->machine, choice->compare->machine);
}

/* A cell with a cost and an error in the norm. */
static bool is_ranked(const struct cs_cell *cell, const struct choice *choice) {
    return is_timed_here(cell, choice) && cell->cpu > 0 &&
           isfinite(cs_norm_of(choice->norm, cell, &choice->compare->reference));
}

/* A cell with an error of at most the bound; rounding may exceed it by 1e-9. */
static bool is_accurate(const struct cs_cell *cell, const struct choice *choice) {
    return is_ranked(cell, choice) &&
           cs_norm_of(choice->norm, cell, &choice->compare->reference) <=
               choice->bound * (1 + 1e-9);
}

/* A cell with one step per frame: no more steps than frames, and those that end at events. */
static bool takes_frames(const struct cs_cell *cell, const struct choice *choice) {
    return is_timed_here(cell, choice) && !cell->adaptive &&
           cell->steps <=
               choice->compare->settings->run.frames + choice->compare->n_event_times;
}

/* A cell with one step per frame and a tolerable energy error. Where energies are not known,
 * any finished cell passes: NAN fails the comparison. */
static bool keeps_energy(const struct cs_cell *cell, const struct choice *choice) {
    return takes_frames(cell, choice) && !(cell->energy_error > CS_FRAME_ENERGY);
}

/* Marks the cells that no other one dominates, in O(n^2) for a few hundred cells. */
static void mark_front(struct cs_ranking *ranking, const struct choice *choice) {
    const struct cs_compare *compare = choice->compare;
    const struct cs_cell *cells = compare->cells.cells;
    for (uint32_t k = 0; k < compare->cells.n; k++) {
        const double error = cs_norm_of(choice->norm, cells + k, &compare->reference);
        ranking->on_pareto_front[k] = is_ranked(cells + k, choice);
        for (uint32_t i = 0; i < compare->cells.n && ranking->on_pareto_front[k]; i++)
            if (is_ranked(cells + i, choice) && cells[i].cpu < cells[k].cpu &&
                cs_norm_of(choice->norm, cells + i, &compare->reference) <= error)
                ranking->on_pareto_front[k] = false;
    }
}

static bool is_cheaper(const struct cs_cell *cell, const struct cs_cell *than) {
    return !than || cell->cpu < than->cpu;
}

/* Cost ratio of a cell to a base. Returns whether it differs from 1: by the interval of pairs
 * if there is one, else by a factor of CS_APART_UNPAIRED at least. */
static bool compare_costs(const struct cs_compare *compare, const struct cs_cell *cell,
                          const struct cs_cell *base, struct cs_ratio *ratio) {
    const struct cs_cell *cells = compare->cells.cells;
    *ratio = (struct cs_ratio){
        .median = cell->cpu / base->cpu, .low = (double)NAN, .high = (double)NAN};
    if (compare->rounds.n == 0 || !cs_rounds_ratio(&compare->rounds, (uint32_t)(cell - cells),
                                                   (uint32_t)(base - cells), ratio))
        return ratio->median >= CS_APART_UNPAIRED;
    return ratio->low > 1;
}

/* The cheapest cell that passes, of any series except that of `but` (NULL: of any). NULL: none.
 */
static const struct cs_cell *cheapest(const struct choice *choice, passes *pass,
                                      const struct cs_cell *but) {
    const struct cs_cell_list *sweep = &choice->compare->cells;
    const struct cs_cell *found = NULL;
    for (uint32_t k = 0; k < sweep->n; k++)
        if (pass(sweep->cells + k, choice) && is_cheaper(sweep->cells + k, found) &&
            !(but && cs_cell_same_series(sweep->cells + k, but)))
            found = sweep->cells + k;
    return found;
}

/* Marks the best, the cheapest cell of each series that is near it, and the runner-up. */
static void mark_contenders(struct cs_ranking *ranking, const struct cs_rank *rank,
                            const struct choice *choice, passes *pass) {
    const struct cs_cell_list *sweep = &choice->compare->cells;
    const struct cs_cell *least = NULL;
    for (uint32_t k = 0; k < sweep->n; k++) {
        const struct cs_cell *cell = sweep->cells + k;
        if (k > 0 && !cs_cell_same_series(cell, cell - 1))
            least = NULL;
        if (pass(cell, choice) && is_cheaper(cell, least))
            least = cell;
        const bool last = k + 1 == sweep->n || !cs_cell_same_series(cell, cell + 1);
        if (last && least && least->cpu <= FAR * rank->best->cpu)
            ranking->is_contender[least - sweep->cells] = true;
    }
    if (rank->runner_up && rank->runner_up->cpu <= FAR_NEXT * rank->best->cpu)
        ranking->is_contender[rank->runner_up - sweep->cells] = true;
}

/* The cheapest cell that passes, and the cheapest one of another series. */
static void find_best(struct cs_rank *rank, const struct choice *choice, passes *pass) {
    rank->best = cheapest(choice, pass, NULL);
    rank->runner_up = rank->best ? cheapest(choice, pass, rank->best) : NULL;
    if (rank->runner_up)
        rank->is_significant =
            compare_costs(choice->compare, rank->runner_up, rank->best, &rank->ratio);
}

static void choose(struct cs_ranking *ranking, struct cs_rank *rank,
                   const struct choice *choice, passes *pass) {
    find_best(rank, choice, pass);
    if (rank->best)
        mark_contenders(ranking, rank, choice, pass);
}

/* Finds for each other norm the cheapest cell that is no worse than the best and significantly
 * cheaper. It shows whether the winner depends on the choice of the norm. */
static void rank_by_other_norms(struct cs_rank *rank, const struct choice *choice) {
    const struct cs_compare *compare = choice->compare;
    for (enum cs_norm norm = 0; norm < CS_NORMS; norm++) {
        struct choice by = {compare, norm, 0};
        struct cs_ratio ratio;
        if (norm == choice->norm || !cs_norm_is_known(norm, &compare->reference) ||
            !is_ranked(rank->best, &by))
            continue;
        by.bound = cs_norm_of(norm, rank->best, &compare->reference);
        const struct cs_cell *found = cheapest(&by, is_accurate, rank->best);
        if (found && found->cpu < rank->best->cpu &&
            compare_costs(compare, rank->best, found, &ratio))
            rank->better_by_norm[norm] = found;
    }
}

/* Largest decade in which an error is meaningful: a tenth of the motion, or the largest error
 * if the norm has no scale. An error as large as the motion means nothing. */
static int first_exponent(const struct choice *choice) {
    const struct cs_compare *compare = choice->compare;
    double most = 0;
    for (uint32_t k = 0; k < compare->cells.n; k++)
        if (is_ranked(compare->cells.cells + k, choice))
            most = fmax(
                most, cs_norm_of(choice->norm, compare->cells.cells + k, &compare->reference));
    // one as large as the motion says nothing
    const double scale = cs_norm_scale(choice->norm, &compare->reference);
    return (int)floor(log10(fmax(isfinite(scale) ? 0.1 * scale : most, 1e-300)) + 1e-9);
}

/* One rank per decade, down to the first one that no cell reaches. */
static void make_ranks(struct cs_ranking *ranking, struct choice *choice) {
    for (int exponent = first_exponent(choice); exponent > -16 && ranking->n < CS_RANKS_MAX;
         exponent--) {
        struct cs_rank rank = {.exponent = exponent};
        choice->bound = pow(10, exponent);
        choose(ranking, &rank, choice, is_accurate);
        if (!rank.best)
            break;
        rank_by_other_norms(&rank, choice);
        ranking->ranks[ranking->n++] = rank;
    }
}

/* Rank of the cells with one step per frame, and how many were tried and finished. */
static void make_frame(struct cs_ranking *ranking, const struct choice *choice) {
    const struct cs_compare *compare = choice->compare;
    for (uint32_t k = 0; k < compare->cells.n; k++) {
        const struct cs_cell *cell = compare->cells.cells + k;
        const bool through = takes_frames(cell, choice);
        ranking->frame_finished += through;
        ranking->frame_tried +=
            through || (!strcmp(cell->control, "dt") && cell->value * compare->fps >= 1 - 1e-9);
        if (through && (!ranking->frame_nearest ||
                        cell->energy_error < ranking->frame_nearest->energy_error))
            ranking->frame_nearest = cell;
    }
    choose(ranking, &ranking->frame, choice, keeps_energy);
}

enum cs_status cs_ranking_make(struct cs_ranking *ranking, const struct cs_compare *compare,
                               struct cs_error *error) {
    struct choice choice = {.compare = compare, .norm = compare->settings->ranking_norm};
    *ranking = (struct cs_ranking){.norm = choice.norm};
    ranking->on_pareto_front = calloc(compare->cells.n + 1, sizeof *ranking->on_pareto_front);
    ranking->is_contender = calloc(compare->cells.n + 1, sizeof *ranking->is_contender);
    if (!ranking->on_pareto_front || !ranking->is_contender) {
        cs_ranking_finish(ranking);
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the ranking");
    }
    make_frame(ranking, &choice);
    if (cs_norm_is_known(choice.norm, &compare->reference)) {
        mark_front(ranking, &choice);
        make_ranks(ranking, &choice);
    }
    return CS_OK;
}

void cs_ranking_at(const struct cs_compare *compare, double bound, struct cs_rank *rank) {
    const struct choice choice = {compare, compare->settings->ranking_norm, bound};
    *rank = (struct cs_rank){.exponent = (int)floor(log10(bound))};
    find_best(rank, &choice, is_accurate);
}

void cs_ranking_finish(struct cs_ranking *ranking) {
    free(ranking->on_pareto_front);
    free(ranking->is_contender);
    *ranking = (struct cs_ranking){0};
}

/* True if more rounds would not change the statement on this rank. */
static bool is_narrow(const struct cs_rank *rank, double share) {
    const struct cs_ratio *ratio = &rank->ratio;
    if (!rank->runner_up || ratio->median > FAR_NEXT)
        return true;
    return ratio->pairs > 0 && ratio->pair_uncertainty <= share;
}

bool cs_ranking_is_narrow(const struct cs_ranking *ranking, double share) {
    bool narrow = is_narrow(&ranking->frame, share);
    for (uint32_t k = 0; k < ranking->n; k++)
        narrow &= is_narrow(ranking->ranks + k, share);
    return narrow;
}

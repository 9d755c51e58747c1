/* Finds the Pareto front and the ranks of cells. */
#include "study/compare/equal_error.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Cells up to FAR times the cost of the best are contenders, in the first round FAR_NEXT times,
 * and the runner-up up to FAR_NEXT times, by work too: a single time may be far off. Chosen by
 * trial. */
#define FAR      1.5
#define FAR_NEXT 3

/* A cell with one step per frame: no more steps than frames, and those that end at events. */
static bool takes_frames(const struct cs_cell *cell, const struct cs_choice *choice) {
    return cs_choice_is_timed(cell, choice) && !cell->adaptive &&
           cell->steps <=
               choice->compare->settings->run.frames + choice->compare->n_event_times;
}

/* A cell with one step per frame and a tolerable energy error. Where energies are not known,
 * any finished cell passes: NAN fails the comparison. */
static bool keeps_energy(const struct cs_cell *cell, const struct cs_choice *choice) {
    return takes_frames(cell, choice) && !(cell->energy_error > CS_FRAME_ENERGY);
}

/* Marks the cells that no other one dominates, in O(n^2) for a few hundred cells. errors (n):
 * scratch, NAN for a cell without a rank. */
static void mark_front(struct cs_ranking *ranking, const struct cs_choice *choice,
                       double *errors) {
    const struct cs_compare *compare = choice->compare;
    const struct cs_cell *cells = compare->cells.cells;
    for (uint32_t k = 0; k < compare->cells.n; k++)
        errors[k] = cs_choice_is_ranked(cells + k, choice) ? cs_choice_error(cells + k, choice)
                                                           : (double)NAN;
    for (uint32_t k = 0; k < compare->cells.n; k++) {
        const double cost = cs_choice_cost(cells + k, choice);
        ranking->on_pareto_front[k] = !isnan(errors[k]);
        for (uint32_t i = 0; i < compare->cells.n && ranking->on_pareto_front[k]; i++)
            if (errors[i] <= errors[k] && cs_choice_cost(cells + i, choice) < cost)
                ranking->on_pareto_front[k] = false;
    }
}

/* Cost ratio of a cell to a base. Returns whether it differs from 1: by the interval of pairs
 * if there is one, else by a factor of CS_APART_UNPAIRED at least; work is exact. */
static bool compare_costs(const struct cs_compare *compare, const struct cs_cell *cell,
                          const struct cs_cell *base, struct cs_ratio *ratio) {
    const struct cs_cell *cells = compare->cells.cells;
    const double work = cell->work / base->work;
    *ratio = (struct cs_ratio){
        .median = cell->cpu / base->cpu, .low = (double)NAN, .high = (double)NAN};
    if (compare->by_work)
        *ratio = (struct cs_ratio){.median = work, .low = work, .high = work};
    else if (compare->rounds.n == 0 ||
             !cs_rounds_ratio(&compare->rounds, (uint32_t)(cell - cells),
                              (uint32_t)(base - cells), ratio))
        return ratio->median >= CS_APART_UNPAIRED;
    return ratio->low > 1;
}

/* The series that passes at the least cost, of all except that of `but` (NULL: of all). */
static void find_cheapest(const struct cs_choice *choice, cs_choice_passes *pass,
                          const struct cs_cell *but, struct cs_standing *found) {
    const struct cs_cell_list *list = &choice->compare->cells;
    *found = (struct cs_standing){0};
    for (uint32_t first = 0, end; first < list->n; first = end) {
        struct cs_standing standing;
        end = cs_choice_series_end(choice, first);
        if (but && cs_cell_same_series(list->cells + first, but))
            continue;
        cs_standing_find(choice, pass, first, end, &standing);
        if (standing.cell && (!found->cell || cs_choice_cost(standing.cell, choice) <
                                                  cs_choice_cost(found->cell, choice)))
            *found = standing;
    }
}

/* Marks the cell of each series that is near the best, and the runner-up. */
static void mark_contenders(struct cs_ranking *ranking, const struct cs_rank *rank,
                            const struct cs_choice *choice, cs_choice_passes *pass) {
    const struct cs_cell_list *list = &choice->compare->cells;
    const double far = choice->compare->rounds.n > 0 ? FAR : FAR_NEXT;
    for (uint32_t first = 0, end; first < list->n; first = end) {
        struct cs_standing standing;
        end = cs_choice_series_end(choice, first);
        cs_standing_find(choice, pass, first, end, &standing);
        if (standing.cell &&
            cs_choice_cost(standing.cell, choice) <= far * cs_choice_cost(rank->best, choice))
            ranking->is_contender[standing.cell - list->cells] = true;
    }
    if (rank->runner_up->cpu <= FAR_NEXT * rank->best->cpu ||
        rank->runner_up->work <= FAR_NEXT * rank->best->work)
        ranking->is_contender[rank->runner_up - list->cells] = true;
}

/* Finds the cheapest series that passes, the next one, and their factor. The interval of pairs
 * is widened on the side to which each cell could still move. */
static void find_best(struct cs_rank *rank, const struct cs_choice *choice,
                      cs_choice_passes *pass) {
    struct cs_choice by_work = *choice;
    struct cs_standing frugal;
    find_cheapest(choice, pass, NULL, rank->of);
    rank->best = rank->of[0].cell;
    rank->by_work = choice->by_work;
    if (!rank->best)
        return;
    // the least work is named beside the least time
    by_work.by_work = true;
    find_cheapest(&by_work, pass, NULL, &frugal);
    rank->frugal = frugal.relation == CS_BOUND_BELOW ? rank->best : frugal.cell;
    find_cheapest(choice, pass, rank->best, rank->of + 1);
    rank->runner_up = rank->of[1].cell;
    rank->has_factor = rank->runner_up && rank->of[0].relation != CS_BOUND_BELOW &&
                       rank->of[1].relation != CS_BOUND_BELOW;
    if (!rank->has_factor)
        return;
    rank->is_significant =
        compare_costs(choice->compare, rank->runner_up, rank->best, &rank->ratio);
    const double below = exp(-rank->of[1].left - rank->of[0].luck),
                 above = exp(rank->of[0].left + rank->of[1].luck),
                 work = rank->runner_up->work / rank->best->work;
    rank->ratio.low *= below;
    rank->ratio.high *= above;
    rank->is_significant &= !(rank->ratio.low <= 1);
    rank->work = (struct cs_ratio){.median = work, .low = work * below, .high = work * above};
}

static void choose(struct cs_ranking *ranking, struct cs_rank *rank,
                   const struct cs_choice *choice, cs_choice_passes *pass) {
    find_best(rank, choice, pass);
    /* a series alone has no factor that times could change */
    if (rank->runner_up)
        mark_contenders(ranking, rank, choice, pass);
}

/* Finds for each other norm the cheapest cell that is no worse than the best and significantly
 * cheaper. It shows whether the winner depends on the choice of the norm. */
static void rank_by_other_norms(struct cs_rank *rank, const struct cs_choice *choice) {
    const struct cs_compare *compare = choice->compare;
    for (enum cs_norm norm = 0; norm < CS_NORMS; norm++) {
        struct cs_choice by = {.compare = compare, .norm = norm, .by_work = compare->by_work};
        struct cs_ratio ratio;
        if (norm == choice->norm || !cs_norm_is_known(norm, &compare->reference) ||
            !cs_choice_is_ranked(rank->best, &by))
            continue;
        by.bound = cs_choice_error(rank->best, &by);
        struct cs_standing found;
        find_cheapest(&by, cs_choice_is_met, rank->best, &found);
        if (found.cell && cs_choice_cost(found.cell, &by) < cs_choice_cost(rank->best, &by) &&
            compare_costs(compare, rank->best, found.cell, &ratio))
            rank->better_by_norm[norm] = found.cell;
    }
}

/* One rank per decade, down to the first one that no cell reaches. */
static void make_ranks(struct cs_ranking *ranking, struct cs_choice *choice) {
    int exponent = 0;
    for (uint32_t n = 0; cs_choice_next_bound(choice, &exponent, &n);) {
        struct cs_rank rank = {.exponent = exponent};
        choose(ranking, &rank, choice, cs_choice_is_met);
        if (!rank.best)
            break;
        rank_by_other_norms(&rank, choice);
        ranking->ranks[ranking->n++] = rank;
    }
}

/* Rank of the cells with one step per frame, and how many were tried and finished. */
static void make_frame(struct cs_ranking *ranking, const struct cs_choice *choice) {
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
    struct cs_choice choice = {.compare = compare,
                               .norm = compare->settings->ranking_norm,
                               .by_work = compare->by_work};
    *ranking = (struct cs_ranking){.norm = choice.norm};
    ranking->on_pareto_front = calloc(compare->cells.n + 1, sizeof *ranking->on_pareto_front);
    ranking->is_contender = calloc(compare->cells.n + 1, sizeof *ranking->is_contender);
    double *errors = calloc(compare->cells.n + 1, sizeof *errors);
    if (!ranking->on_pareto_front || !ranking->is_contender || !errors) {
        cs_ranking_finish(ranking);
        free(errors);
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the ranking");
    }
    make_frame(ranking, &choice);
    if (cs_norm_is_known(choice.norm, &compare->reference)) {
        mark_front(ranking, &choice, errors);
        make_ranks(ranking, &choice);
    }
    free(errors);
    return CS_OK;
}

void cs_ranking_at(const struct cs_compare *compare, double bound, struct cs_rank *rank) {
    const struct cs_choice choice = {.compare = compare,
                                     .norm = compare->settings->ranking_norm,
                                     .bound = bound,
                                     .by_work = compare->by_work};
    *rank = (struct cs_rank){.exponent = (int)floor(log10(bound))};
    find_best(rank, &choice, cs_choice_is_met);
}

void cs_ranking_finish(struct cs_ranking *ranking) {
    free(ranking->on_pareto_front);
    free(ranking->is_contender);
    *ranking = (struct cs_ranking){0};
}

/* True if more rounds would not change the statement on this rank. */
static bool is_narrow(const struct cs_rank *rank, double share) {
    const struct cs_ratio *ratio = &rank->ratio;
    if (!rank->has_factor || rank->by_work || ratio->median > FAR_NEXT)
        return true;
    return ratio->pairs > 0 && ratio->pair_uncertainty <= share;
}

bool cs_ranking_is_narrow(const struct cs_ranking *ranking, double share) {
    bool narrow = is_narrow(&ranking->frame, share);
    for (uint32_t k = 0; k < ranking->n; k++)
        narrow &= is_narrow(ranking->ranks + k, share);
    return narrow;
}

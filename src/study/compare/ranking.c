/* Finds the Pareto front and ranks of cells, and prints verdict and warnings in words. */
#include "study/compare/ranking.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

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
            !cs_cell_same_series(cells + k, rank->best))
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
           known_error(cell, compare->reference.bar) <= pow(10, exponent) * (1 + 1e-9);
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
    const struct cs_compare_reference *reference = &compare->reference;
    *ranking = (struct cs_ranking){0};
    ranking->front = calloc(compare->sweep.n + 1, sizeof *ranking->front);
    if (!ranking->front)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the ranking");
    choose(&ranking->frame, compare, is_at_frame_step);
    if (!reference->pointwise)
        return CS_OK;
    mark_front(ranking, compare->sweep.cells, compare->sweep.n, reference->bar);
    // an error as large as the motion says nothing
    for (int exponent = (int)floor(log10(0.1 * reference->scale));
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

/* "rk4 (dt 1.04 ms), 3.21 ms" */
static void add_cell(const struct cs_cell *cell, struct cs_text *out) {
    if (!strcmp(cell->control, "dt"))
        cs_text_add(out, "%s (dt %.3g ms)", cell->series, 1e3 * cell->step);
    else
        cs_text_add(out, "%s (%s %.1e)", cell->series, cell->control, cell->value);
}

static void add_factor(const struct cs_rank *rank, struct cs_text *out) {
    if (!rank->next) {
        cs_text_add(out, "; no other method gets there\n");
        return;
    }
    if (rank->low > 1)
        cs_text_add(out, "; %.2f times (%.2f to %.2f) cheaper than ", rank->factor, rank->low,
                    rank->high);
    else
        cs_text_add(out, "; not told apart from ");
    add_cell(rank->next, out);
    cs_text_add(out, "\n");
}

void cs_ranking_print(const struct cs_ranking *ranking, const char *bullet,
                      const struct cs_compare *compare, struct cs_text *out) {
    for (uint32_t k = 0, last; k < ranking->n; k = last + 1) {
        const struct cs_rank *rank = ranking->ranks + k;
        // what the next decades share is said once
        for (last = k; last + 1 < ranking->n && rank[last + 1 - k].best == rank->best &&
                       rank[last + 1 - k].next == rank->next;)
            last++;
        cs_text_add(out, "%serror below 1e%03d", bullet, rank->exponent);
        if (last > k)
            cs_text_add(out, " down to 1e%03d", ranking->ranks[last].exponent);
        cs_text_add(out, " m: ");
        add_cell(rank->best, out);
        cs_text_add(out, ", %.3g ms", 1e3 * rank->best->cpu);
        add_factor(rank, out);
    }
    const struct cs_rank *frame = &ranking->frame;
    if (!frame->best) {
        cs_text_add(out, "%sno method gets through with one step a frame\n", bullet);
        return;
    }
    cs_text_add(out, "%sstable with one step a frame (%.3g ms): %s, %.3g ms", bullet,
                1e3 / compare->fps, frame->best->series, 1e3 * frame->best->cpu);
    if (isfinite(frame->best->energy_error))
        cs_text_add(out, ", with an energy error of %.0f %%", 100 * frame->best->energy_error);
    add_factor(frame, out);
}

struct tally {
    uint32_t brief, unquiet, spread, over, failed, blown, below;
};

static struct tally count(const struct cs_compare *compare) {
    struct tally tally = {0};
    for (uint32_t k = 0; k < compare->sweep.n; k++) {
        const struct cs_cell *cell = compare->sweep.cells + k;
        if (cs_cell_is_finished(cell)) {
            tally.brief += cell->cpu < 5e-3;
            tally.unquiet += cell->outliers > 0.2 * cell->runs;
            tally.spread += cell->cpu_high - cell->cpu_low > 0.1 * cell->cpu;
            tally.below += cell->error < compare->reference.bar;
        }
        tally.over += !strcmp(cell->outcome, cs_outcome_text(CS_OVER_BUDGET));
        tally.failed += !strcmp(cell->outcome, "failed");
        tally.blown += !strncmp(cell->outcome, "blew up", 7);
    }
    return tally;
}

static void add(struct cs_text *out, const char *bullet, uint32_t n, const char *what,
                const char *advice) {
    if (n > 0)
        cs_text_add(out, "%s%u cell%s %s%s\n", bullet, n, n == 1 ? "" : "s", what, advice);
}

void cs_compare_warn(const struct cs_compare *compare, const char *bullet,
                     struct cs_text *out) {
    const struct tally tally = count(compare);
    const long processors = sysconf(_SC_NPROCESSORS_ONLN);
    double load = 0;
    if (!compare->reference.pointwise)
        cs_text_add(out, "%sno errors of position: %s%s\n", bullet, compare->reference.reason,
                    compare->reference.agree ? " (a shorter --time, or a larger --accuracy)"
                                             : "");
    if (cs_text_get(&compare->changes)[0])
        cs_text_add(out, "%s%s switched off: no part of the equation of motion\n", bullet,
                    cs_text_get(&compare->changes));
    /* one line for all cells of a kind, however many there are */
    add(out, bullet, tally.below, "below the reference's own error",
        ": not drawn, and ranked as if at it");
    add(out, bullet, tally.blown, "blew up", ": the step is beyond the stable one");
    add(out, bullet, tally.over, "over budget",
        ": stopped (a larger --budget lets them finish)");
    add(out, bullet, tally.failed, "failed", ": the notes in compare.csv say why");
    add(out, bullet, tally.brief, "ran for less than 5 ms",
        ": trust the counts rather than the times, or take a longer --time");
    add(out, bullet, tally.spread, "with quartiles further apart than 10 %",
        ": close other programs, or take more --runs");
    add(out, bullet, tally.unquiet, "with outliers in more than a fifth of the runs",
        ": something else used the processor now and then");
    if (getloadavg(&load, 1) == 1 && load > 0.75 * (double)processors)
        cs_text_add(out,
                    "%sthe machine is busy (load %.1f on %ld processors): factors near 1 "
                    "mean nothing\n",
                    bullet, load, processors);
}

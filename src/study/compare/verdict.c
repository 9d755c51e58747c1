/* Prints the verdict and the warnings of a comparison in words. */
#include "study/compare/equal_error.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* "rk4 (dt 1.04 ms)" */
static void add_cell(const struct cs_cell *cell, struct cs_text *out) {
    if (!strcmp(cell->control, "dt"))
        cs_text_add(out, "%s (dt %.3g ms)", cell->series, 1e3 * cell->step);
    else if (*cell->control)
        cs_text_add(out, "%s (%s %.1e)", cell->series, cell->control, cell->value);
    else
        cs_text_add(out, "%s", cell->series);
}

void cs_verdict_add_cost(const struct cs_cell *cell, bool by_work, struct cs_text *out) {
    if (!by_work)
        cs_text_add(out, ", %.3g ms", 1e3 * cell->cpu);
    if (isfinite(cell->work))
        cs_text_add(out, ", work %.0f", cell->work);
}

void cs_verdict_add_factor(const struct cs_rank *rank, const char *none, struct cs_text *out) {
    const struct cs_ratio *ratio = &rank->ratio;
    if (!rank->runner_up) {
        cs_text_add(out, "; %s\n", none);
        return;
    }
    if (!rank->has_factor) {
        const bool best = rank->of[0].relation == CS_BOUND_BELOW;
        cs_text_add(out, "; no factor: not run to that error, only below it: ");
        add_cell(best ? rank->best : rank->runner_up, out);
        cs_text_add(out, "\n");
        return;
    }
    if (rank->by_work)
        cs_text_add(out, "; %.2f times less work than ", rank->work.median);
    else if (!rank->is_significant)
        cs_text_add(out, "; not significantly different from ");
    else if (ratio->pairs > 0)
        cs_text_add(out, "; %.2f times (%.2f to %.2f) cheaper than ", ratio->median, ratio->low,
                    ratio->high);
    else
        cs_text_add(out, "; about %.1f times cheaper than ", ratio->median);
    add_cell(rank->runner_up, out);
    if (rank->best->work > 0 && !rank->by_work)
        cs_text_add(out, ", by work %.2f", rank->work.median);
    cs_text_add(out, "\n");
}

/* Less work than this fraction of the best's is told. */
#define FRUGAL 0.98

/* Names the method with less work than the best, if there is one: where a force costs more than
 * all else, it is the cheapest. */
static void add_frugal(const struct cs_rank *rank, const char *bullet, struct cs_text *out) {
    if (!rank->frugal || rank->of[0].relation == CS_BOUND_BELOW ||
        !(rank->frugal->work < FRUGAL * rank->best->work))
        return;
    cs_text_add(out, "%s  least work: ", bullet);
    add_cell(rank->frugal, out);
    cs_text_add(out, ", %.2f of it in %.3g ms\n", rank->frugal->work / rank->best->work,
                1e3 * rank->frugal->cpu);
}

/* Names the winners by other norms; a cell that wins by several is named once. */
static void add_others(const struct cs_rank *rank, const char *bullet, struct cs_text *out) {
    for (enum cs_norm norm = 0; norm < CS_NORMS; norm++) {
        const struct cs_cell *other = rank->better_by_norm[norm];
        bool said = false;
        for (enum cs_norm before = 0; before < norm; before++)
            said |= rank->better_by_norm[before] == other;
        if (!other || said)
            continue;
        cs_text_add(out, "%s  no worse by ", bullet);
        for (enum cs_norm also = norm; also < CS_NORMS; also++)
            if (rank->better_by_norm[also] == other)
                cs_text_add(out, "%s%s", also > norm ? ", " : "", cs_norm_words(also));
        cs_text_add(out, ", and cheaper: ");
        add_cell(other, out);
        cs_text_add(out, rank->by_work ? ", work %.0f\n" : ", %.3g ms\n",
                    rank->by_work ? other->work : 1e3 * other->cpu);
    }
}

/* One line for a range of decades with the same winner and runner-up. */
static void add_rank(const struct cs_ranking *ranking, const struct cs_rank *rank, int last,
                     const char *bullet, struct cs_text *out) {
    const char *unit = cs_norm_unit(ranking->norm);
    cs_text_add(out, "%s%s below 1e%03d", bullet, cs_norm_words(ranking->norm), rank->exponent);
    if (last < rank->exponent)
        cs_text_add(out, " down to 1e%03d", last);
    cs_text_add(out, "%s%s: ", *unit ? " " : "", unit);
    add_cell(rank->best, out);
    if (rank->of[0].relation == CS_BOUND_LIMIT)
        cs_text_add(out, " at its limit");
    cs_verdict_add_cost(rank->best, rank->by_work, out);
    cs_verdict_add_factor(rank, "no other series was run to that error", out);
    add_frugal(rank, bullet, out);
    add_others(rank, bullet, out);
}

/* Result at one step per frame. Finishing alone is not praised: the energy error must be small.
 */
static void add_frame(const struct cs_ranking *ranking, const char *bullet,
                      const struct cs_compare *compare, struct cs_text *out) {
    const struct cs_cell *best = ranking->frame.best, *nearest = ranking->frame_nearest;
    cs_text_add(out, "%sone step per frame (%.3g ms): ", bullet, 1e3 / compare->fps);
    if (ranking->frame_tried == 0)
        cs_text_add(out, "no row has that step\n");
    else if (ranking->frame_finished == 0)
        cs_text_add(out, "none of the %u row%s with that step finished\n", ranking->frame_tried,
                    ranking->frame_tried == 1 ? "" : "s");
    else if (!best) {
        cs_text_add(out,
                    "%u of %u rows finished, none with an energy error of %.0f %% or less; the "
                    "smallest is %.0f %%, of ",
                    ranking->frame_finished, ranking->frame_tried, 100 * CS_FRAME_ENERGY,
                    100 * nearest->energy_error);
        add_cell(nearest, out);
        cs_text_add(out, "\n");
    } else {
        add_cell(best, out);
        cs_verdict_add_cost(best, compare->by_work, out);
        if (isfinite(best->error))
            cs_text_add(out, ", error %.1e m", best->error);
        if (isfinite(best->energy_error))
            cs_text_add(out, ", energy error %.2g %%", 100 * best->energy_error);
        else
            cs_text_add(out, ", energy error not known");
        cs_verdict_add_factor(&ranking->frame, "no other series is known to do as well", out);
    }
}

void cs_verdict_print(const struct cs_ranking *ranking, const char *bullet,
                      const struct cs_compare *compare, struct cs_text *out) {
    for (uint32_t k = 0, last; k < ranking->n; k = last + 1) {
        const struct cs_rank *rank = ranking->ranks + k;
        // what the next decades share is said once
        for (last = k; last + 1 < ranking->n && rank[last + 1 - k].best == rank->best &&
                       rank[last + 1 - k].runner_up == rank->runner_up &&
                       rank[last + 1 - k].has_factor == rank->has_factor;)
            last++;
        add_rank(ranking, rank, ranking->ranks[last].exponent, bullet, out);
    }
    add_frame(ranking, bullet, compare, out);
}

enum cs_status cs_verdict_print_preliminary(const struct cs_compare *compare,
                                            struct cs_text *out, struct cs_error *error) {
    struct cs_ranking ranking;
    double work = 0;
    for (uint32_t k = 0; k < compare->cells.n; k++)
        work += fmax(compare->cells.cells[k].work, 0);
    if (work * compare->pass_seconds < CS_COMPARE_LONG_SECONDS ||
        cs_ranking_make(&ranking, compare, error))
        return error->status;
    cs_text_add(out, "before rounds of timing:\n");
    cs_verdict_print(&ranking, "  ", compare, out);
    cs_ranking_finish(&ranking);
    return CS_OK;
}

/* Names the first failed cells, with their notes. */
static void add_failed(const struct cs_compare *compare, const char *bullet,
                       struct cs_text *out) {
    char integrator[CS_CELL_INTEGRATOR];
    uint32_t shown = 0;
    for (uint32_t k = 0; k < compare->cells.n && shown < 3; k++) {
        const struct cs_cell *cell = compare->cells.cells + k;
        if (!cs_cell_has_failed(cell))
            continue;
        cs_cell_integrator(cell, integrator, sizeof integrator);
        cs_text_add(out, "%s%s: %s\n", bullet, integrator, cell->note);
        shown++;
    }
}

/* Number of cells per kind of warning. */
struct tally {
    uint32_t brief, unquiet, spread, over, failed, blown, below;
};

/* Counts the cells of each kind. Thresholds: 5 ms of processor time, a fifth of outliers,
 * quartiles 10 % apart; chosen by trial. */
static struct tally count(const struct cs_compare *compare) {
    struct tally stats = {0};
    for (uint32_t k = 0; k < compare->cells.n; k++) {
        const struct cs_cell *cell = compare->cells.cells + k;
        if (cs_cell_is_finished(cell)) {
            stats.brief += cell->cpu < 5e-3;
            stats.unquiet += cell->runs > 4 && cell->outliers > 0.2 * cell->runs;
            stats.spread += cell->cpu_high - cell->cpu_low > 0.1 * cell->cpu;
            stats.below += cell->error < compare->reference.error_bar;
        }
        stats.over += !strcmp(cell->outcome, cs_outcome_text(CS_OVER_BUDGET));
        stats.failed += cs_cell_has_failed(cell);
        stats.blown += !strncmp(cell->outcome, "blew up", 7);
    }
    return stats;
}

static void add_bullet(struct cs_text *out, const char *bullet, uint32_t n, const char *what,
                       const char *advice) {
    if (n > 0)
        cs_text_add(out, "%s%u cell%s %s%s\n", bullet, n, n == 1 ? "" : "s", what, advice);
}

void cs_compare_warn(const struct cs_compare *compare, const char *bullet,
                     struct cs_text *out) {
    const struct tally stats = count(compare);
    const long processors = sysconf(_SC_NPROCESSORS_ONLN);
    double load = 0;
    if (!compare->reference.pointwise)
        cs_text_add(out, "%sno errors of position: %s%s\n", bullet, compare->reference.reason,
                    compare->reference.families_agree
                        ? " (a shorter --time, or a larger --accuracy)"
                        : "");
    if (cs_text_get(&compare->switched_off)[0])
        cs_text_add(out, "%s%s switched off: not part of the equation of motion\n", bullet,
                    cs_text_get(&compare->switched_off));
    if (compare->by_work)
        cs_text_add(out, "%sranked by work: times of programs are not comparable\n", bullet);
    /* one line for all cells of a kind, however many there are */
    add_bullet(out, bullet, stats.below, "below the reference's own error",
               ": not drawn, and ranked as if at it");
    add_bullet(out, bullet, stats.blown, "blew up", ": the step is beyond the stable one");
    add_bullet(out, bullet, stats.over, "over budget",
               ": their series end there (a larger --budget lets them go on)");
    add_bullet(out, bullet, stats.failed, "failed or gave up",
               ": the notes in compare.csv say why");
    add_failed(compare, bullet, out);
    add_bullet(out, bullet, stats.brief, "ran for less than 5 ms",
               ": trust the counts rather than the times, or take a longer --time");
    add_bullet(out, bullet, stats.spread, "with quartiles further apart than 10 %",
               ": close other programs, or take more --runs");
    add_bullet(out, bullet, stats.unquiet, "with outliers in more than a fifth of the runs",
               ": something else used the processor now and then");
    if (*compare->undrawn)
        cs_text_add(out, "%sno diagrams: %s\n", bullet, compare->undrawn);
    if (getloadavg(&load, 1) == 1 && load > 0.75 * (double)processors)
        cs_text_add(out,
                    "%sthe machine is busy (load %.1f on %ld processors): factors near 1 are "
                    "not significant\n",
                    bullet, load, processors);
}

/* Brings methods to equal errors: where each stands at a bound, and which cell to run next. */
#include "study/compare/equal_error.h"

#include <math.h>
#include <string.h>

/* Methods are brought to an error if their work there is estimated at up to NEAR times the next
 * least. Times would choose other rows on a loaded machine; a pass over the forces cost 2.6
 * times as much for one method as for another where a sheet fell on a sphere, 3.2 times on 16
 * particles. */
#define NEAR 3

/* The search aims at the middle of what counts as equal. It takes TRIALS runs of a method at
 * most; two values of a control nearer than CLOSED have nothing in between. */
#define AIM    (1 - 0.5 * CS_EQUAL_ERROR)
#define TRIALS 8
#define CLOSED 1.02

/* Slopes of log(work) over log(1 / error): a method of order p has 1/p. */
#define WIDE       1.5
#define WIDE_NOISY 5
#define SLOPE_MIN  0.02
#define SLOPE_MAX  2

/* Errors within this factor of a bound show the noise of error control there. */
#define NOISE_RANGE 3

/* Times of another machine are not comparable. */
bool cs_choice_is_timed(const struct cs_cell *cell, const struct cs_choice *choice) {
    return cs_cell_is_finished(cell) && !strcmp(cell->machine, choice->compare->machine);
}

/* A cell with a cost and an error in the norm. */
bool cs_choice_is_ranked(const struct cs_cell *cell, const struct cs_choice *choice) {
    return cs_choice_is_timed(cell, choice) && cell->cpu > 0 &&
           isfinite(cs_norm_of(choice->norm, cell, &choice->compare->reference));
}

double cs_choice_error(const struct cs_cell *cell, const struct cs_choice *choice) {
    const struct cs_cell_list *list = &choice->compare->cells;
    double low, high;
    const double error =
        cs_cell_typical(list->cells, list->n, cell, cs_norm_column(choice->norm), &low, &high);
    return cs_norm_bounded(choice->norm, error, &choice->compare->reference);
}

/* A cell with an error of at most the bound; rounding may exceed it by 1e-9. */
bool cs_choice_is_met(const struct cs_cell *cell, const struct cs_choice *choice) {
    return cs_choice_is_ranked(cell, choice) &&
           cs_choice_error(cell, choice) <= choice->bound * (1 + 1e-9);
}

double cs_choice_cost(const struct cs_cell *cell, const struct cs_choice *choice) {
    return choice->by_work ? cell->work : cell->cpu;
}

/* Equal steps of a frame that a step of fixed length is cut into. */
static double steps_of(const struct cs_cell *cell, const struct cs_choice *choice) {
    return ceil(1 / (cell->value * choice->compare->fps) - 1e-6);
}

static bool takes_steps(const struct cs_cell *cell) {
    return !strcmp(cell->control, "dt");
}

/* The reference's own error, where it is one of the norm. */
static double bar_of(const struct cs_choice *choice) {
    return choice->norm > CS_NORM_LARGEST ? 0 : choice->compare->reference.error_bar;
}

/* Index after the last cell of the series that begins at `first`. */
uint32_t cs_choice_series_end(const struct cs_choice *choice, uint32_t first) {
    const struct cs_cell_list *list = &choice->compare->cells;
    uint32_t k = first + 1;
    while (k < list->n && cs_cell_same_series(list->cells + k, list->cells + first))
        k++;
    return k;
}

/* Slope of log(work) over log(1 / error) in a series at one of its cells, to the nearest cell
 * with an error at least WIDE times larger, or smaller: nearer ones show noise. Work, because
 * times of single runs are noise too. */
static double find_slope(const struct cs_choice *choice, const struct cs_cell *cell,
                         const struct cs_cell *first, const struct cs_cell *end) {
    const double wide = cell->adaptive ? WIDE_NOISY : WIDE;
    const double error = cs_choice_error(cell, choice);
    double nearest = 0;
    const struct cs_cell *other = NULL;
    for (const struct cs_cell *at = first; at < end; at++) {
        const double apart = fabs(log(cs_choice_error(at, choice) / error));
        if (cs_choice_is_ranked(at, choice) && apart >= log(wide) &&
            (!other || apart < nearest)) {
            other = at;
            nearest = apart;
        }
    }
    const double slope =
        other ? log(other->work / cell->work) / log(error / cs_choice_error(other, choice)) : 1;
    return isfinite(slope) ? fmin(fmax(slope, SLOPE_MIN), SLOPE_MAX) : 1;
}

/* True if no value lies between those of two cells, as far as it matters. */
static bool is_closed(const struct cs_choice *choice, const struct cs_cell *coarser,
                      const struct cs_cell *cell) {
    return coarser->value <= CLOSED * cell->value ||
           (takes_steps(cell) && steps_of(cell, choice) - steps_of(coarser, choice) <= 1);
}

/* Cells of the series that were run for this bound. */
static uint32_t count_trials(const struct cs_choice *choice, const struct cs_cell *first,
                             const struct cs_cell *end) {
    uint32_t n = 0;
    for (const struct cs_cell *at = first; at < end; at++)
        n += fabs(at->target - choice->bound) < 1e-9 * choice->bound;
    return n;
}

/* Natural logarithm of the control's next value, between those of the bracket: where the
 * secant of log(error) meets the aim; every third time, or without an error, the middle. A
 * cell without a coarser one takes a longer step. */
static double next_log(const struct cs_choice *choice, const struct cs_standing *standing,
                       uint32_t trials) {
    const struct cs_cell *cell = standing->cell, *coarser = standing->coarser;
    if (!coarser)
        return fmin(log(cell->value) + (takes_steps(cell) ? log(2) : 0.5 * log(10)),
                    log(cell->high));
    const double width = log(coarser->value / cell->value);
    double part = 0.5;
    if (cs_choice_is_ranked(coarser, choice) && trials % 3 != 2)
        part = log(AIM * choice->bound / cs_choice_error(cell, choice)) /
               log(cs_choice_error(coarser, choice) / cs_choice_error(cell, choice));
    return log(cell->value) + fmin(fmax(part, 0.02), 0.98) * width;
}

/* Sets the next value of a method's control: of a step an n-th of a frame, of a tolerance three
 * digits. Returns false if none is left to try. */
static bool next_value(const struct cs_choice *choice, const struct cs_standing *standing,
                       const struct cs_cell *first, const struct cs_cell *end, double *value) {
    const struct cs_cell *cell = standing->cell, *coarser = standing->coarser;
    const uint32_t trials = count_trials(choice, first, end);
    const double fps = choice->compare->fps;
    if (trials >= TRIALS || (coarser && is_closed(choice, coarser, cell)))
        return false;
    *value = exp(next_log(choice, standing, trials));
    if (takes_steps(cell)) {
        const double most = steps_of(cell, choice) - 1,
                     least = coarser ? steps_of(coarser, choice) + 1 : 1;
        *value = 1 / fps / fmin(fmax(floor(1 / (fps * *value) + 0.5), least), most);
    } else {
        const double digit = pow(10, floor(log10(*value)) - 2);
        *value = floor(*value / digit + 0.5) * digit;
    }
    // error control has noise: the bracket may hold cells that were run before
    for (const struct cs_cell *at = first; at < end; at++)
        if (fabs(at->value / *value - 1) < 1e-6)
            return false;
    return *value <= cell->high * (1 + 1e-9);
}

/* True if values between the cells may be run; an end that the user chose is no limit. */
static bool is_free(const struct cs_cell *coarser, const struct cs_cell *cell) {
    return coarser ? coarser->value <= cell->high * (1 + 1e-9) : cell->open;
}

/* Widens left and luck of a method with error control by its noise. Each cell with an error
 * near the bound gives an estimate of the work there, along the slope; they differ, because
 * errors jump from one tolerance to the next. The n estimates show less than the whole range
 * of the noise, by 1/(n - 1) of what they span at either end if it is uniform (the unbiased
 * estimates of both ends; Lloyd 1952, rectangular distribution). */
static void add_noise(const struct cs_choice *choice, const struct cs_cell *first,
                      const struct cs_cell *end, struct cs_standing *standing) {
    double most = 0, least = 0;
    uint32_t n = 0;
    for (const struct cs_cell *at = first; at < end; at++) {
        const double apart =
            log(cs_norm_of(choice->norm, at, &choice->compare->reference) / choice->bound);
        if (!cs_choice_is_ranked(at, choice) || fabs(apart) > log(NOISE_RANGE))
            continue;
        const double more = log(at->work / standing->cell->work) + standing->slope * apart;
        most = fmax(most, more);
        least = fmin(least, more);
        n++;
    }
    const double beyond = n > 1 && standing->cell->adaptive ? (most - least) / (n - 1) : 0;
    standing->luck = fmax(standing->luck, most + beyond);
    standing->left = fmax(standing->left, beyond - least);
}

/* Lowers the slope of fixed steps to that between the neighbours that have the bound between
 * them. Near the stability limit errors fall a thousandfold from one number of steps to the
 * next, and the slope of smaller errors would say that a longer step may save as much. */
static void bound_slope(const struct cs_choice *choice, struct cs_standing *standing) {
    const struct cs_cell *cell = standing->cell, *coarser = standing->coarser;
    const double between =
        log(cell->work / coarser->work) /
        log(cs_choice_error(coarser, choice) / cs_choice_error(cell, choice));
    if (takes_steps(cell) && between > 0)
        standing->slope = fmin(standing->slope, between);
}

/* Sets relation, slope, left and luck. */
static void find_relation(const struct cs_choice *choice, const struct cs_cell *first,
                          const struct cs_cell *end, struct cs_standing *standing) {
    const struct cs_cell *cell = standing->cell, *coarser = standing->coarser;
    const double error = cs_choice_error(cell, choice);
    const bool equal = error >= (1 - CS_EQUAL_ERROR) * choice->bound;
    double value;
    standing->slope = find_slope(choice, cell, first, end);
    if (!equal && takes_steps(cell) && steps_of(cell, choice) <= 1)
        standing->relation = CS_BOUND_LIMIT;
    else if (!equal &&
             (!is_free(coarser, cell) || next_value(choice, standing, first, end, &value)))
        standing->relation = CS_BOUND_BELOW;
    else if (equal || (coarser && cs_choice_is_ranked(coarser, choice))) {
        standing->relation = CS_BOUND_AT;
        if (!equal)
            bound_slope(choice, standing);
        standing->left =
            standing->slope * (log(choice->bound / error) + log1p(bar_of(choice) / error));
        add_noise(choice, first, end, standing);
    } else {
        standing->relation = CS_BOUND_LIMIT;
        standing->left = !coarser || takes_steps(cell) ? 0 : log(coarser->value / cell->value);
    }
}

/* The series from cell `first` to before `end` at the bound, by any predicate. */
void cs_standing_find(const struct cs_choice *choice, cs_choice_passes *pass, uint32_t first,
                      uint32_t end, struct cs_standing *standing) {
    const struct cs_cell *cells = choice->compare->cells.cells;
    *standing = (struct cs_standing){.relation = CS_BOUND_BELOW};
    for (uint32_t k = first; k < end; k++)
        if (pass(cells + k, choice) &&
            (!standing->cell || cells[k].work < standing->cell->work))
            standing->cell = cells + k;
    for (const struct cs_cell *at = cells + first; standing->cell && at < standing->cell; at++)
        if (!pass(at, choice))
            standing->coarser = at;
    if (standing->cell && pass == cs_choice_is_met)
        find_relation(choice, cells + first, cells + end, standing);
    else if (standing->cell)
        standing->relation = CS_BOUND_LIMIT; // a step of one frame
}

/* Largest decade in which an error is meaningful: a tenth of the motion, or the largest error
 * if the norm has no scale. An error as large as the motion means nothing. */
static int first_exponent(const struct cs_choice *choice) {
    const struct cs_compare *compare = choice->compare;
    double most = 0;
    for (uint32_t k = 0; k < compare->cells.n; k++)
        if (cs_choice_is_ranked(compare->cells.cells + k, choice))
            most = fmax(
                most, cs_norm_of(choice->norm, compare->cells.cells + k, &compare->reference));
    // one as large as the motion says nothing
    const double scale = cs_norm_scale(choice->norm, &compare->reference);
    return (int)floor(log10(fmax(isfinite(scale) ? 0.1 * scale : most, 1e-300)) + 1e-9);
}

/* Sets the bound of the next rank, from large errors to small ones, down to twice the error of
 * the reference. Returns false at the end. */
bool cs_choice_next_bound(struct cs_choice *choice, int *exponent, uint32_t *n) {
    const double asked = choice->compare->settings->bound;
    *exponent = *n ? *exponent - 1 : first_exponent(choice);
    choice->bound = asked > 0 ? asked : pow(10, *exponent);
    if (asked > 0)
        return (*n)++ == 0;
    return *exponent > -16 && choice->bound >= 2 * bar_of(choice) && (*n)++ < CS_RANKS_MAX;
}

/* Cost that a method is expected to have at the bound. Below it: along the slope, or half way
 * to an unstable step. */
static double estimate(const struct cs_choice *choice, const struct cs_standing *standing) {
    const struct cs_cell *cell = standing->cell, *coarser = standing->coarser;
    const double cost = cs_choice_cost(cell, choice);
    if (standing->relation != CS_BOUND_BELOW)
        return cost;
    if (coarser && !cs_choice_is_ranked(coarser, choice))
        return cost * sqrt(cell->value / coarser->value);
    return cost * pow(cs_choice_error(cell, choice) / choice->bound, standing->slope);
}

/* The two least estimates of all methods at the bound; HUGE_VAL: there are not so many. */
static void find_least(const struct cs_choice *choice, double least[2]) {
    least[0] = least[1] = HUGE_VAL;
    for (uint32_t first = 0, end; first < choice->compare->cells.n; first = end) {
        struct cs_standing standing;
        end = cs_choice_series_end(choice, first);
        cs_standing_find(choice, cs_choice_is_met, first, end, &standing);
        const double cost = standing.cell ? estimate(choice, &standing) : HUGE_VAL;
        if (cost < least[0]) {
            least[1] = least[0];
            least[0] = cost;
        } else
            least[1] = fmin(least[1], cost);
    }
}

/* The first series near the front that has a next value at the bound. */
static const struct cs_cell *find_next_at(const struct cs_choice *choice, double *value) {
    const struct cs_cell *cells = choice->compare->cells.cells;
    double least[2];
    find_least(choice, least);
    // a factor needs two methods
    for (uint32_t first = 0, end; least[1] < HUGE_VAL && first < choice->compare->cells.n;
         first = end) {
        struct cs_standing standing;
        end = cs_choice_series_end(choice, first);
        cs_standing_find(choice, cs_choice_is_met, first, end, &standing);
        if (standing.cell && estimate(choice, &standing) <= NEAR * least[1] &&
            is_free(standing.coarser, standing.cell) && standing.relation == CS_BOUND_BELOW &&
            next_value(choice, &standing, cells + first, cells + end, value))
            return standing.cell;
    }
    return NULL;
}

const struct cs_cell *cs_equal_error_find_next(const struct cs_compare *compare, double *value,
                                               double *target) {
    struct cs_choice choice = {
        .compare = compare, .norm = compare->settings->ranking_norm, .by_work = true};
    int exponent = 0;
    if (!cs_norm_is_known(choice.norm, &compare->reference))
        return NULL;
    for (uint32_t n = 0; cs_choice_next_bound(&choice, &exponent, &n);) {
        const struct cs_cell *found = find_next_at(&choice, value);
        *target = choice.bound;
        if (found)
            return found;
    }
    return NULL;
}

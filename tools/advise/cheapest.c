/* Searches the cheapest method for an error, best first. */
#include "advise/cheapest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A unit of work takes one method up to TIE times as long as another (rms 1.4 over 30 scenes):
 * candidates that could cost up to TIE times the least work are brought to the error. */
#define TIE 2

/* The work expected of a candidate is too high by up to this factor: errors of methods of one
 * family and order lie within it of each other on most scenes. */
#define GUESS 4

/* The search aims just below the bound, and leaves cells alone that could cost 5 % less. */
#define AIM  (1 - 0.5 * CS_EQUAL_ERROR)
#define GAIN 0.95

/* Expectations of a candidate. */
struct prospect {
    double value;    /* of its control, to be run next; NAN: nothing is left to try */
    double expected; /* work at the bound */
    double least;    /* that it could have there */
    double cost;     /* the same, of a candidate with a cell that meets the bound */
};

/* The cells of a candidate that matter at a bound; NULL: there is none. */
struct record {
    const struct cs_cell *near;   /* meets the bound with the least work, or comes nearest */
    const struct cs_cell *other;  /* the last one before it by falling step, or the next */
    const struct cs_cell *last;   /* shortest step or tightest tolerance with an error */
    const struct cs_cell *failed; /* shortest step that did not finish */
    bool met;
};

static bool takes_steps(const struct cs_candidate *candidate) {
    return !strcmp(candidate->probe.control, "dt");
}

/* Methods whose iterations per step become fewer as steps become shorter. */
static bool is_implicit(const struct cs_candidate *candidate) {
    return strstr(candidate->probe.family, "implicit");
}

static bool is_explicit(const struct cs_candidate *candidate) {
    return strstr(candidate->probe.family, "explicit");
}

/* Methods whose work says little of their time: a step of implicit-block is 2 units that take
 * as long as 30 of others. */
static bool is_approximate(const struct cs_cell *cell) {
    return !strcmp(cell->family, "approximate");
}

static double order_of(const struct cs_candidate *candidate, int shift) {
    return fmax((double)candidate->probe.declared_order + shift, 1);
}

/* d log(work) / d log(1 / error), with an order that is `shift` higher than declared. */
static double slope_of(const struct cs_candidate *candidate, int shift) {
    return (is_implicit(candidate) ? 0.5 : 1) / order_of(candidate, shift);
}

/* Work at another value of the control than that of a cell. */
static double work_at_value(const struct cs_candidate *candidate, const struct cs_cell *cell,
                            double value) {
    const double slope = !takes_steps(candidate)  ? slope_of(candidate, 0)
                         : is_implicit(candidate) ? 0.5
                                                  : 1;
    return cell->work * pow(cell->value / value, slope);
}

/* Work at the bound of a candidate with the error and the work of a cell, if its order is one
 * higher than declared, or one lower where it is too accurate. */
static double least_at_bound(const struct cs_candidate *candidate, const struct cs_cell *cell,
                             const struct cs_choice *choice) {
    const double ratio = cs_choice_error(cell, choice) / choice->bound;
    return cell->work * pow(ratio, slope_of(candidate, ratio > 1 ? 1 : -1));
}

/* Value of the control at which the error of a cell becomes the bound: by the secant of
 * log(error) to another cell, within a factor of 2 of the order; without one by the order. */
static double value_at_bound(const struct cs_candidate *candidate, const struct cs_cell *cell,
                             const struct cs_cell *other, const struct cs_choice *choice) {
    double order = takes_steps(candidate) ? order_of(candidate, 0) : 1;
    if (other) {
        const double found =
            log(cs_choice_error(other, choice) / cs_choice_error(cell, choice)) /
            log(other->value / cell->value);
        order = fmin(fmax(found, 0.5 * order), 2 * order);
    }
    return cell->value * pow(AIM * choice->bound / cs_choice_error(cell, choice), 1 / order);
}

/* Step over the time scale of the motion, to which a method of that order has the error: error
 * = motion (step / scale)^order. */
static double step_at(double error, double order, const struct cs_choice *choice) {
    return pow(fmin(error / choice->compare->reference.motion_scale, 1), 1 / order);
}

/* Factor from the work of a relative's cell to that of the candidate at the bound: its longer
 * or shorter steps, and its stages, one an order. */
static double factor_from(const struct cs_candidate *candidate, const struct cs_cell *cell,
                          const struct cs_choice *choice) {
    const double order = order_of(candidate, 0), of_cell = fmax(cell->declared_order, 1);
    const double steps = step_at(cs_choice_error(cell, choice), of_cell, choice) /
                         step_at(choice->bound, order, choice);
    return order / of_cell * pow(steps, is_implicit(candidate) ? 0.5 : 1);
}

/* The nearest value that may be run: a frame cut into equal steps, or three digits of a
 * tolerance, not above `value` if possible. */
static double round_value(const struct cs_candidate *candidate, double value, double fps) {
    value = fmin(fmax(value, candidate->probe.low), candidate->probe.high);
    if (!candidate->probe.open || !(value > 0))
        return value;
    if (takes_steps(candidate))
        return 1 / fps / ceil(1 / (fps * value) - 1e-6);
    const double digit = pow(10, floor(log10(value)) - 2);
    return fmax(floor(value / digit + 1e-6) * digit, candidate->probe.low);
}

static void find_record(const struct cs_candidate *candidate, const struct cs_choice *choice,
                        struct record *record) {
    const struct cs_cell_list *cells = &choice->compare->cells;
    *record = (struct record){0};
    for (const struct cs_cell *at = cells->cells; at < cells->cells + cells->n; at++) {
        if (!cs_cell_same_series(at, &candidate->probe))
            continue;
        if (!cs_choice_is_ranked(at, choice)) {
            record->failed = at;
            continue;
        }
        const bool met = cs_choice_is_met(at, choice);
        record->last = at;
        if (!record->near || (met && (!record->met || at->work < record->near->work)) ||
            (!record->met &&
             cs_choice_error(at, choice) < cs_choice_error(record->near, choice))) {
            record->other = record->near;
            record->near = at;
            record->met = met;
        } else if (!record->other)
            record->other = at;
    }
}

/* True if a value is that of a cell, or too near to one to matter. */
static bool was_run(const struct cs_candidate *candidate, const struct cs_choice *choice,
                    double value) {
    const struct cs_cell_list *cells = &choice->compare->cells;
    for (uint32_t k = 0; k < cells->n; k++)
        if (cs_cell_same_series(cells->cells + k, &candidate->probe) &&
            !(fabs(cells->cells[k].value / value - 1) > (takes_steps(candidate) ? 1e-6 : 0.02)))
            return true;
    return false;
}

/* By its own cells, of which one has an error. */
static void judge_by_error(const struct cs_candidate *candidate, const struct record *record,
                           const struct cs_choice *choice, struct prospect *out) {
    const struct cs_cell *near = record->near, *failed = record->failed;
    const double fps = choice->compare->fps;
    double value = value_at_bound(candidate, near, record->other, choice);
    if (failed && failed->value < near->value)
        return; // shorter steps fail
    if (failed && value > sqrt(failed->value * near->value))
        value = sqrt(failed->value * near->value);
    // errors jump between tolerances: a second miss takes half a decade
    if (!record->met && record->other && !takes_steps(candidate))
        value = fmin(value, record->last->value / sqrt(10));
    value = round_value(candidate, value, fps);
    out->least = least_at_bound(candidate, near, choice);
    if (record->met) {
        out->cost = near->work;
        const double most = failed ? failed->value : candidate->probe.high;
        out->least = fmax(out->least, work_at_value(candidate, near, most));
        if (record->other && record->other->value > near->value)
            out->least = fmax(out->least, record->other->work);
        if (out->least > GAIN * near->work ||
            cs_choice_error(near, choice) > (1 - CS_EQUAL_ERROR) * choice->bound)
            return;
    }
    if (was_run(candidate, choice, value))
        return;
    out->value = value;
    out->expected = fmax(work_at_value(candidate, near, value), out->least);
    out->least = fmax(out->least, out->expected / GUESS);
    out->cost = fmin(out->cost, record->met ? out->expected : HUGE_VAL);
}

/* Without an error: after a blow-up half the step, at the cost of its steps so far. */
static void judge_by_failure(const struct cs_candidate *candidate, const struct cs_cell *failed,
                             const struct cs_choice *choice, struct prospect *out) {
    const double value = round_value(candidate, failed->value / 2, choice->compare->fps);
    if (strncmp(failed->outcome, "blew up", 7) != 0 || was_run(candidate, choice, value))
        return;
    out->value = value;
    out->expected = takes_steps(candidate) ? choice->compare->time / value *
                                                 fmax(failed->work / fmax(failed->steps, 1), 1)
                                           : 2 * failed->work;
    out->least = out->expected;
}

/* Geometric means over the cells of the candidate's family. Returns false without any. */
static bool find_relatives(const struct cs_candidate *candidate, const struct cs_choice *choice,
                           struct prospect *mean) {
    const struct cs_cell_list *cells = &choice->compare->cells;
    struct prospect sum = {0};
    uint32_t n = 0;
    for (const struct cs_cell *at = cells->cells; at < cells->cells + cells->n; at++) {
        if (strcmp(at->family, candidate->probe.family) != 0 ||
            !cs_choice_is_ranked(at, choice))
            continue;
        const double factor = factor_from(candidate, at, choice);
        sum.value += log(value_at_bound(candidate, at, NULL, choice));
        sum.expected += log(factor * at->work);
        n++;
    }
    *mean = (struct prospect){.value = exp(sum.value / n), .expected = exp(sum.expected / n)};
    return n > 0;
}

/* Least work by theory: an evaluation per step, and the longest step. */
static double least_by_theory(const struct cs_cheapest *cheapest,
                              const struct cs_candidate *candidate,
                              const struct cs_choice *choice) {
    double longest = 1 / choice->compare->fps;
    if (is_explicit(candidate) && takes_steps(candidate))
        longest = candidate->probe.high;
    else if (is_explicit(candidate)) {
        longest = 0;
        for (const struct cs_candidate *other = cheapest->candidates;
             other < cheapest->candidates + cheapest->n; other++)
            if (is_explicit(other) && takes_steps(other))
                longest = fmax(longest, other->probe.high);
        longest = longest > 0 ? longest : 1 / choice->compare->fps;
    }
    return choice->compare->time / longest;
}

/* Before its first cell. A method without a control has one cell, at any value. */
static void judge_unrun(const struct cs_cheapest *cheapest,
                        const struct cs_candidate *candidate, const struct cs_choice *choice,
                        struct prospect *out) {
    const double motion = choice->compare->reference.motion_scale;
    double value = takes_steps(candidate) ? candidate->probe.high : choice->bound / motion;
    struct prospect relatives;
    out->expected = out->least = least_by_theory(cheapest, candidate, choice);
    if (find_relatives(candidate, choice, &relatives)) {
        out->expected = fmax(out->expected, relatives.expected);
        out->least = fmax(out->least, relatives.expected / GUESS);
        if (!(is_explicit(candidate) && takes_steps(candidate)))
            value = relatives.value;
    }
    out->value = round_value(candidate, value, choice->compare->fps);
}

static struct prospect judge(const struct cs_cheapest *cheapest,
                             const struct cs_candidate *candidate,
                             const struct cs_choice *choice) {
    struct prospect out = {(double)NAN, HUGE_VAL, HUGE_VAL, HUGE_VAL};
    struct record record;
    find_record(candidate, choice, &record);
    if (record.near)
        judge_by_error(candidate, &record, choice, &out);
    else if (record.failed)
        judge_by_failure(candidate, record.failed, choice, &out);
    else
        judge_unrun(cheapest, candidate, choice, &out);
    return out;
}

/* Least work at the bound of the candidates with a cell that meets it: of a family; or, with
 * NULL, of all families, approximate methods among them or not. HUGE_VAL: there is none. */
static double find_least(const struct cs_cheapest *cheapest, const struct cs_choice *choice,
                         const char *family, bool approximate) {
    double least = HUGE_VAL;
    for (uint32_t k = 0; k < cheapest->n; k++) {
        const struct cs_cell *probe = &cheapest->candidates[k].probe;
        if (family ? !strcmp(probe->family, family) : approximate || !is_approximate(probe))
            least = fmin(least, judge(cheapest, cheapest->candidates + k, choice).cost);
    }
    return least;
}

/* Work that a candidate may have to be of interest. Units of a family take equally long. */
static double find_worth(const struct cs_cheapest *cheapest, const struct cs_choice *choice,
                         const struct cs_candidate *candidate) {
    const bool approximate = is_approximate(&candidate->probe);
    const double worth = TIE * find_least(cheapest, choice, NULL, approximate);
    return approximate
               ? worth
               : fmin(worth, find_least(cheapest, choice, candidate->probe.family, false));
}

/* The candidate of interest with the least expected work, of those that meet the bound already
 * or of the others; NULL: none. */
static const struct cs_cell *find_best(const struct cs_cheapest *cheapest,
                                       const struct cs_choice *choice, bool met,
                                       double *value) {
    const struct cs_cell *found = NULL;
    double expected = HUGE_VAL;
    for (uint32_t k = 0; k < cheapest->n; k++) {
        const struct cs_candidate *candidate = cheapest->candidates + k;
        const struct prospect prospect = judge(cheapest, candidate, choice);
        if (!isnan(prospect.value) && (prospect.cost < HUGE_VAL) == met &&
            prospect.expected < expected &&
            prospect.least <= find_worth(cheapest, choice, candidate)) {
            expected = prospect.expected;
            *value = prospect.value;
            found = &candidate->probe;
        }
    }
    return found;
}

/* Candidates without a cell at the error come first: it may show that others cost too much. */
const struct cs_cell *cs_cheapest_find_next(struct cs_cheapest *cheapest,
                                            const struct cs_compare *compare, double *value) {
    const struct cs_choice choice = {.compare = compare,
                                     .norm = compare->settings->ranking_norm,
                                     .bound = compare->settings->bound};
    const struct cs_cell *found;
    double target;
    if (cheapest->n_runs >= CS_CHEAPEST_RUNS ||
        !cs_norm_is_known(choice.norm, &compare->reference))
        return NULL;
    cheapest->n_runs++;
    found = find_best(cheapest, &choice, false, value);
    found = found ? found : find_best(cheapest, &choice, true, value);
    return found ? found : cs_equal_error_find_next(compare, value, &target);
}

/* Adds the series of a cell, or widens its range by the cell. */
static void add_candidate(struct cs_cheapest *cheapest, const struct cs_cell *cell) {
    struct cs_candidate *last = cheapest->candidates + cheapest->n - 1;
    if (cheapest->n > 0 && cs_cell_same_series(cell, &last->probe)) {
        last->probe.low = fmin(last->probe.low, cell->low);
        last->probe.high = fmax(last->probe.high, cell->high);
    } else
        cheapest->candidates[cheapest->n++].probe = *cell;
}

enum cs_status cs_cheapest_begin(struct cs_cheapest *cheapest, struct cs_compare *compare,
                                 struct cs_error *error) {
    const struct cs_cell_list *cells = &compare->cells;
    *cheapest =
        (struct cs_cheapest){.candidates = calloc(cells->n + 1, sizeof *cheapest->candidates)};
    if (!cheapest->candidates)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the methods of a search");
    for (uint32_t k = 0; k < cells->n; k++)
        if (!*cells->cells[k].outcome)
            add_candidate(cheapest, cells->cells + k);
    cs_cell_list_drop_unrun(&compare->cells);
    return CS_OK;
}

void cs_cheapest_finish(struct cs_cheapest *cheapest) {
    free(cheapest->candidates);
    *cheapest = (struct cs_cheapest){0};
}

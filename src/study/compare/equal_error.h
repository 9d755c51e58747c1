/* equal_error.h - the cost of a method at an error, and the cells that it takes to know it.
 *
 * The cost of a method at an error is that of its longest step, or loosest tolerance, with an
 * error of at most that. Steps go by halves in a sweep, so the row below the error may cost a
 * method twice what it needs, and another nothing. cs_equal_error_find_next therefore closes
 * the bracket of each method near the front, between the row that misses the error and the one
 * that meets it, by the secant of log(error) over log(step), until a cell
 *   1. has the error, up to CS_EQUAL_ERROR;
 *   2. has no neighbour: no number of steps per frame, or no tolerance, lies in between;
 *   3. is at a limit: the next longer step is unstable, or longer than a frame.
 * In cases 1 and 2 the rest of the distance, times the slope of log(cost) over log(error),
 * widens the interval of a factor. Of methods with error control so does the scatter of the
 * cells near the error about that slope. Methods without such a cell have no factor.
 */
#ifndef CS_EQUAL_ERROR_H
#define CS_EQUAL_ERROR_H

#include "study/compare/compare_state.h"

/* Powers of 10 at most. */
enum { CS_RANKS_MAX = 24 };

/* An error is equal to a bound from this fraction below it on. */
#define CS_EQUAL_ERROR 0.05

/* Where the error of a cell lies that meets a bound. */
enum cs_bound_relation {
    CS_BOUND_BELOW, /* somewhere below: steps in between were not run */
    CS_BOUND_AT,    /* at the bound, or as near as its steps come */
    CS_BOUND_LIMIT  /* below, at the longest step that holds or fits in a frame */
};

/* A method at a bound. */
struct cs_standing {
    const struct cs_cell *cell; /* that meets it with the least work; NULL: not run to it */
    /* the next longer step or looser tolerance, which misses it or did not finish; or NULL */
    const struct cs_cell *coarser;
    enum cs_bound_relation relation;
    double slope; /* d log(work) / d log(1 / error) near the bound */
    double left;  /* logarithm of the factor that the rest of the distance may save, */
    double luck;  /* and of the factor by which the cell may be lucky: noise of error control */
};

/* A question to the cells of a comparison. */
struct cs_choice {
    const struct cs_compare *compare; /* borrowed */
    enum cs_norm norm;
    double bound; /* of the error */
    bool by_work; /* cost is work, not time */
};

/* A predicate on cells. */
typedef bool cs_choice_passes(const struct cs_cell *cell, const struct cs_choice *choice);

/* True if a cell finished on this machine: times of another one are not comparable. */
cs_choice_passes cs_choice_is_timed;
/* True if it has a cost and an error in the norm, too. */
cs_choice_passes cs_choice_is_ranked;
/* True if its error is at most the bound, too; rounding may exceed it by 1e-9. */
cs_choice_passes cs_choice_is_met;

/* Error of a cell of the comparison's list in the norm; of a method with error control the
 * typical one (cs_cell_typical), so that no lucky tolerance wins. */
double cs_choice_error(const struct cs_cell *cell, const struct cs_choice *choice);

/* Cost of a cell: s, or work. */
double cs_choice_cost(const struct cs_cell *cell, const struct cs_choice *choice);

/* Index after the last cell of the series that begins at cell `first`. */
uint32_t cs_choice_series_end(const struct cs_choice *choice, uint32_t first);

/* Sets the bound of the next rank, from a tenth of the motion down to twice the error of the
 * reference, by powers of 10; or to settings->bound, once. *n: ranks so far, 0 at first.
 * Returns false at the end. */
bool cs_choice_next_bound(struct cs_choice *choice, int *exponent, uint32_t *n);

/* Finds where the series of cells first to end - 1 stands at the bound. With another predicate
 * than cs_choice_is_met its relation is CS_BOUND_LIMIT. */
void cs_standing_find(const struct cs_choice *choice, cs_choice_passes *pass, uint32_t first,
                      uint32_t end, struct cs_standing *standing);

/* Finds the cell to run next for equal errors: *value of the control, for the series of the
 * returned cell, sought for the error *target. NULL: all methods near the front, by time or by
 * work, have their cells. */
const struct cs_cell *cs_equal_error_find_next(const struct cs_compare *compare, double *value,
                                               double *target);

#endif

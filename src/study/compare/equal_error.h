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

/* Ranks methods by their cost at equal error (equal_error.h), and states their
 * margin.
 *
 * For each power of ten of the error the cheapest method is the best, and the next one the
 * runner-up. Cost is the median processor time, and the ranking by work is told beside it; in a
 * comparison with programs cost is work alone. The
 * Pareto front holds the cells with no other one both cheaper and at least as accurate. Only
 * cells that were timed on this machine are ranked. */

/* Ratio from which two cells differ that were not timed in pairs. */
#define CS_APART_UNPAIRED 1.5

/* Energy error, as a fraction of the largest kinetic energy, up to which one step per frame
 * counts as stable. */
#define CS_FRAME_ENERGY 0.1

/* The cheapest method with an error of at most 10^exponent, and the next one. */
struct cs_rank {
    int exponent;
    const struct cs_cell *best, *runner_up; /* borrowed; NULL: no other series was run to it */
    struct cs_standing of[2];               /* of the two */
    bool has_factor;                        /* neither of them is somewhere below */
    bool by_work;                           /* cost is work, and no times are compared */
    struct cs_ratio ratio;                  /* runner-up over best, if has_factor */
    struct cs_ratio work;         /* the same of counts, with the last level of the interval */
    bool is_significant;          /* their costs differ significantly */
    const struct cs_cell *frugal; /* least work of a series at the bound; may be best */
    /* by another norm: the cheapest cell that is no worse than best, if it is another series
     * and significantly cheaper; NULL: best wins by that norm too */
    const struct cs_cell *better_by_norm[CS_NORMS];
};

struct cs_ranking {
    enum cs_norm norm;
    struct cs_rank ranks[CS_RANKS_MAX]; /* from large errors to small ones */
    uint32_t n;
    bool *on_pareto_front; /* (cells) nothing is both cheaper and more accurate; owned */
    bool *is_contender;    /* (cells) the verdict rests on them: to be timed in rounds; owned */
    /* one step a frame: the cheapest that keeps the energy and the next; best NULL: none */
    struct cs_rank frame;
    const struct cs_cell *frame_nearest;  /* with the least energy error of them; or NULL */
    uint32_t frame_tried, frame_finished; /* cells with a dt of a frame; of these to the end */
};

/* Ranks the cells of a comparison by settings->ranking_norm. Ranks point into compare->cells,
 * which must not change meanwhile. Returns CS_ERR_MEMORY; the ranking is then empty. */
enum cs_status cs_ranking_make(struct cs_ranking *ranking, const struct cs_compare *compare,
                               struct cs_error *error);

/* Frees the marks of cells; a zeroed ranking is allowed. */
void cs_ranking_finish(struct cs_ranking *ranking);

/* Finds the cheapest row with an error of at most bound (unit of the norm) and its runner-up.
 * best is NULL if there is none. */
void cs_ranking_at(const struct cs_compare *compare, double bound, struct cs_rank *rank);

/* True if the pairs of each ratio of contenders leave at most that fraction open to either
 * side. Ratios above 3 count as narrow: they decide nothing. */
bool cs_ranking_is_narrow(const struct cs_ranking *ranking, double share);

/* States the results of a comparison in words, with warnings. */

/* Adds the ranking, one line per statement after `bullet`. A line states facts of the rows that
 * were run, and claims nothing of others. */
void cs_verdict_print(const struct cs_ranking *ranking, const char *bullet,
                      const struct cs_compare *compare, struct cs_text *out);
/* Adds the ranking by work and single times, for the time that rounds take; nothing where the
 * cells are of little work. CS_ERR_MEMORY. */
enum cs_status cs_verdict_print_preliminary(const struct cs_compare *compare,
                                            struct cs_text *out, struct cs_error *error);

/* Adds time and work of a cell; by_work: without the time. */
void cs_verdict_add_cost(const struct cs_cell *cell, bool by_work, struct cs_text *out);
/* Adds the margin of the best over the runner-up and a line's end: the text `none`, with its
 * interval, or roughly from single times; and that by work. */
void cs_verdict_add_factor(const struct cs_rank *rank, const char *none, struct cs_text *out);

/* Adds the warnings that apply, one per line after `bullet`, each with advice. */
void cs_compare_warn(const struct cs_compare *compare, const char *bullet, struct cs_text *out);

#endif

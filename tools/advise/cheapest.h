/* cheapest.h - finds the cheapest method for an error with few runs.
 *
 * Each series of a comparison (a method, or a variant of one) is a candidate. The search is
 * best first: it runs the candidate whose work at the error is expected to be the least, until
 * no other one can cost less. Work is counted, not timed. The work expected of a candidate
 * comes from, in this order,
 *   1. its own cell that meets the error with the least work, or comes nearest: a method of
 *      order p has error ~ step^p, or ~ rtol, and work ~ error^(-1/p); an implicit one the
 *      square root of that, because conjugate gradients take fewer iterations in shorter steps;
 *   2. the cells of its family: at equal step and motion the error of a method of order p is
 *      motion (step / scale)^p with the same scale, and a step costs p;
 *   3. theory: a fixed explicit method takes no step beyond its stability limit
 * (theory.h), an adaptive one none beyond the longest of these limits, others take one per
 * frame. By 1 it could cost as little as with an order one higher (one lower, if it is more
 * accurate than needed), by 2 a quarter. A cell that blew up is followed by half its step, at
 * its price. A candidate is run as long as it could cost less than twice the best, and less
 * than the best of its family.
 *
 * The first cell of a fixed explicit method has the longest stable step; of another one that
 * which the family predicts, else a frame, or an rtol of the error over the motion. When every
 * candidate meets the error or costs too much, those that meet it by far come nearer, and then
 * methods near the front are brought to equal errors (equal_error.h) with the rest of the runs.
 * Times decide at the end only. */
#ifndef CS_CHEAPEST_H
#define CS_CHEAPEST_H

#include "study/compare/equal_error.h"

/* Runs at most, rounds of timing apart. */
enum { CS_CHEAPEST_RUNS = 25 };

/* One series. */
struct cs_candidate {
    struct cs_cell probe; /* not run; low and high: values of its control that may be run */
};

/* Zeroed: not begun. */
struct cs_cheapest {
    struct cs_candidate *candidates; /* (n) owned */
    uint32_t n, n_runs;
};

/* Makes the candidates from the cells of the comparison that have no outcome, and removes these
 * cells. CS_ERR_MEMORY. */
enum cs_status cs_cheapest_begin(struct cs_cheapest *cheapest, struct cs_compare *compare,
                                 struct cs_error *error);

/* Finds the next cell for the error settings->bound: *value of the control of a series. Returns
 * one of its cells, or NULL: the search is over. */
const struct cs_cell *cs_cheapest_find_next(struct cs_cheapest *cheapest,
                                            const struct cs_compare *compare, double *value);

/* The search as settings->next of a comparison, with *ctx a zeroed struct cs_cheapest. Begins
 * it at the first call, with the limits of theory. Errors: those of stability/theory.h. */
cs_compare_next cs_cheapest_choose;

/* Adds a line: the cheapest way to an error of at most bound. */
void cs_cheapest_print(const struct cs_compare *compare, double bound, struct cs_text *out);

/* Frees the candidates; a zeroed search is allowed. */
void cs_cheapest_finish(struct cs_cheapest *cheapest);

#endif

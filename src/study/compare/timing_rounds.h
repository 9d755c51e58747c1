/* timing_rounds.h - times cells in alternation, to let disturbances of the machine affect all
 * of them alike.
 *
 * Clock frequency, caches and other programs change the speed of a machine over seconds to
 * minutes. Cells timed one after the other would carry these changes as differences. In each
 * round every cell is run once, in a random order. Two times of one round form a pair; their
 * ratio is free of changes that are slower than a round.
 *
 * Estimate: the median of log(time of cell / time of base) over the rounds. Logarithms make
 * "twice as long" and "half as long" symmetric, hence ratio(a, b) = 1 / ratio(b, a). The median
 * ignores single disturbed rounds.
 *
 * Interval, two levels (Kalibera, Jones 2013):
 *   1. Within a comparison: percentile bootstrap (Efron 1979). Pairs are drawn with
 *      replacement, as many as there are; 95 % of the medians lie between the 2.5 and 97.5
 *      percentiles. Both sides are widened for the small number of pairs (Hesterberg 2015).
 *   2. Between comparisons: a constant share that pairs of one comparison cannot show. The two
 *    are independent, so their squares add.
 * Two cells differ significantly if 1 is outside the interval. The generator of the resamples
 * starts from a fixed seed: equal times give equal intervals. */
#ifndef CS_TIMING_ROUNDS_H
#define CS_TIMING_ROUNDS_H

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

enum { CS_ROUNDS_MAX = 101, CS_TIMING_PAIRS_MIN = 5 };

/* Zeroed: none. */
struct cs_rounds {
    double *seconds; /* (CS_ROUNDS_MAX, n_cells) s; NAN: not timed in that round; owned */
    uint32_t n_cells, n;
};

/* Cost ratio of two cells, with its 95 % interval. */
struct cs_ratio {
    double median;           /* median */
    double low, high;        /* 95 %, of comparisons that are repeated */
    double pair_uncertainty; /* relative half width by the pairs of this comparison alone */
    uint32_t
        pairs; /* 0: the cells were timed once, each by itself; then low and high are NAN */
};

/* Allocates CS_ROUNDS_MAX rounds of n_cells, all NAN. Returns CS_ERR_MEMORY; *rounds then has
 * no times. */
enum cs_status cs_rounds_init(struct cs_rounds *rounds, uint32_t n_cells,
                              struct cs_error *error);
/* Frees the times; zeroed rounds are allowed. */
void cs_rounds_finish(struct cs_rounds *rounds);

/* Copies the times of a cell in s, sorted, to out (CS_ROUNDS_MAX). Returns their number; rounds
 * without the cell are left out. */
uint32_t cs_rounds_times(const struct cs_rounds *rounds, uint32_t cell, double *out);

/* Estimates the ratio of cell to base, both indices of cells. Returns false, with *ratio
 * unchanged, if there are fewer than CS_TIMING_PAIRS_MIN pairs. */
bool cs_rounds_ratio(const struct cs_rounds *rounds, uint32_t cell, uint32_t base,
                     struct cs_ratio *ratio);

/* Sorts n numbers in place, ascending; none may be NAN. */
void cs_sort(double *numbers, uint32_t n);
/* Quantile of n >= 1 sorted numbers, interpolated linearly between order statistics; 0 <= share
 * <= 1, the median is 0.5. */
double cs_quantile(const double *sorted, uint32_t n, double share);

/* Draws a number from 0..n-1; *state > 0 is the state of the generator. */
uint32_t cs_rounds_draw(uint64_t *state, uint32_t n);

#endif

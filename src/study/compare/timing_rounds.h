/* timing_rounds.h - cells timed in turns, so that what slows a machine down slows all of them.
 *
 * In each round every cell is run once, in an order of its own. What two cells took in the same
 * round is a pair; the ratio of two cells is the median over their pairs, and its interval is
 * what the median of resampled pairs is in 95 of 100 cases (bootstrap: Efron 1979), widened by
 * what differs between comparisons (two levels: Kalibera, Jones 2013). The generator starts
 * from a fixed seed: the same times give the same interval.
 */
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

/* How many times dearer one cell is than another. */
struct cs_ratio {
    double median;    /* median */
    double low, high; /* 95 %, of comparisons that are repeated */
    double
        pair_uncertainty; /* share that the pairs of this one alone leave open to either side */
    uint32_t
        pairs; /* 0: the cells were timed once, each by itself; then low and high are NAN */
};

enum cs_status cs_rounds_init(struct cs_rounds *rounds, uint32_t n_cells,
                              struct cs_error *error);
void cs_rounds_finish(struct cs_rounds *rounds);

/* The times of a cell, sorted: (n) into out, which holds CS_ROUNDS_MAX; returns n. */
uint32_t cs_rounds_times(const struct cs_rounds *rounds, uint32_t cell, double *out);

/* Of cell over base; false: fewer than CS_TIMING_PAIRS_MIN pairs. */
bool cs_rounds_ratio(const struct cs_rounds *rounds, uint32_t cell, uint32_t base,
                     struct cs_ratio *ratio);

void cs_sort(double *numbers, uint32_t n);
/* Of the sorted numbers, 0 <= share <= 1. */
double cs_quantile(const double *sorted, uint32_t n, double share);

/* The next of a sequence of numbers in 0..n-1; *state: its seed, above 0. */
uint32_t cs_rounds_draw(uint64_t *state, uint32_t n);

#endif

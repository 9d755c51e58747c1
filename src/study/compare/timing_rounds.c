/* Stores the times of rounds, and computes ratios with bootstrap intervals over pairs. */
#include "study/compare/timing_rounds.h"

#include <math.h>
#include <stdlib.h>

/* Resamples of the bootstrap: about 25 of the medians lie outside the interval on either side.
 */
enum { RESAMPLES = 999 };
/* Start of the generator: 2^64 divided by the golden ratio, an arbitrary number with mixed
 * bits. */
#define SEED UINT64_C(0x9e3779b97f4a7c15)

/* Half width of a 95 % interval between comparisons, as a fraction of the ratio. The state of
 * the machine (clock, neighbours on the chip, position of memory) differs from one comparison
 * to the next and favours one method over another. Pairs within seconds cannot show this.
 * Measured by repeating whole comparisons on an idle machine, see docs/compare.md. */
#define BETWEEN_RUNS 0.04

enum cs_status cs_rounds_init(struct cs_rounds *rounds, uint32_t n_cells,
                              struct cs_error *error) {
    *rounds = (struct cs_rounds){.n_cells = n_cells};
    rounds->seconds = malloc(((size_t)CS_ROUNDS_MAX * n_cells + 1) * sizeof(double));
    if (!rounds->seconds)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the times of %u cells",
                       n_cells);
    for (size_t k = 0; k < (size_t)CS_ROUNDS_MAX * n_cells; k++)
        rounds->seconds[k] = (double)NAN;
    return CS_OK;
}

void cs_rounds_finish(struct cs_rounds *rounds) {
    free(rounds->seconds);
    *rounds = (struct cs_rounds){0};
}

/* Order of qsort; NAN does not occur. */
static int by_size(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

void cs_sort(double *numbers, uint32_t n) {
    qsort(numbers, n, sizeof *numbers, by_size);
}

double cs_quantile(const double *sorted, uint32_t n, double share) {
    const double at = share * (n - 1);
    const uint32_t k = (uint32_t)at;
    return k + 1 < n ? sorted[k] + (at - k) * (sorted[k + 1] - sorted[k]) : sorted[k];
}

uint32_t cs_rounds_times(const struct cs_rounds *rounds, uint32_t cell, double *out) {
    uint32_t n = 0;
    for (uint32_t r = 0; r < rounds->n; r++) {
        const double seconds = rounds->seconds[(size_t)r * rounds->n_cells + cell];
        if (!isnan(seconds))
            out[n++] = seconds;
    }
    cs_sort(out, n);
    return n;
}

/* xorshift64* (Marsaglia 2003; Vigna 2016). The high 32 bits are the better ones; multiplying
 * them by n and shifting maps them to 0..n-1 without a division. */
uint32_t cs_rounds_draw(uint64_t *state, uint32_t n) {
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    const uint64_t high = (*state * UINT64_C(2685821657736338717)) >> 32;
    return (uint32_t)((high * n) >> 32);
}

/* Median of n draws with replacement from the sorted numbers. Counts how often each was drawn,
 * then walks to the middle of the counts: no second sort. */
static double resampled_median(const double *sorted, uint32_t n, uint64_t *state) {
    uint32_t drawn[CS_ROUNDS_MAX] = {0}, seen = 0, k = 0;
    for (uint32_t i = 0; i < n; i++)
        drawn[cs_rounds_draw(state, n)]++;
    while (2 * (seen + drawn[k]) < n)
        seen += drawn[k++];
    if (2 * (seen + drawn[k]) > n)
        return sorted[k];
    // an even number of them: half way to the next that was drawn
    uint32_t next = k + 1;
    while (!drawn[next])
        next++;
    return 0.5 * (sorted[k] + sorted[next]);
}

/* Collects log(cell / base) of the rounds that have both, sorted. Returns their number. */
static uint32_t find_pairs(const struct cs_rounds *rounds, uint32_t cell, uint32_t base,
                           double *logs) {
    uint32_t n = 0;
    for (uint32_t r = 0; r < rounds->n; r++) {
        const double *round = rounds->seconds + (size_t)r * rounds->n_cells;
        if (round[cell] > 0 && round[base] > 0)
            logs[n++] = log(round[cell] / round[base]);
    }
    cs_sort(logs, n);
    return n;
}

/* Factor by which a percentile interval of n pairs is too short (Hesterberg 2015, sec. 4.2).
 *
 * Two causes: resamples have (n - 1)/n of the variance of the sample, and their percentiles are
 * those of a normal distribution where Student's t with n - 1 degrees of freedom is right. The
 * quantile of t is expanded in 1/(n - 1) up to the second order (Fisher, Cornish 1960):
 *   t = z + (z^3 + z)/(4 d) + (5 z^5 + 16 z^3 + 3 z)/(96 d^2),  d = n - 1,  z = 1.959964.
 * The factor is t/z sqrt(n/d): 1.56 for 5 pairs, 1.34 for 7, 1.10 for 20. */
static double expansion(uint32_t n) {
    const double z = 1.959964, d = n - 1.0, z3 = z * z * z;
    const double t = z + (z3 + z) / (4 * d) + (5 * z3 * z * z + 16 * z3 + 3 * z) / (96 * d * d);
    return t / z * sqrt(n / d);
}

/* Variances of independent causes add; half widths go as their roots. */
static double root_of_squares(double a, double b) {
    return sqrt(a * a + b * b);
}

/* All intervals are in the logarithm; exp at the end gives factors. pair_uncertainty leaves out
 * the share between comparisons, because more rounds cannot reduce it: it decides when the
 * rounds end. */
bool cs_rounds_ratio(const struct cs_rounds *rounds, uint32_t cell, uint32_t base,
                     struct cs_ratio *ratio) {
    double logs[CS_ROUNDS_MAX], medians[RESAMPLES];
    uint64_t state = SEED;
    const uint32_t n = find_pairs(rounds, cell, base, logs);
    if (n < CS_TIMING_PAIRS_MIN)
        return false;
    for (int k = 0; k < RESAMPLES; k++)
        medians[k] = resampled_median(logs, n, &state);
    cs_sort(medians, RESAMPLES);
    const double middle = cs_quantile(logs, n, 0.5);
    const double between = log1p(BETWEEN_RUNS), wide = expansion(n);
    const double below = wide * (middle - cs_quantile(medians, RESAMPLES, 0.025)),
                 above = wide * (cs_quantile(medians, RESAMPLES, 0.975) - middle);
    *ratio = (struct cs_ratio){.median = exp(middle),
                               .low = exp(middle - root_of_squares(below, between)),
                               .high = exp(middle + root_of_squares(above, between)),
                               .pair_uncertainty = expm1(fmax(below, above)),
                               .pairs = n};
    return true;
}

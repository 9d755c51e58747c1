/* Keeps the times of rounds, and finds ratios with bootstrap intervals over pairs. */
#include "study/compare/timing_rounds.h"

#include <math.h>
#include <stdlib.h>

enum { RESAMPLES = 999 };
#define SEED UINT64_C(0x9e3779b97f4a7c15)

/* The machine's state - clock, neighbours on the chip, where memory lies - differs from one
 * comparison to the next and favours one method over another by that share, which pairs of
 * seconds cannot show: half of a 95 % interval of its own, measured by whole comparisons that
 * were repeated on an idle machine, see docs/compare.md. */
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

/* xorshift64* (Marsaglia 2003; Vigna 2016): the high bits are the good ones */
uint32_t cs_rounds_draw(uint64_t *state, uint32_t n) {
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    const uint64_t high = (*state * UINT64_C(2685821657736338717)) >> 32;
    return (uint32_t)((high * n) >> 32);
}

/* The median of n numbers drawn from the sorted ones, by counting how often each was drawn. */
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

/* Resampling n numbers shows (n - 1)/n of their variance, and percentiles are those of a normal
 * distribution where Student's t is right: by how much an interval is too short (Hesterberg
 * 2015, sec. 4.2; t by its expansion in 1/(n - 1), Fisher, Cornish 1960). */
static double expansion(uint32_t n) {
    const double z = 1.959964, d = n - 1.0, z3 = z * z * z;
    const double t = z + (z3 + z) / (4 * d) + (5 * z3 * z * z + 16 * z3 + 3 * z) / (96 * d * d);
    return t / z * sqrt(n / d);
}

/* independent causes add as variances do */
static double root_of_squares(double a, double b) {
    return sqrt(a * a + b * b);
}

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

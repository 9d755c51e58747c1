/* Times cells in rounds, in a new random order in every round.
 *
 *   1. Rank the cells by their times so far; contenders are those the verdict depends on.
 *   2. Stop if there are none, after LEAST_ROUNDS rounds if their ratios are narrow, or when
 * the work of the rounds exceeds its budget.
 *   3. Run each contender once and record its time.
 *   4. Update the cells' medians and quartiles, and go to 1.
 * Contenders are chosen again in every round, because better times change the ranking. */
#include "study/compare/compare_state.h"

#include "study/compare/equal_error.h"

#include <math.h>
#include <stdlib.h>

/* s of processor time. Short runs are repeated within a round until they fill it; before a run
 * expected to be shorter than SHORT_SECONDS its first frames are run untimed, for
 * WARM_SECONDS, to warm the caches. */
#define LEAST_SECONDS 0.01
#define SHORT_SECONDS 0.05
#define WARM_SECONDS  0.003

/* Rounds at least, if so many are allowed. */
enum { LEAST_ROUNDS = 7 };

/* Half width of the pairs' interval at which a ratio is known well enough. More rounds would
 * hardly narrow the whole interval, which BETWEEN_RUNS then dominates. */
#define NARROW 0.02

/* A time further from the median than 3 standard deviations is an outlier. The median absolute
 * deviation of a normal distribution is sigma / 1.4826. The bound is at least UNREST of the
 * median, because clocks and schedulers alone cause such differences. */
#define OUTLIER (3 * 1.4826)
#define UNREST  0.05

/* Up to so many bytes are allocated before a cell is opened, which moves its arrays in every
 * round: their position affects the speed through caches and pages, and would otherwise favour
 * one method throughout. */
enum { SHIFT_BYTES = 1 << 16 };

/* Mean time in s of one run, over at least LEAST_SECONDS. expected: s, of earlier runs. */
static enum cs_status run_warm(struct cs_recorded_run *recording, double expected,
                               double *seconds, struct cs_error *error) {
    struct cs_recorded_run_result result;
    double total = 0;
    uint32_t n = 0;
    const uint32_t frames = recording->frames;
    if (expected < SHORT_SECONDS) {
        recording->frames = (uint32_t)ceil(frames * fmin(WARM_SECONDS / expected, 1));
        cs_recorded_run_execute(recording, 0, NULL, &result, error);
        recording->frames = frames;
    }
    do {
        if (error->status || cs_recorded_run_execute(recording, 0, NULL, &result, error))
            return error->status;
        total += result.cpu;
        n++;
    } while (total < LEAST_SECONDS && n < 1000);
    *seconds = total / n;
    return CS_OK;
}

/* Opens the cell, runs it for this round and closes it. *seconds is that of one run. shift:
 * bytes that displace its memory. */
static enum cs_status time_cell(const struct cs_compare *compare, const struct cs_cell *cell,
                                uint32_t shift, double *seconds, struct cs_error *error) {
    char integrator[CS_CELL_INTEGRATOR];
    struct cs_recorded_run recording = {0};
    char *volatile memory = malloc(shift + 1);
    cs_cell_integrator(cell, integrator, sizeof integrator);
    if (!cs_recorded_run_open(&recording, &compare->settings->run, integrator, error))
        run_warm(&recording, cell->cpu, seconds, error);
    cs_recorded_run_close(&recording);
    free(memory);
    return error->status;
}

/* Sets median, quartiles and number of outliers of a cell from its n sorted times. */
static void take_times(struct cs_cell *cell, const double *sorted, uint32_t n) {
    double away[CS_ROUNDS_MAX];
    cell->cpu = cs_quantile(sorted, n, 0.5);
    cell->cpu_low = cs_quantile(sorted, n, 0.25);
    cell->cpu_high = cs_quantile(sorted, n, 0.75);
    cell->runs = n;
    cell->outliers = 0;
    for (uint32_t k = 0; k < n; k++)
        away[k] = fabs(sorted[k] - cell->cpu);
    cs_sort(away, n);
    const double bound = fmax(OUTLIER * cs_quantile(away, n, 0.5), UNREST * cell->cpu);
    for (uint32_t k = 0; k < n; k++)
        cell->outliers += away[k] > bound;
}

/* Random order (Fisher-Yates): each permutation is equally likely, up to the generator. */
static void shuffle(uint32_t *order, uint32_t n, uint64_t *state) {
    for (uint32_t k = n; k > 1; k--) {
        const uint32_t other = cs_rounds_draw(state, k), kept = order[k - 1];
        order[k - 1] = order[other];
        order[other] = kept;
    }
}

/* Times the n cells of the list once, in its order. */
static enum cs_status make_round(struct cs_compare *compare, const uint32_t *order, uint32_t n,
                                 uint64_t *state, struct cs_error *error) {
    struct cs_rounds *rounds = &compare->rounds;
    double times[CS_ROUNDS_MAX];
    double *round = rounds->seconds + (size_t)rounds->n++ * rounds->n_cells;
    for (uint32_t k = 0; k < n; k++) {
        struct cs_cell *cell = compare->cells.cells + order[k];
        if (time_cell(compare, cell, cs_rounds_draw(state, SHIFT_BYTES), round + order[k],
                      error))
            return error->status;
        take_times(cell, times, cs_rounds_times(rounds, order[k], times));
    }
    return CS_OK;
}

/* Lists the cells of the next round. *narrow: all ratios of contenders are known well enough.
 */
static enum cs_status choose(const struct cs_compare *compare, uint32_t *order, uint32_t *n,
                             bool *narrow, struct cs_error *error) {
    struct cs_ranking ranking;
    *n = 0;
    if (cs_ranking_make(&ranking, compare, error))
        return error->status;
    for (uint32_t k = 0; k < compare->cells.n; k++)
        if (ranking.is_contender[k])
            order[(*n)++] = k;
    *narrow = cs_ranking_is_narrow(&ranking, NARROW);
    cs_ranking_finish(&ranking);
    return CS_OK;
}

/* Nominal s of a round of the n cells of the list. */
static double round_seconds(const struct cs_compare *compare, const uint32_t *order,
                            uint32_t n) {
    double sum = 0;
    for (uint32_t k = 0; k < n; k++)
        sum += fmax(compare->cells.cells[order[k]].work * compare->pass_seconds, LEAST_SECONDS);
    return sum;
}

/* Runs rounds until a stopping rule holds, see the head of this file. */
static enum cs_status make_rounds(struct cs_compare *compare, uint32_t *order,
                                  struct cs_error *error) {
    const uint32_t most = compare->settings->runs;
    double done = 0;
    const uint32_t least = most < LEAST_ROUNDS ? most : LEAST_ROUNDS;
    uint64_t state = 1;
    for (uint32_t k = 0, n; k < most; k++) {
        bool narrow;
        if (choose(compare, order, &n, &narrow, error))
            return error->status;
        if (n == 0 || (k >= least && narrow) || (k > 0 && done > compare->rounds_seconds))
            break;
        const double round = round_seconds(compare, order, n),
                     left = fmax(ceil((compare->rounds_seconds - done) / round), 1);
        done += round;
        if (compare->settings->on_round)
            compare->settings->on_round(compare->settings->ctx, k,
                                        (uint32_t)fmin(k + left, most));
        shuffle(order, n, &state);
        if (make_round(compare, order, n, &state, error))
            return error->status;
    }
    return CS_OK;
}

enum cs_status cs_compare_time(struct cs_compare *compare, struct cs_error *error) {
    uint32_t *order = calloc(compare->cells.n + 1, sizeof *order);
    if (!order)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the order of a round");
    if (!cs_rounds_init(&compare->rounds, compare->cells.n, error))
        make_rounds(compare, order, error);
    free(order);
    return error->status;
}

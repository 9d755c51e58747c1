/* Factors at equal error, on methods with planted errors and costs: what the search finds is
 * what a grid ten times denser shows, and a row at another error gives no number. */
#include "../suite.h"
#include "study/compare/equal_error.h"

#include <math.h>
#include <string.h>

/* A method: error = scale (dt / frame)^order below the limit, cost = seconds per step. Adaptive
 * ones have rtol in place of dt / frame, cost = seconds rtol^(-1/order), and errors that jump
 * by `noise` from one tolerance to the next. Up to `border` times the limit runs finish with an
 * error of 0.3. */
struct planted {
    double order, scale, limit, seconds, evals, noise, border;
    bool adaptive;
};

enum { METHODS_MAX = 6, SWEPT = 12 };
static const double FPS = 60;

static struct cs_compare compare;
static struct cs_compare_settings settings;
static const struct planted *methods;

/* A number between 0 and 1 that depends on the bits of x: the noise of step control. */
static double hash_of(double x) {
    uint64_t state;
    memcpy(&state, &x, sizeof state);
    state ^= state >> 29;
    state *= UINT64_C(0xbf58476d1ce4e5b9);
    return (double)((state ^ state >> 32) >> 11) / 9007199254740992.0;
}

/* Runs a cell by its model. */
static void run_planted(struct cs_cell *cell) {
    const struct planted *of = methods + cell->series[0] - 'a';
    const double steps = cell->adaptive ? pow(cell->value, -1 / of->order)
                                        : ceil(1 / (FPS * cell->value) - 1e-6);
    const double h = 1 / steps;
    const bool holds = h <= of->limit * (1 + 1e-9),
               finishes = holds || h <= of->limit * of->border;
    snprintf(cell->outcome, sizeof cell->outcome, "%s",
             finishes ? "finished" : "blew up: not finite");
    cell->steps = steps;
    cell->step = h / FPS;
    cell->cpu = of->seconds * steps;
    cell->work = of->evals * steps;
    if (finishes)
        cell->error = 0.3;
    if (holds)
        cell->error =
            of->scale * pow(h, of->order) * (1 + of->noise * (hash_of(cell->value) - 0.5));
}

static void add(char series, double value, bool open) {
    struct cs_cell cell;
    struct cs_error error = {0};
    const struct planted *of = methods + series - 'a';
    const char name[] = {series, 0};
    cs_cell_init(&cell, name);
    cell.adaptive = of->adaptive;
    snprintf(cell.control, sizeof cell.control, "%s", of->adaptive ? "rtol" : "dt");
    snprintf(cell.options, sizeof cell.options, "%.17g", value);
    cell.value = value;
    cell.open = open;
    cell.low = open ? 1e-14 : value;
    cell.high = open ? of->adaptive ? 0.1 : 1 / FPS : value;
    run_planted(&cell);
    ck_assert(!cs_cell_list_add(&compare.cells, &cell, &error));
}

static void begin(const struct planted *of) {
    methods = of;
    settings = (struct cs_compare_settings){.run = {.frames = 1}};
    compare = (struct cs_compare){.settings = &settings, .fps = FPS};
    compare.reference = (struct cs_compare_reference){
        .families_agree = true, .pointwise = true, .motion_scale = 1, .error_bar = 1e-12};
}

/* Rows whose values go by factors of 2, or of half a decade; `denser` times as many. */
static void sweep(uint32_t n, int denser) {
    for (uint32_t m = 0; m < n; m++)
        for (int k = 0; k < (methods[m].adaptive ? 2 : 1) * SWEPT * denser; k++)
            add((char)('a' + m),
                methods[m].adaptive ? pow(10, -(denser > 1 ? 1 : 2) - 0.5 * k / denser)
                                    : 1 / FPS * pow(2, -(double)k / denser),
                true);
}

/* Runs what the search asks for. Returns the number of runs. */
static uint32_t search(void) {
    const struct cs_cell *near;
    double value, target;
    uint32_t n = 0;
    while ((near = cs_equal_error_find_next(&compare, &value, &target))) {
        struct cs_cell cell;
        struct cs_error error = {0};
        const uint32_t before = compare.cells.n;
        cs_cell_derive(&cell, near, value);
        cell.target = target;
        run_planted(&cell);
        ck_assert(!cs_cell_list_add(&compare.cells, &cell, &error));
        ck_assert_uint_eq(compare.cells.n, before + 1); // never the same one again
        ck_assert_uint_lt(++n, 1000);
    }
    return n;
}

/* Cost of a method at an error on the grid at hand: between the row that misses it and the one
 * that meets it; of the longest step where none misses it. */
static double cost_at(char series, double bound) {
    const struct cs_cell *misses = NULL;
    for (uint32_t k = 0; k < compare.cells.n; k++) {
        const struct cs_cell *cell = compare.cells.cells + k;
        if (cell->series[0] != series || strcmp(cell->outcome, "finished") != 0)
            continue;
        if (!(cell->error <= bound)) {
            misses = cell;
            continue;
        }
        if (!misses)
            return cell->cpu;
        const double part = log(bound / cell->error) / log(misses->error / cell->error);
        return cell->cpu * pow(misses->cpu / cell->cpu, part);
    }
    return HUGE_VAL;
}

/* Times without noise: intervals keep the level between comparisons and that of errors. */
static void plant_times(void) {
    struct cs_error error = {0};
    ck_assert(!cs_rounds_init(&compare.rounds, compare.cells.n, &error));
    compare.rounds.n = 9;
    for (uint32_t k = 0; k < 9 * compare.cells.n; k++)
        compare.rounds.seconds[k] = compare.cells.cells[k % compare.cells.n].cpu;
}

/* Finds the factors of the search, and what the dense grid has for the same pairs. */
struct tally {
    uint32_t factors, right, wrong_names, wide, runs;
};

static void judge(const struct planted *of, uint32_t n, struct tally *tally) {
    struct cs_ranking ranking;
    struct cs_error error = {0};
    begin(of);
    sweep(n, 1);
    tally->runs += search();
    plant_times();
    ck_assert(!cs_ranking_make(&ranking, &compare, &error));
    struct cs_cell_list found = compare.cells;
    compare.cells = (struct cs_cell_list){0};
    sweep(n, 10);
    for (uint32_t k = 0; k < ranking.n; k++) {
        const struct cs_rank *rank = ranking.ranks + k;
        const double bound = pow(10, rank->exponent);
        if (!rank->has_factor)
            continue;
        const double best = cost_at(rank->best->series[0], bound),
                     next = cost_at(rank->runner_up->series[0], bound);
        const double truth = next / best;
        tally->factors++;
        tally->right += rank->ratio.low <= truth && truth <= rank->ratio.high;
        tally->wide += rank->ratio.high / rank->ratio.low > 1.25;
        for (uint32_t m = 0; m < n; m++) {
            const char name = (char)('a' + m);
            tally->wrong_names +=
                name != rank->best->series[0] && 1.1 * cost_at(name, bound) < best;
        }
    }
    cs_ranking_finish(&ranking);
    cs_rounds_finish(&compare.rounds);
    cs_cell_list_finish(&found);
    cs_cell_list_finish(&compare.cells);
}

/* rk4 against Verlet, one step of which costs a quarter: the grids straddle every decade. */
TEST(factor_is_that_between_methods) {
    static const struct planted pair[] = {
        {.order = 2, .scale = 0.3, .limit = 0.1, .seconds = 1e-4, .evals = 1},
        {.order = 4, .scale = 2, .limit = 0.2, .seconds = 4e-4, .evals = 4}};
    struct cs_ranking ranking;
    struct cs_error error = {0};
    begin(pair);
    sweep(2, 1);
    ck_assert(!cs_ranking_make(&ranking, &compare, &error));
    for (uint32_t k = 0; k < ranking.n; k++)
        ck_assert(!ranking.ranks[k].has_factor); // rows of a sweep are at no equal error
    cs_ranking_finish(&ranking);
    ck_assert_uint_gt(search(), 5);
    ck_assert(!cs_ranking_make(&ranking, &compare, &error));
    ck_assert_uint_ge(ranking.n, 7);
    for (uint32_t k = 0; k < ranking.n; k++) {
        const struct cs_rank *rank = ranking.ranks + k;
        const double bound = pow(10, rank->exponent);
        const double steps[] = {fmax(sqrt(0.3 / bound), 10), fmax(pow(2 / bound, 0.25), 5)};
        const double costs[] = {1e-4 * steps[0], 4e-4 * steps[1]};
        const int best = costs[1] < costs[0];
        if (!rank->runner_up)
            continue;
        ck_assert(rank->has_factor);
        ck_assert_int_eq(rank->best->series[0], 'a' + best);
        const double off = log(costs[!best] / costs[best] / rank->ratio.median);
        ck_assert_msg(-rank->of[1].left - 1e-3 <= off && off <= rank->of[0].left + 1e-3,
                      "1e%d: factor %g, true %g", rank->exponent, rank->ratio.median,
                      costs[!best] / costs[best]);
        ck_assert_int_eq(rank->frugal->series[0], 'a' + best);
    }
    cs_ranking_finish(&ranking);
    cs_cell_list_finish(&compare.cells);
}

static double draw(uint64_t *state, double low, double high) {
    return low * pow(high / low, cs_rounds_draw(state, 1u << 20) / (double)(1u << 20));
}

/* 30 scenes of random methods. */
TEST(factors_are_those_of_a_dense_grid) {
    uint64_t state = 99;
    struct tally tally = {0};
    for (int scene = 0; scene < 30; scene++) {
        struct planted of[METHODS_MAX];
        for (uint32_t m = 0; m < METHODS_MAX; m++) {
            const bool adaptive = m % 3 == 2;
            of[m] = (struct planted){.order = adaptive ? 5 : 1 + cs_rounds_draw(&state, 4),
                                     .scale = draw(&state, 1e-2, 3),
                                     .limit = adaptive ? 1 : draw(&state, 0.02, 1),
                                     .seconds = draw(&state, 1e-4, 1e-3),
                                     .evals = draw(&state, 1, 8),
                                     .noise = adaptive ? 0.2 : 0,
                                     .adaptive = adaptive};
            if (adaptive)
                of[m].scale *= 10;
        }
        judge(of, METHODS_MAX, &tally);
    }
    ck_assert_uint_gt(tally.factors, 200);
    ck_assert_msg(tally.right >= 0.95 * tally.factors, "%u of %u factors", tally.right,
                  tally.factors);
    // an interval that says nothing would be right as well
    ck_assert_msg(tally.wide <= 0.1 * tally.factors, "%u of %u", tally.wide, tally.factors);
    ck_assert_msg(tally.wrong_names <= 0.01 * tally.factors, "%u of %u", tally.wrong_names,
                  tally.factors);
    ck_assert_msg(tally.runs < 8 * tally.factors, "%u runs for %u factors", tally.runs,
                  tally.factors);
}

/* Errors of 3e-7 and 6e-7 at the limit and of 0.3 beyond it: at errors in between both methods
 * cost what their limits do, to a step. */
TEST(border_of_stability_leaves_intervals_narrow) {
    static const struct planted pair[] = {
        {.order = 2,
         .scale = 7.5e-4,
         .limit = 0.02,
         .border = 1.1,
         .seconds = 1e-4,
         .evals = 1},
        {.order = 4, .scale = 0.23, .limit = 0.04, .border = 1.1, .seconds = 4e-4, .evals = 4}};
    struct cs_ranking ranking;
    struct cs_error error = {0};
    begin(pair);
    sweep(2, 1);
    search();
    plant_times();
    ck_assert(!cs_ranking_make(&ranking, &compare, &error));
    ck_assert_uint_gt(ranking.n, 5);
    for (uint32_t k = 1; k < 5; k++) {
        const struct cs_rank *rank = ranking.ranks + k;
        ck_assert(rank->has_factor);
        ck_assert_msg(rank->work.low <= 2 && 1.92 <= rank->work.high &&
                          rank->work.high < 1.1 * rank->work.low,
                      "1e%d: %g to %g", rank->exponent, rank->work.low, rank->work.high);
    }
    cs_ranking_finish(&ranking);
    cs_rounds_finish(&compare.rounds);
    cs_cell_list_finish(&compare.cells);
}

/* Errors and work of cvode-adams and dop853 on scenes/self_compare.json, which stand still at
 * three tolerances and fall afterwards, and of a method at its rounding. */
TEST(errors_that_stand_still_for_a_while_are_no_rounding) {
    static const struct {
        double error, work;
        bool rounding;
    } rows[] = {{1.69e-5, 1008, false}, {1.49e-6, 1203, false}, {1.64e-6, 1270, false},
                {1.39e-6, 1539, false}, {1.81e-7, 1564, false}, {1.14e-7, 1708, false},
                {1.08e-7, 1756, false}, {9.1e-8, 1948, false},  {2e-9, 2500, false},
                {1.9e-9, 5000, false},  {2.2e-9, 10000, false}, {2.1e-9, 20000, true}};
    struct cs_cell cells[sizeof rows / sizeof *rows];
    for (uint32_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        cs_cell_init(cells + k, "a");
        cells[k].error = rows[k].error;
        cells[k].work = rows[k].work;
        ck_assert_int_eq(cs_cell_is_rounding(cells + k, k + 1, 0.4), rows[k].rounding);
    }
}

/* A runner-up whose single time is far off is timed in rounds all the same, by its work. */
TEST(runner_up_near_by_work_is_timed) {
    for (int work = 2; work <= 4; work += 2) {
        const struct planted pair[] = {
            {.order = 2, .scale = 0.3, .limit = 1, .seconds = 1e-4, .evals = 1},
            {.order = 2, .scale = 0.3, .limit = 1, .seconds = 4e-4, .evals = work}};
        struct cs_ranking ranking;
        struct cs_error error = {0};
        begin(pair);
        sweep(2, 1);
        search();
        ck_assert(!cs_ranking_make(&ranking, &compare, &error));
        ck_assert_uint_gt(ranking.n, 3);
        for (uint32_t k = 0; k < ranking.n; k++)
            if (ranking.ranks[k].runner_up)
                ck_assert_int_eq(
                    ranking.is_contender[ranking.ranks[k].runner_up - compare.cells.cells],
                    work <= 3);
        cs_ranking_finish(&ranking);
        cs_cell_list_finish(&compare.cells);
    }
}

/* Errors that one series alone was run to have no factor: its rows there are not timed. */
TEST(series_alone_is_not_timed) {
    static const struct planted pair[] = {
        {.order = 4, .scale = 0.3, .limit = 1, .seconds = 1e-4, .evals = 4},
        {.order = 1, .scale = 0.3, .limit = 1, .seconds = 1e-4, .evals = 1}};
    struct cs_ranking ranking;
    struct cs_error error = {0};
    uint32_t alone = 0;
    begin(pair);
    sweep(2, 1);
    search();
    ck_assert(!cs_ranking_make(&ranking, &compare, &error));
    for (uint32_t k = 0; k < ranking.n; k++) {
        const struct cs_rank *rank = ranking.ranks + k;
        ck_assert_int_eq(ranking.is_contender[rank->best - compare.cells.cells],
                         rank->runner_up != NULL);
        alone += !rank->runner_up;
    }
    ck_assert_uint_gt(alone, 3);
    ck_assert_uint_gt(ranking.n, alone);
    cs_ranking_finish(&ranking);
    cs_cell_list_finish(&compare.cells);
}

/* The verdict names the row that is not at the error, and gives no number. */
TEST(no_number_without_equal_error) {
    static const struct planted pair[] = {
        {.order = 2, .scale = 0.3, .limit = 1, .seconds = 1e-4, .evals = 1},
        {.order = 4, .scale = 2, .limit = 1, .seconds = 4e-4, .evals = 4}};
    struct cs_ranking ranking;
    struct cs_error error = {0};
    struct cs_text text = {0};
    begin(pair);
    // single rows, as asked for: errors of 2.9e-4 and 3.1e-5, and Verlet's to 7.3e-5
    add('a', 1 / FPS / 32, false);
    add('a', 1 / FPS / 64, false);
    add('b', 1 / FPS / 16, false);
    ck_assert_uint_eq(search(), 0);
    ck_assert(!cs_ranking_make(&ranking, &compare, &error));
    cs_verdict_print(&ranking, "", &compare, &text);
    ck_assert_ptr_nonnull(strstr(cs_text_get(&text), "no factor: not run to that error"));
    ck_assert_ptr_nonnull(strstr(cs_text_get(&text), "down to 1e-03"));
    ck_assert_ptr_null(strstr(cs_text_get(&text), "times"));
    cs_text_finish(&text);
    cs_ranking_finish(&ranking);
    cs_cell_list_finish(&compare.cells);
}

/* Where forces cost all there is, another method is the cheapest: both are named. */
TEST(rankings_by_time_and_by_work_may_disagree) {
    static const struct planted pair[] = {
        {.order = 2, .scale = 0.3, .limit = 1, .seconds = 1e-4, .evals = 4},
        {.order = 2, .scale = 0.3, .limit = 1, .seconds = 2e-4, .evals = 1}};
    struct cs_ranking ranking;
    struct cs_error error = {0};
    struct cs_text text = {0};
    begin(pair);
    sweep(2, 1);
    search();
    ck_assert(!cs_ranking_make(&ranking, &compare, &error));
    for (uint32_t k = 0; k < ranking.n; k++) {
        if (!ranking.ranks[k].runner_up)
            continue;
        ck_assert_int_eq(ranking.ranks[k].best->series[0], 'a');
        ck_assert_int_eq(ranking.ranks[k].frugal->series[0], 'b');
        ck_assert_double_eq_tol(ranking.ranks[k].ratio.median, 2, 0.1);
    }
    cs_verdict_print(&ranking, "", &compare, &text);
    ck_assert_ptr_nonnull(strstr(cs_text_get(&text), "least work: b (dt "));
    ck_assert_ptr_nonnull(strstr(cs_text_get(&text), ", by work 0.25"));
    cs_text_finish(&text);
    cs_ranking_finish(&ranking);
    cs_cell_list_finish(&compare.cells);
}

/* The verdict: whichever rows there are, each of its sentences is true of them. */
#include "scene.h"
#include "study/compare/equal_error.h"

#include <math.h>
#include <string.h>

enum { CELLS = 11, FRAMES = 30, ROUNDS = 9 };
static const double FPS = 60;

/* Rows of every kind: two near each other, an energy that is lost, a blow-up, a step that the
 * method cut, one over budget; at a power of ten, far below it, and at one step per frame. dt
 * 0: adaptive. "cuts" takes half the work of others for its time. */
static const struct row {
    const char *series, *outcome;
    double dt, rtol, steps, error, path, energy, cpu;
} rows[CELLS] = {
    {"keeps", "finished", 1 / 60.0, 0, 30, 2e-2, 3e-2, 0.03, 1.0e-3},
    {"keeps", "finished", 1 / 120.0, 0, 60, 5e-3, 6e-3, 0.01, 2.0e-3},
    {"keeps", "over budget", 1 / 240.0, 0, 40, (double)NAN, (double)NAN, (double)NAN, 4.0e-3},
    {"loses", "finished", 1 / 60.0, 0, 30, 3e-2, 4e-2, 0.89, 0.8e-3},
    {"loses", "finished", 1 / 240.0, 0, 120, 9.9e-4, 9.9e-4, 0.3, 4.0e-3},
    {"bursts", "blew up: not finite", 1 / 60.0, 0, 3, (double)NAN, (double)NAN, (double)NAN,
     0.1e-3},
    {"bursts", "finished", 2e-3, 0, 250, 9.7e-5, 8e-3, 0.002, 4.1e-3},
    {"cuts", "finished", 1 / 60.0, 0, 55, 9.6e-4, 9.7e-4, 0.04, 4.05e-3},
    {"adapts", "finished", 0, 1e-3, 40, 9.6e-5, 1e-4, 0.001, 4.2e-3},
    {"adapts", "finished", 0, 1e-5, 90, 1e-6, 2e-6, 1e-4, 9.0e-3},
    {"adapts:order=8", "finished", 0, 1e-5, 70, 2e-6, 1e-6, 2e-4, 8.9e-3},
};

static struct cs_compare compare;
static struct cs_compare_settings settings;
static struct cs_cell cells[CELLS];

/* The rows whose bits are set, and times of rounds for all but two of them. */
static void take_rows(unsigned bits) {
    uint64_t state = 7;
    uint32_t n = 0, of[CELLS];
    settings = (struct cs_compare_settings){.run = {.frames = FRAMES}};
    compare = (struct cs_compare){.settings = &settings, .fps = FPS};
    compare.reference = (struct cs_compare_reference){
        .families_agree = true, .pointwise = true, .motion_scale = 1, .error_bar = 1e-9};
    for (uint32_t k = 0; k < CELLS; k++) {
        const struct row *row = rows + k;
        if (!(bits >> k & 1))
            continue;
        struct cs_cell *cell = cells + (of[n] = k, n);
        cs_cell_init(cell, "method");
        snprintf(cell->series, sizeof cell->series, "%s", row->series);
        snprintf(cell->control, sizeof cell->control, "%s", row->dt > 0 ? "dt" : "rtol");
        snprintf(cell->outcome, sizeof cell->outcome, "%s", row->outcome);
        cell->adaptive = !(row->dt > 0);
        cell->value = row->dt > 0 ? row->dt : row->rtol;
        cell->steps = row->steps;
        cell->step = FRAMES / FPS / row->steps;
        cell->error = row->error;
        cell->path_error = row->path;
        cell->energy_error = row->energy;
        cell->cpu = row->cpu;
        cell->work = (strcmp(row->series, "cuts") ? 1e6 : 5e5) * row->cpu;
        n++;
    }
    compare.cells.cells = cells;
    compare.cells.n = n;
    struct cs_error error = {0};
    ck_assert(!cs_rounds_init(&compare.rounds, n, &error));
    compare.rounds.n = ROUNDS;
    for (uint32_t r = 0; r < ROUNDS; r++)
        for (uint32_t i = 0; i < n; i++)
            if (of[i] % 5 != 3)
                compare.rounds.seconds[r * n + i] =
                    cells[i].cpu * (1 + 1e-4 * cs_rounds_draw(&state, 200));
}

/* The row that a sentence begins with: "SERIES (dt 2 ms)" or "SERIES (rtol 1.0e-05)". */
static const struct cs_cell *named(const char *text) {
    for (uint32_t i = 0; i < compare.cells.n; i++) {
        char name[400];
        if (cells[i].adaptive)
            snprintf(name, sizeof name, "%.99s (rtol %.1e)", cells[i].series, cells[i].value);
        else
            snprintf(name, sizeof name, "%.99s (dt %.3g ms)", cells[i].series,
                     1e3 * cells[i].step);
        if (!strncmp(text, name, strlen(name)))
            return cells + i;
    }
    ck_abort_msg("no row is called \"%s\"", text);
}

static bool finished(const struct cs_cell *cell) {
    return !strcmp(cell->outcome, "finished");
}

static bool other_series(const struct cs_cell *a, const struct cs_cell *b) {
    return strcmp(a->series, b->series) != 0;
}

/* True if a factor may rest on the row: its error is the bound, or one step a frame leaves no
 * longer one. */
static bool is_at(const struct cs_cell *cell, double bound) {
    return isinf(bound) || !(cell->error < 0.95 * bound) || cell->value >= 1 / FPS;
}

static void check_factor(const char *rest, const struct cs_cell *best, double bound,
                         const struct cs_cell **next) {
    double factor, low, high, work;
    const char *name = strstr(rest, " than "), *by_work = strstr(rest, ", by work ");
    *next = NULL;
    if (!strncmp(rest, "; no other series", 17))
        return;
    if (!strncmp(rest, "; no factor", 11)) {
        ck_assert(!is_at(named(strstr(rest, "below it: ") + 10), bound) && !by_work);
        return;
    }
    if (strstr(rest, "; not significantly different from "))
        *next = named(strstr(rest, "from ") + 5);
    else if (sscanf(rest, "; about %lf times", &factor) == 1) {
        *next = named(name + 6);
        ck_assert_double_eq_tol(factor, (*next)->cpu / best->cpu, 0.051);
        ck_assert_double_ge(factor, 1.45);
    } else {
        ck_assert_int_eq(sscanf(rest, "; %lf times (%lf to %lf)", &factor, &low, &high), 3);
        *next = named(name + 6);
        ck_assert(1 <= low && low <= factor && factor <= high);
        ck_assert_double_eq_tol(factor * best->cpu / (*next)->cpu, 1, 0.03);
    }
    ck_assert(other_series(best, *next) && finished(*next));
    ck_assert(is_at(best, bound) && is_at(*next, bound));
    ck_assert(by_work && sscanf(by_work, ", by work %lf", &work) == 1);
    ck_assert_double_eq_tol(work, (*next)->work / best->work, 0.0051);
}

/* "error below 1e-03 down to 1e-04 m: ..." returns the last decade. */
static int check_rank(const char *line, int *first) {
    int last;
    const struct cs_cell *best, *next;
    const bool no_factor = strstr(line, "; no factor");
    if (sscanf(line, "error below 1e%d down to 1e%d", first, &last) < 2)
        last = *first;
    best = named(strstr(line, ": ") + 2);
    check_factor(strchr(line, ';'), best, pow(10, no_factor ? *first : last), &next);
    ck_assert(finished(best) && best->error <= pow(10, last) * 1.000001);
    ck_assert(!next || next->error <= pow(10, last) * 1.000001);
    for (uint32_t i = 0; i < compare.cells.n; i++)
        for (int decade = *first; decade >= last; decade--) {
            if (!finished(cells + i) || !(cells[i].error <= pow(10, decade) * 1.000001))
                continue;
            ck_assert_double_ge(cells[i].cpu, best->cpu);
            ck_assert(!other_series(cells + i, best) || no_factor ||
                      (next && cells[i].cpu >= next->cpu));
        }
    return last;
}

static void check_other(const char *line, const struct cs_cell *best) {
    const struct cs_cell *other = named(strstr(line, ": ") + 2);
    ck_assert(finished(other) && other_series(other, best) && other->cpu < best->cpu);
    ck_assert(!strstr(line, "path error") || other->path_error <= best->path_error);
    ck_assert(!strstr(line, "energy error") || other->energy_error <= best->energy_error);
    ck_assert(strstr(line, "path error") || strstr(line, "energy error"));
}

static void check_frugal(const char *line, const struct cs_cell *best) {
    const struct cs_cell *other = named(strstr(line, ": ") + 2);
    ck_assert(finished(other) && other_series(other, best) && other->work < best->work);
}

static void check_frame(const char *line) {
    unsigned tried = 0, through = 0, said[2];
    const struct cs_cell *next;
    double least = HUGE_VAL;
    for (uint32_t i = 0; i < compare.cells.n; i++) {
        const bool whole =
            finished(cells + i) && !cells[i].adaptive && cells[i].steps <= FRAMES;
        tried += whole || (!cells[i].adaptive && cells[i].value >= 1 / FPS);
        through += whole;
        least = whole ? fmin(least, cells[i].energy_error) : least;
    }
    const char *rest = strchr(line, ':') + 2;
    if (!strcmp(rest, "no row has that step"))
        ck_assert_uint_eq(tried, 0);
    else if (sscanf(rest, "none of the %u row", said) == 1)
        ck_assert(said[0] == tried && through == 0);
    else if (sscanf(rest, "%u of %u rows finished", said, said + 1) == 2) {
        ck_assert(said[0] == through && said[1] == tried && least > 0.1);
        ck_assert_double_eq(named(strstr(line, ", of ") + 5)->energy_error, least);
    } else {
        const struct cs_cell *best = named(rest);
        ck_assert(finished(best) && best->energy_error <= 0.1 && strstr(rest, "error"));
        check_factor(strchr(rest, ';'), best, HUGE_VAL, &next);
        ck_assert(!next || (next->energy_error <= 0.1 && next->steps <= FRAMES));
    }
}

/* Every line, and that none is missing. */
static void check_lines(char *text) {
    int expected = -1;
    double least = HUGE_VAL;
    const struct cs_cell *best = NULL;
    bool frame = false;
    for (uint32_t i = 0; i < compare.cells.n; i++)
        least = finished(cells + i) ? fmin(least, cells[i].error) : least;
    for (char *line = strtok(text, "\n"); line; line = strtok(NULL, "\n")) {
        int first;
        if (!strncmp(line, "error", 5)) {
            best = named(strstr(line, ": ") + 2);
            const int last = check_rank(line, &first);
            ck_assert_int_eq(first, expected);
            expected = last - 1;
        } else if (!strncmp(line, "  no worse", 10))
            check_other(line, best);
        else if (!strncmp(line, "  least work", 12))
            check_frugal(line, best);
        else {
            ck_assert(!strncmp(line, "one step per frame", 18) && !frame);
            check_frame(line);
            frame = true;
        }
    }
    ck_assert(frame && (least > pow(10, expected)));
}

TEST(sentences_hold_for_every_subset) {
    for (unsigned bits = 0; bits < 1u << CELLS; bits++) {
        struct cs_ranking ranking;
        struct cs_error error = {0};
        struct cs_text text = {0};
        take_rows(bits);
        ck_assert(!cs_ranking_make(&ranking, &compare, &error));
        cs_verdict_print(&ranking, "", &compare, &text);
        check_lines(text.bytes);
        cs_text_finish(&text);
        cs_ranking_finish(&ranking);
        cs_rounds_finish(&compare.rounds);
    }
}

TEST(winner_by_another_error_is_named) {
    struct cs_ranking ranking;
    struct cs_error error = {0};
    take_rows((1u << CELLS) - 1);
    ck_assert(!cs_ranking_make(&ranking, &compare, &error));
    // 9e-5 at the end, but 8e-3 on the way there
    const struct cs_rank *rank = ranking.ranks + 3;
    ck_assert_int_eq(rank->exponent, -4);
    ck_assert_str_eq(rank->best->series, "bursts");
    ck_assert_str_eq(rank->better_by_norm[CS_NORM_PATH]->series, "keeps");
    cs_ranking_finish(&ranking);
    settings.ranking_norm = CS_NORM_PATH;
    ck_assert(!cs_ranking_make(&ranking, &compare, &error));
    ck_assert_int_eq(ranking.ranks[3].exponent, -4);
    ck_assert_str_eq(ranking.ranks[3].best->series, "adapts");
    cs_ranking_finish(&ranking);
    cs_rounds_finish(&compare.rounds);
}

/* Pairs that a common factor of each round moves, and own noise of 2 % behind it. */
static void make_times(struct cs_rounds *rounds, double factor, uint64_t *state) {
    for (uint32_t r = 0; r < rounds->n; r++) {
        const double both = 1 + 1e-3 * cs_rounds_draw(state, 2000);
        for (uint32_t k = 0; k < 2; k++) {
            double noise = 0;
            for (int i = 0; i < 12; i++)
                noise += cs_rounds_draw(state, 1u << 20) / (double)(1u << 20);
            rounds->seconds[2 * r + k] = both * (k ? factor : 1) * exp(0.02 * (noise - 6));
        }
    }
}

/* What a machine's state gives to one method in all rounds of a comparison: up to 3.5 %. */
static double drift(uint64_t *state) {
    return exp(0.035 * (cs_rounds_draw(state, 2001) / 1000.0 - 1));
}

TEST(intervals_cover_the_ratio) {
    enum { REPEATS = 400 };
    struct cs_error error = {0};
    uint64_t state = 12345;
    for (uint32_t n = 7; n <= 40; n += 11) {
        int covered = 0, wrong = 0;
        struct cs_rounds rounds;
        ck_assert(!cs_rounds_init(&rounds, 2, &error));
        rounds.n = n;
        for (int k = 0; k < REPEATS; k++) {
            struct cs_ratio ratio, back;
            make_times(&rounds, 1.05 * drift(&state), &state);
            ck_assert(cs_rounds_ratio(&rounds, 1, 0, &ratio));
            ck_assert(cs_rounds_ratio(&rounds, 0, 1, &back));
            covered += ratio.low <= 1.05 && 1.05 <= ratio.high;
            wrong += back.low > 1;
        }
        ck_assert_msg(covered >= 0.9 * REPEATS, "%u rounds: %d of %d", n, covered, REPEATS);
        ck_assert_int_eq(wrong, 0);
        cs_rounds_finish(&rounds);
    }
}

TEST(few_pairs_give_no_interval) {
    struct cs_error error = {0};
    struct cs_rounds rounds;
    struct cs_ratio ratio;
    uint64_t state = 1;
    ck_assert(!cs_rounds_init(&rounds, 2, &error));
    rounds.n = CS_TIMING_PAIRS_MIN;
    make_times(&rounds, 2, &state);
    ck_assert(cs_rounds_ratio(&rounds, 1, 0, &ratio));
    rounds.seconds[3] = (double)NAN;
    ck_assert(!cs_rounds_ratio(&rounds, 1, 0, &ratio));
    cs_rounds_finish(&rounds);
}

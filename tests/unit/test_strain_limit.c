/* Strain limiting of pairs and chains against closed forms. */
#include "model/post_step/contact_projection.h"
#include "sheet.h"

#define CHAIN                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [%d, 1], \"size\": [%d, 1]}, \"mass\": "             \
    "{\"areal_density\": 1}, \"pins\": [%s], \"strain_limit\": 1.1, \"strain_limit_sweeps\": " \
    "%d}]}"

/* passes alone, without rounds */
#define PASSES (&(struct cs_strain_limit){0})

static double length_of(const struct sheet *sheet, size_t a, size_t b) {
    double squared = 0;
    for (size_t c = 0; c < 3; c++) {
        const double d = sheet->x[c * sheet->n + b] - sheet->x[c * sheet->n + a];
        squared += d * d;
    }
    return sqrt(squared);
}

TEST(short_springs_are_left_alone) {
    static const double lengths[] = {0, 0.5, 1, 1.0999};
    struct sheet pair;
    sheet_open(&pair, 0, CHAIN, 2, 1, "", 5);
    for (size_t k = 0; k < sizeof lengths / sizeof *lengths; k++) {
        sheet_put(&pair, 0, 0, 0, 0, 1, 2, 3);
        sheet_put(&pair, 1, 0, lengths[k], 0, -4, -5, -6);
        ck_assert_uint_eq(cs_strain_limit_apply(PASSES, &pair.system, 0.1, pair.x, pair.v), 0);
        ck_assert_double_eq(pair.x[3], lengths[k]);
        ck_assert_double_eq(pair.v[0], 1);
    }
    sheet_close(&pair);
}

/* 1.5 m in a direction of length 3 become 1.1 m about the same centre. In 0.1 s that takes 4
 * m/s from the rate of lengthening, but no more than there is. */
TEST(pair_is_shortened_about_its_centre) {
    for (int fast = 0; fast < 2; fast++) {
        struct sheet pair;
        const double speed = fast ? 27 : 1, taken = fast ? 4 : speed / 3, half = 0.55 / 3;
        sheet_open(&pair, 0, CHAIN, 2, 1, "", 1);
        sheet_put(&pair, 0, -0.25, -0.5, -0.5, 0, 0, 0);
        sheet_put(&pair, 1, 0.25, 0.5, 0.5, speed, 0, 0);
        ck_assert_uint_eq(cs_strain_limit_apply(PASSES, &pair.system, 0.1, pair.x, pair.v), 1);
        SHEET_ASSERT_AT(&pair, pair.x, 0, -half, -2 * half, -2 * half, 1e-15);
        SHEET_ASSERT_AT(&pair, pair.x, 1, half, 2 * half, 2 * half, 1e-15);
        SHEET_ASSERT_AT(&pair, pair.v, 0, taken / 6, taken / 3, taken / 3, 1e-14);
        SHEET_ASSERT_AT(&pair, pair.v, 1, speed - taken / 6, -taken / 3, -taken / 3, 1e-14);
        sheet_close(&pair);
    }
}

TEST(pinned_end_stays) {
    struct sheet pair;
    sheet_open(&pair, 0, CHAIN, 2, 1, "0", 1);
    sheet_put(&pair, 0, 0, 0, 0, 0, 0, 0);
    sheet_put(&pair, 1, 2, 0, 0, 3, 0, 0);
    ck_assert_uint_eq(cs_strain_limit_apply(PASSES, &pair.system, 0.5, pair.x, pair.v), 1);
    SHEET_ASSERT_AT(&pair, pair.x, 0, 0, 0, 0, 0);
    SHEET_ASSERT_AT(&pair, pair.v, 0, 0, 0, 0, 0);
    SHEET_ASSERT_AT(&pair, pair.x, 1, 1.1, 0, 0, 1e-15);
    SHEET_ASSERT_AT(&pair, pair.v, 1, 3 - 0.9 / 0.5, 0, 0, 1e-15);
    sheet_close(&pair);

    // two pins cannot be helped
    sheet_open(&pair, 0, CHAIN, 2, 1, "0, 1", 5);
    sheet_put(&pair, 1, 9, 0, 0, 0, 0, 0);
    ck_assert_uint_eq(cs_strain_limit_apply(PASSES, &pair.system, 0.5, pair.x, pair.v), 0);
    sheet_close(&pair);
}

/* The middle particle of three is twice as heavy as the ends. Whatever passes and rounds do,
 * centre of mass and momentum are kept, because moves are along the springs. */
TEST(momentum_is_kept) {
    for (int rounds = 0; rounds < 2; rounds++) {
        double before[18];
        struct cs_strain_limit limit = {.before = rounds ? before : NULL};
        struct sheet chain;
        sheet_open(&chain, 0, CHAIN, 3, 2, "", rounds ? 1 : 7);
        const double *m = chain.system.mass;
        ck_assert_double_eq(m[1], 2 * m[0]);
        sheet_put(&chain, 0, -2, 0.5, 0, -4, 1, 0);
        sheet_put(&chain, 1, 0, 0, 1, 0, 0, 2);
        sheet_put(&chain, 2, 3, 1, -1, 5, 1, 0);
        ck_assert_uint_gt(cs_strain_limit_apply(&limit, &chain.system, 0.01, chain.x, chain.v),
                          2);
        ck_assert_double_eq(limit.missed, 0);
        const double centre[3] = {1, 1.5, 1}, moves[3] = {1, 2, 4};
        for (size_t c = 0; c < 3; c++) {
            double first = 0, momentum = 0;
            for (size_t i = 0; i < 3; i++) {
                first += m[i] / m[0] * chain.x[3 * c + i];
                momentum += m[i] / m[0] * chain.v[3 * c + i];
            }
            ck_assert_double_eq_tol(first, centre[c], 1e-13);
            ck_assert_double_eq_tol(momentum, moves[c], 1e-13);
        }
        sheet_close(&chain);
    }
}

/* A chain just below its limit, pulled at its far end: the first pass runs towards that end and
 * moves its last spring only, the second runs back and hands the pull on to the near end. */
TEST(every_other_sweep_runs_backwards) {
    for (int sweeps = 1; sweeps <= 2; sweeps++) {
        struct sheet chain;
        sheet_open(&chain, 0, CHAIN, 5, 4, "", sweeps);
        for (size_t i = 0; i < 5; i++)
            sheet_put(&chain, i, 1.0999 * (double)i + (i == 4 ? 0.5 : 0), 0, 0, 0, 0, 0);
        const uint64_t moves =
            cs_strain_limit_apply(PASSES, &chain.system, 1, chain.x, chain.v);
        ck_assert_uint_eq(moves, sweeps == 1 ? 1 : 4);
        ck_assert(chain.x[4] < 4 * 1.0999 + 0.5);
        ck_assert(chain.x[3] > 3 * 1.0999);
        for (size_t i = 0; i < 3; i++)
            ck_assert((chain.x[i] > 1.0999 * (double)i) == (sweeps == 2));
        sheet_close(&chain);
    }
}

/* With enough passes no spring is too long, and a pass that finds nothing is the last. */
TEST(enough_sweeps_hold_the_chain) {
    struct sheet chain;
    sheet_open(&chain, 0, CHAIN, 6, 5, "0", 10000);
    for (size_t i = 0; i < 6; i++)
        sheet_put(&chain, i, 2 * (double)i, 0.3 * (double)(i * i), 0, 0, 0, 0);
    ck_assert_uint_lt(cs_strain_limit_apply(PASSES, &chain.system, 1, chain.x, chain.v), 50000);
    for (size_t i = 0; i + 1 < 6; i++)
        ck_assert_double_le(length_of(&chain, i, i + 1), 1.1 * (1 + 1e-15));
    SHEET_ASSERT_AT(&chain, chain.x, 0, 0, 0, 0, 0);
    sheet_close(&chain);
}

/* a square sheared flat: its sides are as they were, one diagonal far too long */
TEST(only_stretch_springs_are_limited) {
    struct sheet square;
    sheet_open(&square, 0,
               "{\"bodies\": [{\"cloth\": {\"grid\": [2, 2]}, \"mass\": {\"total\": 1},"
               " \"strain_limit\": 1.1}]}");
    static const double x[4] = {0, 1, 0.8, 1.8}, y[4] = {0, 0, -0.6, -0.6};
    for (size_t i = 0; i < 4; i++)
        sheet_put(&square, i, x[i], y[i], 0, 0, 0, 0);
    ck_assert_double_gt(length_of(&square, 0, 3), 1.1 * sqrt(2));
    ck_assert_uint_eq(cs_strain_limit_apply(PASSES, &square.system, 1, square.x, square.v), 0);
    sheet_close(&square);
}

/* each body has its own limit, or none */
TEST(limit_belongs_to_a_body) {
    struct sheet two;
    sheet_open(&two, 0,
               "{\"bodies\": [{\"cloth\": {\"grid\": [2, 1]}, \"mass\": {\"total\": 1}},"
               " {\"cloth\": {\"grid\": [2, 1]}, \"mass\": {\"total\": 1},"
               " \"strain_limit\": 1.5, \"strain_limit_sweeps\": 1}]}");
    for (size_t i = 0; i < 4; i++)
        sheet_put(&two, i, i % 2 ? 3 : 0, 0, 0, 0, 0, 0);
    ck_assert_uint_eq(cs_strain_limit_apply(PASSES, &two.system, 1, two.x, two.v), 1);
    ck_assert_double_eq(length_of(&two, 0, 1), 3);
    ck_assert_double_eq_tol(length_of(&two, 2, 3), 1.5, 1e-15);
    sheet_close(&two);
}

/* Largest length of a spring of a square grid of unit springs. */
static double longest_of(const struct sheet *sheet, size_t side) {
    double longest = 0;
    for (size_t i = 0; i < side * side; i++) {
        if ((i + 1) % side)
            longest = fmax(longest, length_of(sheet, i, i + 1));
        if (i + side < side * side)
            longest = fmax(longest, length_of(sheet, i, i + side));
    }
    return longest;
}

/* Sheets that hang from two corners and are 30 % too long, of springs of 1 m, and one of a
 * mesh: rounds meet the limit whatever the grid, ten passes do not. */
TEST(rounds_meet_the_limit_on_any_grid) {
    static const size_t sides[] = {10, 24, 40};
    for (size_t k = 0; k < 3; k++) {
        static double before[6 * 40 * 40];
        const size_t side = sides[k];
        struct cs_strain_limit limit = {before, 0};
        for (int rounds = 0; rounds < 2; rounds++) {
            struct sheet sheet;
            sheet_open(
                &sheet, 0,
                "{\"bodies\": [{\"cloth\": {\"grid\": [%zu, %zu], \"size\": [%zu, %zu]}, "
                "\"mass\": {\"areal_density\": 1}, \"pins\": [\"top-left\", "
                "\"top-right\"], \"strain_limit\": 1.05}]}",
                side, side, side - 1, side - 1);
            for (size_t i = 0; i < side * side; i++)
                sheet.x[side * side + i] *= 1.3;
            cs_strain_limit_apply(rounds ? &limit : PASSES, &sheet.system, 0.01, sheet.x,
                                  sheet.v);
            const double longest = longest_of(&sheet, side) / 1.05 - 1;
            if (rounds)
                ck_assert_double_le(longest, CS_STRAIN_LIMIT_TOLERANCE * (1 + 1e-12));
            else
                ck_assert_double_gt(longest, 0.05);
            sheet_close(&sheet);
        }
        ck_assert_double_eq(limit.missed, 0);
    }
}

/* A chain that falls off its limit at rest: gravity adds the same velocity each step, and the
 * limit takes as much, so that velocities are those of positions: 0. */
TEST(velocities_fit_positions_at_rest) {
    const double dt = 1e-3, g = 9.81;
    double before[6 * 6];
    struct cs_strain_limit limit = {before, 0};
    struct sheet chain;
    sheet_open(&chain, 0, CHAIN, 6, 5, "0", 10);
    for (size_t i = 0; i < 6; i++)
        sheet_put(&chain, i, 0, -1.1 * (double)i, 0, 0, 0, 0);
    for (int step = 0; step < 500; step++) {
        for (size_t i = 7; i < 12; i++) {
            chain.v[i] -= g * dt;
            chain.x[i] += dt * chain.v[i];
        }
        cs_strain_limit_apply(&limit, &chain.system, dt, chain.x, chain.v);
    }
    for (size_t i = 7; i < 12; i++) {
        ck_assert_double_le(fabs(chain.v[i]), 1e-2);
        ck_assert_double_eq_tol(chain.x[i], -1.1 * (double)(i - 6), 1.1e-3 * 6);
    }
    sheet_close(&chain);
}

/* one spring by the formula of the manual's section on theory; true if it was too long */
static bool shorten(struct sheet *sheet, size_t a, size_t b, double longest) {
    const size_t n = sheet->n;
    double d[3], squared = 0, rate = 0;
    for (size_t c = 0; c < 3; c++) {
        d[c] = sheet->x[c * n + b] - sheet->x[c * n + a];
        squared += d[c] * d[c];
        rate += d[c] * (sheet->v[c * n + b] - sheet->v[c * n + a]);
    }
    const double wa = sheet->system.inv_mass[a], wb = sheet->system.inv_mass[b];
    if (squared <= longest * longest || wa + wb == 0)
        return false;
    const double share = (1 - longest / sqrt(squared)) / (wa + wb);
    const double v_share = fmin(share * (1 / 0.1), fmax(rate, 0) / (squared * (wa + wb)));
    for (size_t c = 0; c < 3; c++) {
        const size_t i = c * n + a, j = c * n + b;
        sheet->x[i] += wa * share * d[c];
        sheet->v[i] += wa * v_share * d[c];
        sheet->x[j] += -wb * share * d[c];
        sheet->v[j] += -wb * v_share * d[c];
    }
    return true;
}

/* the springs along all rows */
static uint64_t shorten_along(struct sheet *sheet, size_t first, size_t columns, bool backwards,
                              double longest) {
    uint64_t moves = 0;
    for (size_t row = first; row < sheet->n; row += columns)
        for (size_t k = 0; k + 1 < columns; k++) {
            const size_t i = row + (backwards ? columns - 2 - k : k);
            moves += shorten(sheet, i, i + 1, longest);
        }
    return moves;
}

/* the springs from row to row */
static uint64_t shorten_down(struct sheet *sheet, size_t first, size_t columns, bool backwards,
                             double longest) {
    const size_t springs = sheet->n - first - columns;
    uint64_t moves = 0;
    for (size_t k = 0; k < springs; k++) {
        const size_t i = first + (backwards ? springs - 1 - k : k);
        moves += shorten(sheet, i, i + columns, longest);
    }
    return moves;
}

static uint64_t pass(struct sheet *sheet, size_t first, size_t columns, bool backwards,
                     double longest) {
    uint64_t moves = backwards ? shorten_down(sheet, first, columns, true, longest) : 0;
    moves += shorten_along(sheet, first, columns, backwards, longest);
    return moves + (backwards ? 0 : shorten_down(sheet, first, columns, false, longest));
}

/* The same bits as one spring after the other in the stated order, whatever the numbers of
 * columns and rows leave for the ends of vectors and strips, and with pinned particles. */
TEST(order_is_the_stated_one) {
    static const size_t sizes[][2] = {{2, 1}, {1, 9}, {3, 5}, {16, 17}, {17, 16}, {37, 20}};
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        const size_t columns = sizes[k][0], rows = sizes[k][1];
        struct sheet sheets[2];
        uint64_t moves = 0;
        for (int s = 0; s < 2; s++) {
            sheet_open(
                sheets + s, 0,
                "{\"bodies\": [{\"cloth\": {\"grid\": [2, 2]}, \"mass\": {\"total\": 1}},"
                " {\"cloth\": {\"grid\": [%zu, %zu], \"size\": [%zu, %zu]},"
                " \"mass\": {\"areal_density\": 1}, \"pins\": [1],"
                " \"strain_limit\": 1.02, \"strain_limit_sweeps\": 3}]}",
                columns, rows, columns - (columns > 1), rows - (rows > 1));
            sheet_stir(sheets + s, 0.2, 1);
        }
        ck_assert_mem_eq(sheets[0].x, sheets[1].x, 6 * sizeof(double) * sheets[0].n);
        const uint64_t by_library =
            cs_strain_limit_apply(PASSES, &sheets[0].system, 0.1, sheets[0].x, sheets[0].v);
        struct sheet *by_hand = sheets + 1;
        for (int p = 0; p < 3; p++)
            moves += pass(by_hand, 4, columns, p % 2, 1.02);
        ck_assert(moves > 0 || rows == 1);
        ck_assert_uint_eq(by_library, moves);
        ck_assert_mem_eq(sheets[0].x, sheets[1].x, 6 * sizeof(double) * sheets[0].n);
        sheet_close(sheets);
        sheet_close(sheets + 1);
    }
}

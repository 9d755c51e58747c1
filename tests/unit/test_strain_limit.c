/* Strain limiting of pairs and chains against closed forms. */
#include "model/post_step/contact_projection.h"
#include "sheet.h"

#define CHAIN                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [%d, 1], \"size\": [%d, 1]}, \"mass\": "             \
    "{\"areal_density\": 1}, \"pins\": [%s], \"strain_limit\": 1.1, \"strain_limit_sweeps\": " \
    "%d}]}"

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
        ck_assert_uint_eq(cs_strain_limit_apply(&pair.system, 0.1, pair.x, pair.v), 0);
        ck_assert_double_eq(pair.x[3], lengths[k]);
        ck_assert_double_eq(pair.v[0], 1);
    }
    sheet_close(&pair);
}

/* 1.5 m in a direction of length 3 become 1.1 m about the same centre; each velocity changes by
 * its move over dt */
TEST(pair_is_shortened_about_its_centre) {
    struct sheet pair;
    sheet_open(&pair, 0, CHAIN, 2, 1, "", 1);
    sheet_put(&pair, 0, -0.25, -0.5, -0.5, 0, 0, 0);
    sheet_put(&pair, 1, 0.25, 0.5, 0.5, 1, 0, 0);
    ck_assert_uint_eq(cs_strain_limit_apply(&pair.system, 0.1, pair.x, pair.v), 1);
    const double half = 0.55 / 3, moved = 0.2 / 3;
    SHEET_ASSERT_AT(&pair, pair.x, 0, -half, -2 * half, -2 * half, 1e-15);
    SHEET_ASSERT_AT(&pair, pair.x, 1, half, 2 * half, 2 * half, 1e-15);
    SHEET_ASSERT_AT(&pair, pair.v, 0, moved / 0.1, 2 * moved / 0.1, 2 * moved / 0.1, 1e-14);
    SHEET_ASSERT_AT(&pair, pair.v, 1, 1 - moved / 0.1, -2 * moved / 0.1, -2 * moved / 0.1,
                    1e-14);
    sheet_close(&pair);
}

TEST(pinned_end_stays) {
    struct sheet pair;
    sheet_open(&pair, 0, CHAIN, 2, 1, "0", 1);
    sheet_put(&pair, 0, 0, 0, 0, 0, 0, 0);
    sheet_put(&pair, 1, 2, 0, 0, 0, 0, 0);
    ck_assert_uint_eq(cs_strain_limit_apply(&pair.system, 0.5, pair.x, pair.v), 1);
    SHEET_ASSERT_AT(&pair, pair.x, 0, 0, 0, 0, 0);
    SHEET_ASSERT_AT(&pair, pair.v, 0, 0, 0, 0, 0);
    SHEET_ASSERT_AT(&pair, pair.x, 1, 1.1, 0, 0, 1e-15);
    SHEET_ASSERT_AT(&pair, pair.v, 1, -0.9 / 0.5, 0, 0, 1e-15);
    sheet_close(&pair);

    // two pins cannot be helped
    sheet_open(&pair, 0, CHAIN, 2, 1, "0, 1", 5);
    sheet_put(&pair, 1, 9, 0, 0, 0, 0, 0);
    ck_assert_uint_eq(cs_strain_limit_apply(&pair.system, 0.5, pair.x, pair.v), 0);
    sheet_close(&pair);
}

/* The middle particle of three is twice as heavy as the ends. Whatever the sweeps do, centre of
 * mass and momentum are kept, and angular momentum too: moves are along the springs, and with
 * v = 0 before the velocities are the moves over dt. */
TEST(momentum_is_kept) {
    struct sheet chain;
    sheet_open(&chain, 0, CHAIN, 3, 2, "", 7);
    const double *m = chain.system.mass;
    ck_assert_double_eq(m[1], 2 * m[0]);
    sheet_put(&chain, 0, -2, 0.5, 0, 0, 0, 0);
    sheet_put(&chain, 1, 0, 0, 1, 0, 0, 0);
    sheet_put(&chain, 2, 3, 1, -1, 0, 0, 0);
    ck_assert_uint_gt(cs_strain_limit_apply(&chain.system, 0.01, chain.x, chain.v), 2);
    const double centre[3] = {1, 1.5, 1};
    for (size_t c = 0; c < 3; c++) {
        double first = 0, momentum = 0;
        for (size_t i = 0; i < 3; i++) {
            first += m[i] / m[0] * chain.x[3 * c + i];
            momentum += m[i] * chain.v[3 * c + i];
        }
        ck_assert_double_eq_tol(first, centre[c], 1e-14);
        ck_assert_double_eq_tol(momentum, 0, 1e-13);
    }
    sheet_close(&chain);
}

/* A chain just below its limit, pulled at its far end: the first pass runs towards that end and
 * moves its last spring only, the second runs back and hands the pull on to the near end. */
TEST(every_other_sweep_runs_backwards) {
    for (int sweeps = 1; sweeps <= 2; sweeps++) {
        struct sheet chain;
        sheet_open(&chain, 0, CHAIN, 5, 4, "", sweeps);
        for (size_t i = 0; i < 5; i++)
            sheet_put(&chain, i, 1.0999 * (double)i + (i == 4 ? 0.5 : 0), 0, 0, 0, 0, 0);
        const uint64_t moves = cs_strain_limit_apply(&chain.system, 1, chain.x, chain.v);
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
    ck_assert_uint_lt(cs_strain_limit_apply(&chain.system, 1, chain.x, chain.v), 50000);
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
    ck_assert_uint_eq(cs_strain_limit_apply(&square.system, 1, square.x, square.v), 0);
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
    ck_assert_uint_eq(cs_strain_limit_apply(&two.system, 1, two.x, two.v), 1);
    ck_assert_double_eq(length_of(&two, 0, 1), 3);
    ck_assert_double_eq_tol(length_of(&two, 2, 3), 1.5, 1e-15);
    sheet_close(&two);
}

/* one spring by the formula of the manual's section on theory; true if it was too long */
static bool shorten(struct sheet *sheet, size_t a, size_t b, double longest) {
    const size_t n = sheet->n;
    double d[3], squared = 0;
    for (size_t c = 0; c < 3; c++) {
        d[c] = sheet->x[c * n + b] - sheet->x[c * n + a];
        squared += d[c] * d[c];
    }
    const double wa = sheet->system.inv_mass[a], wb = sheet->system.inv_mass[b];
    if (squared <= longest * longest || wa + wb == 0)
        return false;
    const double share = (1 - longest / sqrt(squared)) / (wa + wb);
    for (size_t c = 0; c < 3; c++) {
        const size_t i = c * n + a, j = c * n + b;
        sheet->x[i] += wa * share * d[c];
        sheet->v[i] += wa * share * d[c] * (1 / 0.1);
        sheet->x[j] += -wb * share * d[c];
        sheet->v[j] += -wb * share * d[c] * (1 / 0.1);
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
            cs_strain_limit_apply(&sheets[0].system, 0.1, sheets[0].x, sheets[0].v);
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

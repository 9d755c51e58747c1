/* Distances against a search over all points of both sides, and moves against the time at which
 * they close. */
#include "model/contact/ccd/accd.h"
#include "unit.h"

#include <math.h>

static double random_real(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) * 0x1p-52 - 1;
}

static void points(uint64_t *state, double size, double p[4][3]) {
    for (int k = 0; k < 4; k++)
        for (int c = 0; c < 3; c++)
            p[k][c] = size * random_real(state);
}

static double sampled(enum cs_pair_kind kind, const double p[4][3], int cuts) {
    double least = HUGE_VAL;
    for (int i = 0; i <= cuts; i++)
        for (int j = 0; j <= (kind == CS_PAIR_POINT_TRIANGLE ? cuts - i : cuts); j++) {
            const double s = i / (double)cuts, t = j / (double)cuts;
            double sum = 0;
            for (int c = 0; c < 3; c++) {
                const double r =
                    kind == CS_PAIR_POINT_TRIANGLE
                        ? p[0][c] - p[1][c] - s * (p[2][c] - p[1][c]) - t * (p[3][c] - p[1][c])
                        : p[0][c] + s * (p[1][c] - p[0][c]) - p[2][c] - t * (p[3][c] - p[2][c]);
                sum += r * r;
            }
            least = fmin(least, sum);
        }
    return sqrt(least);
}

/* never above what a sample has, and no further below than two samples lie apart */
TEST(distances_are_the_least_ones) {
    uint64_t state = 5;
    for (int round = 0; round < 600; round++) {
        const enum cs_pair_kind kind = round % 2 ? CS_PAIR_POINT_TRIANGLE : CS_PAIR_EDGE_EDGE;
        double p[4][3];
        points(&state, 1, p);
        // flat and near parallel ones among them
        if (round % 3 == 0)
            for (int c = 0; c < 3; c++)
                p[3][c] = p[2][c] + (p[1][c] - p[0][c]) + (round % 9 ? 1e-8 * p[3][c] : 0);
        const double d = sqrt(cs_exact_distance_squared(kind, (const double(*)[3])p));
        const double near = sampled(kind, (const double(*)[3])p, 60);
        UNIT_ASSERT_OFTEN(d <= near + 1e-9);
        UNIT_ASSERT_OFTEN(d >= near - 3.5 / 60);
    }
}

/* two edges that cross at a small angle touch, however parallel they are */
TEST(nearly_parallel_edges_touch) {
    for (double angle = 0.1; angle > 1e-12; angle /= 10) {
        const double p[4][3] = {{-1, 0, 0}, {1, 0, 0}, {-1, -angle, 0}, {1, angle, 0}};
        ck_assert_double_le(sqrt(cs_exact_distance_squared(CS_PAIR_EDGE_EDGE, p)),
                            1e-3 * angle);
    }
}

/* A point straight at a triangle, and two edges at each other: the share is below that at which
 * they touch, and not by more than a tenth of the way. Moving all of it along changes nothing.
 */
TEST(shares_are_below_the_touch) {
    static const double flat[3][3] = {{-1, -1, 0}, {1, -1, 0}, {0, 2, 0}};
    for (double past = 0.01; past < 20; past *= 3)
        for (int moved = 0; moved < 2; moved++) {
            double p[4][3] = {{0.1, 0.1, 0.5}}, moves[4][3] = {{0, 0, -0.5 - past}};
            memcpy(p + 1, flat, sizeof flat);
            for (int k = 0; k < 4; k++)
                moves[k][0] += moved;
            const double touch = 0.5 / (0.5 + past);
            const double share = cs_accd_safe_fraction(
                CS_PAIR_POINT_TRIANGLE, (const double(*)[3])p, (const double(*)[3])moves, 1);
            ck_assert_double_lt(share, touch);
            ck_assert_double_gt(share, 0.89 * touch);
            const double edges[4][3] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0.5}, {0, 1, 0.5}};
            const double towards[4][3] = {
                {0, 0, 0}, {0, 0, 0}, {0, 0, -0.5 - past}, {0, 0, -0.5 - past}};
            const double other = cs_accd_safe_fraction(CS_PAIR_EDGE_EDGE, edges, towards, 1);
            ck_assert_double_lt(other, touch);
            ck_assert_double_gt(other, 0.89 * touch);
        }
}

/* moves of all kinds: at no moment up to the share is a pair closed that was open */
TEST(nothing_is_closed_up_to_the_share) {
    uint64_t state = 11;
    int cut = 0;
    for (int round = 0; round < 4000; round++) {
        const enum cs_pair_kind kind = round % 2 ? CS_PAIR_POINT_TRIANGLE : CS_PAIR_EDGE_EDGE;
        double p[4][3], moves[4][3], at[4][3];
        points(&state, 1, p);
        points(&state, 1.5, moves);
        const double share =
            cs_accd_safe_fraction(kind, (const double(*)[3])p, (const double(*)[3])moves, 1);
        cut += share < 1;
        for (int i = 0; i <= 20; i++) {
            for (int k = 0; k < 4; k++)
                for (int c = 0; c < 3; c++)
                    at[k][c] = p[k][c] + share * i / 20 * moves[k][c];
            UNIT_ASSERT_OFTEN(cs_exact_distance_squared(kind, (const double(*)[3])at) > 0);
        }
        UNIT_ASSERT_OFTEN(cs_accd_safe_fraction(kind, (const double(*)[3])p,
                                                (const double(*)[3])moves,
                                                0.5 * share) == 0.5 * share);
    }
    ck_assert_int_gt(cut, 300);
}

TEST(touching_pairs_may_not_move) {
    const double p[4][3] = {{0, 0, 0}, {-1, -1, 0}, {1, -1, 0}, {0, 2, 0}};
    double moves[4][3] = {{0, 0, 1}};
    ck_assert_double_eq(
        cs_accd_safe_fraction(CS_PAIR_POINT_TRIANGLE, p, (const double(*)[3])moves, 1), 0);
    moves[0][2] = 0;
    ck_assert_double_eq(
        cs_accd_safe_fraction(CS_PAIR_POINT_TRIANGLE, p, (const double(*)[3])moves, 1), 1);
    moves[0][2] = (double)NAN;
    ck_assert_double_eq(
        cs_accd_safe_fraction(CS_PAIR_POINT_TRIANGLE, p, (const double(*)[3])moves, 1), 1);
}

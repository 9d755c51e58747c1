/* The distance filter of single precision: it holds nothing back that is near, however bad the
 * shapes are, and lets little through that is far. */
#include "base/vec3.h"
#include "model/contact/broad_phase/distance_filter.h"
#include "model/contact/ccd/accd.h"
#include "unit.h"

#include <math.h>
#include <string.h>

enum { ROUNDS = 1500, LANES = 8, POINTS = 4 * LANES };

/* a number in -1..1, always the same ones */
static double draw(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) / 4503599627370496.0 - 1;
}

/* The points of a pair, of size 1: any, slivers or edges almost parallel, and what has no area
 * or length at all. */
static void shape(uint64_t *state, uint64_t choice, double p[4][3]) {
    static const double thin[] = {1, 1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-9, 0};
    const double flat = thin[choice % 8], share = draw(state);
    for (int k = 0; k < 4; k++)
        for (int c = 0; c < 3; c++)
            p[k][c] = draw(state);
    for (int c = 0; c < 3; c++)
        p[3][c] = p[2][c] + share * (p[1][c] - p[choice / 8 % 2 ? 2 : 0][c]) + flat * p[3][c];
}

/* moves them to each other, a place of one to a little beside a place of the other */
static void approach(uint64_t *state, uint64_t choice, bool edges, double p[4][3]) {
    static const double gaps[] = {1, 1e-1, 1e-3, 1e-5, 1e-7};
    const double gap = gaps[choice / 16 % 5];
    const double s = 0.6 * draw(state) + 0.5, t = 0.6 * draw(state) + 0.5;
    for (int c = 0; c < 3; c++) {
        const double one = edges ? p[0][c] + s * (p[1][c] - p[0][c]) : p[0][c];
        const double other =
            edges ? p[2][c] + t * (p[3][c] - p[2][c])
                  : p[1][c] + s * (p[2][c] - p[1][c]) + t * (1 - s) * (p[3][c] - p[1][c]);
        const double move = one - other + gap * draw(state);
        for (int k = edges ? 2 : 1; k < 4; k++)
            p[k][c] += move;
    }
}

/* eight pairs, and their squared distances in m2 */
struct eight {
    double p[LANES][4][3], squared[LANES];
};

/* Triangles within sin^2 = 1e-10 are their edges: a foot in their plane is rounding alone. */
static double squared_of(enum cs_pair_kind kind, double p[4][3]) {
    double u[3], v[3], least = HUGE_VAL;
    for (int c = 0; c < 3; c++)
        u[c] = p[2][c] - p[1][c], v[c] = p[3][c] - p[1][c];
    const double a = cs_vec3_dot(u, u), b = cs_vec3_dot(u, v), c = cs_vec3_dot(v, v);
    if (kind == CS_PAIR_EDGE_EDGE || a * c - b * b > 1e-10 * a * c)
        return cs_exact_distance_squared(kind, (const double(*)[3])p);
    for (int k = 0; k < 3; k++) {
        double q[4][3];
        memcpy(q[0], p[0], sizeof q[0]);
        for (int j = 0; j < 3; j++)
            memcpy(q[1 + j], p[1 + (k + (j > 0)) % 3], sizeof q[0]);
        least = fmin(least, cs_exact_distance_squared(kind, (const double(*)[3])q));
    }
    return least;
}

/* eight pairs `away` from the origin, which is what all places are against; scaled */
static void fill(uint64_t *state, bool edges, double away, double scale, double *x,
                 struct eight *lanes) {
    const size_t n = 1 + POINTS;
    for (size_t c = 0; c < 3; c++)
        x[c * n] = 0;
    for (int l = 0; l < LANES; l++) {
        double p[4][3];
        const uint64_t choice = *state >> 40;
        shape(state, choice, p);
        approach(state, choice, edges, p);
        for (size_t k = 0; k < 4; k++)
            for (size_t c = 0; c < 3; c++) {
                double *at = x + c * n + 1 + 4 * (size_t)l + k;
                *at = scale * (p[k][c] + (c == 1 ? away : 0));
                lanes->p[l][k][c] = *at;
            }
    }
}

/* Which of eight pairs it lets through, as bits, with a reach of `share` of their distances. */
static uint32_t sift(const double *x, double scale, bool edges, double share,
                     const struct eight *lanes) {
    static struct cs_distance_filter filter;
    struct cs_scaled_point points[1 + POINTS];
    uint32_t bits = 0;
    cs_distance_filter_scale_points(x, 1 + POINTS, 1 / scale, 0, 1 + POINTS, points);
    for (uint32_t l = 0; l < LANES; l++) {
        const uint32_t at[4] = {1 + 4 * l, 2 + 4 * l, 3 + 4 * l, 4 + 4 * l};
        cs_distance_filter_add(&filter, points, at, share * sqrt(lanes->squared[l]) / scale,
                               (const uint32_t[2]){l, l + 1});
    }
    const uint32_t kept =
        cs_distance_filter_run(edges ? CS_PAIR_EDGE_EDGE : CS_PAIR_POINT_TRIANGLE, &filter);
    for (uint32_t k = 0; k < kept; k++) {
        UNIT_ASSERT_OFTEN(filter.pairs[k][1] == filter.pairs[k][0] + 1);
        bits |= 1u << filter.pairs[k][0];
    }
    return bits;
}

/* the squares of all six lengths between a pair's points */
static double size(const struct eight *lanes, int l) {
    double squared = 0;
    for (int k = 0; k < 4; k++)
        for (int j = 0; j < k; j++)
            for (int c = 0; c < 3; c++)
                squared += (lanes->p[l][k][c] - lanes->p[l][j][c]) *
                           (lanes->p[l][k][c] - lanes->p[l][j][c]);
    return squared;
}

/* those further away than the reach and what is allowed for rounding, as bits */
static uint32_t far_ones(const struct eight *lanes, double share, double away) {
    uint32_t bits = 0;
    for (int l = 0; l < LANES; l++)
        if (lanes->squared[l] > 1.03 * share * share * lanes->squared[l] +
                                    5e-4 * size(lanes, l) + 2e-10 * away * away)
            bits |= 1u << l;
    return bits;
}

/* near: all of them; at a share of their distance: none that is far */
static void check(bool edges, double away, double scale) {
    uint64_t state = 1;
    int far = 0;
    for (int round = 0; round < ROUNDS; round++) {
        struct eight lanes;
        double x[3 * (1 + POINTS)];
        fill(&state, edges, away, scale, x, &lanes);
        for (int l = 0; l < LANES; l++)
            lanes.squared[l] =
                squared_of(edges ? CS_PAIR_EDGE_EDGE : CS_PAIR_POINT_TRIANGLE, lanes.p[l]);
        UNIT_ASSERT_OFTEN(sift(x, scale, edges, 1, &lanes) == (1u << LANES) - 1);
        const uint32_t bits = far_ones(&lanes, 0.8, scale * away);
        UNIT_ASSERT_OFTEN(!(sift(x, scale, edges, 0.8, &lanes) & bits));
        far += __builtin_popcount(bits);
    }
    // so far away that rounding leaves little
    ck_assert(away > 1e4 || far > ROUNDS);
}

TEST(nothing_near_is_held_back) {
    for (int edges = 0; edges < 2; edges++) {
        check(edges, 0, 1);
        check(edges, 300, 1);
        check(edges, 5e3, 1e-3);
        check(edges, 1e6, 1);
        check(edges, 0, 1e-12);
        check(edges, 0, 1e12);
    }
}

/* places that are not finite are let through: who asks next is to see them */
TEST(not_finite_is_let_through) {
    static const double bad[] = {(double)NAN, HUGE_VAL, -HUGE_VAL};
    for (int edges = 0; edges < 2; edges++)
        for (size_t k = 0; k < 12; k++) {
            static struct cs_distance_filter filter;
            struct cs_scaled_point points[5];
            double x[15] = {0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 9, 5, 5, 5};
            x[5 * (k % 3) + 1 + k / 3] = bad[k % 3];
            cs_distance_filter_scale_points(x, 5, 1, 0, 5, points);
            cs_distance_filter_add(&filter, points, (const uint32_t[4]){1, 2, 3, 4}, 0.1,
                                   (const uint32_t[2]){0, 1});
            ck_assert_uint_eq(cs_distance_filter_run(
                                  edges ? CS_PAIR_EDGE_EDGE : CS_PAIR_POINT_TRIANGLE, &filter),
                              1);
        }
}

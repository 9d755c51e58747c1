/* Signs of determinants, and edges through triangles, against whole numbers of 128 bits. */
#include "model/contact/ccd/edge_triangle.h"
#include "unit.h"

#include <math.h>
#include <stdint.h>

__extension__ typedef __int128 wide;

enum { ROUNDS = 60000 };

/* whole numbers in -most..most, from a generator of its own (Lehmer 1949) */
static int64_t whole(uint64_t *state, int64_t most) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (int64_t)((*state >> 11) % (uint64_t)(2 * most + 1)) - most;
}

static void points(uint64_t *state, int64_t most, size_t n, int64_t p[][3]) {
    for (size_t i = 0; i < n; i++)
        for (int c = 0; c < 3; c++)
            p[i][c] = whole(state, most);
}

static int sign_of(wide value) {
    return (value > 0) - (value < 0);
}

static int orient_wide(const wide a[3], const wide b[3], const wide c[3], const wide d[3]) {
    wide u[3], v[3], w[3];
    for (int k = 0; k < 3; k++)
        u[k] = a[k] - d[k], v[k] = b[k] - d[k], w[k] = c[k] - d[k];
    return sign_of(u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
                   u[2] * (v[0] * w[1] - v[1] * w[0]));
}

static void to_doubles(const int64_t p[3], double scale, double out[3]) {
    for (int c = 0; c < 3; c++)
        out[c] = (double)p[c] * scale;
}

/* points beside a plane, far from the origin: determinants that rounding turns round */
TEST(signs_of_points_beside_a_plane) {
    uint64_t state = 1;
    int rounded_wrong = 0, zeros = 0;
    for (int round = 0; round < ROUNDS; round++) {
        int64_t p[4][3];
        wide exact[4][3];
        double x[4][3];
        points(&state, 1 << 20, 3, p);
        const int64_t s = whole(&state, 500), t = whole(&state, 500);
        for (int c = 0; c < 3; c++)
            p[3][c] = p[0][c] + s * (p[1][c] - p[0][c]) + t * (p[2][c] - p[0][c]);
        p[3][round % 3] += whole(&state, 1);
        for (int k = 0; k < 4; k++)
            for (int c = 0; c < 3; c++) {
                p[k][c] += ((int64_t)1 << 45) / (c + 3);
                exact[k][c] = p[k][c];
            }
        for (int k = 0; k < 4; k++)
            to_doubles(p[k], 0x1p-30, x[k]);
        const int sign = orient_wide(exact[0], exact[1], exact[2], exact[3]);
        UNIT_ASSERT_OFTEN(cs_orient3d(x[0], x[1], x[2], x[3]) == sign);
        // an exchange of two turns the sign
        UNIT_ASSERT_OFTEN(cs_orient3d(x[1], x[0], x[2], x[3]) == -sign);
        UNIT_ASSERT_OFTEN(cs_orient3d(x[3], x[1], x[2], x[0]) == -sign);
        zeros += !sign;
        double naive = 0;
        for (int i = 0; i < 3; i++) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            naive += x[0][i] * (x[1][j] * x[2][k] - x[1][k] * x[2][j]) -
                     x[1][i] * (x[2][j] * x[3][k] - x[2][k] * x[3][j]) +
                     x[2][i] * (x[3][j] * x[0][k] - x[3][k] * x[0][j]) -
                     x[3][i] * (x[0][j] * x[1][k] - x[0][k] * x[1][j]);
        }
        rounded_wrong += (naive > 0) - (naive < 0) != sign;
    }
    // the cases are worth their name
    ck_assert_int_gt(zeros, ROUNDS / 10);
    ck_assert_int_gt(rounded_wrong, ROUNDS / 10);
}

/* differences that need two doubles each */
TEST(signs_of_points_of_many_sizes) {
    const double tiny = 0x1p-80, a[3] = {1, 0, 0}, b[3] = {0, 1, 0}, c[3] = {0, 0, 1};
    const double third = 1 / 3.0, rest = 1 - 2 * third;
    const double on[3] = {third, third, rest};
    ck_assert_int_eq(cs_orient3d(a, b, c, on), 0);
    for (int k = 0; k < 3; k++) {
        double near[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        near[k][(k + 1) % 3] = tiny;
        ck_assert_int_eq(cs_orient3d(near[0], near[1], near[2], on), 1);
        near[k][(k + 1) % 3] = -tiny;
        ck_assert_int_eq(cs_orient3d(near[0], near[1], near[2], on), -1);
    }
    const double nan[3] = {(double)NAN, 0, 0}, far[3] = {HUGE_VAL, 0, 0};
    ck_assert_int_eq(cs_orient3d(nan, b, c, on), 0);
    ck_assert_int_eq(cs_orient3d(a, b, nan, on), 0);
    ck_assert_int_eq(cs_orient3d(far, b, c, far), 0);
}

/* The second end really moved, by 1 / MOVE of the least difference and less: see
 * edge_triangle.h. */
#define MOVE ((wide)1 << 12)

static bool pierces_wide(const int64_t p[5][3]) {
    wide x[5][3], q[3];
    for (int k = 0; k < 5; k++)
        for (int c = 0; c < 3; c++)
            x[k][c] = p[k][c] * MOVE * MOVE * MOVE;
    q[0] = x[1][0] + MOVE * MOVE, q[1] = x[1][1] + MOVE, q[2] = x[1][2] + 1;
    const int above = orient_wide(x[2], x[3], x[4], x[0]);
    const int below = orient_wide(x[2], x[3], x[4], x[1]);
    const int first = orient_wide(x[2], x[3], x[0], q),
              second = orient_wide(x[3], x[4], x[0], q);
    const int third = orient_wide(x[4], x[2], x[0], q);
    return above * below < 0 && first == second && second == third;
}

/* few places, so that ends lie in planes and edges go through sides and corners all the time */
TEST(edges_through_triangles_of_few_places) {
    uint64_t state = 7;
    int pierced = 0, touched = 0;
    for (int round = 0; round < ROUNDS; round++) {
        int64_t p[5][3];
        double x[5][3];
        points(&state, 1 + round % 3, 5, p);
        for (int k = 0; k < 5; k++)
            to_doubles(p[k], round % 7 ? 1 : 0x1p-200, x[k]);
        const bool found =
            cs_edge_crosses_triangle((const double(*)[3])x, (const double(*)[3])(x + 2));
        UNIT_ASSERT_OFTEN(found == pierces_wide((const int64_t(*)[3])p));
        // corners in any order
        const double turned[3][3] = {{x[3][0], x[3][1], x[3][2]},
                                     {x[2][0], x[2][1], x[2][2]},
                                     {x[4][0], x[4][1], x[4][2]}};
        UNIT_ASSERT_OFTEN(found == cs_edge_crosses_triangle((const double(*)[3])x, turned));
        pierced += found;
        for (int k = 0; k < 2; k++)
            touched += found && !cs_orient3d(x[2 + k], x[3 + k], x[0], x[1]);
    }
    ck_assert_int_gt(pierced, 1000);
    ck_assert_int_gt(touched, 300);
}

/* six triangles about a corner, and an edge through the corner: one of them has it, however the
 * edge goes */
TEST(corner_of_a_surface_counts_once) {
    static const double ring[6][2] = {{2, 0}, {1, 2}, {-1, 1}, {-2, 0}, {-1, -2}, {1, -1}};
    uint64_t state = 3;
    for (int round = 0; round < 500; round++) {
        double edge[2][3], height[6];
        for (int c = 0; c < 2; c++) {
            edge[0][c] = (double)whole(&state, 3) / 16;
            edge[1][c] = -edge[0][c];
        }
        edge[0][2] = round % 2 ? 1 : -1;
        edge[1][2] = -edge[0][2];
        for (int k = 0; k < 6; k++)
            height[k] = (double)whole(&state, 2) / 16;
        int n = 0;
        for (int k = 0; k < 6; k++) {
            const int l = (k + 1) % 6;
            const double triangle[3][3] = {{0, 0, 0},
                                           {ring[k][0], ring[k][1], height[k]},
                                           {ring[l][0], ring[l][1], height[l]}};
            n += cs_edge_crosses_triangle((const double(*)[3])edge, triangle);
        }
        UNIT_ASSERT_OFTEN(n == 1);
    }
}

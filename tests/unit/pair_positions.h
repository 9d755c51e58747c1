/* pair_positions.h - four points at random for the tests of pairs, hard places among them, and
 * differences along a direction. */
#ifndef CS_UNIT_PAIR_POSITIONS_H
#define CS_UNIT_PAIR_POSITIONS_H

#include "model/contact/pair_distance.h"

/* a number in -1..1, always the same ones */
static inline double draw(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) / 4503599627370496.0 - 1;
}

/* points of size 1, and two of three pairs at a hard place: edges almost parallel, a point over
 * the rim of a triangle, and of these every other with all points almost in one plane, next to
 * each other */
static inline void place_stencil(uint64_t *state, int pair, enum cs_pair_kind kind,
                                 double p[4][3]) {
    for (int k = 0; k < 4; k++)
        for (int c = 0; c < 3; c++)
            p[k][c] = draw(state);
    const double share = draw(state), shift = 0.1 * draw(state), tilt = 1e-3 * draw(state);
    if (pair % 3 == 0)
        return;
    if (kind == CS_PAIR_EDGE_EDGE)
        for (int c = 0; c < 3; c++) { // parallel, beside each other
            p[2][c] = p[0][c] + (c == 1 ? 0.3 : share * (p[1][c] - p[0][c]));
            p[3][c] = p[2][c] + p[1][c] - p[0][c] + tilt * p[3][c];
        }
    else
        for (int c = 0; c < 3; c++) // over the middle of an edge, a little aside
            p[0][c] = (p[1][c] + p[2][c]) / 2 + shift * (p[3][c] - p[1][c]) + 0.2 * p[0][c];
    for (int k = 0; k < 4 && pair % 3 == 2; k++) // flat, almost
        p[k][2] *= 1e-3;
}

/* over all of a triangle and beside it, near the rim and its ends above all */
static inline void place_facet(uint64_t *state, int pair, double p[4][3]) {
    for (int i = 1; i < 4; i++)
        for (int c = 0; c < 3; c++)
            p[i][c] = (i == 2 && c == 0) + (i == 3 && c == 1) + 0.2 * draw(state);
    const double along = pair % 3 ? 0.5 + 0.5 * draw(state) : 0.1 * draw(state),
                 aside = (pair % 2 ? 0.2 : 0.8) * draw(state),
                 up = 0.1 + 0.4 * fabs(draw(state));
    for (int c = 0; c < 3; c++)
        p[0][c] =
            p[1][c] + along * (p[2][c] - p[1][c]) + aside * (p[3][c] - p[1][c]) + up * (c == 2);
}

/* Differences are poor by short edges. */
static inline bool place_is_good(const struct cs_pair_distance *s) {
    return s->d >= 0.02 && s->a >= 0.25 && s->c >= 0.25;
}

/* A slope by values at -3 .. 3 steps: sixth order. Which of the steps is best hangs on the
 * pair: it is too long for one that turns fast and too short for the digits of another. */
static const double place_at[6] = {-3, -2, -1, 1, 2, 3},
                    place_share[6] = {-1.0 / 60, 3.0 / 20,  -3.0 / 4,
                                      3.0 / 4,   -3.0 / 20, 1.0 / 60};
static const double place_steps[4] = {1e-7, 1e-6, 1e-5, 1e-4};
enum { PLACE_AT = 6, PLACE_STEPS = 4 };

static inline double place_size(double g[4][3]) {
    double squared = 0;
    for (int k = 0; k < 4; k++)
        squared += cs_vec3_dot(g[k], g[k]);
    return sqrt(squared);
}

static inline void place_move(double p[4][3], double by, double dp[4][3], double to[4][3]) {
    for (int k = 0; k < 12; k++)
        to[k / 3][k % 3] = p[k / 3][k % 3] + by * dp[k / 3][k % 3];
}

/* to += share of */
static inline void place_add(double to[4][3], double share, double of[4][3]) {
    for (int k = 0; k < 12; k++)
        to[k / 3][k % 3] += share * of[k / 3][k % 3];
}

/* What four vectors at four points push and turn, as a whole. */
static inline double place_whole(double p[4][3], double f[4][3]) {
    double sum[3] = {0}, torque[3] = {0};
    for (int k = 0; k < 4; k++) {
        double turn[3];
        cs_vec3_cross(p[k], f[k], turn);
        for (int c = 0; c < 3; c++) {
            sum[c] += f[k][c];
            torque[c] += turn[c];
        }
    }
    return sqrt(cs_vec3_dot(sum, sum) + cs_vec3_dot(torque, torque));
}

/* least distance of p from the segment a b, squared */
static inline double place_from_segment(const double p[3], const double a[3],
                                        const double b[3]) {
    double u[3], w[3], squared = 0;
    for (int c = 0; c < 3; c++) {
        u[c] = b[c] - a[c];
        w[c] = p[c] - a[c];
    }
    const double t = fmin(fmax(cs_vec3_dot(w, u) / cs_vec3_dot(u, u), 0), 1);
    for (int c = 0; c < 3; c++)
        squared += (w[c] - t * u[c]) * (w[c] - t * u[c]);
    return squared;
}

#endif

/* Smooth distances of a point and a triangle, and of two edges: against the true distance,
 * against differences, and against the laws of momentum. */
#include "model/contact/narrow_phase/pair_distance_tangent.h"
#include "pair_positions.h"
#include "unit.h"

#include <math.h>

enum { PAIRS = 50000 };

static double distance_at(enum cs_pair_kind kind, double p[4][3], double g[4][3]) {
    struct cs_pair_distance s;
    cs_pair_distance_set(&s, kind, p);
    cs_pair_distance_gradient(&s, g);
    return s.d;
}

/* least distance of p from the segment a b, squared */
static double from_segment(const double p[3], const double a[3], const double b[3]) {
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

/* the true distance: the crossing of perpendiculars where it is inside, else the best rim */
static double true_distance(enum cs_pair_kind kind, double p[4][3]) {
    double u[3], v[3], w[3], squared = 0;
    cs_pair_distance_differences(kind, p, u, v, w);
    const double a = cs_vec3_dot(u, u), b = cs_vec3_dot(u, v), c = cs_vec3_dot(v, v);
    const double d = cs_vec3_dot(u, w), e = cs_vec3_dot(v, w), det = a * c - b * b;
    const double l = (c * d - b * e) / det, m = (a * e - b * d) / det;
    for (int k = 0; k < 3; k++)
        squared += (w[k] - l * u[k] - m * v[k]) * (w[k] - l * u[k] - m * v[k]);
    if (kind == CS_PAIR_EDGE_EDGE) {
        if (l >= 0 && l <= 1 && m >= 0 && m <= 1)
            return sqrt(squared);
        return sqrt(fmin(fmin(from_segment(p[0], p[2], p[3]), from_segment(p[1], p[2], p[3])),
                         fmin(from_segment(p[2], p[0], p[1]), from_segment(p[3], p[0], p[1]))));
    }
    if (l >= 0 && m >= 0 && l + m <= 1)
        return sqrt(squared);
    return sqrt(fmin(from_segment(p[0], p[1], p[2]),
                     fmin(from_segment(p[0], p[2], p[3]), from_segment(p[0], p[3], p[1]))));
}

static bool is_inside(const struct cs_pair_distance *s) {
    bool inside = true;
    for (int i = 0; i < 2; i++)
        inside = inside && s->unclamped[i] >= CS_PAIR_DISTANCE_BLEND &&
                 s->unclamped[i] <= 1 - CS_PAIR_DISTANCE_BLEND;
    return inside && (s->kind == CS_PAIR_EDGE_EDGE ||
                      s->unclamped[0] + s->unclamped[1] <= 1 - CS_PAIR_DISTANCE_BLEND);
}

/* Never below the true distance. Inside the rim it is that of the point to the plane; of edges
 * it exceeds it by what pulling to the middles does. */
TEST(distance_is_never_too_small) {
    uint64_t state = 1;
    int inside = 0;
    for (int pair = 0; pair < PAIRS; pair++)
        for (int kind = 0; kind < 2; kind++) {
            struct cs_pair_distance s;
            double p[4][3];
            place_stencil(&state, 0, kind, p);
            cs_pair_distance_set(&s, kind, p);
            const double least = true_distance(kind, p);
            const double more = 1e-9 + s.q * (s.a + s.c) / 4;
            UNIT_ASSERT_OFTEN(s.d >= least * (1 - 1e-9));
            inside += is_inside(&s);
            UNIT_ASSERT_OFTEN(!is_inside(&s) || s.a * s.c - s.b * s.b < 0.1 * s.a * s.c ||
                              s.d * s.d <= least * least + more);
        }
    ck_assert_int_gt(inside, PAIRS / 50);
}

/* at right angles over the inside of both it is the height itself */
TEST(distance_inside_is_the_height) {
    double triangle[4][3] = {{0.3, 0.3, -0.25}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    double edges[4][3] = {{0, 0, 0}, {1, 0, 0}, {0.5, -1, 0.25}, {0.5, 1, 0.25}};
    double g[4][3];
    ck_assert_double_eq_tol(distance_at(CS_PAIR_POINT_TRIANGLE, triangle, g), 0.25, 1e-11);
    ck_assert_double_eq_tol(g[0][2], -1, 1e-11);
    ck_assert_double_eq_tol(distance_at(CS_PAIR_EDGE_EDGE, edges, g), 0.25, 1e-11);
    ck_assert_double_eq_tol(g[0][2], -0.5, 1e-9);
    // three quarters along, the nearer end has three quarters of the weight, but for q
    double aside[4][3] = {{0, 0, 0}, {1, 0, 0}, {0.75, -1, 0.25}, {0.75, 1, 0.25}};
    distance_at(CS_PAIR_EDGE_EDGE, aside, g);
    ck_assert_double_eq_tol(g[1][2], -0.75, 1e-3);
}

/* slopes of the distance against the gradient, and of the gradient against the tangent; both
 * relative to the largest, by the best of several steps */
static void differ(const struct cs_pair_distance *s, double p[4][3], double dp[4][3],
                   double g[4][3], double best[2]) {
    double dg[4][3], dweights[4], along = 0;
    cs_pair_distance_tangent(s, dp, dg, dweights);
    for (int k = 0; k < 4; k++)
        along += cs_vec3_dot(g[k], dp[k]);
    for (int i = 0; i < PLACE_STEPS; i++) {
        double slope = 0, off[4][3] = {{0}}, moved[4][3], there[4][3];
        place_add(off, -1, dg);
        for (int j = 0; j < PLACE_AT; j++) {
            const double share = place_share[j] / place_steps[i];
            place_move(p, place_at[j] * place_steps[i], dp, moved);
            slope += share * distance_at(s->kind, moved, there);
            place_add(off, share, there);
        }
        best[0] = fmin(best[0], fabs(slope - along) / place_size(g));
        best[1] = fmin(best[1], place_size(off) / (place_size(dg) + place_size(g)));
    }
}

TEST(derivatives_are_those_of_differences) {
    uint64_t state = 2;
    for (int kind = 0; kind < 2; kind++) {
        double worst[2] = {0, 0};
        for (int pair = 0; pair < PAIRS; pair++) {
            double p[4][3], g[4][3], dp[4][3], best[2] = {HUGE_VAL, HUGE_VAL};
            struct cs_pair_distance s;
            place_stencil(&state, pair, kind, p);
            for (int k = 0; k < 12; k++)
                dp[k / 3][k % 3] = draw(&state);
            cs_pair_distance_set(&s, kind, p);
            if (!place_is_good(&s))
                continue;
            cs_pair_distance_gradient(&s, g);
            differ(&s, p, dp, g, best);
            worst[0] = fmax(worst[0], best[0]);
            worst[1] = fmax(worst[1], best[1]);
        }
        ck_assert_msg(worst[0] < 1e-6 && worst[1] < 1e-6, "kind %d: %g %g", kind, worst[0],
                      worst[1]);
    }
}

/* a force along the gradient moves and turns nothing as a whole */
TEST(gradient_keeps_momentum) {
    uint64_t state = 3;
    double worst = 0;
    for (int pair = 0; pair < PAIRS; pair++)
        for (int kind = 0; kind < 2; kind++) {
            double p[4][3], g[4][3];
            place_stencil(&state, pair, kind, p);
            distance_at(kind, p, g);
            worst = fmax(worst, place_whole(p, g) / place_size(g));
        }
    ck_assert_msg(worst < 1e-12, "%g", worst);
}

/* points in one place, edges without length: numbers, not NAN */
TEST(degenerate_pairs_stay_finite) {
    for (int kind = 0; kind < 2; kind++)
        for (int same = 1; same <= 4; same++) {
            double p[4][3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, g[4][3], dg[4][3],
                   dw[4];
            struct cs_pair_distance s;
            for (int k = 0; k < same; k++)
                p[k][0] = 1;
            cs_pair_distance_set(&s, kind, p);
            cs_pair_distance_gradient(&s, g);
            cs_pair_distance_tangent(&s, p, dg, dw);
            ck_assert(isfinite(s.d) && isfinite(place_size(g)) && isfinite(place_size(dg)));
        }
}

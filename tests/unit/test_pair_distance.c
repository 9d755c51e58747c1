/* Distances of two edges, and of a point and a whole triangle: against the true distance,
 * against differences, and against the laws of momentum. Edges are tested at lengths of 1 to
 * 1000 thicknesses, each on its own, at all angles down to 1e-7. */
#include "model/contact/barrier_law.h"
#include "model/contact/body_pair_params.h"
#include "model/contact/narrow_phase/feature_weights.h"
#include "model/contact/narrow_phase/pair_contact.h"
#include "pair_positions.h"
#include "unit.h"

#include <math.h>
#include <string.h>

enum { PAIRS = 50000, POSES = 1000000, SAMPLE = 20000 };

/* m, of pairs of size 1 */
#define RANGE 0.1

static double distance_at(enum cs_pair_kind kind, double range, double p[4][3],
                          double g[4][3]) {
    struct cs_pair_contact s;
    const double d = cs_pair_contact_measure_whole(&s, kind, range, p);
    memcpy(g, s.g, sizeof s.g);
    return d;
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
        return sqrt(fmin(
            fmin(place_from_segment(p[0], p[2], p[3]), place_from_segment(p[1], p[2], p[3])),
            fmin(place_from_segment(p[2], p[0], p[1]), place_from_segment(p[3], p[0], p[1]))));
    }
    if (l >= 0 && m >= 0 && l + m <= 1)
        return sqrt(squared);
    return sqrt(
        fmin(place_from_segment(p[0], p[1], p[2]),
             fmin(place_from_segment(p[0], p[2], p[3]), place_from_segment(p[0], p[3], p[1]))));
}

/* That of edges is never below it. The square of that of triangles is at most 0.3451 e^2 below,
 * beside edges, and 0.2845^2 e^2 above, by their ends (mesh_feature.h). */
TEST(distances_beside_the_true_one) {
    const double e = CS_FEATURE_BLEND_RADIUS / CS_FEATURE_RANGE_RATIO * RANGE;
    const double bent = 0.3452 * e * e;
    uint64_t state = 1;
    int n_bent = 0;
    for (int pair = 0; pair < PAIRS; pair++)
        for (int kind = 0; kind < 2; kind++) {
            double p[4][3], g[4][3];
            place_stencil(&state, 0, kind, p);
            const double d = distance_at(kind, RANGE, p, g), least = true_distance(kind, p);
            const bool edges = kind == CS_PAIR_EDGE_EDGE;
            UNIT_ASSERT_OFTEN(d * d >= least * least * (1 - 1e-9) - (edges ? 0 : bent));
            UNIT_ASSERT_OFTEN(edges || d * d <= least * least * (1 + 1e-9) + 0.081 * e * e);
            n_bent += !edges && d < 0.999 * least;
        }
    ck_assert_int_gt(n_bent, PAIRS / 1000);
}

/* at right angles over the inside of both it is the height itself */
TEST(distance_inside_is_the_height) {
    double triangle[4][3] = {{0.3, 0.3, -0.25}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    double edges[4][3] = {{0, 0, 0}, {1, 0, 0}, {0.5, -1, 0.25}, {0.5, 1, 0.25}};
    double g[4][3];
    ck_assert_double_eq_tol(distance_at(CS_PAIR_POINT_TRIANGLE, RANGE, triangle, g), 0.25,
                            1e-11);
    ck_assert_double_eq_tol(g[0][2], -1, 1e-11);
    ck_assert_double_eq_tol(distance_at(CS_PAIR_EDGE_EDGE, RANGE, edges, g), 0.25, 1e-11);
    ck_assert_double_eq_tol(g[0][2], -0.5, 1e-9);
    // three quarters along, the nearer end has three quarters of the weight, but for p
    double aside[4][3] = {{0, 0, 0}, {1, 0, 0}, {0.75, -1, 0.25}, {0.75, 1, 0.25}};
    distance_at(CS_PAIR_EDGE_EDGE, RANGE, aside, g);
    ck_assert_double_eq_tol(g[1][2], -0.75, 1e-3);
}

/* slopes of the distance against the gradient, and of the gradient against the tangent; both
 * relative to the largest, by the best of several steps of dp */
static void differ(const struct cs_pair_distance *s, double range, double p[4][3],
                   double dp[4][3], double best[2]) {
    double g[4][3], dg[4][3], dweights[4], along = 0;
    cs_pair_distance_gradient(s, g);
    cs_pair_distance_tangent(s, dp, dg, dweights);
    for (int k = 0; k < 4; k++)
        along += cs_vec3_dot(g[k], dp[k]);
    best[0] = best[1] = HUGE_VAL;
    for (int i = 0; i < PLACE_STEPS; i++) {
        double slope = 0, off[4][3] = {{0}}, moved[4][3], there[4][3];
        place_add(off, -1, dg);
        for (int j = 0; j < PLACE_AT; j++) {
            const double share = place_share[j] / place_steps[i];
            place_move(p, place_at[j] * place_steps[i], dp, moved);
            slope += share * distance_at(CS_PAIR_EDGE_EDGE, range, moved, there);
            place_add(off, share, there);
        }
        best[0] = fmin(best[0], fabs(slope - along) / (place_size(g) * place_size(dp)));
        best[1] = fmin(best[1], place_size(off) / (place_size(dg) + place_size(g)));
    }
}

TEST(derivatives_are_those_of_differences) {
    uint64_t state = 2;
    double worst[2] = {0, 0};
    for (int pair = 0; pair < PAIRS; pair++) {
        double p[4][3], dp[4][3], best[2];
        struct cs_pair_distance s;
        place_stencil(&state, pair, CS_PAIR_EDGE_EDGE, p);
        for (int k = 0; k < 12; k++)
            dp[k / 3][k % 3] = draw(&state);
        cs_pair_distance_set(&s, RANGE, p);
        if (!place_is_good(&s))
            continue;
        differ(&s, RANGE, p, dp, best);
        worst[0] = fmax(worst[0], best[0]);
        worst[1] = fmax(worst[1], best[1]);
    }
    ck_assert_msg(worst[0] < 1e-6 && worst[1] < 1e-6, "%g %g", worst[0], worst[1]);
}

/* Gradients of whole triangles, at points over the inside, the edges and the vertices: by the
 * slope along a direction, whatever the order in which the vertices stand. */
TEST(gradients_of_triangles_are_those_of_differences) {
    uint64_t state = 8;
    double worst = 0, off = 0;
    for (int pair = 0; pair < SAMPLE; pair++) {
        double p[4][3], dp[4][3], g[4][3], there[4][3], along = 0, best = HUGE_VAL;
        place_facet(&state, pair, p);
        for (int k = 0; k < 12; k++)
            dp[k / 3][k % 3] = draw(&state);
        const double d = distance_at(CS_PAIR_POINT_TRIANGLE, 1, p, g);
        for (int k = 0; k < 4; k++)
            along += cs_vec3_dot(g[k], dp[k]);
        for (int i = 0; i < PLACE_STEPS; i++) {
            double slope = 0, moved[4][3];
            for (int j = 0; j < PLACE_AT; j++) {
                place_move(p, place_at[j] * place_steps[i], dp, moved);
                slope += place_share[j] / place_steps[i] *
                         distance_at(CS_PAIR_POINT_TRIANGLE, 1, moved, there);
            }
            best = fmin(best, fabs(slope - along) / (place_size(g) * place_size(dp)));
        }
        worst = fmax(worst, best);
        double turned[4][3];
        for (int k = 0; k < 4; k++)
            memcpy(turned[k], p[k ? 1 + k % 3 : 0], sizeof p[k]);
        off = fmax(off, fabs(distance_at(CS_PAIR_POINT_TRIANGLE, 1, turned, there) - d));
        for (int k = 1; k < 4; k++)
            for (int c = 0; c < 3; c++)
                off = fmax(off, fabs(there[k][c] - g[1 + k % 3][c]));
    }
    ck_assert_msg(worst < 1e-6 && off < 1e-9, "%g %g", worst, off);
}

/* a force along the gradient moves and turns nothing as a whole */
TEST(gradient_keeps_momentum) {
    uint64_t state = 3;
    double worst = 0;
    for (int pair = 0; pair < PAIRS; pair++)
        for (int kind = 0; kind < 2; kind++) {
            double p[4][3], g[4][3];
            place_stencil(&state, pair, kind, p);
            distance_at(kind, RANGE, p, g);
            worst = fmax(worst, place_whole(p, g) / place_size(g));
        }
    ck_assert_msg(worst < 1e-12, "%g", worst);
}

/* points in one place, edges without length: numbers, not NAN */
TEST(degenerate_pairs_stay_finite) {
    for (int kind = 0; kind < 2; kind++)
        for (int same = 1; same <= 4; same++) {
            double p[4][3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, g[4][3],
                   dg[4][3] = {{0}}, dw[4];
            struct cs_pair_distance s;
            for (int k = 0; k < same; k++)
                p[k][0] = 1;
            const double d = distance_at(kind, RANGE, p, g);
            cs_pair_distance_set(&s, RANGE, p);
            cs_pair_distance_tangent(&s, p, dg, dw);
            ck_assert(isfinite(d) && isfinite(place_size(g)) && isfinite(place_size(dg)));
        }
}

/* --- edges of all lengths; D = 1 --- */

/* a unit vector in any direction */
static void draw_direction(uint64_t *state, double to[3]) {
    do
        for (int c = 0; c < 3; c++)
            to[c] = draw(state);
    while (cs_vec3_dot(to, to) > 1 || cs_vec3_dot(to, to) < 0.01);
    cs_vec3_normalise(to);
}

/* 10^(3 x) for x in 0..1 as the product of roots: a length of 1 to 1000 */
static double draw_length(uint64_t *state) {
    return pow(10, 1.5 + 1.5 * draw(state));
}

/* Two edges with their nearest points within both, `apart` along their common perpendicular:
 * the minimum of a convex function, so that this is the distance. Every other pair is nearly
 * parallel, and of one in four the points are near ends, or at them. */
static double draw_edges(uint64_t *state, int pose, double p[4][3]) {
    double along[2][3], across[3], from[2], length[2];
    draw_direction(state, along[0]);
    draw_direction(state, along[1]);
    const double tilt = pow(10, 3.5 * draw(state) - 3.5);
    for (int c = 0; c < 3 && pose % 2; c++)
        along[1][c] = along[0][c] + tilt * along[1][c];
    cs_vec3_normalise(along[1]);
    cs_vec3_cross(along[0], along[1], across);
    cs_vec3_normalise(across);
    for (int i = 0; i < 2; i++) {
        length[i] = draw_length(state);
        from[i] = 0.5 + 0.5 * draw(state);
        if (pose % 4 > 1)
            from[i] = pow(from[i], 6);
        if (pose % 8 > 5)
            from[i] = draw(state) > 0 ? 0 : 1;
    }
    const double apart = 0.125 + 0.125 * draw(state);
    for (int c = 0; c < 3; c++) {
        p[0][c] = -from[0] * length[0] * along[0][c];
        p[1][c] = (1 - from[0]) * length[0] * along[0][c];
        p[2][c] = apart * across[c] - from[1] * length[1] * along[1][c];
        p[3][c] = apart * across[c] + (1 - from[1]) * length[1] * along[1][c];
    }
    return apart;
}

/* No pair nearer than D/4 within both edges is without a force: 0.86 of the range is the bound
 * of pair_distance.h. Nothing is pushed or turned as a whole; rounding grows with the lengths.
 */
TEST(edges_of_any_length_have_a_force) {
    uint64_t state = 4;
    double most = 0, sum = 0, torque = 0;
    for (int pose = 0; pose < POSES; pose++) {
        double p[4][3], g[4][3];
        const double apart = draw_edges(&state, pose, p);
        const double d = distance_at(CS_PAIR_EDGE_EDGE, CS_EDGE_RANGE_RATIO, p, g);
        double here[4][3] = {{0}}, size = 0;
        for (int k = 0; k < 4; k++)
            size = fmax(size, sqrt(cs_vec3_dot(p[k], p[k])));
        UNIT_ASSERT_OFTEN(d >= apart - 1e-12 * size);
        most = fmax(most, d / CS_EDGE_RANGE_RATIO);
        sum = fmax(sum, place_whole(here, g) / place_size(g));
        torque = fmax(torque, place_whole(p, g) / (size * place_size(g)));
    }
    ck_assert_msg(most < 0.86, "%g of the range", most);
    ck_assert_msg(sum < 1e-12 && torque < 1e-12, "%g %g", sum, torque);
}

/* An edge that crosses a ridge of 1000 D anywhere but within D of its ends is as far from it
 * everywhere, so that nothing draws it along. */
TEST(distance_is_the_same_along_a_ridge) {
    double worst = 0;
    for (double along = 1; along <= 999; along += 0.37)
        for (int turn = 0; turn < 3; turn++) {
            const double angle[3][2] = {{0, 1.5}, {0.9, 1.2}, {1.46, 0.35}};
            double g[4][3], p[4][3] = {{0, 0, 0}, {1000, 0, 0}};
            for (int k = 0; k < 2; k++) {
                p[2 + k][0] = along + (k ? 1 : -1) * angle[turn][0];
                p[2 + k][1] = (k ? 1 : -1) * angle[turn][1];
                p[2 + k][2] = 0.25;
            }
            const double d = distance_at(CS_PAIR_EDGE_EDGE, CS_EDGE_RANGE_RATIO, p, g);
            worst = fmax(worst, fabs(d - 0.25));
        }
    ck_assert_msg(worst < 1e-4, "%g", worst);
}

/* Points move by up to D, so that steps are fractions of it. */
TEST(edges_of_any_length_have_exact_derivatives) {
    uint64_t state = 5;
    double worst[2] = {0, 0}, of_short[2] = {0, 0};
    for (int pose = 0; pose < SAMPLE; pose++) {
        double p[4][3], dp[4][3], best[2];
        struct cs_pair_distance s;
        draw_edges(&state, pose, p);
        for (int k = 0; k < 12; k++)
            dp[k / 3][k % 3] = draw(&state);
        cs_pair_distance_set(&s, CS_EDGE_RANGE_RATIO, p);
        if (s.d < 0.02)
            continue;
        differ(&s, CS_EDGE_RANGE_RATIO, p, dp, best);
        const bool is_short = fmax(s.a, s.c) < 30 * 30;
        for (int k = 0; k < 2; k++) {
            worst[k] = fmax(worst[k], best[k]);
            of_short[k] = fmax(of_short[k], is_short ? best[k] : 0);
        }
    }
    ck_assert_msg(worst[0] < 1e-6 && worst[1] < 1e-6, "%g %g", worst[0], worst[1]);
    ck_assert_msg(of_short[0] < 1e-8 && of_short[1] < 1e-8, "%g %g", of_short[0], of_short[1]);
}

/* --- whole triangles --- */

/* Two bodies of one triangle each: points 0 to 2 and 3 to 5. */
static uint32_t corners[6] = {0, 1, 2, 3, 4, 5},
                edges[6][2] = {{0, 1}, {0, 2}, {1, 2}, {3, 4}, {3, 5}, {4, 5}};

/* J with k = D = 1, of a point and all features of the other triangle */
static double point_energy(const struct cs_feature_weights *features, uint32_t point,
                           const double *x) {
    struct cs_weighted_feature uses[CS_FEATURES_PER_TRIANGLE];
    const uint32_t other = point < 3;
    const struct cs_feature_query query = {
        .points = {point, 3 * other, 3 * other + 1, 3 * other + 2},
        .triangle = other,
        .range = 1};
    const uint32_t n = cs_feature_weights_find(features, &query, 1, x, uses);
    double energy = 0;
    for (uint32_t k = 0; k < n; k++)
        energy += uses[k].weight * cs_barrier_energy(uses[k].d, CS_FEATURE_RANGE_RATIO, 1);
    return energy;
}

/* Copies points of x (3, 6) to those of a pair. */
static void read_points(const double *x, const uint32_t at[4], double p[4][3]) {
    for (size_t k = 0; k < 4; k++)
        for (size_t c = 0; c < 3; c++)
            p[k][c] = x[6 * c + at[k]];
}

/* Least true distance of all 15 pairs, and their energy. */
static double measure_triangles(const struct cs_feature_weights *features, const double *x,
                                double *energy) {
    double p[4][3], least = HUGE_VAL;
    *energy = 0;
    for (uint32_t i = 0; i < 6; i++) {
        const uint32_t other = 3 * (i < 3);
        read_points(x, (uint32_t[]){i, other, other + 1, other + 2}, p);
        least = fmin(least, true_distance(CS_PAIR_POINT_TRIANGLE, p));
        *energy += point_energy(features, i, x);
    }
    for (int i = 0; i < 3; i++)
        for (int j = 3; j < 6; j++) {
            struct cs_pair_distance s;
            read_points(x, (uint32_t[]){edges[i][0], edges[i][1], edges[j][0], edges[j][1]}, p);
            cs_pair_distance_set(&s, CS_EDGE_RANGE_RATIO, p);
            least = fmin(least, true_distance(CS_PAIR_EDGE_EDGE, p));
            *energy += cs_barrier_energy(s.d, CS_EDGE_RANGE_RATIO, 1);
        }
    return least;
}

/* Where edges end on a vertex, its point-triangle pairs have the force: two triangles of any
 * size whose true distance is below D/4 are never without one. The triangles hang on edges as
 * above, whose nearest points may then not be those of the triangles. */
TEST(triangles_of_any_size_have_a_force) {
    struct cs_surfaces surfaces = {.n_bodies = 2,
                                   .n_points = 6,
                                   .n_triangles = 2,
                                   .n_edges = 6,
                                   .triangles = corners,
                                   .edges = edges[0]};
    uint32_t owners[12];
    for (int k = 0; k < 12; k++)
        owners[k] = k % 2 ? CS_NO_TRIANGLE : (uint32_t)k / 6;
    surfaces.edge_triangles = owners;
    struct cs_error error = {0};
    struct cs_arena arena = {0};
    struct cs_feature_weights features;
    ck_assert(!cs_feature_weights_init(&features, &surfaces, &arena, &error));
    uint64_t state = 6;
    int near = 0;
    for (int pose = 0; pose < POSES / 50; pose++) {
        double p[4][3], x[18], energy;
        draw_edges(&state, pose, p);
        for (int side = 0; side < 2; side++) {
            const double length = draw_length(&state);
            double away[3];
            draw_direction(&state, away);
            for (int c = 0; c < 3; c++) {
                x[6 * c + 3 * side] = p[2 * side][c];
                x[6 * c + 3 * side + 1] = p[2 * side + 1][c];
                x[6 * c + 3 * side + 2] = p[2 * side][c] + length * away[c];
            }
        }
        const double least = measure_triangles(&features, x, &energy);
        near += least < 0.25;
        UNIT_ASSERT_OFTEN(!(least < 0.25) || energy > 0);
    }
    ck_assert_int_gt(near, POSES / 200);
    cs_arena_finish(&arena);
}

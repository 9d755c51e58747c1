/* mesh_feature.h - distance of a point from the plane, an edge or a vertex of a triangle, for
 * sums over the triangles of a mesh that count nothing twice.
 *
 * A point over a mesh is near several triangles that share an edge or a vertex. With psi the
 * barrier energy, h the height over the plane of a triangle and f one growing function, the
 * energy of a point is, by inclusion and exclusion,
 *
 *   E = sum of triangles psi(d) - sum of inner edges psi(d) + sum of inner vertices psi(d)
 *   d^2 = h^2 + f(m),   m = squared distance of the foot from triangle, edge or vertex
 *
 * Flat mesh: E = psi(h) exactly, wherever the edges and vertices are. Proof. All terms have the
 * same h and the same foot q, so each is phi(m) = psi(sqrt(h^2 + f(m))), which falls from
 * phi(0) = psi(h) to 0. It is a superposition of steps [m <= r^2] over radii r, and each step
 * counts the features that meet the closed disc B of radius r about q. Let S be the surface,
 * and 1_X the indicator function of a set X. At every point
 *
 *   1_S = sum of triangles 1_T - sum of inner edges 1_e + sum of inner vertices 1_v
 *
 * It is 1 inside a triangle, 2 - 1 on an inner edge, k - k + 1 at an inner vertex with k
 * triangles, and k - (k - 1) at a border vertex. Multiply by 1_B and take the Euler
 * characteristic, which is additive, and 1 for every convex set that is not empty. The right
 * side becomes the signed count, and the left side the Euler characteristic of the intersection
 * of S and B. This is 1 if B lies inside S, and also at a convex border. So all steps have the
 * factor 1, and their sum is phi(0) = psi(h). The proof holds for any f;
 * f only changes the scale of phi.
 *
 * The smooth clamp zeta below does not spoil this. A triangle whose foot is outside has the
 * distance of its nearest edge, so each edge near q occurs once with + and once with -. At an
 * inner vertex one edge is left over, which points away from q. There the clamp is exact: its
 * distance is that of the vertex, which cancels it.
 *
 * Bent mesh: the heights differ, as do the terms of one feature. Both triangles of an edge
 * give the same squared distance l = h^2 + m from it; d^2 then lies between l - 0.35 e^2 and l.
 * With e = 0.2 D their distances differ by at most 0.007 D^2/d; from m = e^2 on they are equal.
 * Each term is smooth, so E is smooth: only its size near bent edges is approximate.
 *
 *   f(m) = m step((m - e^2/8) / (7 e^2/8)),   step(x) = x^4 (35 - 84x + 70x^2 - 20x^3)
 *
 * is flat where the foot comes to an edge, and exact from m = e^2 on. step has three zero
 * derivatives at 0 and 1, so E has three continuous derivatives over a bent mesh too. The
 * largest value of m - f(m) is 0.3451 e^2 (evaluated numerically).
 *
 *   t = u.w/u.u   b = e / sqrt(u.u + 4 e^2)   zeta = t step(t/b), and 1 - (1-t) step((1-t)/b)
 *
 * clamps the foot on an edge u: exactly outside its ends, and by less than 0.3 e inside, since
 * b |u| < e and x (1 - step(x)) is at most 0.2845. b is below 1/2, so both ends never overlap.
 *
 * Each inner edge is measured half by either of its triangles, and each vertex in equal parts
 * by all its triangles: feature_weights.c. */
#ifndef CS_NARROW_PHASE_MESH_FEATURE_H
#define CS_NARROW_PHASE_MESH_FEATURE_H

#include "model/contact/narrow_phase/pair_distance_tangent.h"
#include "model/contact/pair_distance.h"

#include <stdbool.h>

/* Fractions of the range D of a pair. The blend radius is e. The range of the features is
 * smaller than D, so that candidates with a true distance below D miss none: from d < r D
 * follows a true distance below D sqrt(r^2 + 0.3451 0.2^2), which is 0.9990 D for r = 0.992. */
#define CS_FEATURE_BLEND_RADIUS 0.2
#define CS_FEATURE_RANGE_RATIO  0.992

/* Fraction of e^2 up to which f(m) is 0. */
#define CS_FEATURE_BLEND_START 0.125

/* The feature that the first edge of a triangle stands for: the edge (1, 1), its first end (0,
 * 1) or the plane (0, 0). The flags are factors in the formulas, which have no branches. */
struct cs_feature_kind {
    double is_edge, is_off_plane; /* 1, 1; 0, 1; or 0, 0 */
    /* blend radius in m */
    double e;
};

/* Value and two derivatives of step, constant outside [0, 1]. step' = 140 x^3 (1-x)^3 and
 * step'' = 420 x^2 (1-x)^2 (1 - 2x). */
CS_INLINE void cs_smoothstep7(double x, double out[3]) {
    const double low = x > 0 ? x : 0, z = low < 1 ? low : 1, left = 1 - z;
    const double square = z * z, both = z * left;
    out[0] = square * square * (35 + z * (-84 + z * (70 - 20 * z)));
    out[1] = 140 * both * both * both;
    out[2] = 420 * both * both * (left - z);
}

/* A feature at one state. The points are in the order of struct cs_weighted_feature: the point,
 * both ends of the edge, the third vertex. Vectors are in m. */
struct cs_mesh_feature {
    /* frame of the plane: u, v, w and unclamped l; its distance is not set */
    struct cs_pair_distance plane;
    /* distance in m; its gradient by u, v, w */
    double d, g[3][3];
    /* length in m and direction of the vector between both contact points */
    double length, n[3];
    /* weights of u and v in that vector; that of w is 1 */
    double weights_uv[2];
    /* vectors to the point: from its foot in the plane, and from the clamped point of the edge
     * ("leg") */
    double from_foot[3], from_edge[3];
    /* y = t/b or (1-t)/b, whichever end is near; half_b_over_w = b / (2 (u.u + 4 e^2)) */
    double t, y, b, half_b_over_w, zeta;
    double dzeta_dt, dzeta_db, d2zeta_dt2; /* zeta's derivatives */
    /* f' and f'' at m */
    double f1, f2;
    /* gradients of h^2 and of leg^2 by u, v, w, in m */
    double h2_gradient[3][3],
        edge_gradient[3][3]; /* gradients of h^2 and of leg^2 by u, v, w */
    double dleg2_dzeta;      /* -2 leg.u: slope of leg^2 by zeta */
    struct cs_feature_kind kind;
};

/* Sets t, b, zeta and its derivatives. With s = step and y as in the struct, z = b y s(y):
 *
 *   dzeta/dt = s + y s'                          for both ends
 *   dzeta/db = +-(y s - y (s + y s')),  d2zeta/dt2 = +-(2 s' + y s'') / b     - at the far end
 *
 * Being zero for a plane or vertex, is_edge then moves the point of the edge to its first end.
 */
CS_INLINE void cs_mesh_feature_clamp(struct cs_mesh_feature *s) {
    const double first = s->plane.a + DBL_MIN, wide = s->plane.a + 4 * s->kind.e * s->kind.e;
    s->t = cs_vec3_dot(s->plane.u, s->plane.w) / first;
    s->b = s->kind.e / sqrt(wide);
    s->half_b_over_w = 0.5 * s->b / wide;
    const bool near = s->t < 0.5;
    double step[3];
    s->y = (near ? s->t : 1 - s->t) / s->b;
    cs_smoothstep7(s->y, step);
    const double z = s->b * (s->y * step[0]), slope = step[0] + s->y * step[1];
    const double side = near ? s->kind.is_edge : -s->kind.is_edge;
    s->zeta = s->kind.is_edge * (near ? z : 1 - z);
    s->dzeta_dt = s->kind.is_edge * slope;
    s->dzeta_db = side * (s->y * step[0] - s->y * slope);
    s->d2zeta_dt2 = side * (2 * step[1] + s->y * step[2]) / s->b;
}

/* Gradients of h^2 and of leg^2 by u, v, w:
 *
 *   h^2 = min over l of |w - l1 u - l2 v|^2:   -2 l1 foot,  -2 l2 foot,  2 foot
 *   leg^2 = |w - zeta u|^2:   -2 zeta leg + c dzeta/du,  0,  2 leg + c dzeta/dw
 *
 * The derivative of the minimum by l vanishes. c = -2 leg.u is dleg2_dzeta, and dt/du = (w - 2
 * t u)/u.u, dt/dw = u/u.u, db/du = -2 half_b_over_w u. */
CS_INLINE void cs_mesh_feature_gradients(struct cs_mesh_feature *s) {
    const double *u = s->plane.u, *w = s->plane.w, *l = s->plane.unclamped;
    const double first = s->plane.a + DBL_MIN;
    s->dleg2_dzeta = -2 * cs_vec3_dot(s->from_edge, u);
    for (int c = 0; c < 3; c++) {
        s->h2_gradient[0][c] = -2 * l[0] * s->from_foot[c];
        s->h2_gradient[1][c] = -2 * l[1] * s->from_foot[c];
        s->h2_gradient[2][c] = 2 * s->from_foot[c];
        s->edge_gradient[0][c] =
            -2 * s->zeta * s->from_edge[c] +
            s->dleg2_dzeta * (s->dzeta_dt * (w[c] - 2 * s->t * u[c]) / first -
                              2 * s->dzeta_db * s->half_b_over_w * u[c]);
        s->edge_gradient[1][c] = 0;
        s->edge_gradient[2][c] =
            2 * s->from_edge[c] + s->dleg2_dzeta * s->dzeta_dt * u[c] / first;
    }
}

/* Returns f(m), and sets f' = s + m s' k and f'' = (2 s' + m s'' k) k, with k the slope of the
 * argument of step. All are 0 for the plane. */
CS_INLINE double cs_mesh_feature_blend(struct cs_mesh_feature *s, double m) {
    const double e2 = s->kind.e * s->kind.e, span = 1 / ((1 - CS_FEATURE_BLEND_START) * e2);
    double step[3];
    cs_smoothstep7((m - CS_FEATURE_BLEND_START * e2) * span, step);
    s->f1 = s->kind.is_off_plane * (step[0] + m * step[1] * span);
    s->f2 = s->kind.is_off_plane * (2 * step[1] + m * step[2] * span) * span;
    return s->kind.is_off_plane * m * step[0];
}

/* Sets the distance, and all that its derivatives need. least is added to d^2 so that d has
 * derivatives at 0. */
CS_INLINE void cs_mesh_feature_measure(struct cs_mesh_feature *s, struct cs_feature_kind kind,
                                       double p[4][3]) {
    const double least = CS_PAIR_DISTANCE_MIN * CS_PAIR_DISTANCE_MIN;
    s->kind = kind;
    cs_pair_distance_frame(&s->plane, CS_PAIR_POINT_TRIANGLE, 0, p);
    const double *u = s->plane.u, *v = s->plane.v, *w = s->plane.w, *l = s->plane.unclamped;
    cs_mesh_feature_clamp(s);
    for (int c = 0; c < 3; c++) {
        s->from_foot[c] = w[c] - l[0] * u[c] - l[1] * v[c];
        s->from_edge[c] = w[c] - s->zeta * u[c];
    }
    const double height = cs_vec3_dot(s->from_foot, s->from_foot);
    const double bent =
        cs_mesh_feature_blend(s, cs_vec3_dot(s->from_edge, s->from_edge) - height);
    s->d = sqrt(height + bent + least);
}

/* Sets distance, gradient and contact points. From d^2 = h^2 + f(leg^2 - h^2),
 *
 *   g = ((1 - f') grad h^2 + f' grad leg^2) / 2d
 *   r = (1 - f') foot + f' leg,   n = r/|r|
 *
 * r joins the point to the contact point on the triangle, which moves from the foot to the edge
 * as f' goes from 0 to 1. Friction and damping act there. */
CS_INLINE void cs_mesh_feature_set(struct cs_mesh_feature *s, struct cs_feature_kind kind,
                                   double p[4][3]) {
    const double least = CS_PAIR_DISTANCE_MIN * CS_PAIR_DISTANCE_MIN;
    cs_mesh_feature_measure(s, kind, p);
    const double *l = s->plane.unclamped;
    cs_mesh_feature_gradients(s);
    const double in = 1 - s->f1, half = 0.5 / s->d;
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++)
            s->g[k][c] = half * (in * s->h2_gradient[k][c] + s->f1 * s->edge_gradient[k][c]);
    s->weights_uv[0] = -(in * l[0] + s->f1 * s->zeta);
    s->weights_uv[1] = -in * l[1];
    double r[3];
    for (int c = 0; c < 3; c++)
        r[c] = in * s->from_foot[c] + s->f1 * s->from_edge[c];
    s->length = sqrt(cs_vec3_dot(r, r) + least);
    for (int c = 0; c < 3; c++)
        s->n[c] = r[c] / s->length;
}

/* Squared distance of p[0] from the edge of a triangle between p[i] and p[j], in m2. */
CS_INLINE double cs_mesh_feature_to_edge(double p[4][3], int i, int j) {
    double u[3], w[3], r[3];
    for (int c = 0; c < 3; c++) {
        u[c] = p[j][c] - p[i][c];
        w[c] = p[0][c] - p[i][c];
    }
    const double t = cs_vec3_dot(u, w) / (cs_vec3_dot(u, u) + DBL_MIN), low = t > 0 ? t : 0;
    const double inner = low < 1 ? low : 1;
    for (int c = 0; c < 3; c++)
        r[c] = w[c] - inner * u[c];
    return cs_vec3_dot(r, r);
}

/* Number 0, 1 or 2 of the edge of a triangle that is nearest to the point p[0]: a double, and
 * selected without branches, so that loops over lanes vectorise. */
CS_INLINE double cs_mesh_feature_nearest_edge(double p[4][3]) {
    const double first = cs_mesh_feature_to_edge(p, 1, 2),
                 second = cs_mesh_feature_to_edge(p, 2, 3),
                 third = cs_mesh_feature_to_edge(p, 3, 1);
    const double least = second < first ? second : first, edge = second < first ? 1 : 0;
    return third < least ? 2 : edge;
}

/* Rotates the numbers x[1..3] of the vertices by `edge` places, to begin at that edge. */
CS_INLINE void cs_mesh_feature_rotate(double edge, double x[4]) {
    const double a = x[1], b = x[2], c = x[3];
    const double first = edge > 0.5 ? b : a, second = edge > 0.5 ? c : b,
                 third = edge > 0.5 ? a : c;
    x[1] = edge > 1.5 ? c : first;
    x[2] = edge > 1.5 ? a : second;
    x[3] = edge > 1.5 ? b : third;
}

/* Form of the feature of a whole triangle that is nearest to a point, of those that sums count
 * with 1: the plane if the foot is inside, else the first edge, which stands for its ends too.
 * p is rotated to begin at the nearest edge. Triangles that are slivers within sin^2 = 1e-10
 * are their edges, because l is then rounding alone. */
CS_INLINE struct cs_feature_kind cs_mesh_feature_nearest_form(double e, double p[4][3]) {
    struct cs_pair_distance plane;
    cs_pair_distance_frame(&plane, CS_PAIR_POINT_TRIANGLE, 0, p);
    const double *l = plane.unclamped;
    const bool inside = (l[0] >= 0) & (l[1] >= 0) & (l[0] + l[1] <= 1) &
                        (plane.a * plane.c - plane.b * plane.b > 1e-10 * plane.a * plane.c);
    return (struct cs_feature_kind){inside ? 0 : 1, inside ? 0 : 1, e};
}

/* Converts slopes by u, v, w into slopes by the four points. */
CS_INLINE void cs_mesh_feature_to_points(double by[3][3], double out[4][3]) {
    for (int c = 0; c < 3; c++) {
        double four[4];
        cs_pair_distance_to_points(CS_PAIR_POINT_TRIANGLE, by[0][c], by[1][c], by[2][c], four);
        for (int k = 0; k < 4; k++)
            out[k][c] = four[k];
    }
}

/* Weights of the four points in the difference of both contact points; they sum to 0. */
CS_INLINE void cs_mesh_feature_weights(const struct cs_mesh_feature *s, double out[4]) {
    cs_pair_distance_to_points(CS_PAIR_POINT_TRIANGLE, s->weights_uv[0], s->weights_uv[1], 1,
                               out);
}

/* Exact derivative of the gradient of a feature's distance along a
 * direction: d(g) = H dp, with H the Hessian of d by the four points.
 *
 * Forward differentiation of mesh_feature.h, value and change side by side. With G = (1 - f')
 * grad h^2 + f' grad leg^2, so that g = G / 2d, and m = leg^2 - h^2:
 *
 *   dG = (1 - f') d(grad h^2) + f' d(grad leg^2) + f'' dm (grad leg^2 - grad h^2)
 *   dm = (grad leg^2 - grad h^2) . dp
 *   d(g) = H dp = dG / 2d - g dd/d,   dd = g . dp
 *
 * The cost is about that of the gradient twice, where H itself would need 12 directions. */

/* Changes along the direction, named as the values in struct cs_mesh_feature, in the order in
 * which they follow from each other. */
struct cs_mesh_feature_tangents {
    struct cs_pair_distance_tangents plane; /* of u, v, w, a and l */
    double t, zeta, dzeta_dt, dzeta_db, half_b_over_w;
    double from_foot[3], from_edge[3], dleg2_dzeta;
    double h[3][3], edge_gradient[3][3], f1;
};

/* Changes of t, zeta, its derivatives and both legs:
 *
 *   dt = (du.w + u.dw - t da) / a          a = u.u
 *   db = -half_b_over_w da                 d(half_b_over_w) = -3/2 half_b_over_w da / (a + 4
 * e^2) dy = (+-dt - y db) / b                 - at the far end; y below is b dy */
CS_INLINE void cs_mesh_feature_tangent_clamp(const struct cs_mesh_feature *s,
                                             struct cs_mesh_feature_tangents *d) {
    const double *u = s->plane.u, first = s->plane.a + DBL_MIN;
    const double b = -s->half_b_over_w * d->plane.a;
    d->t =
        (cs_vec3_dot(d->plane.u, s->plane.w) + cs_vec3_dot(u, d->plane.w) - s->t * d->plane.a) /
        first;
    d->zeta = s->dzeta_dt * d->t + s->dzeta_db * b;
    // y changes by (t' - y b')/b, and by (-t' - y b')/b beyond the middle
    const double side = s->t < 0.5 ? 1 : -1, y = side * d->t - s->y * b;
    d->dzeta_dt = side * s->d2zeta_dt2 * y;
    d->dzeta_db = -s->y * s->d2zeta_dt2 * y;
    d->half_b_over_w =
        -1.5 * s->half_b_over_w * d->plane.a / (s->plane.a + 4 * s->kind.e * s->kind.e);
    for (int c = 0; c < 3; c++) {
        d->from_foot[c] = d->plane.w[c] - d->plane.l[0] * u[c] -
                          s->plane.unclamped[0] * d->plane.u[c] -
                          d->plane.l[1] * s->plane.v[c] - s->plane.unclamped[1] * d->plane.v[c];
        d->from_edge[c] = d->plane.w[c] - d->zeta * u[c] - s->zeta * d->plane.u[c];
    }
    d->dleg2_dzeta =
        -2 * (cs_vec3_dot(d->from_edge, u) + cs_vec3_dot(s->from_edge, d->plane.u));
}

/* Changes of the gradients of h^2 and leg^2, by the product rule. way = dt/du, along = dt/dw
 * and thin = -(db/du of zeta) per u, as in cs_mesh_feature_gradients; d... is the change of
 * each. */
CS_INLINE void cs_mesh_feature_tangent_gradients(const struct cs_mesh_feature *s,
                                                 struct cs_mesh_feature_tangents *d) {
    const double *l = s->plane.unclamped, *u = s->plane.u, *w = s->plane.w, *du = d->plane.u;
    const double inverse = 1 / (s->plane.a + DBL_MIN), shrink = d->plane.a * inverse;
    for (int c = 0; c < 3; c++) {
        d->h[0][c] = -2 * (d->plane.l[0] * s->from_foot[c] + l[0] * d->from_foot[c]);
        d->h[1][c] = -2 * (d->plane.l[1] * s->from_foot[c] + l[1] * d->from_foot[c]);
        d->h[2][c] = 2 * d->from_foot[c];
        const double way = (w[c] - 2 * s->t * u[c]) * inverse;
        const double dway =
            (d->plane.w[c] - 2 * (d->t * u[c] + s->t * du[c])) * inverse - way * shrink;
        const double along = u[c] * inverse, dalong = du[c] * inverse - along * shrink;
        const double thin = 2 * s->dzeta_db * s->half_b_over_w;
        const double dthin =
            2 * (d->dzeta_db * s->half_b_over_w + s->dzeta_db * d->half_b_over_w);
        d->edge_gradient[0][c] = -2 * (d->zeta * s->from_edge[c] + s->zeta * d->from_edge[c]) +
                                 d->dleg2_dzeta * (s->dzeta_dt * way - thin * u[c]) +
                                 s->dleg2_dzeta * (d->dzeta_dt * way + s->dzeta_dt * dway -
                                                   dthin * u[c] - thin * du[c]);
        d->edge_gradient[1][c] = 0;
        d->edge_gradient[2][c] = 2 * d->from_edge[c] + d->dleg2_dzeta * s->dzeta_dt * along +
                                 s->dleg2_dzeta * (d->dzeta_dt * along + s->dzeta_dt * dalong);
    }
}

/* d(f') = f'' dm */
CS_INLINE double cs_mesh_feature_tangent_blend(const struct cs_mesh_feature *s,
                                               const struct cs_mesh_feature_tangents *d) {
    return s->f2 * (cs_vec3_dot(s->edge_gradient[0], d->plane.u) +
                    cs_vec3_dot(s->edge_gradient[2], d->plane.w) -
                    cs_vec3_dot(s->h2_gradient[0], d->plane.u) -
                    cs_vec3_dot(s->h2_gradient[1], d->plane.v) -
                    cs_vec3_dot(s->h2_gradient[2], d->plane.w));
}

/* Sets dg (4,3) = H dp in 1, and dweights (4) = the change of the weights in 1, for moves dp
 * (4,3) in m. s is the feature at the state, after cs_mesh_feature_set. */
CS_INLINE void cs_mesh_feature_tangent(const struct cs_mesh_feature *s, double dp[4][3],
                                       double dg[4][3], double dweights[4]) {
    struct cs_mesh_feature_tangents d;
    double by[3][3];
    cs_pair_distance_differences(CS_PAIR_POINT_TRIANGLE, dp, d.plane.u, d.plane.v, d.plane.w);
    cs_pair_distance_jvp_positions(CS_PAIR_POINT_TRIANGLE, &s->plane, &d.plane);
    cs_mesh_feature_tangent_clamp(s, &d);
    cs_mesh_feature_tangent_gradients(s, &d);
    d.f1 = cs_mesh_feature_tangent_blend(s, &d);
    const double dd = cs_vec3_dot(s->g[0], d.plane.u) + cs_vec3_dot(s->g[1], d.plane.v) +
                      cs_vec3_dot(s->g[2], d.plane.w);
    const double in = 1 - s->f1, half = 0.5 / s->d;
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++)
            by[k][c] = half * (in * d.h[k][c] + s->f1 * d.edge_gradient[k][c] +
                               d.f1 * (s->edge_gradient[k][c] - s->h2_gradient[k][c])) -
                       s->g[k][c] * dd / s->d;
    cs_mesh_feature_to_points(by, dg);
    const double *l = s->plane.unclamped;
    cs_pair_distance_to_points(CS_PAIR_POINT_TRIANGLE,
                               d.f1 * (l[0] - s->zeta) - in * d.plane.l[0] - s->f1 * d.zeta,
                               d.f1 * l[1] - in * d.plane.l[1], 0, dweights);
}

#endif

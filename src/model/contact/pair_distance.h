/* pair_distance.h - smooth distance of two edges: a function of four points, with its gradient
 * and its exact second derivative along a direction (pair_distance_tangent.h); and the plane of
 * a triangle, on which mesh_feature.h builds the distances of points.
 *
 * All use three differences u, v, w of the points, and the weights l of a difference w - l1 u -
 * l2 v that is as short as can be:
 *
 *   point p, triangle t0 t1 t2    u = t1 - t0   v = t2 - t0   w = p - t0
 *   edges x0 x1 and x2 x3         u = x0 - x1   v = x3 - x2   w = x0 - x2
 *
 * The distance of edges is |r| with r = w - L1 u - L2 v. l minimises |w - l1 u - l2 v|^2 + p1
 * (l1 - 1/2)^2 + p2 (l2 - 1/2)^2, a system of two equations. The regularisation p keeps it
 * regular for parallel edges. Then l is moved into the edges by the smooth positive part S of
 * scene/shape_core.h, over e_i to both sides of an end:
 *
 *   L_i = S(l_i, e_i) - S(l_i - 1, e_i)            e_i = B / sqrt(1 + (B s_i/R)^2),   B = 0.1
 *   p_i = s_i pi(s1 + s2)                          pi(s) = (q/2) s / (1 + q s^2/(2 C R^2))
 *
 * with the lengths s_i of the edges and the range R of the force between them, q = 1e-3, C =
 * 0.16. Both contact points lie on the edges, so the distance is never below the true one. Each
 * L_i has three continuous derivatives wherever the edges have a length.
 *
 * How far d exceeds the true distance t where both nearest points lie within the edges, at
 * distances y_i from the middles: let k be the cosine of the angle of the edges, and m the
 * unclamped l in the same units, s_i (l_i - 1/2). With p_i = s_i pi,
 *
 *   m1 = ((1 - k^2 + pi/s2) y1 -+ k (pi/s2) y2) / ((1 + pi/s1) (1 + pi/s2) - k^2)
 *
 * and from |y_i| <= s_i/2 follows |m1| <= s1/2: the regularisation moves no contact point
 * beyond an end, however unequal the lengths are (p_i = q s_i^2 would, by up to half of the
 * shorter edge). The minimum is at most its value at the nearest points, t^2 + (p1 + p2)/4 <=
 * t^2 + C R^2/4. Within an edge the clamp moves a contact point by S(0) = 0.15625 e_i s_i at
 * most, below 0.157 R. So d <= sqrt(t^2 + 0.04 R^2) + 0.313 R, which is below 0.86 R for t <=
 * R/2: no pair of edges that are so near is without a force, whatever their lengths. Where an
 * end is nearest, its point-triangle pairs have a force; edges have one there only if their
 * lines come near each other close to that end.
 *
 * r has 1e-12 m added at right angles, so that d has derivatives at 0 too. */
#ifndef CS_CONTACT_PAIR_DISTANCE_H
#define CS_CONTACT_PAIR_DISTANCE_H

#include "base/vec3.h"

#include <float.h>

/* B, q and C of edges, as above: the half-width of the smooth clamp in units of l, half and
 * twice of which gave the same convergence orders; the slope and the limit of p. */
#define CS_PAIR_DISTANCE_BLEND    0.1
#define CS_PAIR_DISTANCE_PARALLEL 1e-3
#define CS_PAIR_DISTANCE_PULL_MAX 0.16
#define CS_PAIR_DISTANCE_FLAT     1e-12 /* p of a triangle in units of u.u and v.v */
#define CS_PAIR_DISTANCE_MIN      1e-12 /* m, of a distance and of the length of an edge */

/* A point (the first) against a triangle (the other three), or the first two points against the
 * last two. */
enum cs_pair_kind { CS_PAIR_POINT_TRIANGLE, CS_PAIR_EDGE_EDGE };

/* Defines `linkage void name(kind, parameters)`, which calls the inline function of the same
 * arguments with the kind as a constant. Each kind has clones of its own, because loops over
 * lanes become vectors without branches alone. Both lists are in parentheses. */
#define CS_PAIR_KERNEL(linkage, name, inlined, parameters, arguments)                          \
    CS_CLONES static void name##_triangles parameters {                                        \
        inlined(CS_PAIR_POINT_TRIANGLE, CS_UNWRAPPED arguments);                               \
    }                                                                                          \
    CS_CLONES static void name##_edges parameters {                                            \
        inlined(CS_PAIR_EDGE_EDGE, CS_UNWRAPPED arguments);                                    \
    }                                                                                          \
    linkage void name(enum cs_pair_kind kind, CS_UNWRAPPED parameters) {                       \
        if (kind == CS_PAIR_EDGE_EDGE)                                                         \
            name##_edges arguments;                                                            \
        else                                                                                   \
            name##_triangles arguments;                                                        \
    }
#define CS_UNWRAPPED(...) __VA_ARGS__

/* Two edges at one state, filled by cs_pair_distance_set; or a point and the plane of a
 * triangle, of which cs_pair_distance_frame fills u to unclamped. */
struct cs_pair_distance {
    /* distance in m; unit vector from the second contact point to the first */
    double d, n[3];
    double u[3], v[3], w[3]; /* m */
    /* u.u, u.v, v.v in m2; the system's determinant is 1/inverse */
    double a, b, c, inverse_determinant;
    /* m2, regularisation p1 and p2 */
    double pull[2];
    /* l before and L after the clamp */
    double unclamped[2], clamped[2];
    /* lengths s_i in m; pi and its two derivatives */
    double length[2], pull_per_length[3];
    /* L_i, its derivative by l_i and by s_i; then by l_i twice, by both, by s_i twice */
    double blend[2][3], blend_second[2][3];
};

/* Solves (a + p1, b; b, c + p2) z = k by Cramer's rule. */
CS_INLINE void cs_pair_distance_solve(const struct cs_pair_distance *s, const double k[2],
                                      double z[2]) {
    const double a = s->a + s->pull[0], c = s->c + s->pull[1];
    z[0] = (c * k[0] - s->b * k[1]) * s->inverse_determinant;
    z[1] = (a * k[1] - s->b * k[0]) * s->inverse_determinant;
}

/* L_i = S(l_i) - S(l_i - 1): 0 below -e, 1 above 1 + e, and l_i between e and 1 - e. S is
 * homogeneous, S(g t, g e) = g S(t, e), which gives its derivatives by e from those by t:
 *
 *   e S_e = S - t S'      e S_te = -t S''      e^2 S_ee = t^2 S''
 *   e' = -s e^3/R^2       e'' = e^3/R^2 (3 (s e/R)^2 - 1)      by the length s */
CS_INLINE void cs_pair_distance_clamp_edge(struct cs_pair_distance *s, int i, double squared,
                                           double range) {
    const double narrow = CS_PAIR_DISTANCE_BLEND / range;
    const double e = CS_PAIR_DISTANCE_BLEND / sqrt(1 + narrow * narrow * squared);
    const double l = s->unclamped[i], t = l - 1, ratio = e / range, bend = e * (ratio * ratio);
    const double first = -s->length[i] * bend;
    const double second = bend * (3 * squared * (ratio * ratio) - 1);
    double low[3], high[3];
    cs_smooth_positive(l, e, low);
    cs_smooth_positive(t, e, high);
    const double by_e = (low[0] - l * low[1] - (high[0] - t * high[1])) / e;
    const double by_both = -(l * low[2] - t * high[2]) / e;
    const double by_e_twice = (l * l * low[2] - t * t * high[2]) / (e * e);
    s->clamped[i] = low[0] - high[0];
    s->blend[i][0] = s->clamped[i];
    s->blend[i][1] = low[1] - high[1];
    s->blend[i][2] = by_e * first;
    s->blend_second[i][0] = low[2] - high[2];
    s->blend_second[i][1] = by_both * first;
    s->blend_second[i][2] = by_e_twice * first * first + by_e * second;
}

/* The three differences of four points, or of their displacements: (u, v, w) = D p. */
CS_INLINE void cs_pair_distance_differences(enum cs_pair_kind kind, double p[4][3], double u[3],
                                            double v[3], double w[3]) {
    for (int c = 0; c < 3; c++) {
        const bool edges = kind == CS_PAIR_EDGE_EDGE;
        u[c] = edges ? p[0][c] - p[1][c] : p[2][c] - p[1][c];
        v[c] = edges ? p[3][c] - p[2][c] : p[3][c] - p[1][c];
        w[c] = edges ? p[0][c] - p[2][c] : p[0][c] - p[1][c];
    }
}

/* D^T for one component: slopes by u, v, w to slopes by the four points, which sum to 0. */
CS_INLINE void cs_pair_distance_to_points(enum cs_pair_kind kind, double u, double v, double w,
                                          double out[4]) {
    const bool edges = kind == CS_PAIR_EDGE_EDGE;
    out[0] = edges ? u + w : w;
    out[1] = edges ? -u : -(u + v + w);
    out[2] = edges ? -(v + w) : u;
    out[3] = v;
}

/* Inverse of D^T on slopes by the points that sum to 0. */
CS_INLINE void cs_pair_distance_from_points(enum cs_pair_kind kind, const double four[4],
                                            double by[3]) {
    const bool edges = kind == CS_PAIR_EDGE_EDGE;
    by[0] = edges ? -four[1] : four[2];
    by[1] = four[3];
    by[2] = edges ? four[0] + four[1] : four[0];
}

/* Sets lengths, pi with its derivatives, and p of edges: with x = q s^2/(2 C R^2) at s = s1 +
 * s2 is pi' = (q/2) (1 - x)/(1 + x)^2 and pi'' = q (x/s) (x - 3)/(1 + x)^3. */
CS_INLINE void cs_pair_distance_pull_edges(struct cs_pair_distance *s, double range) {
    const double least = CS_PAIR_DISTANCE_MIN * CS_PAIR_DISTANCE_MIN;
    const double half = 0.5 * CS_PAIR_DISTANCE_PARALLEL;
    const double bend = half / (CS_PAIR_DISTANCE_PULL_MAX * range * range);
    s->length[0] = sqrt(s->a + least);
    s->length[1] = sqrt(s->c + least);
    const double sum = s->length[0] + s->length[1], x = bend * sum * sum, in = 1 / (1 + x);
    s->pull_per_length[0] = half * sum * in;
    s->pull_per_length[1] = half * (1 - x) * (in * in);
    s->pull_per_length[2] = 2 * half * bend * sum * (x - 3) * (in * in * in);
    s->pull[0] = s->length[0] * s->pull_per_length[0];
    s->pull[1] = s->length[1] * s->pull_per_length[0];
}

/* One step of iterative refinement of l: of long edges, nearly parallel, a c - b^2 loses up to
 * nine digits. The residual is made of one small vector, so that its rounding moves both l as a
 * rigid motion would. */
CS_INLINE void cs_pair_distance_refine(struct cs_pair_distance *s) {
    double *l = s->unclamped, r[3], more[2];
    for (int c = 0; c < 3; c++)
        r[c] = s->w[c] - l[0] * s->u[c] - l[1] * s->v[c];
    const double rest[2] = {cs_vec3_dot(s->u, r) + s->pull[0] * (0.5 - l[0]),
                            cs_vec3_dot(s->v, r) + s->pull[1] * (0.5 - l[1])};
    cs_pair_distance_solve(s, rest, more);
    l[0] += more[0];
    l[1] += more[1];
}

/* Sets the differences, their products, p and l. DBL_MIN keeps the inverse finite if all points
 * coincide. range: R of edges in m; triangles have none. */
CS_INLINE void cs_pair_distance_frame(struct cs_pair_distance *s, enum cs_pair_kind kind,
                                      double range, double p[4][3]) {
    cs_pair_distance_differences(kind, p, s->u, s->v, s->w);
    s->a = cs_vec3_dot(s->u, s->u);
    s->b = cs_vec3_dot(s->u, s->v);
    s->c = cs_vec3_dot(s->v, s->v);
    s->pull[0] = CS_PAIR_DISTANCE_FLAT * s->a;
    s->pull[1] = CS_PAIR_DISTANCE_FLAT * s->c;
    if (kind == CS_PAIR_EDGE_EDGE)
        cs_pair_distance_pull_edges(s, range);
    s->inverse_determinant =
        1 / ((s->a + s->pull[0]) * (s->c + s->pull[1]) - s->b * s->b + DBL_MIN);
    const double right[2] = {cs_vec3_dot(s->u, s->w) + 0.5 * s->pull[0],
                             cs_vec3_dot(s->v, s->w) + 0.5 * s->pull[1]};
    cs_pair_distance_solve(s, right, s->unclamped);
    if (kind == CS_PAIR_EDGE_EDGE)
        cs_pair_distance_refine(s);
}

/* Sets the distance of two edges, and all that its derivatives need. range: R in m, above 0. p
 * is not changed. */
CS_INLINE void cs_pair_distance_set(struct cs_pair_distance *s, double range, double p[4][3]) {
    cs_pair_distance_frame(s, CS_PAIR_EDGE_EDGE, range, p);
    cs_pair_distance_clamp_edge(s, 0, s->a, range);
    cs_pair_distance_clamp_edge(s, 1, s->c, range);
    double r[3];
    for (int c = 0; c < 3; c++)
        r[c] = s->w[c] - s->clamped[0] * s->u[c] - s->clamped[1] * s->v[c];
    s->d = sqrt(cs_vec3_dot(r, r) + CS_PAIR_DISTANCE_MIN * CS_PAIR_DISTANCE_MIN);
    for (int c = 0; c < 3; c++)
        s->n[c] = r[c] / s->d;
}

/* Weights of the four points in the difference of both contact points; they sum to 0. */
CS_INLINE void cs_pair_distance_weights(const struct cs_pair_distance *s, double out[4]) {
    cs_pair_distance_to_points(CS_PAIR_EDGE_EDGE, -s->clamped[0], -s->clamped[1], 1, out);
}

/* Intermediate values of the gradient, by the adjoint method: k = dd/dl through the
 * clamp, z = A^-1 k, and y = z1 u + z2 v. For one direction, k.dl = z.(d(rhs) - dA l), so that
 * one solution z serves all twelve components. The lengths act through p and e:
 *
 *   m_j = dd/ds_j = sum_i z_i (1/2 - l_i) dp_i/ds_j + dd/dL_j dL_j/ds_j
 *       = pi' sum_i z_i (1/2 - l_i) s_i + pi z_j (1/2 - l_j) + dd/dL_j dL_j/ds_j */
struct cs_pair_distance_gradients {
    double dd_dweight[2]; /* of d by L1, L2 */
    double k[2], z[2], y[3];
    /* z_i (1/2 - l_i), and their sum with the weights s_i */
    double lever[2], levers;
    /* m_j / s_j */
    double stretch[2];
};

/* Fills `slopes`. dd/dL is (-n.u, -n.v). */
CS_INLINE void cs_pair_distance_set_slopes(const struct cs_pair_distance *s,
                                           struct cs_pair_distance_gradients *slopes) {
    const double *pi = s->pull_per_length;
    slopes->dd_dweight[0] = -cs_vec3_dot(s->n, s->u);
    slopes->dd_dweight[1] = -cs_vec3_dot(s->n, s->v);
    for (int i = 0; i < 2; i++)
        slopes->k[i] = slopes->dd_dweight[i] * s->blend[i][1];
    cs_pair_distance_solve(s, slopes->k, slopes->z);
    for (int i = 0; i < 2; i++)
        slopes->lever[i] = slopes->z[i] * (0.5 - s->unclamped[i]);
    slopes->levers = slopes->lever[0] * s->length[0] + slopes->lever[1] * s->length[1];
    for (int i = 0; i < 2; i++)
        slopes->stretch[i] = (pi[1] * slopes->levers + pi[0] * slopes->lever[i] +
                              slopes->dd_dweight[i] * s->blend[i][2]) /
                             s->length[i];
    for (int c = 0; c < 3; c++)
        slopes->y[c] = slopes->z[0] * s->u[c] + slopes->z[1] * s->v[c];
}

/* Gradient by the differences u, v, w, component c. */
CS_INLINE void cs_pair_distance_slope(const struct cs_pair_distance *s,
                                      const struct cs_pair_distance_gradients *gradients, int c,
                                      double by[3]) {
    const double *l = s->unclamped;
    const double r = s->w[c] - l[0] * s->u[c] - l[1] * s->v[c];
    by[0] = gradients->z[0] * r + gradients->stretch[0] * s->u[c] - l[0] * gradients->y[c] -
            s->clamped[0] * s->n[c];
    by[1] = gradients->z[1] * r + gradients->stretch[1] * s->v[c] - l[1] * gradients->y[c] -
            s->clamped[1] * s->n[c];
    by[2] = gradients->y[c] + s->n[c];
}

/* Sets g (4,3) = the gradient of d by the four points. By the differences it is
 *
 *   g_u = -L1 n + z1 r0 - l1 y + (m1/s1) u,   r0 = w - l1 u - l2 v
 *   g_v = -L2 n + z2 r0 - l2 y + (m2/s2) v
 *   g_w = n + y
 *
 * The sums of g and of p x g over the points are 0: forces along g have no resultant
 * or moment. */
CS_INLINE void cs_pair_distance_gradient(const struct cs_pair_distance *s, double g[4][3]) {
    struct cs_pair_distance_gradients gradients;
    cs_pair_distance_set_slopes(s, &gradients);
    for (int c = 0; c < 3; c++) {
        double by[3], out[4];
        cs_pair_distance_slope(s, &gradients, c, by);
        cs_pair_distance_to_points(CS_PAIR_EDGE_EDGE, by[0], by[1], by[2], out);
        for (int k = 0; k < 4; k++)
            g[k][c] = out[k];
    }
}

#endif

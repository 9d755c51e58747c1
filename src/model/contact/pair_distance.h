/* pair_distance.h - smooth distance of a point and a triangle, or of two edges: a function of
 * four points, with its gradient and exact second derivative along a direction.
 *
 * Both are |r| with r = w - L1 u - L2 v for three differences u, v, w of the points:
 *
 *   point p, triangle t0 t1 t2    u = t1 - t0   v = t2 - t0   w = p - t0
 *   edges x0 x1 and x2 x3         u = x0 - x1   v = x3 - x2   w = x0 - x2
 *
 * (l1, l2) minimises |w - l1 u - l2 v|^2 + q (u.u (l1 - 1/2)^2 + v.v (l2 - 1/2)^2). This is a
 * system of two equations. q = CS_PAIR_DISTANCE_PARALLEL keeps it regular for parallel edges;
 * triangles have a q too small to change a distance, for those without area. Then l is moved
 * into the primitives by the smooth positive part S of scene/shape_core.h, over
 * CS_PAIR_DISTANCE_BLEND to both sides of a border:
 *
 *   triangle   L_i = S(l_i) / (S(l0) + S(l1) + S(l2)),   l0 = 1 - l1 - l2
 *   edges      L_i = S(l_i) - S(l_i - 1)
 *
 * Both contact points lie on the primitives, so the distance is never below the true one. Over
 * the inside of a triangle it is the true one; at its edges it is larger by at most 0.016 of an
 * edge. It has three continuous derivatives wherever it is positive, without a kink where the
 * closest feature changes. r has 1e-12 m added at right angles, so that d has derivatives at 0
 * too. */
#ifndef CS_CONTACT_PAIR_DISTANCE_H
#define CS_CONTACT_PAIR_DISTANCE_H

#include "base/vec3.h"
#include "scene/shape_core.h"

#include <float.h>
#include <stdbool.h>

/* BLEND is the half-width of the smooth clamp in units of l; half and twice of it gave the same
 * convergence orders. PARALLEL and FLAT are q of edges and of triangles. */
#define CS_PAIR_DISTANCE_BLEND    0.1
#define CS_PAIR_DISTANCE_PARALLEL 1e-3
#define CS_PAIR_DISTANCE_FLAT     1e-12 /* q of a triangle */
#define CS_PAIR_DISTANCE_MIN      1e-12 /* m */

/* A point (the first) against a triangle (the other three), or the first two points against the
 * last two. */
enum cs_pair_kind { CS_PAIR_POINT_TRIANGLE, CS_PAIR_EDGE_EDGE };

/* One pair at one state; cs_pair_distance_set fills it. */
struct cs_pair_distance {
    enum cs_pair_kind kind;
    /* distance in m; unit vector from the second contact point to the first */
    double d, n[3];
    double u[3], v[3], w[3]; /* m */
    double a, b, c, q,
        inverse_determinant; /* u.u, u.v, v.v; the system's determinant is 1/inverse */
    /* l before and L after the smooth clamp */
    double unclamped[2], clamped[2];
    /* S, S', S'' of l0, l1, l2 for a triangle, of l1, l2 for edges */
    double blend[3][3];
};

/* Solves ((1+q) a, b; b, (1+q) c) z = k by Cramer's rule. */
CS_INLINE void cs_pair_distance_solve(const struct cs_pair_distance *s, const double k[2],
                                      double z[2]) {
    const double a = (1 + s->q) * s->a, c = (1 + s->q) * s->c;
    z[0] = (c * k[0] - s->b * k[1]) * s->inverse_determinant;
    z[1] = (a * k[1] - s->b * k[0]) * s->inverse_determinant;
}

/* L_i = S(l_i) / sum of S(l_j). The sum never vanishes: the l_i add up to 1, so one of them is
 * at least 1/3, and S(l) = l from 0.1 on. */
CS_INLINE void cs_pair_distance_clamp_triangle(struct cs_pair_distance *s) {
    cs_smooth_positive(1 - s->unclamped[0] - s->unclamped[1], CS_PAIR_DISTANCE_BLEND,
                       s->blend[0]);
    cs_smooth_positive(s->unclamped[0], CS_PAIR_DISTANCE_BLEND, s->blend[1]);
    cs_smooth_positive(s->unclamped[1], CS_PAIR_DISTANCE_BLEND, s->blend[2]);
    const double sum = s->blend[0][0] + s->blend[1][0] + s->blend[2][0]; // above 1/3
    s->clamped[0] = s->blend[1][0] / sum;
    s->clamped[1] = s->blend[2][0] / sum;
}

/* L_i = S(l_i) - S(l_i - 1): 0 below -0.1, 1 above 1.1, and l_i between 0.1 and 0.9. */
CS_INLINE void cs_pair_distance_clamp_edges(struct cs_pair_distance *s) {
    for (int i = 0; i < 2; i++) {
        double low[3], high[3];
        cs_smooth_positive(s->unclamped[i], CS_PAIR_DISTANCE_BLEND, low);
        cs_smooth_positive(s->unclamped[i] - 1, CS_PAIR_DISTANCE_BLEND, high);
        for (int k = 0; k < 3; k++)
            s->blend[i][k] = low[k] - high[k];
        s->clamped[i] = s->blend[i][0];
    }
    for (int k = 0; k < 3; k++)
        s->blend[2][k] = 0;
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

/* Sets the differences, their products and l. DBL_MIN keeps the inverse finite if all points
 * coincide. */
CS_INLINE void cs_pair_distance_frame(struct cs_pair_distance *s, enum cs_pair_kind kind,
                                      double p[4][3]) {
    s->kind = kind;
    s->q = kind == CS_PAIR_EDGE_EDGE ? CS_PAIR_DISTANCE_PARALLEL : CS_PAIR_DISTANCE_FLAT;
    cs_pair_distance_differences(kind, p, s->u, s->v, s->w);
    s->a = cs_vec3_dot(s->u, s->u);
    s->b = cs_vec3_dot(s->u, s->v);
    s->c = cs_vec3_dot(s->v, s->v);
    const double grown = (1 + s->q) * (1 + s->q);
    s->inverse_determinant = 1 / (grown * s->a * s->c - s->b * s->b + DBL_MIN);
    const double right[2] = {cs_vec3_dot(s->u, s->w) + 0.5 * s->q * s->a,
                             cs_vec3_dot(s->v, s->w) + 0.5 * s->q * s->c};
    cs_pair_distance_solve(s, right, s->unclamped);
}

/* Sets the distance, and all that its derivatives need. p is not changed. */
CS_INLINE void cs_pair_distance_set(struct cs_pair_distance *s, enum cs_pair_kind kind,
                                    double p[4][3]) {
    cs_pair_distance_frame(s, kind, p);
    if (kind == CS_PAIR_EDGE_EDGE)
        cs_pair_distance_clamp_edges(s);
    else
        cs_pair_distance_clamp_triangle(s);
    double r[3];
    for (int c = 0; c < 3; c++)
        r[c] = s->w[c] - s->clamped[0] * s->u[c] - s->clamped[1] * s->v[c];
    s->d = sqrt(cs_vec3_dot(r, r) + CS_PAIR_DISTANCE_MIN * CS_PAIR_DISTANCE_MIN);
    for (int c = 0; c < 3; c++)
        s->n[c] = r[c] / s->d;
}

/* Weights of the four points in the difference of both contact points; they sum to 0. */
CS_INLINE void cs_pair_distance_weights(const struct cs_pair_distance *s, double out[4]) {
    cs_pair_distance_to_points(s->kind, -s->clamped[0], -s->clamped[1], 1, out);
}

/* Intermediate values of the gradient, by the adjoint method: k = dd/dl through the clamp, z =
 * A^-1 k, and y = z1 u + z2 v. For one direction, k.dl = z.(d(rhs) - dA l), so that one
 * solution z serves all twelve components. */
struct cs_pair_distance_gradients {
    double dd_dweight[2]; /* of d by L1, L2 */
    /* triangle: sum of L_i dd/dL_i */
    double mean;
    /* triangle: slopes by l0, l1, l2 as independent numbers */
    double h[3];
    double k[2], z[2], y[3];
};

/* Fills `slopes`. dd/dL is (-n.u, -n.v). For a triangle dd/dL_0 = 0, and each L depends on all
 * l_i through the sum. */
CS_INLINE void cs_pair_distance_set_slopes(const struct cs_pair_distance *s,
                                           struct cs_pair_distance_gradients *slopes) {
    const double *g = slopes->dd_dweight;
    slopes->dd_dweight[0] = -cs_vec3_dot(s->n, s->u);
    slopes->dd_dweight[1] = -cs_vec3_dot(s->n, s->v);
    slopes->mean = s->clamped[0] * g[0] + s->clamped[1] * g[1];
    if (s->kind == CS_PAIR_EDGE_EDGE) {
        slopes->k[0] = g[0] * s->blend[0][1];
        slopes->k[1] = g[1] * s->blend[1][1];
    } else {
        const double sum = s->blend[0][0] + s->blend[1][0] + s->blend[2][0];
        slopes->h[0] = -slopes->mean * s->blend[0][1] / sum;
        slopes->h[1] = (g[0] - slopes->mean) * s->blend[1][1] / sum;
        slopes->h[2] = (g[1] - slopes->mean) * s->blend[2][1] / sum;
        slopes->k[0] = slopes->h[1] - slopes->h[0];
        slopes->k[1] = slopes->h[2] - slopes->h[0];
    }
    cs_pair_distance_solve(s, slopes->k, slopes->z);
    for (int c = 0; c < 3; c++)
        slopes->y[c] = slopes->z[0] * s->u[c] + slopes->z[1] * s->v[c];
}

/* Sets g (4,3) = the gradient of d by the four points. By the differences it is
 *
 *   g_u = -L1 n + z1 (r0 + q (1 - 2 l1) u) - l1 y,   r0 = w - l1 u - l2 v
 *   g_v = -L2 n + z2 (r0 + q (1 - 2 l2) v) - l2 y
 *   g_w = n + y
 *
 * The sum of g over the points is 0, and so is that of p x g: no net force and no torque. */
CS_INLINE void cs_pair_distance_gradient(const struct cs_pair_distance *s, double g[4][3]) {
    struct cs_pair_distance_gradients at;
    cs_pair_distance_set_slopes(s, &at);
    const double pull[2] = {s->q * (1 - 2 * s->unclamped[0]), s->q * (1 - 2 * s->unclamped[1])};
    for (int c = 0; c < 3; c++) {
        const double r = s->w[c] - s->unclamped[0] * s->u[c] - s->unclamped[1] * s->v[c];
        const double u = at.z[0] * (r + pull[0] * s->u[c]) - s->unclamped[0] * at.y[c];
        const double v = at.z[1] * (r + pull[1] * s->v[c]) - s->unclamped[1] * at.y[c];
        double out[4];
        cs_pair_distance_to_points(s->kind, u - s->clamped[0] * s->n[c],
                                   v - s->clamped[1] * s->n[c], at.y[c] + s->n[c], out);
        for (int k = 0; k < 4; k++)
            g[k][c] = out[k];
    }
}

#endif

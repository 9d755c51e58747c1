/* pair_distance_tangent.h - exact derivative of the gradient of a pair's distance along a
 * direction: d(g) = H dp, with H the Hessian of d by the four points.
 *
 * Forward differentiation of pair_distance.h, value and change side by side. l solves A l = k
 * with A = ((1+q) a, b; b, (1+q) c), k = (u.w + q a/2, v.w + q c/2), and z solves A z = dd/dl:
 *
 *   dl = A^-1 (dk - dA l),   dz = A^-1 (d(dd/dl) - dA z)
 *   dL by the smooth clamp,  dr = dw - L1 du - L2 dv - dL1 u - dL2 v,  dd = n.dr
 *   dn = (dr - n dd) / d
 *   d(g) = H dp:  the product rule on g by u, v, w, then the transposed differences
 *
 * One solution of a 2 x 2 system more than the gradient; no 12 x 12 matrix is formed. */
#ifndef CS_NARROW_PHASE_PAIR_DISTANCE_TANGENT_H
#define CS_NARROW_PHASE_PAIR_DISTANCE_TANGENT_H

#include "model/contact/pair_distance.h"

/* Changes along the direction, named as the values in struct cs_pair_distance and struct
 * cs_pair_distance_gradients, in the order in which they follow from each other. */
struct cs_pair_distance_tangents {
    double u[3], v[3], w[3];
    double a, b, c;
    double l[2], weight[2], n[3];
    double dd_dweight_dot[2], k[2], z[2], y[3];
};

/* Change of a solution of A z = k: out = A^-1 (right - dA solution), right = dk. */
CS_INLINE void cs_pair_distance_jvp_solution(const struct cs_pair_distance *s,
                                             const struct cs_pair_distance_tangents *d,
                                             const double solution[2], const double right[2],
                                             double out[2]) {
    const double grown = 1 + s->q;
    const double rest[2] = {right[0] - grown * d->a * solution[0] - d->b * solution[1],
                            right[1] - d->b * solution[0] - grown * d->c * solution[1]};
    cs_pair_distance_solve(s, rest, out);
}

/* Changes of a, b, c and l from those of u, v, w. */
CS_INLINE void cs_pair_distance_jvp_positions(const struct cs_pair_distance *s,
                                              struct cs_pair_distance_tangents *d) {
    d->a = 2 * cs_vec3_dot(s->u, d->u);
    d->b = cs_vec3_dot(s->u, d->v) + cs_vec3_dot(d->u, s->v);
    d->c = 2 * cs_vec3_dot(s->v, d->v);
    const double right[2] = {
        cs_vec3_dot(d->u, s->w) + cs_vec3_dot(s->u, d->w) + 0.5 * s->q * d->a,
        cs_vec3_dot(d->v, s->w) + cs_vec3_dot(s->v, d->w) + 0.5 * s->q * d->c};
    cs_pair_distance_jvp_solution(s, d, s->unclamped, right, d->l);
}

/* Triangle: change of the weights L_i = S_i / sum, dL_i = (S_i' dl_i - L_i dsum) / sum; returns
 * dsum. dl0 = -dl1 - dl2. */
CS_INLINE double cs_pair_distance_jvp_triangle(const struct cs_pair_distance *s,
                                               struct cs_pair_distance_tangents *d) {
    const double sum = s->blend[0][0] + s->blend[1][0] + s->blend[2][0];
    const double first = s->blend[1][1] * d->l[0], second = s->blend[2][1] * d->l[1];
    const double dsum = first + second - s->blend[0][1] * (d->l[0] + d->l[1]);
    d->weight[0] = (first - s->clamped[0] * dsum) / sum;
    d->weight[1] = (second - s->clamped[1] * dsum) / sum;
    return dsum;
}

/* Changes of n and of the slopes dd/dL = (-n.u, -n.v). */
CS_INLINE void cs_pair_distance_jvp_direction(const struct cs_pair_distance *s,
                                              struct cs_pair_distance_tangents *d) {
    double dr[3];
    for (int c = 0; c < 3; c++)
        dr[c] = d->w[c] - s->clamped[0] * d->u[c] - s->clamped[1] * d->v[c] -
                d->weight[0] * s->u[c] - d->weight[1] * s->v[c];
    const double dd = cs_vec3_dot(s->n, dr);
    for (int c = 0; c < 3; c++)
        d->n[c] = (dr[c] - s->n[c] * dd) / s->d;
    d->dd_dweight_dot[0] = -cs_vec3_dot(d->n, s->u) - cs_vec3_dot(s->n, d->u);
    d->dd_dweight_dot[1] = -cs_vec3_dot(d->n, s->v) - cs_vec3_dot(s->n, d->v);
}

/* Change of k = dd/dl, the slopes of d before the clamp: for edges k_i = dd/dL_i S_i', for a
 * triangle k_i = h_i - h_0 with h_i = (dd/dL_i - mean) S_i' / sum. */
CS_INLINE void cs_pair_distance_jvp_slopes(const struct cs_pair_distance *s,
                                           const struct cs_pair_distance_gradients *at,
                                           double dsum, struct cs_pair_distance_tangents *d) {
    if (s->kind == CS_PAIR_EDGE_EDGE) {
        for (int i = 0; i < 2; i++)
            d->k[i] = d->dd_dweight_dot[i] * s->blend[i][1] +
                      at->dd_dweight[i] * s->blend[i][2] * d->l[i];
        return;
    }
    const double sum = s->blend[0][0] + s->blend[1][0] + s->blend[2][0];
    const double dmean =
        d->weight[0] * at->dd_dweight[0] + s->clamped[0] * d->dd_dweight_dot[0] +
        d->weight[1] * at->dd_dweight[1] + s->clamped[1] * d->dd_dweight_dot[1];
    const double g[3] = {0, at->dd_dweight[0], at->dd_dweight[1]};
    const double dg[3] = {0, d->dd_dweight_dot[0], d->dd_dweight_dot[1]};
    const double dl[3] = {-d->l[0] - d->l[1], d->l[0], d->l[1]};
    double dh[3];
    for (int i = 0; i < 3; i++)
        dh[i] = ((dg[i] - dmean) * s->blend[i][1] + (g[i] - at->mean) * s->blend[i][2] * dl[i] -
                 at->h[i] * dsum) /
                sum;
    d->k[0] = dh[1] - dh[0];
    d->k[1] = dh[2] - dh[0];
}

/* Component c of the change of the gradient at the four points. r is the component of w - l1 u
 * - l2 v without clamp, and pull = q (1 - 2 l) the part of the regularisation. */
CS_INLINE void cs_pair_distance_jvp_gradient(const struct cs_pair_distance *s,
                                             const struct cs_pair_distance_gradients *at,
                                             const struct cs_pair_distance_tangents *d, int c,
                                             double out[4]) {
    const double *u = s->u, *v = s->v, *l = s->unclamped, *z = at->z;
    const double pull[2] = {s->q * (1 - 2 * l[0]), s->q * (1 - 2 * l[1])};
    const double r = s->w[c] - l[0] * u[c] - l[1] * v[c];
    const double dr =
        d->w[c] - l[0] * d->u[c] - l[1] * d->v[c] - d->l[0] * u[c] - d->l[1] * v[c];
    const double du = d->z[0] * (r + pull[0] * u[c]) +
                      z[0] * (dr + pull[0] * d->u[c] - 2 * s->q * d->l[0] * u[c]) -
                      d->l[0] * at->y[c] - l[0] * d->y[c];
    const double dv = d->z[1] * (r + pull[1] * v[c]) +
                      z[1] * (dr + pull[1] * d->v[c] - 2 * s->q * d->l[1] * v[c]) -
                      d->l[1] * at->y[c] - l[1] * d->y[c];
    cs_pair_distance_to_points(s->kind, du - d->weight[0] * s->n[c] - s->clamped[0] * d->n[c],
                               dv - d->weight[1] * s->n[c] - s->clamped[1] * d->n[c],
                               d->y[c] + d->n[c], out);
}

/* Sets dg (4,3) = H dp, and dweights (4) = the change of the weights, for moves dp (4,3) in m.
 * s is the pair at the state, after cs_pair_distance_set. */
CS_INLINE void cs_pair_distance_tangent(const struct cs_pair_distance *s, double dp[4][3],
                                        double dg[4][3], double dweights[4]) {
    struct cs_pair_distance_gradients at;
    struct cs_pair_distance_tangents d;
    double dsum = 0, out[4];
    cs_pair_distance_set_slopes(s, &at);
    cs_pair_distance_differences(s->kind, dp, d.u, d.v, d.w);
    cs_pair_distance_jvp_positions(s, &d);
    if (s->kind == CS_PAIR_EDGE_EDGE)
        for (int i = 0; i < 2; i++)
            d.weight[i] = s->blend[i][1] * d.l[i];
    else
        dsum = cs_pair_distance_jvp_triangle(s, &d);
    cs_pair_distance_jvp_direction(s, &d);
    cs_pair_distance_jvp_slopes(s, &at, dsum, &d);
    cs_pair_distance_jvp_solution(s, &d, at.z, d.k, d.z);
    for (int c = 0; c < 3; c++)
        d.y[c] = d.z[0] * s->u[c] + at.z[0] * d.u[c] + d.z[1] * s->v[c] + at.z[1] * d.v[c];
    for (int c = 0; c < 3; c++) {
        cs_pair_distance_jvp_gradient(s, &at, &d, c, out);
        for (int k = 0; k < 4; k++)
            dg[k][c] = out[k];
    }
    cs_pair_distance_to_points(s->kind, -d.weight[0], -d.weight[1], 0, dweights);
}

#endif

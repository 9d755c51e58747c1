/* pair_distance_tangent.h - exact derivative of the gradient of the distance of two edges along
 * a direction: d(g) = H dp, with H the Hessian of d by the four points.
 *
 * Forward differentiation of pair_distance.h, value and change side by side; d... is a change.
 * l solves A l = k with A = (a + p1, b; b, c + p2), k = (u.w + p1/2, v.w + p2/2), and z solves
 * A z = dd/dl:
 *
 *   ds_i = u_i.du_i / s_i            dp_i = ds_i pi + s_i pi' (ds1 + ds2)
 *   dl = A^-1 (dk - dA l),           dz = A^-1 (d(dd/dl) - dA z)
 *   dL = L_l dl + L_s ds,            dr = dw - L1 du - L2 dv - dL1 u - dL2 v,  dd = n.dr
 *   dn = (dr - n dd) / d
 *   dm_j by the product rule on m_j, with pi'' and the second derivatives of L
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
    double length[2], pull[2];
    double l[2], weight[2], n[3];
    double dd_dweight_dot[2], k[2], z[2], y[3];
    double stretch[2];
};

/* Change of a solution of A z = k: out = A^-1 (right - dA solution), right = dk. */
CS_INLINE void cs_pair_distance_jvp_solution(const struct cs_pair_distance *s,
                                             const struct cs_pair_distance_tangents *d,
                                             const double solution[2], const double right[2],
                                             double out[2]) {
    const double a = d->a + d->pull[0], c = d->c + d->pull[1];
    const double rest[2] = {right[0] - a * solution[0] - d->b * solution[1],
                            right[1] - d->b * solution[0] - c * solution[1]};
    cs_pair_distance_solve(s, rest, out);
}

/* Changes of a, b, c, the lengths, p and l from those of u, v, w. */
CS_INLINE void cs_pair_distance_jvp_positions(enum cs_pair_kind kind,
                                              const struct cs_pair_distance *s,
                                              struct cs_pair_distance_tangents *d) {
    d->a = 2 * cs_vec3_dot(s->u, d->u);
    d->b = cs_vec3_dot(s->u, d->v) + cs_vec3_dot(d->u, s->v);
    d->c = 2 * cs_vec3_dot(s->v, d->v);
    d->pull[0] = CS_PAIR_DISTANCE_FLAT * d->a;
    d->pull[1] = CS_PAIR_DISTANCE_FLAT * d->c;
    if (kind == CS_PAIR_EDGE_EDGE) {
        d->length[0] = 0.5 * d->a / s->length[0];
        d->length[1] = 0.5 * d->c / s->length[1];
        const double more = s->pull_per_length[1] * (d->length[0] + d->length[1]);
        for (int i = 0; i < 2; i++)
            d->pull[i] = d->length[i] * s->pull_per_length[0] + s->length[i] * more;
    }
    const double right[2] = {
        cs_vec3_dot(d->u, s->w) + cs_vec3_dot(s->u, d->w) + 0.5 * d->pull[0],
        cs_vec3_dot(d->v, s->w) + cs_vec3_dot(s->v, d->w) + 0.5 * d->pull[1]};
    cs_pair_distance_jvp_solution(s, d, s->unclamped, right, d->l);
}

/* Changes of L, n and of the slopes dd/dL = (-n.u, -n.v). */
CS_INLINE void cs_pair_distance_jvp_direction(const struct cs_pair_distance *s,
                                              struct cs_pair_distance_tangents *d) {
    double dr[3];
    for (int i = 0; i < 2; i++)
        d->weight[i] = s->blend[i][1] * d->l[i] + s->blend[i][2] * d->length[i];
    for (int c = 0; c < 3; c++)
        dr[c] = d->w[c] - s->clamped[0] * d->u[c] - s->clamped[1] * d->v[c] -
                d->weight[0] * s->u[c] - d->weight[1] * s->v[c];
    const double dd = cs_vec3_dot(s->n, dr);
    for (int c = 0; c < 3; c++)
        d->n[c] = (dr[c] - s->n[c] * dd) / s->d;
    d->dd_dweight_dot[0] = -cs_vec3_dot(d->n, s->u) - cs_vec3_dot(s->n, d->u);
    d->dd_dweight_dot[1] = -cs_vec3_dot(d->n, s->v) - cs_vec3_dot(s->n, d->v);
}

/* Changes of k_i = dd/dL_i L_l, the slopes of d before the clamp, and of z. */
CS_INLINE void cs_pair_distance_jvp_slopes(const struct cs_pair_distance *s,
                                           const struct cs_pair_distance_gradients *gradients,
                                           struct cs_pair_distance_tangents *d) {
    for (int i = 0; i < 2; i++)
        d->k[i] = d->dd_dweight_dot[i] * s->blend[i][1] +
                  gradients->dd_dweight[i] *
                      (s->blend_second[i][0] * d->l[i] + s->blend_second[i][1] * d->length[i]);
    cs_pair_distance_jvp_solution(s, d, gradients->z, d->k, d->z);
    for (int c = 0; c < 3; c++)
        d->y[c] = d->z[0] * s->u[c] + gradients->z[0] * d->u[c] + d->z[1] * s->v[c] +
                  gradients->z[1] * d->v[c];
}

/* Change of m_j / s_j, with dm_j by the product rule. */
CS_INLINE void cs_pair_distance_jvp_stretch(const struct cs_pair_distance *s,
                                            const struct cs_pair_distance_gradients *gradients,
                                            struct cs_pair_distance_tangents *d) {
    const double *pi = s->pull_per_length, sum = d->length[0] + d->length[1];
    double lever[2], levers = 0;
    for (int i = 0; i < 2; i++) {
        lever[i] = d->z[i] * (0.5 - s->unclamped[i]) - gradients->z[i] * d->l[i];
        levers += lever[i] * s->length[i] + gradients->lever[i] * d->length[i];
    }
    for (int i = 0; i < 2; i++) {
        const double by_length =
            s->blend_second[i][1] * d->l[i] + s->blend_second[i][2] * d->length[i];
        const double m = pi[1] * levers + pi[2] * sum * gradients->levers + pi[0] * lever[i] +
                         pi[1] * sum * gradients->lever[i] +
                         d->dd_dweight_dot[i] * s->blend[i][2] +
                         gradients->dd_dweight[i] * by_length;
        d->stretch[i] = (m - gradients->stretch[i] * d->length[i]) / s->length[i];
    }
}

/* Component c of the change of the gradient at the four points. r is the component of w - l1 u
 * - l2 v without clamp. */
CS_INLINE void cs_pair_distance_jvp_gradient(const struct cs_pair_distance *s,
                                             const struct cs_pair_distance_gradients *gradients,
                                             const struct cs_pair_distance_tangents *d, int c,
                                             double out[4]) {
    const double *u = s->u, *v = s->v, *l = s->unclamped, *z = gradients->z;
    const double r = s->w[c] - l[0] * u[c] - l[1] * v[c];
    const double dr =
        d->w[c] - l[0] * d->u[c] - l[1] * d->v[c] - d->l[0] * u[c] - d->l[1] * v[c];
    const double du = d->z[0] * r + z[0] * dr - d->l[0] * gradients->y[c] - l[0] * d->y[c] +
                      d->stretch[0] * u[c] + gradients->stretch[0] * d->u[c];
    const double dv = d->z[1] * r + z[1] * dr - d->l[1] * gradients->y[c] - l[1] * d->y[c] +
                      d->stretch[1] * v[c] + gradients->stretch[1] * d->v[c];
    cs_pair_distance_to_points(
        CS_PAIR_EDGE_EDGE, du - d->weight[0] * s->n[c] - s->clamped[0] * d->n[c],
        dv - d->weight[1] * s->n[c] - s->clamped[1] * d->n[c], d->y[c] + d->n[c], out);
}

/* Sets dg (4,3) = H dp, and dweights (4) = the change of the weights, for moves dp (4,3) in m.
 * s is a pair of edges at the state, after cs_pair_distance_set. */
CS_INLINE void cs_pair_distance_tangent(const struct cs_pair_distance *s, double dp[4][3],
                                        double dg[4][3], double dweights[4]) {
    struct cs_pair_distance_gradients gradients;
    struct cs_pair_distance_tangents d;
    double out[4];
    cs_pair_distance_set_slopes(s, &gradients);
    cs_pair_distance_differences(CS_PAIR_EDGE_EDGE, dp, d.u, d.v, d.w);
    cs_pair_distance_jvp_positions(CS_PAIR_EDGE_EDGE, s, &d);
    cs_pair_distance_jvp_direction(s, &d);
    cs_pair_distance_jvp_slopes(s, &gradients, &d);
    cs_pair_distance_jvp_stretch(s, &gradients, &d);
    for (int c = 0; c < 3; c++) {
        cs_pair_distance_jvp_gradient(s, &gradients, &d, c, out);
        for (int k = 0; k < 4; k++)
            dg[k][c] = out[k];
    }
    cs_pair_distance_to_points(CS_PAIR_EDGE_EDGE, -d.weight[0], -d.weight[1], 0, dweights);
}

#endif

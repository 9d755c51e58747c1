/* mesh_feature_tangent.h - exact derivative of the gradient of a feature's distance along a
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
#ifndef CS_NARROW_PHASE_MESH_FEATURE_TANGENT_H
#define CS_NARROW_PHASE_MESH_FEATURE_TANGENT_H

#include "model/contact/narrow_phase/mesh_feature.h"
#include "model/contact/narrow_phase/pair_distance_tangent.h"

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
    cs_pair_distance_jvp_positions(&s->plane, &d.plane);
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

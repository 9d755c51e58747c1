/* facet_tangent.h - how the gradient of a facet's distance changes: its derivative forwards,
 * value and change side by side. */
#ifndef CS_PAIR_FACET_TANGENT_H
#define CS_PAIR_FACET_TANGENT_H

#include "model/pair/facet.h"
#include "model/pair/stencil_tangent.h"

/* The changes along a direction, in the order in which they follow from each other. */
struct cs_facet_changes {
    struct cs_stencil_changes plane; /* of u, v, w, a and l */
    double t, zeta, by_t, by_b, narrow;
    double foot[3], leg[3], pull;
    double h[3][3], far[3][3], f1;
};

CS_INLINE void cs_facet_change_clamp(const struct cs_facet *s, struct cs_facet_changes *d) {
    const double *u = s->plane.u, first = s->plane.a + DBL_MIN;
    const double b = -s->narrow * d->plane.a;
    d->t =
        (cs_vec3_dot(d->plane.u, s->plane.w) + cs_vec3_dot(u, d->plane.w) - s->t * d->plane.a) /
        first;
    d->zeta = s->by_t * d->t + s->by_b * b;
    // y changes by (t' - y b')/b, and by (-t' - y b')/b beyond the middle
    const double side = s->t < 0.5 ? 1 : -1, y = side * d->t - s->y * b;
    d->by_t = side * s->by_tt * y;
    d->by_b = -s->y * s->by_tt * y;
    d->narrow = -1.5 * s->narrow * d->plane.a / (s->plane.a + 4 * s->form.e * s->form.e);
    for (int c = 0; c < 3; c++) {
        d->foot[c] = d->plane.w[c] - d->plane.l[0] * u[c] - s->plane.l[0] * d->plane.u[c] -
                     d->plane.l[1] * s->plane.v[c] - s->plane.l[1] * d->plane.v[c];
        d->leg[c] = d->plane.w[c] - d->zeta * u[c] - s->zeta * d->plane.u[c];
    }
    d->pull = -2 * (cs_vec3_dot(d->leg, u) + cs_vec3_dot(s->leg, d->plane.u));
}

CS_INLINE void cs_facet_change_slopes(const struct cs_facet *s, struct cs_facet_changes *d) {
    const double *l = s->plane.l, *u = s->plane.u, *w = s->plane.w, *du = d->plane.u;
    const double inverse = 1 / (s->plane.a + DBL_MIN), shrink = d->plane.a * inverse;
    for (int c = 0; c < 3; c++) {
        d->h[0][c] = -2 * (d->plane.l[0] * s->foot[c] + l[0] * d->foot[c]);
        d->h[1][c] = -2 * (d->plane.l[1] * s->foot[c] + l[1] * d->foot[c]);
        d->h[2][c] = 2 * d->foot[c];
        const double way = (w[c] - 2 * s->t * u[c]) * inverse;
        const double dway =
            (d->plane.w[c] - 2 * (d->t * u[c] + s->t * du[c])) * inverse - way * shrink;
        const double along = u[c] * inverse, dalong = du[c] * inverse - along * shrink;
        const double thin = 2 * s->by_b * s->narrow;
        const double dthin = 2 * (d->by_b * s->narrow + s->by_b * d->narrow);
        d->far[0][c] = -2 * (d->zeta * s->leg[c] + s->zeta * d->leg[c]) +
                       d->pull * (s->by_t * way - thin * u[c]) +
                       s->pull * (d->by_t * way + s->by_t * dway - dthin * u[c] - thin * du[c]);
        d->far[1][c] = 0;
        d->far[2][c] = 2 * d->leg[c] + d->pull * s->by_t * along +
                       s->pull * (d->by_t * along + s->by_t * dalong);
    }
}

/* change of f' by those of leg^2 and h^2 */
CS_INLINE double cs_facet_change_bend(const struct cs_facet *s,
                                      const struct cs_facet_changes *d) {
    return s->f2 * (cs_vec3_dot(s->far[0], d->plane.u) + cs_vec3_dot(s->far[2], d->plane.w) -
                    cs_vec3_dot(s->h[0], d->plane.u) - cs_vec3_dot(s->h[1], d->plane.v) -
                    cs_vec3_dot(s->h[2], d->plane.w));
}

/* dg, dweights = change of the gradient and of the weights when the points move by dp. */
CS_INLINE void cs_facet_tangent(const struct cs_facet *s, double dp[4][3], double dg[4][3],
                                double dweights[4]) {
    struct cs_facet_changes d;
    double by[3][3];
    cs_stencil_differences(CS_STENCIL_TRIANGLE, dp, d.plane.u, d.plane.v, d.plane.w);
    cs_stencil_change_places(&s->plane, &d.plane);
    cs_facet_change_clamp(s, &d);
    cs_facet_change_slopes(s, &d);
    d.f1 = cs_facet_change_bend(s, &d);
    const double dd = cs_vec3_dot(s->g[0], d.plane.u) + cs_vec3_dot(s->g[1], d.plane.v) +
                      cs_vec3_dot(s->g[2], d.plane.w);
    const double in = 1 - s->f1, half = 0.5 / s->d;
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++)
            by[k][c] = half * (in * d.h[k][c] + s->f1 * d.far[k][c] +
                               d.f1 * (s->far[k][c] - s->h[k][c])) -
                       s->g[k][c] * dd / s->d;
    cs_facet_spread(by, dg);
    const double *l = s->plane.l;
    cs_stencil_spread(CS_STENCIL_TRIANGLE,
                      d.f1 * (l[0] - s->zeta) - in * d.plane.l[0] - s->f1 * d.zeta,
                      d.f1 * l[1] - in * d.plane.l[1], 0, dweights);
}

#endif

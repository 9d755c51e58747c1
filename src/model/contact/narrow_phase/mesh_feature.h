/* mesh_feature.h - how far a point is from the plane, a rim or a corner of a triangle, so that
 * sums over all triangles of a mesh count nothing twice.
 *
 * A point over a mesh is near to several triangles that share a rim or a corner. With f the
 * same growing function for all of them, psi the law's energy and h^2 the squared height over
 * the plane of the triangle
 *
 *   E = sum of triangles psi(d) - sum of inner rims psi(d) + sum of inner corners psi(d),
 *   d^2 = h^2 + f(m),   m = squared distance of the foot from triangle, rim or corner
 *
 * is psi(h) exactly over a flat mesh, wherever its rims and corners are: inclusion and
 * exclusion of what is within a distance, of which any f changes the scale alone. A triangle
 * whose foot is outside has the distance of its nearest rim, one whose foot is inside that of
 * its plane: so plane, rims and corners are all there is to measure. An inner rim is measured
 * half by either of its triangles, a corner in equal shares by all of its.
 *
 *   f(m) = m step((m - e^2/8) / (7 e^2/8)),   step(x) = x^4 (35 - 84x + 70x^2 - 20x^3)
 *
 * is flat where the foot comes to a rim, and true beyond e: the sum has three continuous
 * derivatives over a bent mesh too. At m < e^2 a distance is below the true one, by at most
 * 0.35 e^2 in its square. The foot on a rim is clamped smoothly, exactly outside its ends and
 * bent by less than 0.3 e inside.
 *
 *   t = u.w/u.u   b = e / sqrt(u.u + 4 e^2)   zeta = t step(t/b), and 1 - (1-t) step((1-t)/b)
 */
#ifndef CS_NARROW_PHASE_MESH_FEATURE_H
#define CS_NARROW_PHASE_MESH_FEATURE_H

#include "model/contact/pair_distance.h"

/* Of the range: e, and the range of the law within which no true distance is above the range.
 */
#define CS_FEATURE_BLEND_RADIUS 0.2
#define CS_FEATURE_RANGE_RATIO  0.992
/* Of e^2: m up to which f is 0. */
#define CS_FEATURE_BLEND_START 0.125

/* Which feature the first rim of a triangle stands for: the rim, its first end, or the plane.
 */
struct cs_feature_kind {
    double is_edge, is_off_plane; /* 1, 1; 0, 1; or 0, 0 */
    double e;                     /* m */
};

/* value and two derivatives of the step */
CS_INLINE void cs_smoothstep7(double x, double out[3]) {
    const double low = x > 0 ? x : 0, z = low < 1 ? low : 1, left = 1 - z;
    const double square = z * z, both = z * left;
    out[0] = square * square * (35 + z * (-84 + z * (70 - 20 * z)));
    out[1] = 140 * both * both * both;
    out[2] = 420 * both * both * (left - z);
}

/* A feature at one state. The point, the two ends of the rim, and the third corner. */
struct cs_mesh_feature {
    struct cs_pair_distance plane;         /* u, v, w and l; its distance is not set */
    double d, g[3][3];                     /* m; its gradient by u, v, w */
    double length, n[3];                   /* m; between the two contact points */
    double weights_uv[2];                  /* of u and v in what they are apart by */
    double from_foot[3], from_edge[3];     /* m, to the point from its foot, and from the rim */
    double t, y, b, half_b_over_w, zeta;   /* narrow = b / 2 (u.u + 4 e^2) */
    double dzeta_dt, dzeta_db, d2zeta_dt2; /* zeta's derivatives */
    double f1, f2;                         /* f's */
    double h2_gradient[3][3],
        edge_gradient[3][3]; /* gradients of h^2 and of leg^2 by u, v, w */
    double dleg2_dzeta;      /* -2 leg.u: slope of leg^2 by zeta */
    struct cs_feature_kind kind;
};

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

/* gradients of the two squares */
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

/* f's derivatives; f itself */
CS_INLINE double cs_mesh_feature_blend(struct cs_mesh_feature *s, double m) {
    const double e2 = s->kind.e * s->kind.e, span = 1 / ((1 - CS_FEATURE_BLEND_START) * e2);
    double step[3];
    cs_smoothstep7((m - CS_FEATURE_BLEND_START * e2) * span, step);
    s->f1 = s->kind.is_off_plane * (step[0] + m * step[1] * span);
    s->f2 = s->kind.is_off_plane * (2 * step[1] + m * step[2] * span) * span;
    return s->kind.is_off_plane * m * step[0];
}

/* The distance, and what its derivatives need. */
CS_INLINE void cs_mesh_feature_measure(struct cs_mesh_feature *s, struct cs_feature_kind form,
                                       double p[4][3]) {
    const double least = CS_PAIR_DISTANCE_MIN * CS_PAIR_DISTANCE_MIN;
    s->kind = form;
    cs_pair_distance_frame(&s->plane, CS_PAIR_POINT_TRIANGLE, p);
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

/* Distance, gradient and contact points. */
CS_INLINE void cs_mesh_feature_set(struct cs_mesh_feature *s, struct cs_feature_kind form,
                                   double p[4][3]) {
    const double least = CS_PAIR_DISTANCE_MIN * CS_PAIR_DISTANCE_MIN;
    cs_mesh_feature_measure(s, form, p);
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

/* by the three differences, to the four points */
CS_INLINE void cs_mesh_feature_to_points(double by[3][3], double out[4][3]) {
    for (int c = 0; c < 3; c++) {
        double four[4];
        cs_pair_distance_to_points(CS_PAIR_POINT_TRIANGLE, by[0][c], by[1][c], by[2][c], four);
        for (int k = 0; k < 4; k++)
            out[k][c] = four[k];
    }
}

/* Shares of the four points in the difference of the two contact points; their sum is 0. */
CS_INLINE void cs_mesh_feature_weights(const struct cs_mesh_feature *s, double out[4]) {
    cs_pair_distance_to_points(CS_PAIR_POINT_TRIANGLE, s->weights_uv[0], s->weights_uv[1], 1,
                               out);
}

#endif

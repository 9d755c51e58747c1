/* point_contact.h - what a point feels near an obstacle: the law's force, friction and damping,
 * with their derivatives.
 *
 * With the smooth distance d of the point, its gradient g and Hessian H, the point's velocity V
 * against the obstacle, n = g/|g| and T = V - n (n.V):
 *
 *   elastic    F g                               F = -psi'(d), law.h
 *   damping   -tau K (g.V) g                     K = psi''(d): of the law, so it fades with it
 *   friction  -mu N T / sqrt(T.T + ev^2)         N = F |g|; ev: the speed where it has 0.7 of
 * mu N
 *
 * All are functions of position and velocity alone. Friction is Coulomb's law made smooth
 * (contact has no memory): below the angle of friction a body creeps at
 * ev tan a / sqrt(mu^2 - tan^2 a) instead of resting. A function whose loops over points are
 * hot has them inlined.
 */
#ifndef CS_CONTACT_POINT_CONTACT_H
#define CS_CONTACT_POINT_CONTACT_H

#include "model/contact/barrier_law.h"
#include "model/spring/spring_runs.h"

#include <math.h>

/* A point near an obstacle, and how the two rub. */
struct cs_point_contact {
    double d, range;   /* m */
    double g[3], h[6]; /* gradient and Hessian of d; h: xx, xy, xz, yy, yz, zz */
    double v[3];       /* m/s, of the point against the obstacle */
    double k;          /* N/m */
    double friction, friction_speed, damping; /* friction; m/s; s */
};

CS_INLINE double cs_point_contact_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Parts of the force asked for, as factors 0 or 1. */
struct cs_contact_force_parts {
    double elastic, friction;
};

/* f = force on the point in N. */
CS_INLINE void cs_point_contact_force(const struct cs_point_contact *contact,
                                      struct cs_contact_force_parts parts, double f[3]) {
    const struct cs_barrier law = cs_barrier_at(contact->d, contact->range, contact->k);
    const double square = cs_point_contact_dot(contact->g, contact->g);
    const double approach = cs_point_contact_dot(contact->g, contact->v);
    const double along = parts.elastic * law.force -
                         parts.friction * contact->damping * law.stiffness * approach;
    double t[3];
    for (int c = 0; c < 3; c++)
        t[c] = contact->v[c] - contact->g[c] * (approach / square);
    const double speed =
        sqrt(cs_point_contact_dot(t, t) + contact->friction_speed * contact->friction_speed);
    const double rub = parts.friction * contact->friction * law.force * sqrt(square) / speed;
    for (int c = 0; c < 3; c++)
        f[c] = along * contact->g[c] - rub * t[c];
}

/* A small move of the point: by dp, with dv the change of its velocity against the obstacle. */
struct cs_point_contact_motion {
    double dp[3], dv[3];
    double extra_dd; /* m, by which d changes beyond g.dp */
};

/* df = change of the force, exact. */
CS_INLINE void cs_point_contact_jvp(const struct cs_point_contact *contact,
                                    struct cs_contact_force_parts parts,
                                    const struct cs_point_contact_motion *move, double df[3]) {
    const double *g = contact->g, *h = contact->h, *v = contact->v, *dp = move->dp;
    const struct cs_barrier law = cs_barrier_at(contact->d, contact->range, contact->k);
    const double dg[3] = {h[0] * dp[0] + h[1] * dp[1] + h[2] * dp[2],
                          h[1] * dp[0] + h[3] * dp[1] + h[4] * dp[2],
                          h[2] * dp[0] + h[4] * dp[1] + h[5] * dp[2]};
    const double dd = cs_point_contact_dot(g, dp) + move->extra_dd;
    const double square = cs_point_contact_dot(g, g), dsquare = 2 * cs_point_contact_dot(g, dg);
    const double approach = cs_point_contact_dot(g, v);
    const double dapproach = cs_point_contact_dot(dg, v) + cs_point_contact_dot(g, move->dv);
    const double dforce = -law.stiffness * dd;
    const double dstiffness = cs_barrier_slope(contact->d, contact->range, contact->k) * dd;
    const double along = parts.elastic * law.force -
                         parts.friction * contact->damping * law.stiffness * approach;
    const double dalong =
        parts.elastic * dforce -
        parts.friction * contact->damping * (dstiffness * approach + law.stiffness * dapproach);

    // T = V - g a with a = (g.V)/g.g, and the slope of friction
    const double a = approach / square, da = (dapproach - a * dsquare) / square;
    double t[3], dt[3];
    for (int c = 0; c < 3; c++) {
        t[c] = v[c] - g[c] * a;
        dt[c] = move->dv[c] - dg[c] * a - g[c] * da;
    }
    const double speed =
        sqrt(cs_point_contact_dot(t, t) + contact->friction_speed * contact->friction_speed);
    const double dspeed = cs_point_contact_dot(t, dt) / speed;
    const double length = sqrt(square), dlength = 0.5 * dsquare / length;
    const double load = parts.friction * contact->friction * law.force * length;
    const double dload =
        parts.friction * contact->friction * (dforce * length + law.force * dlength);
    const double rub = load / speed, drub = (dload - rub * dspeed) / speed;
    for (int c = 0; c < 3; c++)
        df[c] = dalong * g[c] + along * dg[c] - drub * t[c] - rub * dt[c];
}

/* b (6) += the symmetric part cd df/dv + ck df/dx that the solver holds.
 * Left out: how the directions of damping and friction turn with the position. psd: the
 * curvature of the obstacle, which is negative, is left out too. bound: friction has the slope
 * mu N / sqrt(T.T + ev^2) along T too, an upper bound that Newton's iteration does not
 * overshoot (iteratively reweighted least squares). */
CS_INLINE void cs_point_contact_add_block(const struct cs_point_contact *contact,
                                          const struct cs_matrix *matrix, double b[6]) {
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    const double *g = contact->g;
    const struct cs_barrier law = cs_barrier_at(contact->d, contact->range, contact->k);
    const double square = cs_point_contact_dot(g, g);
    const double a = cs_point_contact_dot(g, contact->v) / square;
    double t[3];
    for (int c = 0; c < 3; c++)
        t[c] = contact->v[c] - g[c] * a;
    const double speed =
        sqrt(cs_point_contact_dot(t, t) + contact->friction_speed * contact->friction_speed);
    const double rub = -matrix->cd * contact->friction * law.force * sqrt(square) / speed;
    const double along = -(matrix->ck + matrix->cd * contact->damping) * law.stiffness;
    const double curve = matrix->psd ? 0 : matrix->ck * law.force;
    for (int e = 0; e < 6; e++) {
        const int r = row[e], s = column[e];
        // friction holds the plane at right angles to g; along T it grows less than with its
        // load
        const double plane = (r == s) - g[r] * g[s] / square -
                             (matrix->bound ? 0 : t[r] * t[s] / (speed * speed));
        b[e] += along * g[r] * g[s] + rub * plane + curve * contact->h[e];
    }
}

/* Largest stiffness in N/m and damping in N s/m that the point adds in any direction. */
CS_INLINE void cs_point_contact_bound(const struct cs_point_contact *contact, double *stiffness,
                                      double *damping) {
    const struct cs_barrier law = cs_barrier_at(contact->d, contact->range, contact->k);
    const double square = cs_point_contact_dot(contact->g, contact->g);
    const double approach = cs_point_contact_dot(contact->g, contact->v);
    const double sliding =
        cs_point_contact_dot(contact->v, contact->v) - approach * approach / square;
    const double speed =
        sqrt((sliding > 0 ? sliding : 0) + contact->friction_speed * contact->friction_speed);
    *stiffness = law.stiffness * square;
    *damping = contact->damping * law.stiffness * square +
               contact->friction * law.force * sqrt(square) / speed;
}

#endif

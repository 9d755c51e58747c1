/* point_contact.h - force on a point near a collider, by the barrier law, friction and damping,
 * with their derivatives.
 *
 * With the smooth distance d of the point, its gradient g and Hessian H, the velocity V of the
 * point relative to the collider, n = g/|g| and T = V - n (n.V):
 *
 *   elastic    F g                               F = -psi'(d), barrier_law.h
 *   damping   -tau K (g.V) g                     K = psi''(d): vanishes with the contact
 *   loss      -alpha F (g.V)/s g                 s^2 = (g.V)^2 + 2 psi/M
 *   friction  -mu N T / sqrt(T.T + ev^2)         N = F |g|
 *
 * The loss gives an impact its restitution: scaling the speed scales s, whatever k, M and D
 * are, so that the fraction of the energy that comes back depends on alpha alone
 * (cs_restitution_loss). M is the mean mass of free particles. Where bodies meet it is half of
 * the reduced mass of their mean particles, which are pushed from both sides.
 * Particles lighter than M lose more: at e = 1/2, M/4 comes back with 0.37.
 *
 * ev is the speed at which friction has 1/sqrt(2) = 0.71 of mu N. All are functions of position
 * and velocity alone. Friction is Coulomb's law made smooth and has no memory: below the angle
 * of friction a body creeps at ev tan a / sqrt(mu^2 - tan^2 a) and does not rest. Functions are
 * inlined, because loops over points are hot. */
#ifndef CS_CONTACT_POINT_CONTACT_H
#define CS_CONTACT_POINT_CONTACT_H

#include "base/vec3.h"
#include "model/contact/barrier_law.h"
#include "model/spring/spring_runs.h"

#include <math.h>

/* A point near a collider and the parameters of the pair. */
struct cs_point_contact {
    double d, range; /* m */
    /* gradient (1) and Hessian (1/m) of d; h: xx, xy, xz, yy, yz, zz */
    double g[3], h[6];
    /* m/s, relative to the collider */
    double v[3];
    /* stiffness of the law in N/m; negative for a feature that is subtracted */
    double k;
    /* mu (1), ev (m/s), tau (s) */
    double friction, friction_speed, damping;
    double loss, rate; /* alpha (1), k/M (1/s2): of restitution */
};

/* m2/s2, s^2: w^2 + 2 psi/M for the approach w, where psi/M is that of one contact, whatever
 * features are added or subtracted. Above 0, so that quotients are finite. */
CS_INLINE double cs_restitution_square(double d, double range, double rate, double approach) {
    double beyond;
    const double y = cs_barrier_core(d / range, &beyond), a = 1 - y, square = a * a;
    return approach * approach + rate * range * range / 6 * (square * square / y) + 1e-30;
}

/* N s/m, alpha F/s: beside tau K. */
CS_INLINE double cs_point_contact_loss(const struct cs_point_contact *contact,
                                       const struct cs_barrier *barrier, double approach) {
    const double square =
        cs_restitution_square(contact->d, contact->range, contact->rate, approach);
    return contact->loss > 0 ? contact->loss * barrier->force / sqrt(square) : 0;
}

/* g.g, the divisor of projections on g. Two points that coincide have no direction, and g = 0
 * there: 1e-30 keeps quotients finite, and changes no bit where g.g is above 1e-13. */
CS_INLINE double cs_point_contact_square(const double g[3]) {
    return cs_vec3_dot(g, g) + 1e-30;
}

/* Parts of the force that are wanted, as factors 0 or 1. friction includes damping. */
struct cs_contact_force_parts {
    double elastic, friction;
};

/* Sets t to the sliding velocity T = V - g (g.V)/g.g with square = g.g, which is 1 of a normal;
 * returns sqrt(T.T + ev^2). Of any other vector in place of V, t is its part along the surface.
 */
CS_INLINE double cs_sliding_velocity(const double g[3], double square, const double v[3],
                                     double ev, double t[3]) {
    const double a = cs_vec3_dot(g, v) / square;
    for (int c = 0; c < 3; c++)
        t[c] = v[c] - g[c] * a;
    return sqrt(cs_vec3_dot(t, t) + ev * ev);
}

/* f = the elastic force on the point in N. */
CS_INLINE void cs_point_contact_push(const struct cs_point_contact *contact,
                                     struct cs_contact_force_parts parts, double f[3]) {
    const struct cs_barrier barrier = cs_barrier_at(contact->d, contact->range, contact->k);
    for (int c = 0; c < 3; c++)
        f[c] = parts.elastic * barrier.force * contact->g[c];
}

/* f = force on the point in N, with square = g.g. The law is evaluated once for all parts. */
CS_INLINE void cs_point_contact_force_by(const struct cs_point_contact *contact, double square,
                                         struct cs_contact_force_parts parts, double f[3]) {
    const struct cs_barrier barrier = cs_barrier_at(contact->d, contact->range, contact->k);
    const double approach = cs_vec3_dot(contact->g, contact->v);
    const double along =
        parts.elastic * barrier.force -
        parts.friction * contact->damping * barrier.stiffness * approach -
        parts.friction * cs_point_contact_loss(contact, &barrier, approach) * approach;
    double t[3];
    const double speed =
        cs_sliding_velocity(contact->g, square, contact->v, contact->friction_speed, t);
    const double rub =
        parts.friction * contact->friction * barrier.force * sqrt(square) / speed;
    for (int c = 0; c < 3; c++)
        f[c] = along * contact->g[c] - rub * t[c];
}

CS_INLINE void cs_point_contact_force(const struct cs_point_contact *contact,
                                      struct cs_contact_force_parts parts, double f[3]) {
    cs_point_contact_force_by(contact, cs_point_contact_square(contact->g), parts, f);
}

/* Displacement dp in m of the point, and dv in m/s of its relative velocity. */
struct cs_point_contact_motion {
    double dp[3], dv[3];
    /* m, change of d in addition to g.dp; of features whose d is not the distance of the
     * contact points */
    double extra_dd;
};

/* N s/m, change of alpha F/s with d and the approach: d(s^2)/2 = w dw - (F/M) dd. */
CS_INLINE double cs_point_contact_loss_change(const struct cs_point_contact *contact,
                                              const struct cs_barrier *barrier, double approach,
                                              double dd, double dapproach) {
    if (!(contact->loss > 0))
        return 0;
    const double square =
        cs_restitution_square(contact->d, contact->range, contact->rate, approach);
    const double half = approach * dapproach - contact->rate / contact->k * barrier->force * dd;
    return contact->loss / sqrt(square) *
           (-barrier->stiffness * dd - barrier->force * half / square);
}

/* df = exact change of the force along a motion, in N. By the product rule, with dg = H dp, dd
 * = g.dp + extra_dd, dF = -K dd and dK = K' dd. */
CS_INLINE void cs_point_contact_jvp(const struct cs_point_contact *contact,
                                    struct cs_contact_force_parts parts,
                                    const struct cs_point_contact_motion *motion,
                                    double df[3]) {
    const double *g = contact->g, *v = contact->v, *dp = motion->dp;
    const struct cs_barrier barrier = cs_barrier_at(contact->d, contact->range, contact->k);
    double dg[3];
    cs_sym3_multiply(contact->h, dp, dg);
    const double dd = cs_vec3_dot(g, dp) + motion->extra_dd;
    const double square = cs_point_contact_square(g), dsquare = 2 * cs_vec3_dot(g, dg);
    const double approach = cs_vec3_dot(g, v);
    const double dapproach = cs_vec3_dot(dg, v) + cs_vec3_dot(g, motion->dv);
    const double dforce = -barrier.stiffness * dd;
    const double dstiffness = cs_barrier_slope(contact->d, contact->range, contact->k) * dd;
    const double loss = cs_point_contact_loss(contact, &barrier, approach);
    const double dloss =
        cs_point_contact_loss_change(contact, &barrier, approach, dd, dapproach);
    const double along = parts.elastic * barrier.force -
                         parts.friction * contact->damping * barrier.stiffness * approach -
                         parts.friction * loss * approach;
    const double dalong = parts.elastic * dforce -
                          parts.friction * contact->damping *
                              (dstiffness * approach + barrier.stiffness * dapproach) -
                          parts.friction * (dloss * approach + loss * dapproach);

    // T = V - g a with a = (g.V)/g.g, and the slope of friction
    const double a = approach / square, da = (dapproach - a * dsquare) / square;
    double t[3], dt[3];
    const double speed = cs_sliding_velocity(g, square, v, contact->friction_speed, t);
    for (int c = 0; c < 3; c++)
        dt[c] = motion->dv[c] - dg[c] * a - g[c] * da;
    const double dspeed = cs_vec3_dot(t, dt) / speed;
    const double length = sqrt(square), dlength = 0.5 * dsquare / length;
    const double load = parts.friction * contact->friction * barrier.force * length;
    const double dload =
        parts.friction * contact->friction * (dforce * length + barrier.force * dlength);
    const double rub = load / speed, drub = (dload - rub * dspeed) / speed;
    for (int c = 0; c < 3; c++)
        df[c] = dalong * g[c] + along * dg[c] - drub * t[c] - rub * dt[c];
}

/* b (6) += the symmetric part cd df/dv + ck df/dx that the solver uses:
 *
 *   -(ck K + cd (tau K + alpha F/s)) g g^T - cd mu N / s (I - n n^T - T T^T / s^2) + ck F H,
 * s^2 = T.T + ev^2
 *
 * Left out: the change of the directions of damping and friction with the position. psd: leaves
 * out F H too, whose curvature has the wrong sign in front of a convex collider. bound: leaves
 * out T T^T / s^2. The slope mu N / s along T is then an upper bound, which Newton's iteration
 * does not overshoot (iteratively reweighted least squares). */
CS_INLINE void cs_point_contact_add_block(const struct cs_point_contact *contact,
                                          const struct cs_matrix *matrix, double b[6]) {
    const double *g = contact->g;
    const struct cs_barrier barrier = cs_barrier_at(contact->d, contact->range, contact->k);
    const double square = cs_point_contact_square(g);
    double t[3];
    const double speed = cs_sliding_velocity(g, square, contact->v, contact->friction_speed, t);
    const double rub = -matrix->cd * contact->friction * barrier.force * sqrt(square) / speed;
    const double loss = cs_point_contact_loss(contact, &barrier, cs_vec3_dot(g, contact->v));
    const double along =
        -(matrix->ck + matrix->cd * contact->damping) * barrier.stiffness - matrix->cd * loss;
    const double curve = matrix->psd ? 0 : matrix->ck * barrier.force;
    for (int e = 0; e < 6; e++) {
        const int r = cs_sym3_row[e], s = cs_sym3_column[e];
        // friction holds the plane at right angles to g; along T it grows less than with its
        // load
        const double plane = (r == s) - g[r] * g[s] / square -
                             (matrix->bound ? 0 : t[r] * t[s] / (speed * speed));
        b[e] += along * g[r] * g[s] + rub * plane + curve * contact->h[e];
    }
}

/* y = ck df/dx V with df/dx as in the block above: how the force changes in a step by the way
 * that the point goes relative to the collider, in units of ck. */
CS_INLINE void cs_point_contact_approach(const struct cs_point_contact *contact,
                                         const struct cs_matrix *matrix, double y[3]) {
    const double *g = contact->g, *v = contact->v;
    const struct cs_barrier barrier = cs_barrier_at(contact->d, contact->range, contact->k);
    const double along = -matrix->ck * barrier.stiffness * cs_vec3_dot(g, v);
    const double curve = matrix->psd ? 0 : matrix->ck * barrier.force;
    cs_sym3_multiply(contact->h, v, y);
    for (int c = 0; c < 3; c++)
        y[c] = along * g[c] + curve * y[c];
}

/* Largest stiffness in N/m and damping in N s/m that the point adds in any direction: K |g|^2,
 * and tau K |g|^2 + mu N / s. square: g.g */
CS_INLINE void cs_point_contact_bound(const struct cs_point_contact *contact, double *stiffness,
                                      double *damping) {
    const double square = cs_point_contact_square(contact->g);
    const struct cs_barrier barrier = cs_barrier_at(contact->d, contact->range, contact->k);
    const double approach = cs_vec3_dot(contact->g, contact->v);
    const double sliding = cs_vec3_dot(contact->v, contact->v) - approach * approach / square;
    const double speed =
        sqrt((sliding > 0 ? sliding : 0) + contact->friction_speed * contact->friction_speed);
    *stiffness = barrier.stiffness * square;
    *damping = contact->damping * barrier.stiffness * square +
               cs_point_contact_loss(contact, &barrier, approach) * square +
               contact->friction * barrier.force * sqrt(square) / speed;
}

#endif

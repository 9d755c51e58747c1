/* pair_motion.h - a pair whose points move along straight lines during a step, and the contact
 * energy that a second-order model at the start of the step misses.
 *
 *   e = |psi(d(s)) - (psi + F a + K a^2/2)|,   a = -s g.dx
 *
 * with psi, F, K at the start, dx the whole displacement and s the fraction of it. The step
 * resolves the contact if e is at most CS_UNRESOLVED_ENERGY_MAX of the energy of the pair. */
#ifndef CS_NARROW_PHASE_PAIR_MOTION_H
#define CS_NARROW_PHASE_PAIR_MOTION_H

#include "model/contact/barrier_law.h"
#include "model/contact/pair_distance.h"
#include "model/contact/step_check.h"

#include <math.h>

/* Positions at the start and displacements of the whole step, in m. */
struct cs_pair_motion {
    enum cs_pair_kind kind;
    double x0[4][3], displacement[4][3]; /* m */
    double inverse_mass[4];              /* 1/kg */
};

/* m2, squared relative displacement of points i and j */
CS_INLINE double cs_pair_motion_relative_squared(struct cs_pair_motion *way, int i, int j) {
    const double *a = way->displacement[i], *b = way->displacement[j];
    const double r[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return cs_vec3_dot(r, r);
}

CS_INLINE double cs_pair_motion_max(double most, double squared) {
    return squared > most ? squared : most;
}

/* m, largest relative displacement of a point of one side and a point of the other. Contact
 * points are convex combinations of the points, so none moves further relative to the other
 * side. */
CS_INLINE double cs_pair_motion_longest(struct cs_pair_motion *way) {
    const bool edges = way->kind == CS_PAIR_EDGE_EDGE;
    double most = edges ? 0 : cs_pair_motion_max(0, cs_pair_motion_relative_squared(way, 0, 1));
    most = cs_pair_motion_max(most, cs_pair_motion_relative_squared(way, 0, 2));
    most = cs_pair_motion_max(most, cs_pair_motion_relative_squared(way, 0, 3));
    most = edges ? cs_pair_motion_max(most, cs_pair_motion_relative_squared(way, 1, 2)) : most;
    most = edges ? cs_pair_motion_max(most, cs_pair_motion_relative_squared(way, 1, 3)) : most;
    return sqrt(most);
}

/* The second-order model, at the start of a step. */
struct cs_pair_motion_start {
    struct cs_barrier law;
    /* J: psi(d); and the energy of the pair, psi(d) + kinetic energy of the relative motion of
     * its contact points + psi(D/2) */
    double contact_energy, total_energy;
    /* m, first-order decrease -g.dx of the distance over the whole step */
    double approach;
};

/* Sets the model from the pair s at the start; h: seconds of the whole step. The effective mass
 * of the contact points is 1 / sum (w_k^2 / m_k), infinite if all are pinned. psi(D/2) keeps
 * pairs that barely touch from being judged. */
CS_INLINE void cs_pair_motion_begin(struct cs_pair_motion *way,
                                    const struct cs_pair_distance *s, double h, double range,
                                    double k, struct cs_pair_motion_start *start) {
    double weight[4], g[4][3], v[3] = {0}, inverse = 0;
    cs_pair_distance_weights(s, weight);
    cs_pair_distance_gradient(s, g);
    start->approach = 0;
    for (int j = 0; j < 4; j++) {
        inverse += weight[j] * weight[j] * way->inverse_mass[j];
        start->approach -= cs_vec3_dot(g[j], way->displacement[j]);
        for (int c = 0; c < 3; c++)
            v[c] += weight[j] * way->displacement[j][c] / h;
    }
    const double kinetic = 0.5 * cs_vec3_dot(v, v) / inverse;
    start->law = cs_barrier_at(s->d, range, k);
    start->contact_energy = cs_barrier_energy(s->d, range, k);
    start->total_energy = (inverse > 0 ? kinetic : HUGE_VAL) + start->contact_energy +
                          cs_barrier_energy(0.5 * range, range, k);
}

/* e in J after the fraction `share` of the step, where the distance is d. */
CS_INLINE double cs_pair_motion_unresolved_energy(const struct cs_pair_motion_start *start,
                                                  double share, double d, double range,
                                                  double k) {
    const double come = share * start->approach;
    const double seen = start->contact_energy + start->law.force * come +
                        0.5 * start->law.stiffness * come * come;
    return fabs(cs_barrier_energy(d, range, k) - seen);
}

/* Number of samples of a step after its start: they are at most half a range of relative motion
 * apart, so that no contact is passed over. */
CS_INLINE double cs_pair_motion_samples(double longest, double range) {
    return longest / (0.5 * range);
}

/* Eight pairs in lanes; lanes without a pair hold unspecified numbers. */
enum { CS_PAIR_MOTION_LANES = 8 };
struct cs_pair_motion_lanes {
    double x0[4][3][CS_PAIR_MOTION_LANES], displacement[4][3][CS_PAIR_MOTION_LANES],
        inverse_mass[4][CS_PAIR_MOTION_LANES];
    double range[CS_PAIR_MOTION_LANES], k[CS_PAIR_MOTION_LANES];
    double result[CS_PAIR_MOTION_LANES];
};

/* Sets result: 1 if the energy missed at the end of the step is above the limit, 0 if it is
 * not, 2 if the step is too long to be judged by its end alone. h: seconds of the step. */
void cs_pair_motion_lanes_check(enum cs_pair_kind kind, struct cs_pair_motion_lanes *lanes,
                                double h);

#endif

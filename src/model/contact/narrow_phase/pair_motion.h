/* pair_motion.h - a pair on the straight way of its particles during a step, and how much of
 * the contact there the state at its start does not foretell. */
#ifndef CS_NARROW_PHASE_PAIR_MOTION_H
#define CS_NARROW_PHASE_PAIR_MOTION_H

#include "model/contact/barrier_law.h"
#include "model/contact/pair_distance.h"
#include "model/contact/step_check.h"

#include <math.h>

struct cs_pair_motion {
    enum cs_pair_kind kind;
    double x0[4][3], displacement[4][3]; /* m */
    double inverse_mass[4];              /* 1/kg */
};

CS_INLINE double cs_pair_motion_relative_squared(struct cs_pair_motion *way, int i, int j) {
    const double *a = way->displacement[i], *b = way->displacement[j];
    const double r[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return cs_vec3_dot(r, r);
}

CS_INLINE double cs_pair_motion_max(double most, double squared) {
    return squared > most ? squared : most;
}

/* the most that a point of one side moves by against one of the other */
CS_INLINE double cs_pair_motion_longest(struct cs_pair_motion *way) {
    const bool edges = way->kind == CS_PAIR_EDGE_EDGE;
    double most = edges ? 0 : cs_pair_motion_max(0, cs_pair_motion_relative_squared(way, 0, 1));
    most = cs_pair_motion_max(most, cs_pair_motion_relative_squared(way, 0, 2));
    most = cs_pair_motion_max(most, cs_pair_motion_relative_squared(way, 0, 3));
    most = edges ? cs_pair_motion_max(most, cs_pair_motion_relative_squared(way, 1, 2)) : most;
    most = edges ? cs_pair_motion_max(most, cs_pair_motion_relative_squared(way, 1, 3)) : most;
    return sqrt(most);
}

/* What the start foretells. */
struct cs_pair_motion_start {
    struct cs_barrier law;
    double contact_energy, total_energy; /* J: psi, and what the pair has in all */
    double approach; /* m, by how much the gradient says that they come nearer */
};

/* h: s of the whole way */
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

/* J, which the start does not foretell where the way has gone by `share` to a distance d */
CS_INLINE double cs_pair_motion_unresolved_energy(const struct cs_pair_motion_start *start,
                                                  double share, double d, double range,
                                                  double k) {
    const double come = share * start->approach;
    const double seen = start->contact_energy + start->law.force * come +
                        0.5 * start->law.stiffness * come * come;
    return fabs(cs_barrier_energy(d, range, k) - seen);
}

/* Points of a way, beside its start, are at most half a range of motion apart. */
CS_INLINE double cs_pair_motion_samples(double longest, double range) {
    return longest / (0.5 * range);
}

/* Eight at a time; lanes that hold none have numbers that mean nothing. */
enum { CS_PAIR_MOTION_LANES = 8 };
struct cs_pair_motion_lanes {
    double x0[4][3][CS_PAIR_MOTION_LANES], displacement[4][3][CS_PAIR_MOTION_LANES],
        inverse_mass[4][CS_PAIR_MOTION_LANES];
    double range[CS_PAIR_MOTION_LANES], k[CS_PAIR_MOTION_LANES];
    double result[CS_PAIR_MOTION_LANES];
};

/* Sets answer: 1 where too much of the energy of contact is unseen, else 0; but 2 where the way
 * is so long that it must be looked at in more points than its end. h: s of the whole way. */
void cs_pair_motion_lanes_check(enum cs_pair_kind kind, struct cs_pair_motion_lanes *lanes,
                                double h);

#endif

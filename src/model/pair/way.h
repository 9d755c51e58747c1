/* way.h - a pair on the straight way of its particles during a step, and how much of the
 * contact there the state at its start does not foretell. */
#ifndef CS_PAIR_WAY_H
#define CS_PAIR_WAY_H

#include "model/contact/law.h"
#include "model/contact/share.h"
#include "model/pair/stencil.h"

#include <math.h>

struct cs_way {
    enum cs_stencil_kind kind;
    double from[4][3], move[4][3]; /* m */
    double inverse_mass[4];        /* 1/kg */
};

CS_INLINE double cs_way_apart(struct cs_way *way, int i, int j) {
    const double *a = way->move[i], *b = way->move[j];
    const double r[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return cs_vec3_dot(r, r);
}

CS_INLINE double cs_way_larger(double most, double squared) {
    return squared > most ? squared : most;
}

/* the most that a point of one side moves by against one of the other */
CS_INLINE double cs_way_longest(struct cs_way *way) {
    const bool edges = way->kind == CS_STENCIL_EDGES;
    double most = edges ? 0 : cs_way_larger(0, cs_way_apart(way, 0, 1));
    most = cs_way_larger(most, cs_way_apart(way, 0, 2));
    most = cs_way_larger(most, cs_way_apart(way, 0, 3));
    most = edges ? cs_way_larger(most, cs_way_apart(way, 1, 2)) : most;
    most = edges ? cs_way_larger(most, cs_way_apart(way, 1, 3)) : most;
    return sqrt(most);
}

/* What the start foretells. */
struct cs_way_start {
    struct cs_law law;
    double held, has; /* J: psi, and what the pair has in all */
    double approach;  /* m, by how much the gradient says that they come nearer */
};

/* h: s of the whole way */
CS_INLINE void cs_way_begin(struct cs_way *way, const struct cs_stencil *s, double h,
                            double range, double k, struct cs_way_start *start) {
    double weight[4], g[4][3], v[3] = {0}, inverse = 0;
    cs_stencil_weights(s, weight);
    cs_stencil_gradient(s, g);
    start->approach = 0;
    for (int j = 0; j < 4; j++) {
        inverse += weight[j] * weight[j] * way->inverse_mass[j];
        start->approach -= cs_vec3_dot(g[j], way->move[j]);
        for (int c = 0; c < 3; c++)
            v[c] += weight[j] * way->move[j][c] / h;
    }
    const double kinetic = 0.5 * cs_vec3_dot(v, v) / inverse;
    start->law = cs_law_at(s->d, range, k);
    start->held = cs_law_energy(s->d, range, k);
    start->has =
        (inverse > 0 ? kinetic : HUGE_VAL) + start->held + cs_law_energy(0.5 * range, range, k);
}

/* J, which the start does not foretell where the way has gone by `share` to a distance d */
CS_INLINE double cs_way_unseen(const struct cs_way_start *start, double share, double d,
                               double range, double k) {
    const double come = share * start->approach;
    const double seen =
        start->held + start->law.force * come + 0.5 * start->law.stiffness * come * come;
    return fabs(cs_law_energy(d, range, k) - seen);
}

/* Points of a way, beside its start, are at most half a range of motion apart. */
CS_INLINE double cs_way_points(double longest, double range) {
    return longest / (0.5 * range);
}

/* Eight at a time; lanes that hold none have numbers that mean nothing. */
enum { CS_WAY_LANES = 8 };
struct cs_way_lanes {
    double from[4][3][CS_WAY_LANES], move[4][3][CS_WAY_LANES], inverse_mass[4][CS_WAY_LANES];
    double range[CS_WAY_LANES], k[CS_WAY_LANES];
    double answer[CS_WAY_LANES];
};

/* Sets answer: 1 where too much of the energy of contact is unseen, else 0; but 2 where the way
 * is so long that it must be looked at in more points than its end. h: s of the whole way. */
void cs_way_lanes_ask(enum cs_stencil_kind kind, struct cs_way_lanes *lanes, double h);

#endif

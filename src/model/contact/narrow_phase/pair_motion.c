/* Checks short steps of pairs, eight at a time: only their end is compared with the model. */
#include "base/vectorise.h"

#include "model/contact/narrow_phase/pair_motion.h"

/* Copies one lane to a pair in point order. */
CS_INLINE void read_motion(struct cs_pair_motion_lanes *lanes, int lane,
                           struct cs_pair_motion *way) {
    CS_UNROLLED
    for (int k = 0; k < 12; k++) {
        way->x0[k / 3][k % 3] = lanes->x0[k / 3][k % 3][lane];
        way->displacement[k / 3][k % 3] = lanes->displacement[k / 3][k % 3][lane];
    }
    CS_UNROLLED
    for (int k = 0; k < 4; k++)
        way->inverse_mass[k] = lanes->inverse_mass[k][lane];
}

/* Result of one lane. A pair that is out of range at both ends counts as resolved. */
CS_INLINE double ask(struct cs_pair_motion *way, double h, double range, double k) {
    struct cs_pair_distance at, to;
    struct cs_pair_motion_start start;
    double end[4][3];
    CS_UNROLLED
    for (int j = 0; j < 12; j++)
        end[j / 3][j % 3] = way->x0[j / 3][j % 3] + way->displacement[j / 3][j % 3];
    cs_pair_distance_set(&at, way->kind, way->x0);
    cs_pair_distance_set(&to, way->kind, end);
    cs_pair_motion_begin(way, &at, h, range, k, &start);
    const double nearest = to.d < at.d ? to.d : at.d;
    const double unseen = cs_pair_motion_unresolved_energy(&start, 1, to.d, range, k);
    const double much = unseen > CS_UNRESOLVED_ENERGY_MAX * start.total_energy ? 1 : 0;
    const double near = nearest < range ? much : 0;
    return cs_pair_motion_samples(cs_pair_motion_longest(way), range) < 1 ? near : 2;
}

CS_INLINE void check_all(enum cs_pair_kind kind, struct cs_pair_motion_lanes *restrict lanes,
                         double h) {
    for (int l = 0; l < CS_PAIR_MOTION_LANES; l++) {
        struct cs_pair_motion way = {.kind = kind};
        read_motion(lanes, l, &way);
        lanes->result[l] = ask(&way, h, lanes->range[l], lanes->k[l]);
    }
}

CS_CLONES static void check_triangles(struct cs_pair_motion_lanes *restrict lanes, double h) {
    check_all(CS_PAIR_POINT_TRIANGLE, lanes, h);
}

CS_CLONES static void check_edges(struct cs_pair_motion_lanes *restrict lanes, double h) {
    check_all(CS_PAIR_EDGE_EDGE, lanes, h);
}

void cs_pair_motion_lanes_check(enum cs_pair_kind kind, struct cs_pair_motion_lanes *lanes,
                                double h) {
    if (kind == CS_PAIR_EDGE_EDGE)
        check_edges(lanes, h);
    else
        check_triangles(lanes, h);
}

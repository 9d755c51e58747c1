/* Short ways, eight at a time. */
#include "base/vectorise.h"

#include "model/pair/way.h"

CS_INLINE void read_way(struct cs_way_lanes *lanes, int lane, struct cs_way *way) {
    CS_UNROLLED
    for (int k = 0; k < 12; k++) {
        way->from[k / 3][k % 3] = lanes->from[k / 3][k % 3][lane];
        way->move[k / 3][k % 3] = lanes->move[k / 3][k % 3][lane];
    }
    CS_UNROLLED
    for (int k = 0; k < 4; k++)
        way->inverse_mass[k] = lanes->inverse_mass[k][lane];
}

CS_INLINE double ask(struct cs_way *way, double h, double range, double k) {
    struct cs_stencil at, to;
    struct cs_way_start start;
    double end[4][3];
    CS_UNROLLED
    for (int j = 0; j < 12; j++)
        end[j / 3][j % 3] = way->from[j / 3][j % 3] + way->move[j / 3][j % 3];
    cs_stencil_set(&at, way->kind, way->from);
    cs_stencil_set(&to, way->kind, end);
    cs_way_begin(way, &at, h, range, k, &start);
    const double nearest = to.d < at.d ? to.d : at.d;
    const double unseen = cs_way_unseen(&start, 1, to.d, range, k);
    const double much = unseen > CS_SHARE_UNSEEN * start.has ? 1 : 0;
    const double near = nearest < range ? much : 0;
    return cs_way_points(cs_way_longest(way), range) < 1 ? near : 2;
}

CS_INLINE void ask_all(enum cs_stencil_kind kind, struct cs_way_lanes *restrict lanes,
                       double h) {
    for (int l = 0; l < CS_WAY_LANES; l++) {
        struct cs_way way = {.kind = kind};
        read_way(lanes, l, &way);
        lanes->answer[l] = ask(&way, h, lanes->range[l], lanes->k[l]);
    }
}

CS_CLONES static void ask_triangles(struct cs_way_lanes *restrict lanes, double h) {
    ask_all(CS_STENCIL_TRIANGLE, lanes, h);
}

CS_CLONES static void ask_edges(struct cs_way_lanes *restrict lanes, double h) {
    ask_all(CS_STENCIL_EDGES, lanes, h);
}

void cs_way_lanes_ask(enum cs_stencil_kind kind, struct cs_way_lanes *lanes, double h) {
    if (kind == CS_STENCIL_EDGES)
        ask_edges(lanes, h);
    else
        ask_triangles(lanes, h);
}

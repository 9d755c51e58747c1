/* True distances by cases (Ericson 2005, sec. 5.1): the common perpendicular if it meets the
 * inside of both primitives, else the least distance between an end or edge of one and the
 * other. */
#include "base/vectorise.h"

#include "model/contact/narrow_phase/exact_distance.h"

CS_INLINE double min_of(double a, double b) {
    return a < b ? a : b;
}

/* Squared distance of p from segment a b; selected without branches, so that loops over lanes
 * vectorise. An edge without length has t = 0. */
CS_INLINE double from_segment(const double p[3], const double a[3], const double b[3]) {
    const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    const double w[3] = {p[0] - a[0], p[1] - a[1], p[2] - a[2]};
    const double along = cs_vec3_dot(u, w), length = cs_vec3_dot(u, u);
    const double inner = along / length, end = along < length ? inner : 1;
    const double t = along > 0 ? end : 0;
    const double r[3] = {w[0] - t * u[0], w[1] - t * u[1], w[2] - t * u[2]};
    return cs_vec3_dot(r, r);
}

/* Feet of the common perpendicular: l and m are the parameters along u and v times `whole` = a
 * c - b^2, and squared its squared length. whole is -1 for primitives that are parallel within
 * sin^2 = 1e-10, whose division would amplify rounding; their edges then decide. */
struct crossing {
    double l, m, whole, squared;
};

CS_INLINE struct crossing cross_at(enum cs_pair_kind kind, double p[4][3]) {
    double u[3], v[3], w[3];
    cs_pair_distance_differences(kind, p, u, v, w);
    const double a = cs_vec3_dot(u, u), b = cs_vec3_dot(u, v), c = cs_vec3_dot(v, v);
    const double d = cs_vec3_dot(u, w), e = cs_vec3_dot(v, w);
    const double whole = a * c - b * b;
    // nearly parallel: the edges decide
    struct crossing at = {c * d - b * e, a * e - b * d, whole > 1e-10 * a * c ? whole : -1, 0};
    const double l = at.l / at.whole, m = at.m / at.whole;
    const double r[3] = {w[0] - l * u[0] - m * v[0], w[1] - l * u[1] - m * v[1],
                         w[2] - l * u[2] - m * v[2]};
    at.squared = cs_vec3_dot(r, r);
    return at;
}

/* Least of the barycentric coordinates times whole: negative if the perpendicular misses the
 * inside of a primitive. */
CS_INLINE double room_of(enum cs_pair_kind kind, struct crossing at) {
    const double left = kind == CS_PAIR_EDGE_EDGE ? min_of(at.whole - at.l, at.whole - at.m)
                                                  : at.whole - (at.l + at.m);
    return min_of(min_of(at.l, at.m), min_of(left, at.whole));
}

/* Least squared distance that involves an end of an edge, or an edge of the triangle. */
CS_INLINE double from_rims(enum cs_pair_kind kind, double p[4][3]) {
    if (kind == CS_PAIR_EDGE_EDGE)
        return min_of(min_of(from_segment(p[0], p[2], p[3]), from_segment(p[1], p[2], p[3])),
                      min_of(from_segment(p[2], p[0], p[1]), from_segment(p[3], p[0], p[1])));
    return min_of(min_of(from_segment(p[0], p[1], p[2]), from_segment(p[0], p[2], p[3])),
                  from_segment(p[0], p[3], p[1]));
}

CS_INLINE void measure(enum cs_pair_kind kind, struct cs_exact_distance_lanes *restrict lanes) {
    for (int l = 0; l < CS_EXACT_DISTANCE_LANES; l++) {
        double p[4][3];
        CS_UNROLLED
        for (int k = 0; k < 12; k++)
            p[k / 3][k % 3] = lanes->p[k / 3][k % 3][l];
        const struct crossing at = cross_at(kind, p);
        const double rims = from_rims(kind, p);
        lanes->squared[l] = room_of(kind, at) >= 0 ? at.squared : rims;
    }
}

CS_CLONES static void measure_triangles(struct cs_exact_distance_lanes *restrict lanes) {
    measure(CS_PAIR_POINT_TRIANGLE, lanes);
}

CS_CLONES static void measure_edges(struct cs_exact_distance_lanes *restrict lanes) {
    measure(CS_PAIR_EDGE_EDGE, lanes);
}

void cs_exact_distance_measure(enum cs_pair_kind kind, struct cs_exact_distance_lanes *lanes) {
    if (kind == CS_PAIR_EDGE_EDGE)
        measure_edges(lanes);
    else
        measure_triangles(lanes);
}

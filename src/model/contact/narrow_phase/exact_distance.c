/* True distances: that of the perpendicular where it meets the inside of both, else the least
 * of those from rims. */
#include "base/vectorise.h"

#include "model/contact/narrow_phase/exact_distance.h"

CS_INLINE double min_of(double a, double b) {
    return a < b ? a : b;
}

/* of p from the segment a b; chosen, not branched to, so that loops over lanes vectorise */
CS_INLINE double from_segment(const double p[3], const double a[3], const double b[3]) {
    const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    const double w[3] = {p[0] - a[0], p[1] - a[1], p[2] - a[2]};
    const double along = cs_vec3_dot(u, w), length = cs_vec3_dot(u, u);
    const double inner = along / length, end = along < length ? inner : 1;
    const double t = along > 0 ? end : 0;
    const double r[3] = {w[0] - t * u[0], w[1] - t * u[1], w[2] - t * u[2]};
    return cs_vec3_dot(r, r);
}

/* The crossing of the perpendicular: shares of u and v over `whole`, and its length squared. */
struct crossing {
    double l, m, whole, squared;
};

CS_INLINE struct crossing cross_at(enum cs_pair_kind kind, double p[4][3]) {
    double u[3], v[3], w[3];
    cs_pair_distance_differences(kind, p, u, v, w);
    const double a = cs_vec3_dot(u, u), b = cs_vec3_dot(u, v), c = cs_vec3_dot(v, v);
    const double d = cs_vec3_dot(u, w), e = cs_vec3_dot(v, w);
    const double whole = a * c - b * b;
    // where they are almost parallel the rims know it better
    struct crossing at = {c * d - b * e, a * e - b * d, whole > 1e-10 * a * c ? whole : -1, 0};
    const double l = at.l / at.whole, m = at.m / at.whole;
    const double r[3] = {w[0] - l * u[0] - m * v[0], w[1] - l * u[1] - m * v[1],
                         w[2] - l * u[2] - m * v[2]};
    at.squared = cs_vec3_dot(r, r);
    return at;
}

/* least of l, m and what is left of the whole, or of the wholes of two edges: below 0 where the
 * crossing is outside */
CS_INLINE double room_of(enum cs_pair_kind kind, struct crossing at) {
    const double left = kind == CS_PAIR_EDGE_EDGE ? min_of(at.whole - at.l, at.whole - at.m)
                                                  : at.whole - (at.l + at.m);
    return min_of(min_of(at.l, at.m), min_of(left, at.whole));
}

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

/* Distances in single precision, one pair per lane. Error analysis: distance_filter.h. */

#include "model/contact/broad_phase/distance_filter.h"

#include <clothsim/clones.h>
#include <string.h>

/* Factors of P^2 and L^2 in the test: 102 (1e-6)^2 and 102 (2e-3)^2. */
#define PLACE  1.02e-10f
#define LENGTH 4.08e-4f

/* s^2 = (a c - b^2) / (a c) up to which edges count as parallel, and triangles as their edges:
 * where the error eps/s^2 of a foot is 0.06 per rounding. */
#define PARALLEL 1e-6f

CS_CLONES void cs_distance_filter_scale_points(const double *x, size_t n, double inverse,
                                               size_t begin, size_t end,
                                               struct cs_scaled_point *points) {
    const double low[3] = {x[0], x[n], x[2 * n]};
    for (size_t i = begin; i < end; i++) {
        float *at = points[i].xyz0;
        at[0] = (float)((x[i] - low[0]) * inverse);
        at[1] = (float)((x[n + i] - low[1]) * inverse);
        at[2] = (float)((x[2 * n + i] - low[2]) * inverse);
        at[3] = 0;
    }
}

CS_INLINE float dot(const float a[3], const float b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

CS_INLINE float min_of(float a, float b) {
    return a < b ? a : b;
}

/* along / length clamped to [0, 1]; 0 if it is not a number */
CS_INLINE float fraction_of(float along, float length) {
    const float t = along / length, low = t > 0 ? t : 0;
    return low < 1 ? low : 1;
}

/* squared distance of w from the segment from the origin along u */
CS_INLINE float from_segment(const float w[3], const float u[3], float along, float length) {
    const float t = fraction_of(along, length);
    const float r[3] = {w[0] - t * u[0], w[1] - t * u[1], w[2] - t * u[2]};
    return dot(r, r);
}

/* The differences of a pair and all their products; whole = a c - b^2. */
struct shape {
    float u[3], v[3], w[3], a, b, c, d, e, whole;
};

CS_INLINE struct shape shape_of(const float u[3], const float v[3], const float w[3]) {
    struct shape s = {
        {u[0], u[1], u[2]}, {v[0], v[1], v[2]}, {w[0], w[1], w[2]}, 0, 0, 0, 0, 0, 0};
    s.a = dot(u, u);
    s.b = dot(u, v);
    s.c = dot(v, v);
    s.d = dot(u, w);
    s.e = dot(v, w);
    s.whole = s.a * s.c - s.b * s.b;
    return s;
}

/* Squared distance of the point w from the triangle 0 u v: that of the plane if the foot is
 * inside, (w.n)^2 / n.n, else the least of the three edges. */
CS_INLINE float from_triangle(struct shape s) {
    const float *u = s.u, *v = s.v, *w = s.w;
    const float n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                        u[0] * v[1] - u[1] * v[0]};
    const float q[3] = {v[0] - u[0], v[1] - u[1], v[2] - u[2]};
    const float z[3] = {w[0] - u[0], w[1] - u[1], w[2] - u[2]};
    const float height = dot(n, w), plane = height * height / dot(n, n);
    const float first = s.c * s.d - s.b * s.e, second = s.a * s.e - s.b * s.d;
    const float capacity = min_of(min_of(first, second), s.whole - (first + second));
    const float rims =
        min_of(min_of(from_segment(w, u, s.d, s.a), from_segment(w, v, s.e, s.c)),
               from_segment(z, q, dot(q, z), dot(q, q)));
    const bool inside = (capacity >= 0) & (s.whole > PARALLEL * s.a * s.c);
    return inside ? plane : rims;
}

/* Squared distance of the edge from w along u and the edge from the origin along v. The
 * parameter on the first line is clamped, then the nearest point on the second edge, then the
 * nearest on the first again (cf. Ericson 2005, sec. 5.1.9). */
CS_INLINE float from_edge(struct shape s) {
    const float cross = fraction_of(s.b * s.e - s.c * s.d, s.whole);
    const float along = s.whole > PARALLEL * s.a * s.c ? cross : 0;
    const float t = fraction_of(s.b * along + s.e, s.c);
    const float k = fraction_of(s.b * t - s.d, s.a);
    const float r[3] = {s.w[0] + k * s.u[0] - t * s.v[0], s.w[1] + k * s.u[1] - t * s.v[1],
                        s.w[2] + k * s.u[2] - t * s.v[2]};
    return dot(r, r);
}

/* Sets `ratio` of all lanes. */
CS_INLINE void measure(enum cs_pair_kind kind, struct cs_distance_filter *restrict filter) {
    const bool edges = kind == CS_PAIR_EDGE_EDGE;
    for (int l = 0; l < CS_DISTANCE_FILTER; l++) {
        float p[4][3], u[3], v[3], w[3];
        CS_UNROLLED
        for (int k = 0; k < 12; k++)
            p[k / 3][k % 3] = filter->points[k / 3][k % 3][l];
        CS_UNROLLED
        for (int c = 0; c < 3; c++) {
            u[c] = edges ? p[1][c] - p[0][c] : p[2][c] - p[1][c];
            v[c] = edges ? p[3][c] - p[2][c] : p[3][c] - p[1][c];
            w[c] = edges ? p[0][c] - p[2][c] : p[0][c] - p[1][c];
        }
        const struct shape s = shape_of(u, v, w);
        const float squared = edges ? from_edge(s) : from_triangle(s);
        const float reach = filter->max_distance[l];
        filter->ratio[l] =
            squared - (cs_distance_filter_bound(reach) + PLACE * dot(p[0], p[0]) +
                       LENGTH * (s.a + s.c + dot(w, w)));
    }
}

CS_PAIR_KERNEL(extern, cs_distance_filter_measure, measure,
               (struct cs_distance_filter *restrict filter), (filter))

uint32_t cs_distance_filter_run(enum cs_pair_kind kind, struct cs_distance_filter *filter) {
    const uint32_t n = filter->n;
    uint32_t kept = 0;
    filter->n = 0;
    if (!n)
        return 0;
    cs_distance_filter_measure(kind, filter);
    for (uint32_t l = 0; l < n; l++) {
        // Compaction without a branch: a removed pair is overwritten by the next.
        memcpy(filter->pairs[kept], filter->pairs[l], sizeof filter->pairs[l]);
        kept += !(filter->ratio[l] > 0);
    }
    return kept;
}

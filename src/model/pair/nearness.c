/* True distances: that of the perpendicular where it meets the inside of both, else the least
 * of those from rims. */
#include "model/pair/nearness.h"

static double least_of(double a, double b) {
    return a < b ? a : b;
}

static double most_of(double a, double b) {
    return a > b ? a : b;
}

bool cs_nearness_is_apart(enum cs_stencil_kind kind, double p[4][3], double range) {
    const bool edges = kind == CS_STENCIL_EDGES;
    const double far = range * (1 + 1e-9);
    bool apart = false;
    for (int c = 0; c < 3; c++) {
        // the second point is of either side
        const double low = least_of(p[2][c], p[3][c]), high = most_of(p[2][c], p[3][c]);
        const double from = edges ? least_of(p[0][c], p[1][c]) : p[0][c];
        const double to = edges ? most_of(p[0][c], p[1][c]) : p[0][c];
        const double least = edges ? low : least_of(low, p[1][c]);
        const double most = edges ? high : most_of(high, p[1][c]);
        apart |= from - most > far || least - to > far;
    }
    return apart;
}

/* of p from the segment a b */
static double from_segment(const double p[3], const double a[3], const double b[3]) {
    double u[3], w[3], squared = 0;
    for (int c = 0; c < 3; c++) {
        u[c] = b[c] - a[c];
        w[c] = p[c] - a[c];
    }
    const double along = cs_vec3_dot(u, w), length = cs_vec3_dot(u, u);
    const double t = !(along > 0) ? 0 : along < length ? along / length : 1;
    for (int c = 0; c < 3; c++)
        squared += (w[c] - t * u[c]) * (w[c] - t * u[c]);
    return squared;
}

/* The crossing of the perpendicular: shares of u and v over `whole`, and its length squared. */
struct crossing {
    double l, m, whole, squared;
};

static struct crossing cross_at(enum cs_stencil_kind kind, double p[4][3]) {
    double u[3], v[3], w[3];
    cs_stencil_differences(kind, p, u, v, w);
    const double a = cs_vec3_dot(u, u), b = cs_vec3_dot(u, v), c = cs_vec3_dot(v, v);
    const double d = cs_vec3_dot(u, w), e = cs_vec3_dot(v, w);
    struct crossing at = {c * d - b * e, a * e - b * d, a * c - b * b, 0};
    // where they are almost parallel the rims know it better
    if (!(at.whole > 1e-10 * a * c))
        at.whole = -1;
    const double l = at.l / at.whole, m = at.m / at.whole;
    for (int k = 0; k < 3; k++)
        at.squared += (w[k] - l * u[k] - m * v[k]) * (w[k] - l * u[k] - m * v[k]);
    return at;
}

double cs_nearness_triangle(double p[4][3]) {
    const struct crossing at = cross_at(CS_STENCIL_TRIANGLE, p);
    if (at.whole > 0 && at.l >= 0 && at.m >= 0 && at.l + at.m <= at.whole)
        return at.squared;
    return least_of(least_of(from_segment(p[0], p[1], p[2]), from_segment(p[0], p[2], p[3])),
                    from_segment(p[0], p[3], p[1]));
}

double cs_nearness_edges(double p[4][3]) {
    const struct crossing at = cross_at(CS_STENCIL_EDGES, p);
    if (at.whole > 0 && at.l >= 0 && at.m >= 0 && at.l <= at.whole && at.m <= at.whole)
        return at.squared;
    return least_of(least_of(from_segment(p[0], p[2], p[3]), from_segment(p[1], p[2], p[3])),
                    least_of(from_segment(p[2], p[0], p[1]), from_segment(p[3], p[0], p[1])));
}

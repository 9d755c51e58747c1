/* Distances by cases (Ericson 2005, sec. 5.1), and additive advance along a move (Li et al.
 * 2021). */
#include "model/contact/ccd/accd.h"

#include "base/vec3.h"

#include <float.h>
#include <math.h>

/* fraction of the safe advance per iteration, so that a tenth of the distance stays for
 * rounding */
#define ADVANCE 0.9

/* fraction of the first distance at which the search ends */
#define LEFT 0.1

/* largest number of iterations; the fraction reached is still safe */
enum { TURNS_MAX = 1000 };

static void subtract(const double a[3], const double b[3], double out[3]) {
    for (int c = 0; c < 3; c++)
        out[c] = a[c] - b[c];
}

static double clamp(double t) {
    return t > 0 ? fmin(t, 1) : 0;
}

/* |w + s u - t v|^2 in m2 */
static double squared_at(const double w[3], double s, const double u[3], double t,
                         const double v[3]) {
    double sum = 0;
    for (int c = 0; c < 3; c++) {
        const double r = w[c] + s * u[c] - t * v[c];
        sum += r * r;
    }
    return sum;
}

/* squared distance of p from the segment a b; from a if it has no length */
static double from_segment(const double p[3], const double a[3], const double b[3]) {
    double u[3], w[3];
    subtract(b, a, u);
    subtract(p, a, w);
    const double uu = cs_vec3_dot(u, u);
    return squared_at(w, 0, u, uu > 0 ? clamp(cs_vec3_dot(u, w) / uu) : 0, u);
}

/* Squared distance of p[0] from its triangle: that of the foot if it is inside, else the least
 * distance from an edge. */
static double from_triangle(const double p[4][3]) {
    double u[3], v[3], w[3];
    subtract(p[2], p[1], u);
    subtract(p[3], p[1], v);
    subtract(p[0], p[1], w);
    const double uu = cs_vec3_dot(u, u), uv = cs_vec3_dot(u, v), vv = cs_vec3_dot(v, v);
    const double uw = cs_vec3_dot(u, w), vw = cs_vec3_dot(v, w);
    const double det = uu * vv - uv * uv, s = vv * uw - uv * vw, t = uu * vw - uv * uw;
    if (det > 0 && s >= 0 && t >= 0 && s + t <= det)
        return squared_at(w, -s / det, u, t / det, v);
    return fmin(from_segment(p[0], p[1], p[2]),
                fmin(from_segment(p[0], p[2], p[3]), from_segment(p[0], p[3], p[1])));
}

/* Squared distance of two edges: from the point of the first line nearest to the second,
 * clamped, and from each end to the other edge. Cross products keep their accuracy for small
 * angles, where the determinant of dot products cancels. */
static double between_edges(const double p[4][3]) {
    double u[3], v[3], w[3], normal[3], across[3];
    subtract(p[1], p[0], u);
    subtract(p[3], p[2], v);
    subtract(p[0], p[2], w);
    cs_vec3_cross(u, v, normal);
    cs_vec3_cross(v, w, across);
    const double square = cs_vec3_dot(normal, normal);
    double inner = DBL_MAX;
    if (square > 0) {
        const double s = clamp(cs_vec3_dot(across, normal) / square);
        double q[3];
        for (int c = 0; c < 3; c++)
            q[c] = p[0][c] + s * u[c];
        inner = from_segment(q, p[2], p[3]);
    }
    const double first = fmin(from_segment(p[0], p[2], p[3]), from_segment(p[1], p[2], p[3]));
    const double second = fmin(from_segment(p[2], p[0], p[1]), from_segment(p[3], p[0], p[1]));
    return fmin(inner, fmin(first, second));
}

double cs_exact_distance_squared(enum cs_pair_kind kind, const double p[4][3]) {
    return kind == CS_PAIR_POINT_TRIANGLE ? from_triangle(p) : between_edges(p);
}

/* Takes the mean off the moves; returns the bound l of the relative motion of both sides. */
static double relative_move(enum cs_pair_kind kind, const double moves[4][3],
                            double rest[4][3]) {
    double mean[3] = {0, 0, 0}, length[4];
    for (int k = 0; k < 4; k++)
        for (int c = 0; c < 3; c++)
            mean[c] += 0.25 * moves[k][c];
    for (int k = 0; k < 4; k++) {
        subtract(moves[k], mean, rest[k]);
        length[k] = sqrt(cs_vec3_dot(rest[k], rest[k]));
    }
    const double other = fmax(length[2], length[3]);
    return kind == CS_PAIR_POINT_TRIANGLE ? length[0] + fmax(length[1], other)
                                          : fmax(length[0], length[1]) + other;
}

/* Two quick exits precede the loop: no relative motion, and a first distance that exceeds the
 * whole relative motion. Each advance is safe by itself, so an early end is safe too. */
double cs_accd_safe_fraction(enum cs_pair_kind kind, const double p[4][3],
                             const double moves[4][3], double most) {
    double rest[4][3], at[4][3], share = 0;
    const double move = relative_move(kind, moves, rest);
    if (!(move > 0 && move <= DBL_MAX))
        return most;
    const double start = sqrt(cs_exact_distance_squared(kind, p));
    if (start > move + CS_ACCD_DISTANCE_MIN)
        return most;
    if (!(start > CS_ACCD_DISTANCE_MIN))
        return 0;
    double gap = start;
    for (int turn = 0; turn < TURNS_MAX; turn++) {
        share += ADVANCE * gap / move;
        if (share >= most)
            return most;
        for (int k = 0; k < 4; k++)
            for (int c = 0; c < 3; c++)
                at[k][c] = p[k][c] + share * rest[k][c];
        gap = sqrt(cs_exact_distance_squared(kind, (const double(*)[3])at));
        if (!(gap > LEFT * start))
            break;
    }
    return share;
}

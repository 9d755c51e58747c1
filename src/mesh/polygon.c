/* Cuts a polygon into triangles, in the plane of its mean normal (Newell's: Sutherland,
 * Sproull, Schumacker 1974). A corner is an ear if it is convex and no other corner lies in its
 * triangle; every simple polygon of four corners or more has two ears (Meisters 1975). */
#include "base/vec3.h"
#include "mesh/mesh_mend.h"

/* Twice the area of a triangle seen along the normal: above 0 if it turns the polygon's way. */
static double turn_of(const double a[3], const double b[3], const double c[3],
                      const double normal[3]) {
    const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]},
                 v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    double across[3];
    cs_vec3_cross(u, v, across);
    return cs_vec3_dot(across, normal);
}

/* Sets the normal, whose length is twice the area, relative to corner 0; returns its square. */
static double find_normal(const double (*x)[3], uint32_t n, double normal[3]) {
    for (int c = 0; c < 3; c++)
        normal[c] = 0;
    for (uint32_t i = 2; i < n; i++) {
        double u[3], v[3], across[3];
        for (int c = 0; c < 3; c++) {
            u[c] = x[i - 1][c] - x[0][c];
            v[c] = x[i][c] - x[0][c];
        }
        cs_vec3_cross(u, v, across);
        for (int c = 0; c < 3; c++)
            normal[c] += across[c];
    }
    return cs_vec3_dot(normal, normal);
}

/* Fraction of the polygon's area below which a triangle counts as flat: rounding. */
#define FLAT 1e-9

/* Writes the fan of the corners in the ring from `first` on. */
static void add_fan(const uint32_t *next, uint32_t first, uint32_t n, uint32_t *out) {
    for (uint32_t b = next[first]; n > 2; n--, b = next[b]) {
        *out++ = first;
        *out++ = b;
        *out++ = next[b];
    }
}

static bool is_same(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* True if the corner behind `before` is an ear of the ring. Others in the place of its corners
 * do not count: they are there at the bridge to a hole, and of quads at the pole of a sphere.
 */
static bool is_ear(const double (*x)[3], const uint32_t *next, uint32_t before, double least,
                   const double normal[3]) {
    const uint32_t at = next[before], behind = next[at];
    if (!(turn_of(x[before], x[at], x[behind], normal) > least))
        return false;
    for (uint32_t i = next[behind]; i != before; i = next[i])
        if (turn_of(x[before], x[at], x[i], normal) >= 0 &&
            turn_of(x[at], x[behind], x[i], normal) >= 0 &&
            turn_of(x[behind], x[before], x[i], normal) >= 0 && !is_same(x[i], x[before]) &&
            !is_same(x[i], x[at]) && !is_same(x[i], x[behind]))
            return false;
    return true;
}

bool cs_polygon_cut(const double (*x)[3], uint32_t n, uint32_t *next, uint32_t *triangles) {
    double normal[3];
    const double least = FLAT * find_normal(x, n, normal);
    bool is_fan = true;
    for (uint32_t i = 0; i < n; i++)
        next[i] = (i + 1) % n;
    // one too long for ears is a fan if it is convex but for rounding
    for (uint32_t i = 2; i < n && n > 3; i++)
        is_fan = is_fan &&
                 turn_of(x[0], x[i - 1], x[i], normal) > (n > CS_POLYGON_MAX ? -least : least);
    /* goes round until an ear is cut off, or a whole round has found none */
    uint32_t before = 0, left = n, missed = 0;
    while (!is_fan && n <= CS_POLYGON_MAX && left > 3 && missed < left) {
        const uint32_t at = next[before];
        if (!is_ear(x, next, before, least, normal)) {
            before = at;
            missed++;
            continue;
        }
        *triangles++ = before;
        *triangles++ = at;
        *triangles++ = next[at];
        next[before] = next[at];
        left--;
        missed = 0;
    }
    add_fan(next, before, left, triangles);
    return is_fan || left == 3;
}

/* collider_distance.c - how far a point is from an obstacle: exactly, and smoothly for the
 * force.
 *
 * In the obstacle's own frame, with the half sizes c of the core and the radius r:
 *   exact    |max(|x_i| - c_i, 0)| + min(max_i(|x_i| - c_i), 0) - r
 *   smooth   |q| - S(-max_i(|x_i| - c_i)) - r,   q_i = sign(x_i) S(|x_i| - c_i)
 * with S of cs_smooth_positive; where the core has no extent along an axis, q_i = x_i. The
 * middle term is there for boxes only. It is 0 everywhere outside.
 */
#include "model/contact/posed_collider.h"

#include "base/vec3.h"
#include "model/contact/smooth_positive.h"

#include <math.h>
#include <string.h>

/* share of the radius over which the core's features are blended, to both sides */
#define BAND 0.5

/* distance from a point; n = unit vector away from it, up where there is none */
static double from_point(const double p[3], const double centre[3], double n[3]) {
    double squared = 0;
    for (int c = 0; c < 3; c++) {
        n[c] = p[c] - centre[c];
        squared += n[c] * n[c];
    }
    const double length = sqrt(squared);
    for (int c = 0; c < 3; c++)
        n[c] = length > 0 ? n[c] / length : c == 1;
    return length;
}

static double from_plane(const struct cs_posed_collider *plane, double skin, const double p[3],
                         double n[3]) {
    memcpy(n, plane->axes[1], 3 * sizeof *n);
    double distance = -skin;
    for (int c = 0; c < 3; c++)
        distance += n[c] * (p[c] - plane->centre[c]);
    return distance;
}

/* p in the obstacle's own frame */
static void to_own(const struct cs_posed_collider *obstacle, const double p[3], double x[3]) {
    const double from[3] = {p[0] - obstacle->centre[0], p[1] - obstacle->centre[1],
                            p[2] - obstacle->centre[2]};
    for (int k = 0; k < 3; k++)
        x[k] = cs_vec3_dot(obstacle->axes[k], from);
}

/* a vector of the own frame in that of the world */
static void to_world(const struct cs_posed_collider *obstacle, const double own[3],
                     double out[3]) {
    for (int c = 0; c < 3; c++)
        out[c] = own[0] * obstacle->axes[0][c] + own[1] * obstacle->axes[1][c] +
                 own[2] * obstacle->axes[2][c];
}

/* the axis along which x is nearest to a face of the core */
static int nearest_face(const struct cs_posed_collider *obstacle, const double x[3]) {
    int face = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(x[k]) - obstacle->half_sizes[k] > fabs(x[face]) - obstacle->half_sizes[face])
            face = k;
    return face;
}

double cs_posed_collider_distance(const struct cs_posed_collider *obstacle, const double p[3],
                                  double n[3]) {
    if (obstacle->kind == CS_COLLIDER_SPHERE)
        return from_point(p, obstacle->centre, n) - obstacle->radius;
    if (obstacle->kind == CS_COLLIDER_PLANE)
        return from_plane(obstacle, 0, p, n);
    if (obstacle->kind == CS_COLLIDER_MESH) {
        memcpy(n, obstacle->axes[1], sizeof obstacle->axes[1]);
        return HUGE_VAL;
    }
    static const double middle[3] = {0, 0, 0};
    double x[3], out[3];
    to_own(obstacle, p, x);
    for (int k = 0; k < 3; k++)
        out[k] = copysign(fmax(fabs(x[k]) - obstacle->half_sizes[k], 0), x[k]);

    // inside the core of a box: out by the nearest face
    const bool inside = out[0] == 0 && out[1] == 0 && out[2] == 0;
    if (inside && obstacle->kind == CS_COLLIDER_BOX) {
        const int face = nearest_face(obstacle, x);
        for (int c = 0; c < 3; c++)
            n[c] = x[face] < 0 ? -obstacle->axes[face][c] : obstacle->axes[face][c];
        return fabs(x[face]) - obstacle->half_sizes[face] - obstacle->radius;
    }
    double own[3];
    const double length = from_point(out, middle, own);
    if (inside)
        from_point(middle, middle, n);
    else
        to_world(obstacle, own, n);
    return length - obstacle->radius;
}

double cs_posed_collider_signed_distance(const struct cs_posed_collider *obstacle,
                                         const double p[3], double n[3]) {
    const double skin = obstacle->collider->thickness;
    return obstacle->kind == CS_COLLIDER_PLANE
               ? from_plane(obstacle, skin, p, n)
               : cs_posed_collider_distance(obstacle, p, n) - skin;
}

/* the plane and the sphere: no features to blend */
static double smooth_point(const struct cs_posed_collider *obstacle, const double p[3],
                           double g[3], double h[6]) {
    memset(h, 0, 6 * sizeof *h);
    if (obstacle->kind == CS_COLLIDER_PLANE)
        return from_plane(obstacle, 0, p, g);
    const double length = from_point(p, obstacle->centre, g);
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    for (int e = 0; e < 6 && length > 0; e++)
        h[e] = ((row[e] == column[e]) - g[row[e]] * g[column[e]]) / length;
    return length - obstacle->radius;
}

/* The smooth distance in the own frame: gradient g (3) and Hessian h (3,3). */
static double smooth_diagonal(const struct cs_posed_collider *obstacle, const double x[3],
                              double g[3], double h[3][3]) {
    double q[3], slope[3], bend[3], soft[3];
    for (int k = 0; k < 3; k++) {
        const double band = fmin(BAND * obstacle->radius, obstacle->half_sizes[k]);
        cs_smooth_positive(fabs(x[k]) - obstacle->half_sizes[k], band, soft);
        const bool none = obstacle->half_sizes[k] == 0;
        q[k] = none ? x[k] : copysign(soft[0], x[k]);
        slope[k] = none ? 1 : soft[1];
        bend[k] = none ? 0 : copysign(soft[2], x[k]);
    }
    const double length = sqrt(cs_vec3_dot(q, q)), per_length = length > 0 ? 1 / length : 0;
    for (int k = 0; k < 3; k++)
        g[k] = q[k] * per_length * slope[k];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            h[i][j] = ((i == j ? slope[i] * slope[i] + q[i] * bend[i] : 0) - g[i] * g[j]) *
                      per_length;
    return length - obstacle->radius;
}

/* the core is a box with a volume */
static bool has_inside(const struct cs_posed_collider *obstacle) {
    const double *core = obstacle->half_sizes;
    return core[0] > 0 && core[1] > 0 && core[2] > 0;
}

/* the face of a box that x lies in front of, further from its rim than what is blended; -1: it
 * lies in front of none */
static int face_below(const struct cs_posed_collider *obstacle, const double x[3]) {
    int face = -1, within = 0;
    for (int k = 0; k < 3; k++) {
        const double band = fmin(BAND * obstacle->radius, obstacle->half_sizes[k]);
        const double out = fabs(x[k]) - obstacle->half_sizes[k];
        if (out >= band)
            face = k;
        within += out <= -band;
    }
    return within == 2 && has_inside(obstacle) ? face : -1;
}

static double smooth_face(const struct cs_posed_collider *obstacle, int face, double x,
                          double gradient[3], double hessian[6]) {
    memset(hessian, 0, 6 * sizeof *hessian);
    for (int c = 0; c < 3; c++)
        gradient[c] = copysign(1, x) * obstacle->axes[face][c];
    return fabs(x) - obstacle->half_sizes[face] - obstacle->radius;
}

/* what is to be added for the inside of the core */
static double smooth_core(const struct cs_posed_collider *obstacle, const double x[3],
                          double g[3], double h[3][3]) {
    double soft[3];
    const int face = nearest_face(obstacle, x);
    const double band = fmin(BAND * obstacle->radius, obstacle->half_sizes[face]);
    cs_smooth_positive(obstacle->half_sizes[face] - fabs(x[face]), band, soft);
    g[face] += copysign(soft[1], x[face]);
    h[face][face] -= soft[2];
    return -soft[0];
}

double cs_posed_collider_smooth_distance(const struct cs_posed_collider *obstacle,
                                         const double p[3], double gradient[3],
                                         double hessian[6]) {
    if (obstacle->kind == CS_COLLIDER_SPHERE || obstacle->kind == CS_COLLIDER_PLANE)
        return smooth_point(obstacle, p, gradient, hessian);
    double x[3], g[3], h[3][3], rows[3][3], out[3][3];
    to_own(obstacle, p, x);
    const int face = face_below(obstacle, x);
    if (face >= 0)
        return smooth_face(obstacle, face, x[face], gradient, hessian);
    double distance = smooth_diagonal(obstacle, x, g, h);
    if (has_inside(obstacle))
        distance += smooth_core(obstacle, x, g, h);

    // the very axis of a capsule has no direction: up, as in the centre of a sphere
    to_world(obstacle, g, gradient);
    if (g[0] == 0 && g[1] == 0 && g[2] == 0)
        gradient[1] = 1;
    for (int k = 0; k < 3; k++)
        to_world(obstacle, h[k], rows[k]);
    for (int c = 0; c < 3; c++) {
        const double column[3] = {rows[0][c], rows[1][c], rows[2][c]};
        to_world(obstacle, column, out[c]);
    }
    const double packed[6] = {out[0][0], out[0][1], out[0][2], out[1][1], out[1][2], out[2][2]};
    memcpy(hessian, packed, sizeof packed);
    return distance;
}

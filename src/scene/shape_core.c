/* The distance from a core - a segment or a box - less a radius: exactly, and smoothly for the
 * force.
 *
 * In the obstacle's own frame, with the half sizes c of the core and the radius r:
 *   exact    |max(|x_i| - c_i, 0)| + min(max_i(|x_i| - c_i), 0) - r
 *   smooth   |q| - S(-max_i(|x_i| - c_i)) - r,   q_i = sign(x_i) S(|x_i| - c_i)
 * with S of cs_smooth_positive; where the core has no extent along an axis, q_i = x_i. The
 * middle term is there for boxes only. It is 0 everywhere outside.
 */
#include "scene/shape_core.h"

#include "base/vec3.h"
#include "scene/soft.h"

#include <string.h>

/* share of the radius over which the core's features are blended, to both sides */
#define BAND 0.5

void cs_core_complete_axes(double axes[3][3]) {
    const double *along = axes[1];
    const double other[3] = {fabs(along[0]) < 0.6, fabs(along[0]) >= 0.6, 0};
    cs_vec3_cross(other, along, axes[2]);
    cs_vec3_normalise(axes[2]);
    cs_vec3_cross(along, axes[2], axes[0]);
}

int cs_core_nearest_face(const struct cs_posed_collider *collider, const double x[3]) {
    int face = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(x[k]) - collider->half_sizes[k] > fabs(x[face]) - collider->half_sizes[face])
            face = k;
    return face;
}

bool cs_core_holds(const struct cs_posed_collider *collider, const double p[3], double x[3],
                   double out[3]) {
    cs_collider_to_local(collider, p, x);
    for (int k = 0; k < 3; k++)
        out[k] = copysign(fmax(fabs(x[k]) - collider->half_sizes[k], 0), x[k]);
    return out[0] == 0 && out[1] == 0 && out[2] == 0;
}

double cs_core_beyond(const struct cs_posed_collider *collider, const double out[3],
                      double n[3]) {
    static const double middle[3] = {0, 0, 0};
    double own[3];
    const double length = cs_core_from_point(out, middle, own);
    cs_collider_rotate(collider, own, n);
    return length - collider->radius;
}

/* The smooth distance in the own frame: gradient g (3) and Hessian h (3,3). */
static double smooth_own(const struct cs_posed_collider *collider, const double x[3],
                         double g[3], double h[3][3]) {
    double q[3], slope[3], bend[3], soft[3];
    for (int k = 0; k < 3; k++) {
        const double band = fmin(BAND * collider->radius, collider->half_sizes[k]);
        cs_smooth_positive(fabs(x[k]) - collider->half_sizes[k], band, soft);
        const bool none = collider->half_sizes[k] == 0;
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
    return length - collider->radius;
}

/* the core is a box with a volume */
static bool has_inside(const struct cs_posed_collider *collider) {
    const double *core = collider->half_sizes;
    return core[0] > 0 && core[1] > 0 && core[2] > 0;
}

/* the face of a box that x lies in front of, further from its rim than what is blended; -1: it
 * lies in front of none */
static int face_below(const struct cs_posed_collider *collider, const double x[3]) {
    int face = -1, within = 0;
    for (int k = 0; k < 3; k++) {
        const double band = fmin(BAND * collider->radius, collider->half_sizes[k]);
        const double out = fabs(x[k]) - collider->half_sizes[k];
        if (out >= band)
            face = k;
        within += out <= -band;
    }
    return within == 2 && has_inside(collider) ? face : -1;
}

static double smooth_face(const struct cs_posed_collider *collider, int face, double x,
                          double gradient[3], double hessian[6]) {
    memset(hessian, 0, 6 * sizeof *hessian);
    for (int c = 0; c < 3; c++)
        gradient[c] = copysign(1, x) * collider->axes[face][c];
    return fabs(x) - collider->half_sizes[face] - collider->radius;
}

/* what is to be added for the inside of the core */
static double smooth_core(const struct cs_posed_collider *collider, const double x[3],
                          double g[3], double h[3][3]) {
    double soft[3];
    const int face = cs_core_nearest_face(collider, x);
    const double band = fmin(BAND * collider->radius, collider->half_sizes[face]);
    cs_smooth_positive(collider->half_sizes[face] - fabs(x[face]), band, soft);
    g[face] += copysign(soft[1], x[face]);
    h[face][face] -= soft[2];
    return -soft[0];
}

double cs_core_smooth(const struct cs_posed_collider *collider, const double p[3],
                      double gradient[3], double hessian[6]) {
    double x[3], g[3], h[3][3], rows[3][3], out[3][3];
    cs_collider_to_local(collider, p, x);
    const int face = face_below(collider, x);
    if (face >= 0)
        return smooth_face(collider, face, x[face], gradient, hessian);
    double distance = smooth_own(collider, x, g, h);
    if (has_inside(collider))
        distance += smooth_core(collider, x, g, h);

    // the very axis of a capsule has no direction: up, as in the centre of a sphere
    cs_collider_rotate(collider, g, gradient);
    if (g[0] == 0 && g[1] == 0 && g[2] == 0)
        gradient[1] = 1;
    for (int k = 0; k < 3; k++)
        cs_collider_rotate(collider, h[k], rows[k]);
    for (int c = 0; c < 3; c++) {
        const double column[3] = {rows[0][c], rows[1][c], rows[2][c]};
        cs_collider_rotate(collider, column, out[c]);
    }
    const double packed[6] = {out[0][0], out[0][1], out[0][2], out[1][1], out[1][2], out[2][2]};
    memcpy(hessian, packed, sizeof packed);
    return distance;
}

/* The distance from a core - a segment or a box - less a radius: exactly, and smoothed for the
 * force.
 *
 * In the collider's own frame, with the half sizes c of the core, the radius r and o_i = |x_i|
 * - c_i:
 *   exact    d = |max(o, 0)| + min(max_i o_i, 0) - r
 * Outside the core the gradient is max(o_i, 0) sign(x_i) / |max(o, 0)|; inside a box it is
 * sign(x_i) along the axis of the largest o_i, the nearest face. The gradient jumps inside the
 * core, and its derivative jumps between the regions of faces, edges and corners.
 *
 *   smooth   d = |q| - S(-max_i o_i) - r,   q_i = sign(x_i) S(o_i)
 * with S of cs_smooth_positive; if the core has no extent along an axis, q_i = x_i. The middle
 * term exists for boxes only, and is 0 outside the core but for its band. With s_i = S'(o_i)
 * and b_i = sign(x_i) S''(o_i) the derivatives of |q| are
 *   g_i  = q_i s_i / |q|
 *   h_ij = ((s_i^2 + q_i b_i) [i = j] - g_i g_j) / |q|
 * The gradient of the middle term is sign(x_f) S'(-o_f) along the nearest face's axis f, its
 * second derivative -S''(-o_f).
 */
#include "scene/shape_core.h"

#include "base/portable_sine.h"
#include "base/vec3.h"

#include <string.h>

/* The surface around a core: its line test and its triangles.
 *
 * Along a line the squared distance to the core, sum_i max(|x_i| - c_i, 0)^2, is convex and
 * piecewise quadratic: pieces end where the line crosses a plane |x_i| = c_i. Its slope is
 * linear on each piece. The minimum is in the first piece at whose end the slope is not
 * negative, and linear interpolation of the slope finds it exactly. */

/* steps from the middle to the border of a face, and quads along an axis of the cube: PARTS
 * steps to either side of the doubled middle line */
enum { PARTS = 6, LINES = 2 * PARTS + 1 };

/* A line x = from + s way in the collider's own frame. */
struct line {
    const double *core;
    double from[3], way[3];
};

/* Squared distance to the core at s in m2; *slope: half its derivative. */
static double squared_at(const struct line *line, double s, double *slope) {
    double squared = 0;
    *slope = 0;
    for (int k = 0; k < 3; k++) {
        const double x = line->from[k] + s * line->way[k];
        const double out = fmax(fabs(x) - line->core[k], 0);
        squared += out * out;
        *slope += copysign(out, x) * line->way[k];
    }
    return squared;
}

/* Writes the ends 0 and share and the crossings between them, ascending by insertion; returns
 * their number, 8 at most. A line parallel to a plane gives an infinite or undefined s, which
 * the comparison leaves out. */
static int find_crossings(const struct line *line, double share, double at[8]) {
    int n = 2;
    at[0] = 0;
    at[1] = share;
    for (int k = 0; k < 6; k++) {
        const double side = k % 2 ? line->core[k / 2] : -line->core[k / 2];
        const double s = (side - line->from[k / 2]) / line->way[k / 2];
        int place = n;
        if (!(s > 0 && s < share))
            continue;
        for (; at[place - 1] > s; place--)
            at[place] = at[place - 1];
        at[place] = s;
        n++;
    }
    return n;
}

/* Minimum of the squared distance for s from 0 to share, in m2. */
static double least_squared(const struct line *line, double share) {
    double at[8], before, after;
    const int n = find_crossings(line, share, at);
    const double first = squared_at(line, 0, &before);
    if (before >= 0)
        return first;
    double least = first;
    for (int k = 1; k < n; k++) {
        least = squared_at(line, at[k], &after);
        if (after >= 0) {
            const double s = at[k - 1] + (at[k] - at[k - 1]) * (before / (before - after));
            return fmin(least, squared_at(line, s, &after));
        }
        before = after;
    }
    return least;
}

bool cs_core_meets_line(const struct cs_posed_collider *collider, const double from[3],
                        const double way[3], double share) {
    struct line line = {.core = collider->half_sizes};
    cs_collider_to_local(collider, from, line.from);
    for (int k = 0; k < 3; k++)
        line.way[k] = cs_vec3_dot(collider->axes[k], way);
    return least_squared(&line, share) < collider->radius * collider->radius;
}

/* tan of a fraction of 45 degrees: equal steps of angle on a face of the cube */
static double tangent(int step) {
    const double r = (step < 0 ? -step : step) / (2.0 * PARTS);
    const double t = cs_quarter_sine(r) / cs_quarter_sine(1 - r);
    return step < 0 ? -t : t;
}

/* Moves the points of a cube's lattice to the surface of the shape. */
static void bend(const struct cs_posed_collider *collider, struct cs_trimesh *mesh) {
    const size_t n = mesh->n;
    for (size_t i = 0; i < n; i++) {
        double d[3], sides[3], place[3];
        for (size_t k = 0; k < 3; k++) {
            /* the number of the line, whose places run from -0.5 to 0.5 */
            const int line = (int)((mesh->positions[k * n + i] + 0.5) * LINES + 0.5);
            sides[k] = line > PARTS ? 1 : -1;
            d[k] = tangent(line > PARTS ? line - PARTS - 1 : line - PARTS);
        }
        cs_core_surface(collider, sides, d, place);
        for (size_t k = 0; k < 3; k++)
            mesh->positions[k * n + i] = place[k];
    }
}

/* Compares positions exactly: coinciding points were computed alike. */
static bool is_same(const struct cs_trimesh *mesh, size_t i, size_t j) {
    const double *p = mesh->positions;
    const size_t n = mesh->n;
    return p[i] == p[j] && p[n + i] == p[n + j] && p[2 * n + i] == p[2 * n + j];
}

/* Merges points of the same position and removes triangles that lose their area by it.
 * Quadratic in the number of points, which is fixed and small. */
static enum cs_status weld(struct cs_trimesh *mesh, struct cs_arena *arena,
                           struct cs_error *error) {
    uint32_t *to = cs_arena_alloc_array(arena, mesh->n, sizeof *to, error), kept = 0, left = 0;
    double *places = cs_arena_alloc_array(arena, mesh->n, 3 * sizeof *places, error);
    if (error->status)
        return error->status;
    for (uint32_t i = 0; i < mesh->n; i++) {
        uint32_t j = 0;
        while (j < i && !is_same(mesh, i, j))
            j++;
        to[i] = j < i ? to[j] : kept++;
        for (size_t k = 0; k < 3; k++)
            places[3 * (size_t)to[i] + k] = mesh->positions[k * mesh->n + i];
    }
    for (size_t t = 0; t < mesh->n_triangles; t++) {
        const uint32_t *old = mesh->triangles + 3 * t;
        const uint32_t a = to[old[0]], b = to[old[1]], c = to[old[2]];
        if (a == b || b == c || c == a)
            continue;
        uint32_t *new = mesh->triangles + 3 * (size_t)left++;
        new[0] = a, new[1] = b, new[2] = c;
    }
    mesh->n = kept;
    mesh->n_triangles = left;
    for (size_t i = 0; i < kept; i++)
        for (size_t k = 0; k < 3; k++)
            mesh->positions[k * kept + i] = places[3 * i + k];
    return CS_OK;
}

enum cs_status cs_core_triangles(const struct cs_posed_collider *collider,
                                 struct cs_trimesh *mesh, struct cs_arena *arena,
                                 struct cs_error *error) {
    if (cs_trimesh_make(mesh, CS_MESH_BOX, LINES, arena, error))
        return error->status;
    bend(collider, mesh);
    return weld(mesh, arena, error);
}

/* fraction of the radius over which S blends faces, edges and corners, to both sides */
#define BAND 0.5

/* The coordinate axis less parallel to axes[1] keeps the cross product away from 0. */
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

/* |q| - r in the own frame; g (3): gradient, h (3,3): Hessian. */
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

/* Returns true if the core is a box with a volume. */
static bool has_inside(const struct cs_posed_collider *collider) {
    const double *core = collider->half_sizes;
    return core[0] > 0 && core[1] > 0 && core[2] > 0;
}

/* The face of a box that x lies in front of, away from the blended bands of its edges; -1:
 * none. The distance is exact there and needs no square root. */
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

/* Distance in front of one face: linear, so the Hessian is 0. */
static double smooth_face(const struct cs_posed_collider *collider, int face, double x,
                          double gradient[3], double hessian[6]) {
    memset(hessian, 0, 6 * sizeof *hessian);
    for (int c = 0; c < 3; c++)
        gradient[c] = copysign(1, x) * collider->axes[face][c];
    return fabs(x) - collider->half_sizes[face] - collider->radius;
}

/* Adds the term of the inside of the core to gradient and Hessian; returns its value. */
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

/* Rotates the derivatives to the world: gradient R^T g, Hessian R^T h R with the axes as
 * rows. */
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

/* segment_test.c - whether a straight line comes into an obstacle.
 *
 * For box and capsule: the squared distance to the core, sum max(|x_i| - c_i, 0)^2, is convex
 * along a line and quadratic between the points where the line crosses |x_i| = c_i. Its slope
 * is linear there, so that the least distance is found exactly. A mesh is asked triangle by
 * triangle (Moeller, Trumbore 1997).
 */
#include "model/contact/posed_collider.h"

#include "base/vec3.h"
#include "mesh/trimesh.h"

#include <math.h>

/* the line comes nearer to the centre than the radius */
static bool hits_sphere(const struct cs_posed_collider *sphere, const double from[3],
                        const double way[3], double share) {
    const double to[3] = {sphere->centre[0] - from[0], sphere->centre[1] - from[1],
                          sphere->centre[2] - from[2]};
    const double at = fmin(fmax(cs_vec3_dot(to, way) / cs_vec3_dot(way, way), 0), share);
    double squared = 0;
    for (int c = 0; c < 3; c++)
        squared += (at * way[c] - to[c]) * (at * way[c] - to[c]);
    return squared < sphere->radius * sphere->radius;
}

/* one end is behind the plane */
static bool hits_plane(const struct cs_posed_collider *plane, const double from[3],
                       const double way[3], double share) {
    const double *normal = plane->axes[1];
    double distance = 0;
    for (int c = 0; c < 3; c++)
        distance += normal[c] * (from[c] - plane->centre[c]);
    return distance < 0 || distance + share * cs_vec3_dot(normal, way) < 0;
}

/* a line in the obstacle's own frame */
struct line {
    const double *core;
    double from[3], way[3];
};

/* squared distance to the core at s, and half its slope */
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

/* the ends and the crossings between them, ascending; returns their number */
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

static double min_squared(const struct line *line, double share) {
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

/* a line in the mesh's own frame goes through its triangle t, rims included */
static bool hits_triangle(const struct cs_trimesh *mesh, uint32_t t, const struct line *line,
                          double share) {
    const uint32_t *corners = mesh->triangles + 3 * (size_t)t;
    double u[3], v[3], to[3], across[3], turned[3];
    for (size_t c = 0; c < 3; c++) {
        const double *places = mesh->positions + c * mesh->n;
        u[c] = places[corners[1]] - places[corners[0]];
        v[c] = places[corners[2]] - places[corners[0]];
        to[c] = line->from[c] - places[corners[0]];
    }
    cs_vec3_cross(line->way, v, across);
    cs_vec3_cross(to, u, turned);
    const double whole = cs_vec3_dot(u, across), sign = whole < 0 ? -1 : 1;
    const double a = sign * cs_vec3_dot(to, across), b = sign * cs_vec3_dot(line->way, turned);
    const double at = sign * cs_vec3_dot(v, turned), size = sign * whole;
    return a >= 0 && b >= 0 && a + b <= size && at >= 0 && at < share * size;
}

static bool hits_mesh(const struct cs_trimesh *mesh, const struct line *line, double share) {
    bool meets = false;
    for (uint32_t t = 0; t < mesh->n_triangles && !meets; t++)
        meets = hits_triangle(mesh, t, line, share);
    return meets;
}

bool cs_posed_collider_hits_segment(const struct cs_posed_collider *obstacle,
                                    const double from[3], const double way[3], double share) {
    if (obstacle->kind == CS_COLLIDER_SPHERE)
        return hits_sphere(obstacle, from, way, share);
    if (obstacle->kind == CS_COLLIDER_PLANE)
        return hits_plane(obstacle, from, way, share);
    const double shift[3] = {from[0] - obstacle->centre[0], from[1] - obstacle->centre[1],
                             from[2] - obstacle->centre[2]};
    struct line line = {.core = obstacle->half_sizes};
    for (int k = 0; k < 3; k++) {
        line.from[k] = cs_vec3_dot(obstacle->axes[k], shift);
        line.way[k] = cs_vec3_dot(obstacle->axes[k], way);
    }
    if (obstacle->kind == CS_COLLIDER_MESH)
        return hits_mesh(obstacle->collider->mesh.geometry, &line, share);
    return min_squared(&line, share) < obstacle->radius * obstacle->radius;
}

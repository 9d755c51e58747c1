/* The surface about a core: whether a line comes into it, and its triangles.
 *
 * The squared distance to the core, sum max(|x_i| - c_i, 0)^2, is convex along a line and
 * quadratic between the points where the line crosses |x_i| = c_i. Its slope is linear there,
 * so that the least distance is found exactly. */
#include "scene/shape_core.h"

#include "base/portable_sine.h"
#include "base/vec3.h"

/* parts of the triangles' lattice, and its lines along each axis less one */
enum { PARTS = 6, LINES = 2 * PARTS + 1 };

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

/* tan(step / PARTS * 45 degrees) */
static double tangent(int step) {
    const double r = (step < 0 ? -step : step) / (2.0 * PARTS);
    const double t = cs_quarter_sine(r) / cs_quarter_sine(1 - r);
    return step < 0 ? -t : t;
}

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

static bool is_same(const struct cs_trimesh *mesh, size_t i, size_t j) {
    const double *p = mesh->positions;
    const size_t n = mesh->n;
    return p[i] == p[j] && p[n + i] == p[n + j] && p[2 * n + i] == p[2 * n + j];
}

/* Points at one place become one, and triangles without area go. */
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

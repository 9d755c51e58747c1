/* Point-in-mesh test by ray parity: an odd number of hits means inside. */
#include "study/containment_warning.h"

#include "model/contact/ccd/edge_triangle.h"
#include "model/contact/surface_points.h"
#include "model/system/surfaces.h"
#include "scene/body_pairs.h"

/* True if every edge of a surface has two triangles. */
static bool is_closed(const struct cs_surfaces *s, uint32_t body) {
    bool closed = s->first_triangle[body] < s->first_triangle[body + 1];
    for (size_t e = s->first_edge[body]; e < s->first_edge[body + 1]; e++)
        closed = closed && s->edge_triangles[2 * e + 1] != CS_NO_TRIANGLE;
    return closed;
}

/* x coordinate in m beyond the body in the direction of the ray. */
static double ray_far_end(const struct cs_surfaces *s, uint32_t body, const double *x) {
    double most = x[s->first_point[body]];
    for (size_t i = s->first_point[body]; i < s->first_point[body + 1]; i++)
        most = x[i] > most ? x[i] : most;
    return most + 1;
}

/* Casts a ray along +x from the first point of a body and counts the crossed triangles of a
 * closed one. One point suffices: bodies that do not cross are inside as a whole.
 * cs_edge_crosses_triangle resolves touching as a general position, so a ray through an edge
 * counts once. */
static bool is_inside(const struct cs_surfaces *s, uint32_t body, uint32_t closed,
                      const double *x) {
    const size_t n = s->n_points, first = s->first_point[body];
    const double edge[2][3] = {{x[first], x[n + first], x[2 * n + first]},
                               {ray_far_end(s, closed, x), x[n + first], x[2 * n + first]}};
    bool inside = false;
    if (edge[0][0] >= edge[1][0])
        return false;
    for (size_t t = s->first_triangle[closed]; t < s->first_triangle[closed + 1]; t++) {
        double triangle[3][3];
        for (size_t k = 0; k < 3; k++)
            for (size_t c = 0; c < 3; c++)
                triangle[k][c] = x[c * n + s->triangles[3 * t + k]];
        inside = inside != cs_edge_crosses_triangle(edge, (const double(*)[3])triangle);
    }
    return inside;
}

static void name(const struct cs_system *system, uint32_t body, struct cs_text *out) {
    const uint32_t n = system->scene->bodies.n;
    if (body < n)
        cs_text_add(out, "bodies[%u]", body);
    else
        cs_text_add(out, "colliders[%u]", body - n);
}

void cs_containment_warning_print(const struct cs_system *system, struct cs_text *out) {
    const struct cs_surfaces *s = system->surfaces;
    uint32_t found = 0;
    double friction;
    if (!system->pairs)
        return;
    const double *x = cs_surface_points_positions(system, CS_POINTS_BEGIN, 0, system->state);
    for (uint32_t b = 0; b < s->n_bodies; b++)
        for (uint32_t a = 0; a < system->scene->bodies.n && is_closed(s, b); a++) {
            if (a == b || !cs_scene_bodies_collide(system->scene, a, b, &friction) ||
                !is_inside(s, a, b, x) || found++)
                continue;
            name(system, a, out);
            cs_text_add(out, " starts inside ");
            name(system, b, out);
            cs_text_add(out, ", which is a closed surface: contact will keep it inside");
        }
    if (found > 1)
        cs_text_add(out, "; %u more do too", found - 1);
}

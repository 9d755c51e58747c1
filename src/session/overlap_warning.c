/* Bounding boxes of bodies, and of the positions they can reach. */
#include "session/scene_findings.h"

#include "base/vec3.h"
#include "model/contact/ccd/edge_triangle.h"
#include "model/contact/contact_samples.h"
#include "model/system/surfaces.h"
#include "scene/body_keys.h"
#include "scene/body_pairs.h"
#include "scene/body_particles.h"

#include <math.h>
#include <stdlib.h>

/* Fraction of a free body's diagonal by which its box is enlarged: it turns and spreads. */
#define SPREAD 0.1

/* An axis-aligned box in m. */
struct box {
    double low[3], high[3];
};

struct body {
    struct box start, reach;  /* at the start; at any time */
    double middle[3], radius; /* m, of a sphere that holds it at the start */
};

static const struct box nowhere = {{HUGE_VAL, HUGE_VAL, HUGE_VAL},
                                   {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};

static bool overlap(const struct box *a, const struct box *b) {
    bool apart = false;
    for (int c = 0; c < 3; c++)
        apart |= a->low[c] > b->high[c] || b->low[c] > a->high[c];
    return !apart;
}

/* Boxes of round bodies overlap at their corners, spheres do not. */
static bool overlap_at_start(const struct body *a, const struct body *b) {
    return overlap(&a->start, &b->start) &&
           cs_vec3_distance(a->middle, b->middle) <= a->radius + b->radius;
}

/* m, from a place to the particle farthest from it. */
static double farthest(const double *x, size_t n, const double from[3]) {
    double most = 0;
    for (size_t i = 0; i < n; i++) {
        double p[3];
        cs_point_read(x, n, i, p);
        most = fmax(most, cs_vec3_distance(p, from));
    }
    return most;
}

/* Box of a pinned body. Inextensible springs keep each particle within its initial distance of
 * the pin. */
static void reach_from_pin(const double *x, size_t n, size_t pin, struct box *reach) {
    double from[3];
    cs_point_read(x, n, pin, from);
    cs_vec3_extend_box(reach->low, reach->high, from, farthest(x, n, from));
}

/* Box of all times in free fall: end of the fall, and the turning point v + g t = 0 if it is on
 * the way. */
static void free_fall_box(const struct cs_scene *scene, const struct cs_body *body,
                          double seconds, const struct box *start, struct box *reach) {
    const double *v = cs_body_velocity(body), *g = scene->forces->gravity;
    const double by = SPREAD * cs_vec3_distance(start->high, start->low);
    for (int c = 0; c < 3; c++) {
        const double end = v[c] * seconds + g[c] * seconds * seconds / 2;
        // where it turns on the way
        const double turn = v[c] * g[c] < 0 ? fmin(-v[c] / g[c], seconds) : 0;
        const double peak = v[c] * turn + g[c] * turn * turn / 2;
        reach->low[c] = start->low[c] + fmin(fmin(end, peak), 0) - by;
        reach->high[c] = start->high[c] + fmax(fmax(end, peak), 0) + by;
    }
}

/* Boxes of a body, from a copy of its start positions. */
static enum cs_status measure_overlap(const struct cs_scene *scene, const struct cs_body *body,
                                      double seconds, struct body *out,
                                      struct cs_error *error) {
    const size_t n = (size_t)cs_body_count(body);
    double *x = calloc(n, 3 * sizeof *x);
    bool *pinned = calloc(n, sizeof *pinned);
    size_t pin = n; // the last
    out->start = out->reach = nowhere;
    if (!x || !pinned) {
        cs_fail(error, CS_ERR_MEMORY, "out of memory for %zu particles", n);
        goto done;
    }
    cs_body_position(body, (uint32_t)n, 0, x);
    cs_body_pin(body, (uint32_t)n, 0, x, pinned);
    for (size_t i = 0; i < n; i++) {
        double p[3];
        cs_point_read(x, n, i, p);
        cs_vec3_extend_box(out->start.low, out->start.high, p, 0);
        pin = pinned[i] ? i : pin;
    }
    for (int c = 0; c < 3; c++)
        out->middle[c] = 0.5 * (out->start.low[c] + out->start.high[c]);
    out->radius = farthest(x, n, out->middle);
    if (pin < n)
        reach_from_pin(x, n, pin, &out->reach);
    else
        free_fall_box(scene, body, seconds, &out->start, &out->reach);
done:
    free(x);
    free(pinned);
    return error->status;
}

/* True if a seam joins two bodies. */
static bool are_sewn(const struct cs_scene *scene, uint32_t a, uint32_t b) {
    const struct cs_seam *seams = scene->seams.items;
    bool sewn = false;
    for (uint32_t k = 0; k < scene->seams.n; k++) {
        const int64_t one = seams[k].side.body, other = seams[k].to.side.body;
        sewn |= (one == a && other == b) || (one == b && other == a);
    }
    return sewn;
}

/* Counts the pairs without contact or seam whose boxes overlap, at the start or at any time;
 * *first and *second belong to the first pair. */
static uint32_t count_pairs(const struct cs_scene *scene, const struct body *bodies, bool start,
                            uint32_t *first, uint32_t *second) {
    uint32_t pairs = 0;
    double friction;
    for (uint32_t a = 0; a < scene->bodies.n; a++)
        for (uint32_t b = a + 1; b < scene->bodies.n; b++) {
            if (cs_scene_bodies_collide(scene, a, b, &friction) || are_sewn(scene, a, b))
                continue;
            if (start ? !overlap_at_start(bodies + a, bodies + b)
                      : !overlap(&bodies[a].reach, &bodies[b].reach))
                continue;
            if (!pairs++) {
                *first = a;
                *second = b;
            }
        }
    return pairs;
}

enum cs_status cs_overlap_warning_print(const struct cs_scene *scene, double seconds,
                                        struct cs_text *out, struct cs_error *error) {
    const uint32_t n = scene->bodies.n;
    uint32_t first = 0, second = 0;
    // limit and stop let no edge through a triangle
    if (n < 2 || cs_scene_crossings(scene) >= CS_CROSSINGS_LIMIT)
        return CS_OK;
    struct body *bodies = calloc(n, sizeof *bodies);
    if (!bodies)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for %u bodies", n);
    for (uint32_t b = 0; b < n && !error->status; b++)
        measure_overlap(scene, cs_scene_bodies(scene) + b, seconds, bodies + b, error);
    bool now = true;
    uint32_t pairs = error->status ? 0 : count_pairs(scene, bodies, true, &first, &second);
    if (!pairs && !error->status) {
        now = false;
        pairs = count_pairs(scene, bodies, false, &first, &second);
    }
    if (pairs)
        cs_text_add(out, "bodies[%u] and bodies[%u] ", first, second);
    if (pairs > 1)
        cs_text_add(out, "(and %u more pair%s) ", pairs - 1, pairs > 2 ? "s" : "");
    if (pairs)
        cs_text_add(
            out,
            "%s, but no contact is defined between them: they will pass through each other",
            now ? "overlap at the start" : "could collide");
    free(bodies);
    return error->status;
}

/* Compares the longest edge of the meshes with the length that its contact samples cover. */

/* Range in m with which an edge of that length is covered by the largest number of samples. */
static double needed(double length, double radius) {
    const double part = length / CS_CONTACT_SAMPLE_PARTS_MAX;
    return (sqrt(radius * radius + 0.75 * part * part) - radius) / 0.75;
}

void cs_sampling_warning_print(const struct cs_system *system, struct cs_text *out) {
    uint32_t fine = 0;
    if (!system->contact_samples)
        return;
    const double edge = cs_contact_sample_longest(system);
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        struct cs_posed_collider collider;
        cs_posed_collider_at(system, c, 0, &collider);
        const double range = system->collider_params[c].range;
        if (edge <= CS_CONTACT_SAMPLE_PARTS_MAX * cs_contact_sample_spacing(&collider, range) ||
            fine++ > 0)
            continue;
        cs_text_add(
            out,
            "colliders[%u]: an edge of %.3g m has at most %d contact samples, too few for this "
            "collider: use a finer mesh, or a thickness of at least %.2g m (now %.2g m)",
            c, edge, CS_CONTACT_SAMPLE_PARTS_MAX + 1, needed(edge, collider.radius), range);
    }
    if (fine > 1)
        cs_text_add(out, "; the same holds for %u more", fine - 1);
}

/* Point-in-mesh test by ray parity: an odd number of hits means inside. */

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
            // what is being moved out meets nothing yet
            if (a == b || cs_system_is_tangled(system, s->first_point[a]) ||
                !cs_scene_bodies_collide(system->scene, a, b, &friction) ||
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

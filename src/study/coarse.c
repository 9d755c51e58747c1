/* Compares the edges of meshes with the curvature of colliders. */
#include "study/coarse.h"

#include "mesh/trimesh.h"
#include "model/contact/obstacle.h"
#include "model/contact/pairing.h"

#include <math.h>

/* share of the range that what sinks in may take */
#define SHARE 0.25

double cs_coarse_sinking(double length, double radius, bool corner) {
    // from the arc's ends on, a chord across a corner touches the flat faces
    if (corner && length > sqrt(2) * radius)
        return 0.5 * length - (sqrt(2) - 1) * radius;
    return length < 2 * radius ? radius - sqrt(radius * radius - 0.25 * length * length)
                               : radius;
}

static double distance(const struct cs_system *system, uint32_t a, uint32_t b) {
    const size_t n = system->view.n;
    double squared = 0;
    for (size_t c = 0; c < 3; c++) {
        const double d = system->start[c * n + a] - system->start[c * n + b];
        squared += d * d;
    }
    return sqrt(squared);
}

/* of a grid, whose cells are cut across */
static double longest_of_grid(const struct cs_system *system,
                              const struct cs_body_range *body) {
    const uint32_t columns = body->columns;
    double longest = 0;
    for (uint32_t k = 0; k < body->count; k++) {
        const uint32_t i = body->first + k;
        const bool right = k % columns + 1 < columns, below = k / columns + 1 < body->rows;
        if (right)
            longest = fmax(longest, distance(system, i, i + 1));
        if (below)
            longest = fmax(longest, distance(system, i, i + columns));
        if (right && below)
            longest = fmax(longest, distance(system, i, i + columns + 1));
    }
    return longest;
}

static double longest_edge(const struct cs_system *system) {
    double longest = 0;
    for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
        const struct cs_body_range *body = system->bodies + b;
        if (!body->mesh)
            longest = fmax(longest, longest_of_grid(system, body));
        for (uint32_t e = 0; body->mesh && e < body->mesh->n_edges; e++) {
            const uint32_t *ends = body->mesh->edges + 2 * (size_t)e;
            longest =
                fmax(longest, distance(system, body->first + ends[0], body->first + ends[1]));
        }
    }
    return longest;
}

void cs_coarse_print(const struct cs_system *system, struct cs_text *out) {
    uint32_t sharp = 0;
    if (!system->pairings)
        return;
    const double edge = longest_edge(system);
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        struct cs_obstacle at;
        cs_obstacle_at(system, c, 0, &at);
        const double range = system->pairings[c].range;
        const double sinks = cs_coarse_sinking(edge, at.radius, at.kind == CS_OBSTACLE_BOX);
        if (at.kind == CS_OBSTACLE_PLANE || sinks <= SHARE * range || sharp++ > 0)
            continue;
        cs_text_add(
            out,
            "colliders[%u]: contact is felt by particles, and edges of %.3g m sink into "
            "it by up to %.2g m between them, more than a quarter of its range of %.2g "
            "m: a finer mesh, or a thickness of %.2g m, keeps it covered",
            c, edge, sinks, range, sinks / SHARE);
    }
    if (sharp > 1)
        cs_text_add(out, "; so do %u more", sharp - 1);
}

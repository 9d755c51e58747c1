/* Bounds how low bodies can hang. Every pin holds a particle, which is therefore no lower than
 *   max over pins of (height of the pin - 1.1 distance at rest).
 * The bound of a body is that of its lowest particle. In a sheet at rest the straight line is
 * the shortest way to a pin; 1.1 allows for springs that stretch. */
#include "draw/lowest_point.h"

#include "draw/scene_extent.h"
#include "mesh/trimesh.h"

#include <math.h>
#include <string.h>

enum { MOST = 1024, MOST_PINS = 64 }; // particles and pins per body that are tested

static bool is_released(const struct cs_scene *scene) {
    bool released = false;
    for (uint32_t e = 0; e < scene->events.n; e++)
        released = released || cs_scene_events(scene)[e].release.present;
    return released;
}

// position of particle i of a body at rest, before its placement: only distances matter
static void rest_position(const struct cs_body *body, const struct cs_body_range *range,
                          uint32_t i, double place[3]) {
    const double *size = body->cloth.size;
    for (size_t c = 0; range->mesh && c < 3; c++)
        place[c] = range->mesh->positions[c * range->mesh->n + i];
    if (range->mesh)
        return;
    place[0] = range->columns > 1 ? size[0] * (i % range->columns) / (range->columns - 1) : 0;
    place[1] = range->rows > 1 ? size[1] * (i / range->columns) / (range->rows - 1) : 0;
    place[2] = 0;
}

static double distance(const double a[3], const double b[3]) {
    double square = 0;
    for (int c = 0; c < 3; c++)
        square += (a[c] - b[c]) * (a[c] - b[c]);
    return sqrt(square);
}

struct pins {
    double height[MOST_PINS], rest[MOST_PINS][3];
    uint32_t n;
};

/* Collects the pins of body b, evenly thinned out to MOST_PINS. */
static void find_pins(const struct cs_system *system, uint32_t b, struct pins *pins) {
    const struct cs_body_range *range = system->bodies + b;
    uint32_t first = 0, n = 0;
    while (first < system->n_pinned && system->pinned[first] < range->first)
        first++;
    while (first + n < system->n_pinned &&
           system->pinned[first + n] < range->first + range->count)
        n++;
    const uint32_t stride = n / MOST_PINS + 1;
    pins->n = 0;
    for (uint32_t k = 0; k < n; k += stride, pins->n++) {
        const uint32_t i = system->pinned[first + k];
        pins->height[pins->n] = system->view.start[system->view.n + i];
        rest_position(cs_scene_bodies(system->scene) + b, range, i - range->first,
                      pins->rest[pins->n]);
    }
}

/* Bound of body b; NaN if it has no pins. */
static double lowest_of_body(const struct cs_system *system, uint32_t b) {
    const struct cs_body_range *range = system->bodies + b;
    struct pins pins;
    double lowest = HUGE_VAL;
    find_pins(system, b, &pins);
    if (!pins.n)
        return (double)NAN;
    for (uint32_t i = 0; i < range->count; i += range->count / MOST + 1) {
        double place[3], held = -HUGE_VAL;
        rest_position(cs_scene_bodies(system->scene) + b, range, i, place);
        for (uint32_t p = 0; p < pins.n; p++)
            held = fmax(held, pins.height[p] - 1.1 * distance(place, pins.rest[p]));
        lowest = fmin(lowest, held);
    }
    return lowest;
}

double cs_lowest_point(const struct cs_system *system,
                       const struct cs_posed_collider *colliders) {
    const struct cs_scene *scene = system->scene;
    double lowest = cs_scene_extent_solid(system, system->view.start, colliders).low[1];
    const bool falls = scene->forces.gravity[1] < 0;
    for (uint32_t b = 0; falls && b < scene->bodies.n; b++) {
        const double own = is_released(scene) ? (double)NAN : lowest_of_body(system, b);
        if (!(own < lowest) && !isnan(own))
            continue;
        lowest = own;
        if (isnan(own))
            break;
    }
    return lowest;
}

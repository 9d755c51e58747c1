/* Chooses position, spacing and colour of the ground. */
#include "draw/ground.h"

#include "draw/srgb.h"
#include "mesh/trimesh.h"
#include "scene/body_keys.h"
#include "scene/event_key.h"
#include "scene/force_keys.h"
#include "scene/picture_keys.h"

#include <math.h>
#include <string.h>

/* Lower bound of the height that the bodies of a scene can reach. */

enum { MOST = 1024, MOST_PINS = 64 }; // particles and pins per body that are tested

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

static double distance_between(const double a[3], const double b[3]) {
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
            held = fmax(held, pins.height[p] - 1.1 * distance_between(place, pins.rest[p]));
        lowest = fmin(lowest, held);
    }
    return lowest;
}

/* Returns a height in m that nothing of a scene falls below, as long as its springs are at most
 * a tenth longer than at rest; colliders (scene->colliders.n) at the start. NaN if something
 * may fall without end: a body that no pin holds, or that a release may set free. */
static double lowest_point(const struct cs_system *system,
                           const struct cs_posed_collider *colliders) {
    const struct cs_scene *scene = system->scene;
    double lowest = cs_scene_extent_solid(system, system->view.start, colliders).low[1];
    const bool falls = scene->forces->gravity[1] < 0;
    for (uint32_t b = 0; falls && b < scene->bodies.n; b++) {
        const double own =
            cs_event_releases_any(scene) ? (double)NAN : lowest_of_body(system, b);
        if (!(own < lowest) && !isnan(own))
            continue;
        lowest = own;
        if (isnan(own))
            break;
    }
    return lowest;
}

// the largest power of ten that is at most length, or of its 1, 2 and 5 fold
static double round_length(double length, bool powers) {
    double power = 1;
    while (power > length)
        power /= 10;
    while (power * 10 <= length)
        power *= 10;
    return powers || 2 * power > length ? power : (5 * power > length ? 2 : 5) * power;
}

/* the visible floor, or plane that serves as one; NULL: there is none */
static const struct cs_posed_collider *floor_of(const struct cs_scene *scene,
                                                const struct cs_posed_collider *colliders) {
    for (uint32_t i = 0; i < scene->colliders.n; i++)
        if (colliders[i].collider->visible && cs_shape_is_endless(colliders[i].shape) &&
            colliders[i].axes[1][1] > 0.5)
            return colliders + i;
    return NULL;
}

/* Sets pattern and haze, and the colours of a ground of its own: those of the background, a
 * little darker, or nothing but shadows. */
static void set_style(struct cs_ground *ground, const struct cs_render *render,
                      const struct cs_bounding_sphere *sphere) {
    struct cs_ground_style *style = &ground->style;
    const bool clear = render->background.kind == CS_BACKGROUND_NONE;
    style->centre[0] = (float)sphere->centre[0];
    style->centre[1] = (float)sphere->centre[2];
    style->radius = (float)cs_view_haze(sphere);
    style->lines = render->ground == CS_GROUND_GRID;
    if (style->lines || (render->ground == CS_GROUND_AUTO && !clear))
        style->tile = (float)round_length(0.3 * sphere->radius, style->lines);
    cs_colour_ink(render->background.colour, style->ink);
    ground->shadow = render->ground == CS_GROUND_SHADOW || clear ? 0.4f : 0;
    for (int i = 0; i < 3; i++)
        ground->collider.colour[i] = 0.02 + 0.68 * render->background.colour[i];
}

/* Makes a square of half side 1 m, which is then extended to the haze. */
static enum cs_status make_square(const struct cs_posed_collider *collider,
                                  struct cs_trimesh *mesh, struct cs_arena *arena,
                                  struct cs_error *error) {
    static const double corners[12] = {-1, -1, 1, 1, 0, 0, 0, 0, -1, 1, 1, -1};
    static const uint32_t triangles[6] = {0, 1, 2, 0, 2, 3};
    (void)collider;
    mesh->positions = cs_arena_alloc_array(arena, 12, sizeof *corners, error);
    mesh->triangles = cs_arena_alloc_array(arena, 6, sizeof *triangles, error);
    if (error->status)
        return error->status;
    memcpy(mesh->positions, corners, sizeof corners);
    memcpy(mesh->triangles, triangles, sizeof triangles);
    mesh->n = 4;
    mesh->n_triangles = 2;
    return CS_OK;
}

static const struct cs_shape square = {.bounds = CS_BOUNDS_HALF_SPACE,
                                       .triangles = make_square};

void cs_ground_make(struct cs_ground *ground, const struct cs_system *system,
                    const struct cs_posed_collider *colliders,
                    const struct cs_bounding_sphere *sphere) {
    const struct cs_render *render = system->scene->render;
    const struct cs_posed_collider *floor = floor_of(system->scene, colliders);
    const bool given = !isnan(render->ground_height);
    set_style(ground, render, sphere);
    ground->floor = floor ? floor->collider : NULL;
    ground->collider.visible = true;
    ground->pose.collider = &ground->collider;
    ground->pose.shape = &square;
    for (int i = 0; i < 3; i++)
        ground->pose.axes[i][i] = 1;
    // a little below what hangs, so that it does not touch
    ground->height =
        given ? render->ground_height : lowest_point(system, colliders) - 0.05 * sphere->radius;
    ground->follows_lowest = !given;
    ground->present = render->ground != CS_GROUND_NONE && (given || !floor) &&
                      (render->ground != CS_GROUND_AUTO || (!floor && !isnan(ground->height)));
    // what falls without end is followed by it
    if (isnan(ground->height))
        ground->height = sphere->low[1];
    cs_ground_aim(ground, sphere);
}

void cs_ground_aim(struct cs_ground *ground, const struct cs_bounding_sphere *sphere) {
    const double below = sphere->low[1] - 0.02 * sphere->radius;
    ground->pose.centre[1] =
        ground->follows_lowest ? fmin(ground->height, below) : ground->height;
}

void cs_ground_style_of(const struct cs_ground *ground,
                        const struct cs_posed_collider *collider,
                        struct cs_surface_style *style) {
    if (!cs_ground_is(ground, collider))
        return;
    style->ground = ground->style;
    for (int i = 0; i < 3; i++)
        style->ground.normal[i] = (float)collider->axes[1][i];
    style->ground.shadow = collider->collider == &ground->collider ? ground->shadow : 0;
    style->specular = 0;
    if (collider->collider != &ground->collider)
        return;
    // pale shadows: the ground is no part of what is simulated
    style->ambient = 2.2;
    style->diffuse = 0.65;
}

bool cs_ground_is(const struct cs_ground *ground, const struct cs_posed_collider *collider) {
    return collider->collider == ground->floor ||
           (cs_shape_is_endless(collider->shape) && collider->axes[1][1] > 0.9999);
}

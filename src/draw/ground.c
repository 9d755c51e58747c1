/* Chooses position, spacing and colour of the ground. */
#include "draw/ground.h"

#include "draw/srgb.h"
#include "draw/view.h"
#include "mesh/trimesh.h"
#include "model/contact/posed_collider.h"
#include "model/system/particle_system.h"

#include <math.h>

/* Lower bound of the height that the bodies of a scene can reach. */

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

/* Returns a height in m that nothing of a scene falls below, as long as its springs are at most
 * a tenth longer than at rest; colliders (scene->colliders.n) at the start. NaN if something
 * may fall without end: a body that no pin holds, or that a release may set free. */
static double lowest_point(const struct cs_system *system,
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

// the largest power of ten that is at most length
static double power_of_ten(double length) {
    double power = 1;
    while (power > length)
        power /= 10;
    while (power * 10 <= length)
        power *= 10;
    return power;
}

/* the visible floor, or plane that serves as one; NULL: there is none */
static const struct cs_posed_collider *floor_of(const struct cs_scene *scene,
                                                const struct cs_posed_collider *obstacles) {
    for (uint32_t i = 0; i < scene->colliders.n; i++)
        if (obstacles[i].collider->visible && cs_shape_is_endless(obstacles[i].shape) &&
            obstacles[i].axes[1][1] > 0.5)
            return obstacles + i;
    return NULL;
}

/* Height in m: given by the scene, that of a floor, or a little below the lowest point. */
static double height_of(const struct cs_system *system,
                        const struct cs_posed_collider *obstacles,
                        const struct cs_bounding_sphere *extent) {
    const struct cs_posed_collider *floor = floor_of(system->scene, obstacles);
    if (!isnan(system->scene->render.ground_height))
        return system->scene->render.ground_height;
    // a little below what hangs, so that it does not touch
    return floor ? floor->centre[1] : lowest_point(system, obstacles) - 0.05 * extent->radius;
}

void cs_ground_make(struct cs_ground *ground, const struct cs_system *system,
                    const struct cs_posed_collider *obstacles,
                    const struct cs_bounding_sphere *extent) {
    const struct cs_render *render = &system->scene->render;
    const bool has_floor = floor_of(system->scene, obstacles);
    if (render->ground == CS_GROUND_NONE || (render->ground == CS_GROUND_AUTO && has_floor))
        return;
    ground->height = height_of(system, obstacles, extent);
    ground->follows_lowest = isnan(render->ground_height) && !has_floor;
    ground->present = render->ground != CS_GROUND_AUTO || !isnan(ground->height);
    // what falls without end is followed by it
    if (isnan(ground->height))
        ground->height = extent->low[1];
    ground->fade_disc[0] = (float)extent->centre[0];
    ground->fade_disc[2] = (float)extent->centre[2];
    ground->fade_disc[3] = (float)(6 * extent->radius);
    if (render->ground == CS_GROUND_GRID)
        ground->line_spacing = (float)power_of_ten(0.3 * extent->radius);
    cs_colour_ink(render->background.colour, ground->line_colour);
    // a floor shows the shadow itself
    ground->shadow = has_floor ? 0.0f : 0.4f;
}

/* Extends a rectangle by a point. */
static void grow(float box[4], const double place[2]) {
    for (int c = 0; c < 2; c++) {
        box[c] = fminf(box[c], (float)place[c]);
        box[c + 2] = fmaxf(box[c + 2], (float)place[c]);
    }
}

/* Extends the rectangle by the shadow of the box around `solid`: the ray from the light through
 * a corner p goes on along d and meets the ground at p + d (height - p_y) / d_y. Returns false
 * if a corner is not below the light, whose shadow has no end. */
static bool cast(const struct cs_bounding_sphere *solid, const float light[4], double height,
                 float box[4]) {
    const bool is_lamp = light[3] > 0;
    for (int corner = 0; corner < 8; corner++) {
        double p[3], down[3];
        for (int c = 0; c < 3; c++) {
            p[c] = corner >> c & 1 ? solid->high[c] : solid->low[c];
            down[c] = is_lamp ? p[c] - (double)light[c] : -(double)light[c];
        }
        if (!(down[1] < 0))
            return false;
        const double way = fmax((height - p[1]) / down[1], 0);
        grow(box, (double[2]){p[0] + way * down[0], p[2] + way * down[2]});
    }
    return true;
}

void cs_ground_aim(struct cs_ground *ground, const struct cs_view_block *block,
                   const struct cs_bounding_sphere *solid) {
    const float *span = ground->fade_disc;
    const double below = solid->low[1] - 0.02 * solid->radius;
    const double height = ground->follows_lowest ? fmin(ground->height, below) : ground->height;
    const float whole[4] = {span[0] - span[3], span[2] - span[3], span[0] + span[3],
                            span[2] + span[3]};
    float box[4] = {INFINITY, INFINITY, -INFINITY, -INFINITY};
    ground->fade_disc[1] = (float)height;
    bool bounded = ground->line_spacing <= 0, lit = false;
    for (int k = 0; k < (int)block->size[3]; k++) {
        const float *light = block->lights[k].place;
        // shadows are not made by light from below
        if (!((double)light[1] > (light[3] > 0 ? height : 0.0)))
            continue;
        lit = true;
        bounded = cast(solid, light, height, box) && bounded;
    }
    // edges are blurred by some texels
    const float soft = (float)(0.08 * solid->radius);
    for (int c = 0; c < 4; c++) {
        const float inside =
            c < 2 ? fmaxf(box[c] - soft, whole[c]) : fminf(box[c] + soft, whole[c]);
        ground->box[c] = bounded ? inside : whole[c];
    }
    // nor are they seen from there
    const bool seen = lit && (double)block->eye[1] > (block->eye[3] > 0 ? height : 0.0);
    if (ground->line_spacing <= 0 && !seen)
        ground->box[2] = ground->box[0];
}

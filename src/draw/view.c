/* Sets up the camera, light, background and colour map that all shaders share. */
#include "draw/view.h"

#include "base/vec3.h"
#include "draw/glyph.h"
#include "draw/matrix.h"
#include "draw/mesh.h"
#include "draw/srgb.h"
#include "scene/body_keys.h"
#include "scene/force_keys.h"

static void copy3(const double from[3], double last, float to[4]) {
    for (int i = 0; i < 3; i++)
        to[i] = (float)from[i];
    to[3] = (float)last;
}

// the camera at time t in s: on its path between two keys, linear or smooth, else as it stands
static struct cs_camera camera_at(const struct cs_camera *camera, double t) {
    const struct cs_camera_key *keys = camera->path.items;
    const uint32_t n = camera->path.n;
    struct cs_camera now = *camera;
    uint32_t next = 0;
    while (next < n && keys[next].at <= t)
        next++;
    if (n == 0)
        return now;
    const struct cs_camera_key *a = keys + (next ? next - 1 : 0),
                               *b = keys + (next < n ? next : n - 1);
    const double width = b->at - a->at;
    double share = width > 0 ? (t - a->at) / width : 0;
    if (camera->motion == CS_MOTION_SMOOTH)
        share = share * share * (3 - 2 * share);
    for (int i = 0; i < 3; i++) {
        now.eye[i] = a->eye[i] + share * (b->eye[i] - a->eye[i]);
        now.target[i] = a->target[i] + share * (b->target[i] - a->target[i]);
    }
    return now;
}

/* Near and far plane. The far one is four times as far as anything is now, since bodies may
 * fall or be blown away; the near one leaves enough steps of depth. */
static void set_depth(struct cs_view_state *view, const struct cs_bounding_sphere *sphere) {
    const struct cs_camera *camera = &view->camera;
    double to_target[3], to_centre[3];
    cs_subtract(camera->target, camera->eye, to_target);
    cs_subtract(sphere->centre, camera->eye, to_centre);
    const double distance = cs_vec3_length(to_target);
    const double far = 4 * fmax(distance, cs_vec3_length(to_centre) + sphere->radius);
    const bool parallel = camera->projection == CS_PROJECTION_ORTHOGRAPHIC;
    view->depth[0] = parallel ? -far : fmin(far / 1000, distance / 20);
    // haze hides the ground before the far plane cuts it
    view->depth[1] = fmax(far, cs_vec3_length(to_centre) + sphere->radius + 1.1 * view->haze);
}

/* Fills matrix, eye and picture size from the camera. */
static void set_camera(struct cs_view_state *view, const struct cs_render *render,
                       const struct cs_bounding_sphere *sphere) {
    const struct cs_camera *camera = &view->camera;
    const double width = (double)render->size[0], height = (double)render->size[1];
    const double slope = cs_tangent(camera->fov * (3.14159265358979323846 / 360));
    const bool parallel = camera->projection == CS_PROJECTION_ORTHOGRAPHIC;
    double back[3], look[16], lens[16], both[16];
    cs_subtract(camera->eye, camera->target, back);
    const double distance = cs_vec3_length(back);
    set_depth(view, sphere);
    cs_matrix_look(camera->eye, camera->target, camera->up, look);
    if (parallel)
        cs_matrix_parallel(slope * distance, width / height, view->depth[0], view->depth[1],
                           lens);
    else
        cs_matrix_perspective(slope, width / height, view->depth[0], view->depth[1], lens);
    cs_matrix_multiply(lens, look, both);
    // the middle of what the colour bar leaves of the picture
    view->shift = cs_colour_bar_width(render) / width;
    for (size_t i = 0; i < 16; i += 4)
        both[i] -= view->shift * both[i + 3];
    cs_matrix_to_float(both, view->block.world_to_clip);
    cs_normalise(back);
    copy3(parallel ? back : camera->eye, !parallel, view->block.eye);
    view->block.size[0] = (float)width;
    view->block.size[1] = (float)height;
    view->block.size[2] = parallel ? 0 : (float)view->depth[0];
    view->pixels_per_m = height / (2 * slope * distance);
}

bool cs_view_varies(const struct cs_scene *scene) {
    return scene->camera->path.n > 0 || scene->camera->frame != CS_FRAME_GIVEN;
}

void cs_view_move(struct cs_view_state *view, const struct cs_scene *scene,
                  const struct cs_bounding_sphere *sphere, size_t n,
                  const struct cs_frame *frame) {
    struct cs_camera_fit fit;
    view->camera = camera_at(scene->camera, frame->t);
    if (scene->camera->frame == CS_FRAME_START)
        cs_camera_fit_picture(&view->fit, frame->colliders, n, frame->x, &view->camera);
    if (scene->camera->frame == CS_FRAME_AUTO) {
        cs_camera_fit_begin(&fit, scene->camera, scene->render);
        cs_camera_fit_solve(&fit, n, frame->x, 0.62, &view->camera);
    }
    set_camera(view, scene->render, sphere);
}

/* Position of a lamp or direction to a sun; by default from above, in front and the right. */
static void set_light_place(struct cs_view_light *block, const struct cs_light *light) {
    double place[3] = {0.35, 0.8, 0.5};
    double is_point = 0;
    if (!isnan(light->point[0])) {
        memcpy(place, light->point, sizeof place);
        is_point = 1;
    } else if (!isnan(light->direction[0])) {
        for (int i = 0; i < 3; i++)
            place[i] = -light->direction[i];
    }
    if (is_point == 0)
        cs_normalise(place);
    copy3(place, is_point, block->place);
}

/* The sum of a light's diffuse colour. */
static double brightness(const struct cs_light *light) {
    return light->strength * (light->diffuse[0] + light->diffuse[1] + light->diffuse[2]);
}

static const struct cs_light *light_of(const struct cs_scene *scene, uint32_t k) {
    return k ? (const struct cs_light *)scene->lights.items + (k - 1) : scene->light;
}

static void set_lights(struct cs_view_state *view, const struct cs_scene *scene) {
    double all = 0;
    view->n_lights = 1 + scene->lights.n;
    view->block.size[3] = (float)view->n_lights;
    copy3(scene->light->ambient, 1, view->block.ambient);
    for (uint32_t k = 0; k < view->n_lights; k++)
        all += brightness(light_of(scene, k));
    for (uint32_t k = 0; k < view->n_lights; k++) {
        const struct cs_light *light = light_of(scene, k);
        struct cs_view_light *block = view->block.lights + k;
        double diffuse[3], specular[3];
        for (int i = 0; i < 3; i++) {
            diffuse[i] = light->strength * light->diffuse[i];
            specular[i] = light->strength * light->specular[i];
        }
        set_light_place(block, light);
        copy3(diffuse, 1, block->diffuse);
        copy3(specular, 1, block->specular);
        block->shadow_params[3] = (float)(all > 0 ? brightness(light) / all : 0);
        view->casts[k] = light->shadow;
    }
}

/* Colours of the picture's upper and lower edge. A gradient without a second colour gets a
 * slight one, brighter above. */
static void set_background(struct cs_view_block *block,
                           const struct cs_background *background) {
    double above[3] = {0, 0, 0}, below[3] = {0, 0, 0};
    const bool slight = isnan(background->below[0]);
    for (int i = 0; i < 3; i++) {
        const double colour = background->colour[i];
        if (background->kind == CS_BACKGROUND_FLAT)
            above[i] = below[i] = colour;
        if (background->kind == CS_BACKGROUND_GRADIENT) {
            above[i] = slight ? 1.06 * colour + 0.04 : colour;
            below[i] = slight ? 0.82 * colour : background->below[i];
        }
    }
    copy3(background->colour, 1, block->sky);
    copy3(above, background->kind != CS_BACKGROUND_NONE, block->top_colour);
    copy3(below, background->kind != CS_BACKGROUND_NONE, block->bottom_colour);
}

void cs_view_set_colours(struct cs_view_state *view, const struct cs_scene *scene) {
    set_lights(view, scene);
    set_background(&view->block, &scene->render->background);
}

void cs_view_init(struct cs_view_state *view, const struct cs_system *system,
                  const struct cs_posed_collider *colliders,
                  const struct cs_bounding_sphere *sphere) {
    const struct cs_scene *scene = system->scene;
    memset(view, 0, sizeof *view);
    view->haze = cs_view_haze(sphere);
    view->camera = camera_at(scene->camera, 0);
    if (scene->camera->frame == CS_FRAME_START) {
        cs_camera_fit_start(&view->fit, system, colliders, sphere->low, sphere->high);
        cs_camera_fit_picture(&view->fit, colliders, 0, NULL, &view->camera);
    }
    set_camera(view, scene->render, sphere);
    cs_view_set_colours(view, scene);
    cs_colour_stops(scene->render->look, scene->render->palette == CS_PALETTE_GREEN_RED,
                    view->block.colour_stops);
}

/* Fits a cone (lamp) or a box (sun) of light to everything that casts a
 * shadow.
 */

/* A sphere around `solid` whose radius is a power of 1.25 and whose centre lies on a grid.
 * Edges of the shadow keep still from frame to frame, and no frame depends on those before it.
 *
 * Containment: R >= 1.1 r, so r <= 0.909 R. Rounding to a grid of 0.1 R moves the centre by at
 * most 0.05 sqrt(3) R = 0.087 R. The sum 0.996 R is within R. */
static struct cs_bounding_sphere coarse(const struct cs_bounding_sphere *solid) {
    struct cs_bounding_sphere ball = {.radius = 1};
    while (ball.radius > 1.1 * solid->radius)
        ball.radius /= 1.25;
    while (ball.radius < 1.1 * solid->radius)
        ball.radius *= 1.25;
    // moves the centre by at most 0.087 of the radius: inside the margin of 1.1
    const double step = 0.1 * ball.radius;
    for (int i = 0; i < 3; i++)
        ball.centre[i] = step * floor(solid->centre[i] / step + 0.5);
    return ball;
}

/* Fits a light's frustum to the sphere `solid` of all casters. Writes world_to_light and
 * shadow_params[0..2]: 1 / side; texel size in m at the centre; 1 or 0: shadows on. They are
 * off if a lamp is within 1.05 radii of the centre. */
static void fit_light_frustum(const struct cs_bounding_sphere *solid,
                              struct cs_view_light *block) {
    static const double up[3] = {0, 1, 0};
    double eye[3], from[3], look[16], lens[16], both[16];
    const struct cs_bounding_sphere ball = coarse(solid), *lit = &ball;
    const bool is_lamp = block->place[3] > 0;
    for (int i = 0; i < 3; i++) {
        const double light = (double)block->place[i];
        eye[i] = is_lamp ? light : lit->centre[i] + 2 * lit->radius * light;
    }
    cs_subtract(eye, lit->centre, from);
    const double distance = cs_vec3_length(from), r = lit->radius;
    block->shadow_params[2] = distance > 1.05 * r;
    if (block->shadow_params[2] == 0)
        return;

    // tangent cone of the sphere: sin a = r / d, so tan a = r / sqrt(d^2 - r^2)
    const double slope = r / sqrt(distance * distance - r * r);
    cs_matrix_look(eye, lit->centre, up, look);
    if (is_lamp)
        cs_matrix_perspective(slope, 1, distance - r, distance + r, lens);
    else
        cs_matrix_parallel(r, 1, distance - r, distance + r, lens);
    cs_matrix_multiply(lens, look, both);
    cs_matrix_to_float(both, block->world_to_light);
    block->shadow_params[0] = 1.0f / CS_SHADOW_SIDE;
    block->shadow_params[1] = (float)(2 * (is_lamp ? slope * distance : r) / CS_SHADOW_SIDE);
}

void cs_light_frusta_fit(const struct cs_bounding_sphere *sphere, struct cs_view_state *view) {
    for (uint32_t k = 0; k < view->n_lights; k++)
        if (view->casts[k])
            fit_light_frustum(sphere, view->block.lights + k);
}

struct cs_bounding_sphere cs_scene_extent_solid(const struct cs_system *system, const double *x,
                                                const struct cs_posed_collider *colliders) {
    const struct cs_scene *scene = system->scene;
    double low[3], high[3], diagonal[3], place[3];
    struct cs_bounding_sphere sphere = {.radius = 0};
    cs_mesh_position(system->view.n, x, 0, low);
    memcpy(high, low, sizeof high);
    for (uint32_t i = 0; i < system->view.n; i++) {
        cs_mesh_position(system->view.n, x, i, place);
        cs_vec3_extend_box(low, high, place, 0);
    }
    /* planes are left out: they have no end */
    for (uint32_t i = 0; i < scene->colliders.n; i++)
        cs_box_grow_by_collider(low, high, colliders + i);
    for (int i = 0; i < 3; i++)
        sphere.centre[i] = (low[i] + high[i]) / 2;
    memcpy(sphere.low, low, sizeof low);
    memcpy(sphere.high, high, sizeof high);
    cs_subtract(high, low, diagonal);
    /* even a lone particle has some extent: what is drawn scales by the radius */
    sphere.radius = fmax(cs_vec3_length(diagonal) / 2, 1e-3);
    return sphere;
}

double cs_scene_extent_cell(const struct cs_system *system) {
    double cell = 0;
    for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
        const struct cs_cloth *cloth = &cs_scene_bodies(system->scene)[b].cloth;
        if (system->bodies[b].mesh) {
            cell = fmax(cell, system->bodies[b].mesh->edge);
            continue;
        }
        for (int i = 0; i < 2; i++)
            if (cloth->grid[i] > 1)
                cell = fmax(cell, cloth->size[i] / (double)(cloth->grid[i] - 1));
    }
    return cell;
}

/* canvas.c - draws a scene without OpenGL, and exports the module's table of calls.
 *
 * The passes of a picture, in order:
 *   1. vertices and normals of bodies; triangles of colliders, if one or the camera has moved;
 *   2. the light frustum, its triangles, and the shadow map in stripes;
 *   3. triangles of bodies for the camera, and bins of all triangles and lines by band of rows;
 *   4. bands: visibility, shading, ground, lines, resolve.
 * Passes 2 (stripes) and 4 (bands) run on all threads. Each stripe or band writes its own rows
 * only, so the picture does not depend on their number or order. */
#include "draw/cpu/band_pass.h"
#include "draw/cpu/collider_geometry.h"
#include "draw/matrix.h"
#include "draw/overlay.h"
#include "draw/view.h"
#include "scene/picture_keys.h"
#include "scene/scene.h"

#include <stdatomic.h>
#include <stdlib.h>

/* A renderer's state for one scene. */
struct cs_canvas {
    struct cs_canvas_settings settings;
    struct cs_arena arena; /* owns all memory but that of growing lists */
    struct cs_view_state view;
    struct cs_clip_transform clip; /* of the camera */
    struct cs_srgb srgb;
    struct cs_shadow_map lightmaps[CS_LIGHTS];
    struct cs_triangles light_fixed[CS_LIGHTS]; /* casters: colliders */
    uint32_t light;                             /* whose shadow map is drawn */
    struct cs_ground ground;
    struct cs_collider_geometry geometries; /* colliders and the ground */
    struct cs_body_geometry *bodies;        /* (scene->bodies.n) */
    struct cs_band_pass pass;
    struct cs_overlay overlay;
    struct cs_tile_buffer *boards; /* (threads) one per thread */
    atomic_uint next_band;         /* first band that no thread has taken */
};

/* Sets the rays of a camera. Parallel rays have slopes in m: the tangent times the distance of
 * the target, so that both projections show the target alike. */
static void aim_rays(struct cs_rays *rays, const struct cs_view_state *view,
                     const struct cs_render *render) {
    const struct cs_camera *camera = &view->camera;
    double look[16], back[3], slope = cs_tangent(camera->fov * (3.14159265358979323846 / 360));
    cs_matrix_look(camera->eye, camera->target, camera->up, look);
    for (int i = 0; i < 3; i++) {
        rays->eye[i] = (float)camera->eye[i];
        rays->right[i] = (float)look[4 * i];
        rays->up[i] = (float)look[4 * i + 1];
        rays->back[i] = (float)look[4 * i + 2];
    }
    rays->parallel = camera->projection == CS_PROJECTION_ORTHOGRAPHIC;
    cs_subtract(camera->eye, camera->target, back);
    if (rays->parallel)
        slope *= cs_vec3_length(back);
    rays->shift = (float)view->shift;
    rays->depth[0] = (float)view->depth[0];
    rays->depth[1] = (float)view->depth[1];
    rays->slope_x = (float)(slope * ((double)render->size[0] / (double)render->size[1]));
    rays->slope_y = (float)slope;
}

/* Sets what depends on the camera: projection and rays. */
static void aim_camera(struct cs_canvas *canvas) {
    const struct cs_render *render = canvas->settings.scene->render;
    cs_clip_transform_make(&canvas->clip, canvas->view.block.world_to_clip,
                           canvas->view.block.size[2], (int)render->size[0],
                           (int)render->size[1]);
    cs_sample_pattern_jitter(canvas->pass.sample_pattern, &canvas->clip);
    aim_rays(&canvas->pass.shading.rays, &canvas->view, render);
}

/* Sets view, tables and the constant inputs of shading. */
static void init_view(struct cs_canvas *canvas) {
    const struct cs_scene *scene = canvas->settings.scene;
    const struct cs_system *system = canvas->settings.system;
    const int width = (int)scene->render->size[0], height = (int)scene->render->size[1];
    const struct cs_bounding_sphere sphere =
        cs_scene_extent_solid(system, system->view.start, canvas->settings.colliders);
    struct cs_band_pass *pass = &canvas->pass;
    pass->sample_pattern = cs_sample_pattern_of(scene->render->samples);
    cs_view_init(&canvas->view, system, canvas->settings.colliders, &sphere);
    aim_camera(canvas);
    cs_srgb_make(&canvas->srgb);
    pass->shading.width = width;
    pass->shading.height = height;
    pass->shading.view = &canvas->view.block;
    pass->shading.shadow_maps = canvas->lightmaps;
    pass->shading.srgb = &canvas->srgb;
    cs_ground_make(&canvas->ground, system, canvas->settings.colliders, &sphere);
}

/* Makes the triangles of all colliders again; they come first in the list. */
static void add_solids(struct cs_canvas *canvas) {
    struct cs_band_pass *pass = &canvas->pass;
    pass->triangles.n = 0;
    cs_collider_geometry_add(&canvas->geometries, &canvas->clip, canvas->view.block.eye,
                             pass->materials, &pass->triangles);
    pass->n_fixed = pass->triangles.n;
}

/* Makes materials and geometry of colliders, the ground, then bodies: surface number =
 * collider, or number of solids + body. */
static enum cs_status init_surfaces(struct cs_canvas *canvas, struct cs_error *error) {
    const struct cs_canvas_settings *settings = &canvas->settings;
    struct cs_band_pass *pass = &canvas->pass;
    if (cs_collider_geometry_init(&canvas->geometries, settings->system, settings->colliders,
                                  &canvas->ground, &canvas->arena, error))
        return error->status;
    const uint32_t n = settings->scene->bodies.n, solids = canvas->geometries.n;
    if (n + solids > UINT16_MAX)
        return cs_fail(error, CS_ERR_MODULE,
                       "renderer cpu draws at most %d bodies and colliders, not %u", UINT16_MAX,
                       n + solids);
    CS_ARENA_ARRAY(&canvas->arena, pass->materials, n + solids, error);
    canvas->bodies = cs_arena_alloc_array(&canvas->arena, n, sizeof *canvas->bodies, error);
    for (uint32_t b = 0; b < n && error->status == CS_OK; b++) {
        canvas->bodies[b].srgb = &canvas->srgb;
        cs_body_geometry_init(canvas->bodies + b, settings, b, pass->materials + solids + b,
                              &canvas->arena, error);
    }
    if (error->status)
        return error->status;
    add_solids(canvas);
    return CS_OK;
}

/* Allocates a tile buffer per thread. */
static enum cs_status init_boards(struct cs_canvas *canvas, struct cs_error *error) {
    const uint32_t n = canvas->settings.threads;
    canvas->boards = cs_arena_alloc_array(&canvas->arena, n, sizeof *canvas->boards, error);
    for (uint32_t i = 0; i < n && error->status == CS_OK; i++)
        cs_tile_buffer_init(canvas->boards + i, canvas->pass.shading.width, &canvas->arena,
                            error);
    return error->status;
}

static enum cs_status init(struct cs_canvas *canvas, struct cs_error *error) {
    struct cs_band_pass *pass = &canvas->pass;
    init_view(canvas);
    for (uint32_t l = 0; l < canvas->view.n_lights; l++)
        if (canvas->view.casts[l])
            cs_shadow_map_init(canvas->lightmaps + l, &canvas->arena, error);
    if (error->status != CS_OK || init_surfaces(canvas, error) != CS_OK ||
        init_boards(canvas, error) != CS_OK ||
        cs_bins_init(&pass->bins, pass->shading.height, error) != CS_OK ||
        cs_thick_lines_init(&pass->thick_lines, &pass->shading, &canvas->clip, error) != CS_OK)
        return error->status;
    canvas->overlay.marks = canvas->settings.marks;
    return cs_overlay_init(&canvas->overlay, canvas->settings.system, canvas->view.pixels_per_m,
                           &pass->thick_lines.lines, &canvas->arena, error);
}

static void destroy(struct cs_canvas *canvas) {
    if (!canvas)
        return;
    for (int l = 0; l < CS_LIGHTS; l++)
        cs_triangles_finish(canvas->light_fixed + l);
    cs_triangles_finish(&canvas->pass.triangles);
    cs_bins_finish(&canvas->pass.bins);
    cs_thick_lines_finish(&canvas->pass.thick_lines);
    cs_arena_finish(&canvas->arena);
    free(canvas);
}

static enum cs_status create(const struct cs_canvas_settings *settings,
                             struct cs_canvas **canvas, struct cs_error *error) {
    *canvas = calloc(1, sizeof **canvas);
    if (!*canvas)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for a canvas");
    (*canvas)->settings = *settings;
    if (!settings->parallel_for || !settings->threads)
        (*canvas)->settings.threads = 1;
    if (init(*canvas, error) == CS_OK)
        return CS_OK;
    destroy(*canvas);
    *canvas = NULL;
    return error->status;
}

/* Runs a task for each block, on the pool's threads if there are several. */
static void share(struct cs_canvas *canvas, uint32_t blocks,
                  void (*task)(void *arg, uint32_t block)) {
    if (canvas->settings.threads > 1)
        canvas->settings.parallel_for(blocks, task, canvas);
    else
        for (uint32_t block = 0; block < blocks; block++)
            task(canvas, block);
}

static void draw_stripe(void *arg, uint32_t stripe) {
    struct cs_canvas *canvas = arg;
    const struct cs_band_pass *pass = &canvas->pass;
    struct cs_triangles lists[2] = {canvas->light_fixed[canvas->light], pass->triangles};
    // bodies lie behind the colliders that the camera sees
    lists[1].n -= pass->n_fixed;
    if (lists[1].n)
        lists[1].items += pass->n_fixed;
    cs_shadow_map_draw(canvas->lightmaps + canvas->light, stripe, lists);
}

/* Moves a camera that follows a path or fits the bodies. */
static void move_camera(struct cs_canvas *canvas, const struct cs_frame *frame,
                        const struct cs_bounding_sphere *sphere) {
    const struct cs_system *system = canvas->settings.system;
    cs_view_move(&canvas->view, canvas->settings.scene, sphere, system->view.n, frame);
    cs_overlay_aim(&canvas->overlay, canvas->view.pixels_per_m);
    aim_camera(canvas);
}

/* Draws the shadow map of light l. Triangles of colliders are kept from frame to frame as long
 * as neither they nor the light frustum move. */
static void draw_shadow(struct cs_canvas *canvas, uint32_t l, bool moved) {
    const struct cs_triangle_kind kind = {.attributes = 0};
    const struct cs_view_light *light = canvas->view.block.lights + l;
    struct cs_shadow_map *map = canvas->lightmaps + l;
    const bool changed = cs_shadow_map_set_frustum(map, light);
    if (!map->enabled)
        return;
    if (changed || moved) {
        canvas->light_fixed[l].n = 0;
        cs_collider_geometry_add_shadow(&canvas->geometries, &map->transform, light->place,
                                        canvas->light_fixed + l);
    }
    canvas->light = l;
    // in the memory of those for the camera, which are added later
    canvas->pass.triangles.n = canvas->pass.n_fixed;
    for (uint32_t b = 0; b < canvas->settings.scene->bodies.n; b++)
        cs_body_geometry_add(canvas->bodies + b, &map->transform, &kind,
                             &canvas->pass.triangles);
    share(canvas, CS_SHADOW_MAP_STRIPES, draw_stripe);
    cs_shadow_map_bound(map);
}

/* Appends the triangles of bodies after those of colliders, and bins all by band. */
static void add_bodies(struct cs_canvas *canvas) {
    struct cs_band_pass *pass = &canvas->pass;
    pass->triangles.n = pass->n_fixed;
    for (uint32_t b = 0; b < canvas->settings.scene->bodies.n; b++) {
        struct cs_body_geometry *body = canvas->bodies + b;
        const struct cs_triangle_kind kind = {.surface = (uint16_t)(canvas->geometries.n + b),
                                              .attributes =
                                                  (uint8_t)body->material->attributes};
        if (!body->hidden)
            cs_body_geometry_add(body, &canvas->clip, &kind, &pass->triangles);
    }
    cs_band_pass_bin(pass);
}

// one thread: draws bands in its tile buffer as long as there are any
static void draw_bands(void *arg, uint32_t tiles) {
    struct cs_canvas *canvas = arg;
    for (;;) {
        const uint32_t band = atomic_fetch_add(&canvas->next_band, 1);
        if (band >= canvas->pass.bins.bands)
            break;
        cs_band_pass_draw(&canvas->pass, band, canvas->boards + tiles);
    }
}

// growing lists record a failure instead of reporting it: asked once per picture
static bool out_of_memory(const struct cs_canvas *canvas) {
    const struct cs_band_pass *pass = &canvas->pass;
    for (int l = 0; l < CS_LIGHTS; l++)
        if (canvas->light_fixed[l].failed)
            return true;
    return pass->triangles.failed || pass->bins.failed || pass->thick_lines.failed ||
           pass->thick_lines.bins.failed;
}

/* Takes lights, background and materials of bodies from a scene whose values change; those of
 * colliders follow with their triangles. */
static void restyle(struct cs_canvas *canvas) {
    const struct cs_scene *scene = canvas->settings.scene;
    cs_view_set_colours(&canvas->view, scene);
    for (uint32_t b = 0; b < scene->bodies.n; b++)
        cs_body_geometry_restyle(canvas->bodies + b, scene, b);
}

static enum cs_status paint(struct cs_canvas *canvas, const struct cs_frame *frame,
                            struct cs_image *image, struct cs_error *error) {
    struct cs_band_pass *pass = &canvas->pass;
    image->width = (uint32_t)pass->shading.width;
    image->height = (uint32_t)pass->shading.height;
    pass->image = image;
    if (canvas->settings.scene_varies)
        restyle(canvas);
    for (uint32_t b = 0; b < canvas->settings.scene->bodies.n; b++)
        cs_mesh_update(&canvas->bodies[b].mesh, canvas->settings.system->view.n, frame);
    const struct cs_bounding_sphere sphere =
        cs_scene_extent_solid(canvas->settings.system, frame->x, frame->colliders);
    const bool varies = canvas->settings.scene_varies || cs_view_varies(canvas->settings.scene);
    cs_ground_aim(&canvas->ground, &sphere);
    const bool moved = cs_collider_geometry_move(&canvas->geometries, frame->colliders);
    if (varies)
        move_camera(canvas, frame, &sphere);
    if (moved || varies)
        add_solids(canvas);
    cs_light_frusta_fit(&sphere, &canvas->view);
    for (uint32_t l = 0; l < canvas->view.n_lights; l++)
        draw_shadow(canvas, l, moved);
    add_bodies(canvas);
    pass->thick_lines.n = 0;
    cs_overlay_draw(&canvas->overlay, frame);
    cs_thick_lines_bin(&pass->thick_lines);
    atomic_store(&canvas->next_band, 0);
    share(canvas, canvas->settings.threads, draw_bands);
    return out_of_memory(canvas) ? cs_fail(error, CS_ERR_MEMORY, "out of memory for a picture")
                                 : CS_OK;
}

static const char *description(const struct cs_canvas *canvas) {
    (void)canvas;
    return "cpu 3 | the same pixels on every machine";
}

#define EXPORT __attribute__((visibility("default")))
extern EXPORT const struct cs_renderer clothsim_renderer;
EXPORT const struct cs_renderer clothsim_renderer = {
    .abi = CS_RENDERER_ABI,
    .name = "cpu",
    .create = create,
    .paint = paint,
    .description = description,
    .destroy = destroy,
};

/* Draws a scene through OpenGL, and exports the renderer's table of calls.
 *
 * The passes of a picture: upload vertices of bodies and of moved colliders; draw the shadow
 * map; then sky, colliders, ground, bodies and lines; read the samples back. OpenGL stays the
 * second opinion on the software renderer (cpu/canvas.c), whose formulas and order are the
 * same. */
#include "draw/gl/collider.h"
#include "draw/gl/context.h"
#include "draw/gl/driver.h"
#include "draw/gl/framebuffer.h"
#include "draw/gl/gl.h"
#include "draw/gl/lines.h"
#include "draw/gl/shadow.h"
#include "draw/gl/sky_and_ground.h"
#include "draw/gl/surface.h"
#include "draw/light_frustum.h"
#include "draw/mesh.h"
#include "draw/overlay.h"
#include "draw/render.h"
#include "draw/scene_extent.h"

#include <stdio.h>
#include <stdlib.h>

/* A body: its mesh, its buffers, its style. */
struct cs_cloth_picture {
    struct cs_mesh mesh;
    struct cs_surface surface;
    struct cs_surface_style style;
};

/* A renderer's state for one scene. */
struct cs_canvas {
    const struct cs_scene *scene; /* borrowed, as the system */
    const struct cs_system *system;
    struct cs_context *context; /* owns all OpenGL objects */
    struct cs_arena arena;      /* owns all other memory */
    struct cs_framebuffer target;
    struct cs_view_state view;
    struct cs_sky_and_ground backdrop;
    struct cs_surface_program program;
    struct cs_shadow shadow;
    struct cs_gl_colliders colliders;
    struct cs_cloth_picture *cloths; /* (scene->bodies.n) */
    struct cs_gl_lines lines;
    struct cs_overlay overlay;
    char description[256];
};

/* Uploads a texture with all its levels. */
static enum cs_status init_texture(struct cs_canvas *canvas, const struct cs_image *image,
                                   unsigned *texture, struct cs_error *error) {
    struct cs_arena arena = {0}; // OpenGL has its own copy
    struct cs_mipmap mips;
    if (cs_mipmap_make(&mips, image, canvas->target.srgb, &arena, error) == CS_OK)
        *texture = cs_texture_make(&mips);
    cs_arena_finish(&arena);
    return error->status;
}

/* Makes mesh, buffers and style of body b, and its texture if it has one. */
static enum cs_status init_cloth(struct cs_canvas *canvas, uint32_t b,
                                 const struct cs_image *texture, struct cs_error *error) {
    struct cs_cloth_picture *cloth = canvas->cloths + b;
    const struct cs_material *material = &cs_scene_bodies(canvas->scene)[b].material;
    if (cs_mesh_init(&cloth->mesh, canvas->system, b, texture->width > 0, &canvas->arena,
                     error) != CS_OK)
        return error->status;
    /* split vertices stand in the order in which they are drawn, without indices */
    cs_surface_init(&cloth->surface, cloth->mesh.split_vertices ? NULL : cloth->mesh.indices,
                    cloth->mesh.n_indices);
    cs_style_cloth(&cloth->style, material, texture->width > 0, canvas->scene->render.look);
    if (cloth->style.mode != CS_SURFACE_TEXTURED)
        return CS_OK;
    if (init_texture(canvas, texture, &cloth->style.texture, error))
        return error->status;
    float *uv =
        cs_arena_alloc_array(&canvas->arena, cloth->mesh.n_vertices, 2 * sizeof *uv, error);
    if (!uv)
        return error->status;
    cs_mesh_uv(&cloth->mesh, material->texture_repeat, uv);
    cs_surface_set_uv(&cloth->surface, uv, cloth->mesh.n_vertices);
    return CS_OK;
}

static enum cs_status init_cloths(struct cs_canvas *canvas, const struct cs_image *textures,
                                  struct cs_error *error) {
    static const struct cs_image none = {0, 0, NULL, NULL};
    const uint32_t n = canvas->scene->bodies.n;
    canvas->cloths = cs_arena_alloc_array(&canvas->arena, n, sizeof *canvas->cloths, error);
    for (uint32_t b = 0; b < n && error->status == CS_OK; b++)
        init_cloth(canvas, b, textures ? textures + b : &none, error);
    return error->status;
}

/* Makes the context, then everything in it; the order matters, since all need its calls. */
static enum cs_status init(struct cs_canvas *canvas, const struct cs_canvas_settings *settings,
                           struct cs_error *error) {
    const struct cs_render *render = &canvas->scene->render;
    /* before there is a context: Mesa reads its environment only once */
    const char *caps = cs_driver_pin(settings->fast_render);
    if (cs_context_create(&canvas->context, error) != CS_OK || cs_gl_load(error) != CS_OK)
        return error->status;
    snprintf(canvas->description, sizeof canvas->description, "%s | %s | %s",
             (const char *)gl.GetString(GL_RENDERER), (const char *)gl.GetString(GL_VERSION),
             caps);

    /* by the start alone, so that the view is the same in every frame */
    const struct cs_bounding_sphere extent =
        cs_scene_extent_solid(canvas->system, canvas->system->view.start, settings->colliders);
    struct cs_ground ground = {.present = false};
    cs_view_init(&canvas->view, canvas->scene, &extent);
    cs_ground_make(&ground, canvas->system, settings->colliders, &extent);
    if (cs_framebuffer_init(&canvas->target, render, &canvas->arena, error) != CS_OK ||
        cs_sky_and_ground_init(&canvas->backdrop, &ground, error) != CS_OK ||
        cs_surface_program_init(&canvas->program, error) != CS_OK ||
        cs_shadow_init(&canvas->shadow, error) != CS_OK ||
        cs_gl_colliders_init(&canvas->colliders, canvas->system, &canvas->view.block,
                             settings->colliders, &canvas->arena, error) != CS_OK ||
        init_cloths(canvas, settings->textures, error) != CS_OK ||
        cs_gl_lines_init(&canvas->lines, error) != CS_OK ||
        cs_overlay_init(&canvas->overlay, canvas->system, canvas->view.pixels_per_m,
                        &canvas->lines.lines, &canvas->arena, error) != CS_OK)
        return error->status;
    gl.DepthFunc(GL_LEQUAL);
    gl.BlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    return cs_gl_check("preparing the scene", error);
}

static void destroy(struct cs_canvas *canvas) {
    if (!canvas)
        return;
    cs_context_destroy(canvas->context);
    cs_arena_finish(&canvas->arena);
    free(canvas);
}

static enum cs_status create(const struct cs_canvas_settings *settings,
                             struct cs_canvas **canvas, struct cs_error *error) {
    *canvas = calloc(1, sizeof **canvas);
    if (!*canvas)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for a canvas");
    (*canvas)->scene = settings->scene;
    (*canvas)->system = settings->system;
    if (init(*canvas, settings, error) == CS_OK)
        return CS_OK;
    destroy(*canvas);
    *canvas = NULL;
    return error->status;
}

static void move_camera(struct cs_canvas *canvas, const struct cs_frame *frame,
                        const struct cs_bounding_sphere *solid) {
    cs_view_move(&canvas->view, canvas->scene, solid, frame->t, canvas->system->view.n,
                 frame->x);
    cs_overlay_aim(&canvas->overlay, canvas->view.pixels_per_m);
}

/* Places ground and light for the frame, uploads the view, and draws the shadow map. */
static void draw_shadow(struct cs_canvas *canvas, const struct cs_bounding_sphere *solid) {
    if (canvas->backdrop.ground.present)
        cs_ground_aim(&canvas->backdrop.ground, &canvas->view.block, solid);
    const bool has_shadow = cs_light_frustum_fit(solid, &canvas->view.block);
    cs_view_upload(&canvas->view);
    if (!has_shadow)
        return;
    cs_shadow_begin(&canvas->shadow);
    cs_gl_colliders_draw_shadow(&canvas->colliders);
    for (uint32_t b = 0; b < canvas->scene->bodies.n; b++)
        cs_surface_draw(&canvas->cloths[b].surface);
}

/* Draws everything from back to front of what blends: ground over colliders, lines over all. */
static void draw_scene(struct cs_canvas *canvas, const struct cs_frame *frame) {
    cs_shadow_bind(&canvas->shadow);
    cs_framebuffer_begin(&canvas->target);
    cs_sky_and_ground_draw_sky(&canvas->backdrop);
    cs_gl_colliders_draw(&canvas->colliders, &canvas->program);
    if (canvas->backdrop.ground.present)
        cs_sky_and_ground_draw_ground(&canvas->backdrop);
    for (uint32_t b = 0; b < canvas->scene->bodies.n; b++) {
        if (cs_overlay_hides(canvas->scene, b))
            continue;
        cs_surface_program_use(&canvas->program, &canvas->cloths[b].style);
        cs_surface_draw(&canvas->cloths[b].surface);
    }
    cs_overlay_draw(&canvas->overlay, frame);
}

static enum cs_status paint(struct cs_canvas *canvas, const struct cs_frame *frame,
                            struct cs_image *image, struct cs_error *error) {
    if (cs_context_use(canvas->context, error) != CS_OK)
        return error->status;
    for (uint32_t b = 0; b < canvas->scene->bodies.n; b++) {
        struct cs_cloth_picture *cloth = canvas->cloths + b;
        cs_mesh_update(&cloth->mesh, canvas->system->view.n, frame);
        cs_surface_upload(&cloth->surface, cloth->mesh.vertices, cloth->mesh.n_vertices);
    }
    const struct cs_bounding_sphere solid =
        cs_scene_extent_solid(canvas->system, frame->x, frame->colliders);
    const bool varies = cs_view_varies(canvas->scene);
    if (varies)
        move_camera(canvas, frame, &solid);
    cs_gl_colliders_move(&canvas->colliders, frame->colliders, varies);
    draw_shadow(canvas, &solid);
    draw_scene(canvas, frame);
    cs_framebuffer_read(&canvas->target, image);
    return cs_gl_check("drawing a frame", error);
}

static const char *description(const struct cs_canvas *canvas) {
    return canvas->description;
}

#define EXPORT __attribute__((visibility("default")))
extern EXPORT const struct cs_renderer clothsim_renderer;
EXPORT const struct cs_renderer clothsim_renderer = {
    .abi = CS_RENDERER_ABI,
    .name = cs_context_name,
    .create = create,
    .paint = paint,
    .description = description,
    .destroy = destroy,
};

/* Draws a scene through OpenGL, and exports the renderer's table of calls.
 *
 * The passes of a picture: upload vertices of bodies and of moved colliders; draw the shadow
 * map; then sky, colliders, ground, bodies and lines; read the samples back. OpenGL stays the
 * second opinion on the software renderer (cpu/canvas.c), whose formulas and order are the
 * same. */
#include "draw/collider_mesh.h"
#include "draw/gl/context.h"
#include "draw/gl/gl.h"
#include "draw/overlay.h"
#include "draw/render.h"
#include "draw/view.h"
#include "scene/body_keys.h"
#include "scene/picture_keys.h"

#include <stdio.h>
#include <stdlib.h>

/* Colliders drawn through OpenGL. */

/* Geometry and buffers of all colliders. */
struct cs_gl_colliders {
    struct cs_collider_geometry geometries;
    struct cs_surface *surfaces;      /* (n) as seen from the camera */
    struct cs_surface *shadows;       /* (n_lights, n) as seen from each light */
    const struct cs_view_state *view; /* borrowed, for camera and lights */
};

/* Fills and uploads a collider for the camera, and for the lights unless it is a plane. */
static void upload(struct cs_gl_colliders *colliders, uint32_t i) {
    const struct cs_collider_geometry *geometries = &colliders->geometries;
    const struct cs_solid *solid = geometries->of + i;
    if (solid->n == 0)
        return;
    cs_solids_fill(geometries, i, colliders->view->block.eye);
    cs_surface_upload(colliders->surfaces + i, geometries->vertices, solid->n);
    if (cs_shape_is_endless(solid->collider.shape))
        return;
    for (uint32_t l = 0; l < colliders->view->n_lights; l++) {
        cs_solids_fill(geometries, i, colliders->view->block.lights[l].place);
        cs_surface_upload(colliders->shadows + l * geometries->n + i, geometries->vertices,
                          solid->n);
    }
}

/* Makes the buffers from the colliders' poses at the start (scene->colliders.n) and a ground.
 * `view` is set before. CS_ERR_MEMORY. */
static enum cs_status gl_colliders_init(struct cs_gl_colliders *colliders,
                                        const struct cs_system *system,
                                        const struct cs_posed_collider *posed,
                                        const struct cs_ground *ground, struct cs_arena *arena,
                                        struct cs_error *error) {
    if (cs_collider_geometry_init(&colliders->geometries, system, posed, ground, arena, error))
        return error->status;
    const struct cs_view_state *view = colliders->view;
    const uint32_t n = colliders->geometries.n;
    colliders->surfaces = cs_arena_alloc_array(arena, n, sizeof *colliders->surfaces, error);
    CS_ARENA_ARRAY(arena, colliders->shadows, (size_t)n * view->n_lights, error);
    if (error->status)
        return error->status;
    for (uint32_t k = 0; k < n * view->n_lights; k++)
        cs_surface_init(colliders->shadows + k, NULL, 0);
    for (uint32_t i = 0; i < n; i++) {
        cs_surface_init(colliders->surfaces + i, NULL, 0);
        upload(colliders, i);
    }
    return CS_OK;
}

/* Uploads them again if one has moved, or the camera (seen_anew). */
static void gl_colliders_move(struct cs_gl_colliders *colliders,
                              const struct cs_posed_collider *obstacles, bool seen_anew) {
    if (cs_collider_geometry_move(&colliders->geometries, obstacles) || seen_anew)
        for (uint32_t i = 0; i < colliders->geometries.n; i++)
            upload(colliders, i);
}

/* Draws the visible ones with the given program. */
static void gl_colliders_draw(const struct cs_gl_colliders *colliders,
                              const struct cs_surface_program *program) {
    for (uint32_t i = 0; i < colliders->geometries.n; i++) {
        struct cs_surface_style style;
        if (!colliders->geometries.of[i].collider.collider->visible)
            continue;
        cs_collider_geometry_style(&colliders->geometries, i, &style);
        cs_surface_program_use(program, &style);
        cs_surface_draw(colliders->surfaces + i);
    }
}

/* Draws all but planes into the shadow map of light l, whose program is in use. */
static void gl_colliders_draw_shadow(const struct cs_gl_colliders *colliders, uint32_t l) {
    for (uint32_t i = 0; i < colliders->geometries.n; i++) {
        const struct cs_posed_collider *collider = &colliders->geometries.of[i].collider;
        if (collider->collider->visible && !cs_shape_is_endless(collider->shape))
            cs_surface_draw(colliders->shadows + l * colliders->geometries.n + i);
    }
}

/* Choice of Mesa's driver, and of the CPU instructions that it may use. */

static const char *in_force;

/* Sets the environment for the software driver llvmpipe and, unless fast, for SSE4.1 code. One
 * version of Mesa then gives the same pixels on every x86-64 CPU that was tried: the default
 * path uses fused multiply-add, the pinned one does not. Mesa reads the environment once, so
 * only the first call of a process decides. Returns the choice: "caps=sse4.1" or
 * "caps=native". */
static const char *driver_pin(bool fast) {
    if (in_force)
        return in_force;
    setenv("GALLIUM_DRIVER", "llvmpipe", 1); // an unknown driver here would crash OSMesa
    setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
    // nothing is written into the user's home; where a folder is named, shaders are kept there
    if (!getenv("MESA_SHADER_CACHE_DIR"))
        setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
    unsetenv("MESA_GL_VERSION_OVERRIDE");
    unsetenv("MESA_GLSL_VERSION_OVERRIDE");
    unsetenv("LP_NATIVE_VECTOR_WIDTH");
    // without AVX2 there is no fused multiply-add, which alone makes pixels differ between CPUs
    if (fast)
        unsetenv("GALLIUM_OVERRIDE_CPU_CAPS");
    else
        setenv("GALLIUM_OVERRIDE_CPU_CAPS", "sse4.1", 1);
    in_force = fast ? "caps=native" : "caps=sse4.1";
    return in_force;
}

/* A body: its mesh, its buffers, its style. */
struct cs_cloth_picture {
    struct cs_mesh mesh;
    struct cs_surface surface;
    struct cs_surface_style style;
};

/* A renderer's state for one scene. */
struct cs_canvas {
    const struct cs_scene *scene; /* borrowed, as the system */
    bool scene_varies;
    const struct cs_system *system;
    struct cs_context *context; /* owns all OpenGL objects */
    struct cs_arena arena;      /* owns all other memory */
    struct cs_framebuffer target;
    struct cs_view_state view;
    struct cs_sky sky;
    struct cs_ground ground;
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
    const int32_t look = canvas->scene->render->look;
    const bool has_uv = cs_look_needs_uv(look, texture->width > 0);
    if (cs_mesh_init(&cloth->mesh, canvas->system, b, has_uv, &canvas->arena, error) != CS_OK)
        return error->status;
    /* split vertices stand in the order in which they are drawn, without indices */
    cs_surface_init(&cloth->surface, cloth->mesh.split_vertices ? NULL : cloth->mesh.indices,
                    cloth->mesh.n_indices);
    cs_style_cloth(&cloth->style, material, texture->width > 0, look);
    if (!has_uv)
        return CS_OK;
    if (cloth->style.mode == CS_SURFACE_TEXTURED &&
        init_texture(canvas, texture, &cloth->style.texture, error))
        return error->status;
    float *uv =
        cs_arena_alloc_array(&canvas->arena, cloth->mesh.n_vertices, 2 * sizeof *uv, error);
    if (!uv)
        return error->status;
    cs_mesh_uv(&cloth->mesh, cs_look_repeat(look, material), uv);
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
    const struct cs_render *render = canvas->scene->render;
    /* before there is a context: Mesa reads its environment only once */
    const char *caps = driver_pin(settings->fast_render);
    if (cs_context_create(&canvas->context, error) != CS_OK || cs_gl_load(error) != CS_OK)
        return error->status;
    snprintf(canvas->description, sizeof canvas->description, "%s | %s | %s",
             (const char *)gl.GetString(GL_RENDERER), (const char *)gl.GetString(GL_VERSION),
             caps);

    /* by the start alone, so that the view is the same in every frame */
    const struct cs_bounding_sphere sphere =
        cs_scene_extent_solid(canvas->system, canvas->system->view.start, settings->colliders);
    cs_view_init(&canvas->view, canvas->system, settings->colliders, &sphere);
    canvas->colliders.view = &canvas->view;
    cs_ground_make(&canvas->ground, canvas->system, settings->colliders, &sphere);
    if (cs_framebuffer_init(&canvas->target, render, &canvas->arena, error) != CS_OK ||
        cs_sky_init(&canvas->sky, error) != CS_OK ||
        cs_surface_program_init(&canvas->program, error) != CS_OK ||
        cs_shadow_init(&canvas->shadow, canvas->view.n_lights, error) != CS_OK ||
        gl_colliders_init(&canvas->colliders, canvas->system, settings->colliders,
                          &canvas->ground, &canvas->arena, error) != CS_OK ||
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
    (*canvas)->scene_varies = settings->scene_varies;
    (*canvas)->overlay.marks = settings->marks;
    (*canvas)->system = settings->system;
    if (init(*canvas, settings, error) == CS_OK)
        return CS_OK;
    destroy(*canvas);
    *canvas = NULL;
    return error->status;
}

/* Places lights for the frame, uploads the view, and draws the shadow maps. */
static void draw_shadow(struct cs_canvas *canvas, const struct cs_bounding_sphere *sphere) {
    cs_light_frusta_fit(sphere, &canvas->view);
    cs_view_upload(&canvas->view);
    for (uint32_t l = 0; l < canvas->view.n_lights; l++) {
        if (!(canvas->view.block.lights[l].shadow_params[2] > 0))
            continue;
        cs_shadow_begin(&canvas->shadow, l);
        gl_colliders_draw_shadow(&canvas->colliders, l);
        for (uint32_t b = 0; b < canvas->scene->bodies.n; b++)
            cs_surface_draw(&canvas->cloths[b].surface);
    }
}

/* Draws all surfaces, then lines, which blend, over them. */
static void draw_scene(struct cs_canvas *canvas, const struct cs_frame *frame) {
    cs_shadow_bind(&canvas->shadow);
    cs_framebuffer_begin(&canvas->target);
    cs_sky_draw(&canvas->sky);
    gl_colliders_draw(&canvas->colliders, &canvas->program);
    for (uint32_t b = 0; b < canvas->scene->bodies.n; b++) {
        if (cs_overlay_hides(canvas->scene, b))
            continue;
        cs_surface_program_use(&canvas->program, &canvas->cloths[b].style);
        cs_surface_draw(&canvas->cloths[b].surface);
    }
    cs_overlay_draw(&canvas->overlay, frame);
}

/* Draws and copies the samples of a pass. OpenGL in OSMesa has four samples at most: eight are
 * those of two pictures, moved so that the pattern is that of the other renderer
 * (cpu/raster.c). */
static void draw_pass(struct cs_canvas *canvas, const struct cs_frame *frame, uint32_t pass) {
    const float side = pass ? 1.0f / 16 : -1.0f / 16, on = canvas->target.passes > 1;
    canvas->view.block.jitter[0] = on * 3 * side;
    canvas->view.block.jitter[1] = -on * side;
    cs_view_upload(&canvas->view);
    draw_scene(canvas, frame);
    cs_framebuffer_copy(&canvas->target, pass);
}

/* Takes lights, background and materials of bodies from a scene whose values change. */
static void restyle(struct cs_canvas *canvas) {
    cs_view_set_colours(&canvas->view, canvas->scene);
    for (uint32_t b = 0; b < canvas->scene->bodies.n; b++) {
        struct cs_surface_style *style = &canvas->cloths[b].style;
        const unsigned texture = style->texture;
        cs_style_cloth(style, &cs_scene_bodies(canvas->scene)[b].material,
                       style->mode == CS_SURFACE_TEXTURED, canvas->scene->render->look);
        style->texture = texture;
    }
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
    const struct cs_bounding_sphere sphere =
        cs_scene_extent_solid(canvas->system, frame->x, frame->colliders);
    const bool varies = canvas->scene_varies || cs_view_varies(canvas->scene);
    if (canvas->scene_varies)
        restyle(canvas);
    if (varies) {
        cs_view_move(&canvas->view, canvas->scene, &sphere, canvas->system->view.n, frame);
        cs_overlay_aim(&canvas->overlay, canvas->view.pixels_per_m);
    }
    cs_ground_aim(&canvas->ground, &sphere);
    gl_colliders_move(&canvas->colliders, frame->colliders, varies);
    draw_shadow(canvas, &sphere);
    for (uint32_t pass = 0; pass < canvas->target.passes; pass++)
        draw_pass(canvas, frame, pass);
    cs_framebuffer_resolve(&canvas->target, image);
    return cs_gl_check("drawing a frame", error);
}

static const char *description(const struct cs_canvas *canvas) {
    return canvas->description;
}

#define EXPORT __attribute__((visibility("default")))

extern EXPORT const struct cs_renderer clothsim_renderer;

EXPORT const struct cs_renderer clothsim_renderer = {
    .abi = CS_RENDERER_ABI,
    .name = "osmesa",
    .create = create,
    .paint = paint,
    .description = description,
    .destroy = destroy,
};

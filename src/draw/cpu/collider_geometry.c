/* collider_geometry.c - colliders, the ground and bodies become triangles of a picture. */
#include "draw/cpu/collider_geometry.h"

#include "draw/overlay.h"
#include "scene/body_keys.h"

#include <string.h>

// viewer and destination of triangles
struct projection {
    const struct cs_clip_transform *clip;
    const float *eye; // position and 1, or direction and 0
    bool sinks;       // apply the depth bias; not for a light
    struct cs_triangles *triangles;
};

// triangles of three vertices each, none shared
static void add_obstacle(const struct cs_collider_geometry *geometries, uint32_t i,
                         const struct cs_surface_style *style,
                         const struct cs_triangle_kind *kind,
                         const struct projection *projection) {
    struct cs_clip_vertex corners[3];
    const struct cs_clip_vertex *const three[3] = {corners, corners + 1, corners + 2};
    cs_solids_fill(geometries, i, projection->eye);
    cs_triangles_reserve(projection->triangles, geometries->of[i].n / 3);
    for (uint32_t v = 0; v < geometries->of[i].n; v++) {
        const struct cs_vertex *vertex = geometries->vertices + v;
        struct cs_clip_vertex *corner = corners + v % 3;
        cs_clip_transform_corner(projection->clip, vertex->position, corner);
        memcpy(corner->attributes, vertex->normal, sizeof vertex->normal);
        if (projection->sinks && style->depth_bias > 0)
            cs_clip_transform_move_depth(projection->clip, vertex->position, projection->eye,
                                         (float)style->depth_bias, corner);
        if (v % 3 == 2)
            cs_triangles_add(projection->triangles, projection->clip, three, kind);
    }
}

void cs_collider_geometry_add(const struct cs_collider_geometry *geometries,
                              const struct cs_clip_transform *clip, const float eye[4],
                              struct cs_shading_material *materials,
                              struct cs_triangles *triangles) {
    const struct projection projection = {clip, eye, true, triangles};
    for (uint32_t i = 0; i < geometries->n; i++) {
        const struct cs_triangle_kind kind = {.surface = (uint16_t)i, .attributes = 3};
        struct cs_surface_style style;
        cs_collider_geometry_style(geometries, i, &style);
        cs_shading_material_make(materials + i, &style);
        if (geometries->of[i].collider.collider->visible)
            add_obstacle(geometries, i, &style, &kind, &projection);
    }
}

void cs_collider_geometry_add_shadow(const struct cs_collider_geometry *geometries,
                                     const struct cs_clip_transform *clip, const float light[4],
                                     struct cs_triangles *triangles) {
    const struct cs_triangle_kind kind = {.attributes = 0};
    const struct projection projection = {clip, light, false, triangles};
    for (uint32_t i = 0; i < geometries->n; i++) {
        const struct cs_posed_collider *collider = &geometries->of[i].collider;
        struct cs_surface_style style;
        if (!collider->collider->visible || cs_shape_is_endless(collider->shape))
            continue;
        cs_style_solid(&style, collider, geometries->cell);
        add_obstacle(geometries, i, &style, &kind, &projection);
    }
}

/* Projects the vertices of bodies, and adds their faces as triangles. */

/* Makes texture coordinates, and mipmaps of a texture. */
static enum cs_status init_texture(struct cs_body_geometry *body, const struct cs_image *image,
                                   const double repeat[2], struct cs_arena *arena,
                                   struct cs_error *error) {
    body->uv = cs_arena_alloc_array(arena, body->mesh.n_vertices, 2 * sizeof *body->uv, error);
    if (error->status)
        return error->status;
    cs_mesh_uv(&body->mesh, repeat, body->uv);
    if (body->material->mode != CS_SURFACE_TEXTURED)
        return CS_OK;
    body->material->mips = cs_arena_alloc(arena, sizeof *body->material->mips, error);
    return error->status
               ? error->status
               : cs_mipmap_make(body->material->mips, image, body->srgb, arena, error);
}

enum cs_status cs_body_geometry_init(struct cs_body_geometry *body,
                                     const struct cs_canvas_settings *settings, uint32_t b,
                                     struct cs_shading_material *shading,
                                     struct cs_arena *arena, struct cs_error *error) {
    static const struct cs_image none = {0, 0, NULL, NULL};
    const struct cs_image *image = settings->textures ? settings->textures + b : &none;
    const struct cs_material *material = &cs_scene_bodies(settings->scene)[b].material;
    const bool textured = image->width > 0;
    const bool has_uv = cs_look_needs_uv(settings->scene->render->look, textured);
    if (cs_mesh_init(&body->mesh, settings->system, b, has_uv, arena, error))
        return error->status;
    CS_ARENA_ARRAY(arena, body->clip_vertices, body->mesh.n_vertices, error);
    body->hidden = cs_overlay_hides(settings->scene, b);
    body->material = shading;
    body->textured = textured;
    cs_body_geometry_restyle(body, settings->scene, b);
    if (error->status == CS_OK && has_uv)
        init_texture(body, image, cs_look_repeat(settings->scene->render->look, material),
                     arena, error);
    return error->status;
}

void cs_body_geometry_restyle(struct cs_body_geometry *body, const struct cs_scene *scene,
                              uint32_t b) {
    struct cs_surface_style style;
    cs_style_cloth(&style, &cs_scene_bodies(scene)[b].material, body->textured,
                   scene->render->look);
    cs_shading_material_make(body->material, &style);
}

/* Attributes of a corner: normal, value, texture coordinates, in the order that shading
 * reads. */
static void set_attributes(const struct cs_body_geometry *body, uint32_t i,
                           struct cs_clip_vertex *corner) {
    const struct cs_vertex *vertex = body->mesh.vertices + i;
    memcpy(corner->attributes, vertex->normal, sizeof vertex->normal);
    corner->attributes[3] = vertex->value;
    corner->attributes[4] = body->uv ? body->uv[2 * (size_t)i] : 0;
    corner->attributes[5] = body->uv ? body->uv[2 * (size_t)i + 1] : 0;
}

void cs_body_geometry_add(struct cs_body_geometry *body, const struct cs_clip_transform *clip,
                          const struct cs_triangle_kind *kind, struct cs_triangles *triangles) {
    const struct cs_mesh *mesh = &body->mesh;
    cs_triangles_reserve(triangles, mesh->n_indices / 3);
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        cs_clip_transform_corner(clip, mesh->vertices[i].position, body->clip_vertices + i);
        if (kind->attributes)
            set_attributes(body, i, body->clip_vertices + i);
    }
    for (uint32_t k = 0; k + 2 < mesh->n_indices; k += 3) {
        const struct cs_clip_vertex *corners[3];
        for (uint32_t i = 0; i < 3; i++)
            corners[i] =
                body->clip_vertices + (mesh->split_vertices ? k + i : mesh->indices[k + i]);
        cs_triangles_add(triangles, clip, corners, kind);
    }
}

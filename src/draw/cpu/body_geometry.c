/* body_geometry.c - projects the vertices of bodies, and adds their faces as triangles. */
#include "draw/cpu/body_geometry.h"

#include "draw/overlay.h"

#include <string.h>

/* Makes mipmaps and texture coordinates. */
static enum cs_status init_texture(struct cs_body_geometry *body, const struct cs_image *image,
                                   const double repeat[2], struct cs_arena *arena,
                                   struct cs_error *error) {
    body->material->mips = cs_arena_alloc(arena, sizeof *body->material->mips, error);
    body->uv = cs_arena_alloc_array(arena, body->mesh.n_vertices, 2 * sizeof *body->uv, error);
    if (error->status || cs_mipmap_make(body->material->mips, image, body->srgb, arena, error))
        return error->status;
    cs_mesh_uv(&body->mesh, repeat, body->uv);
    return CS_OK;
}

enum cs_status cs_body_geometry_init(struct cs_body_geometry *body,
                                     const struct cs_canvas_settings *settings, uint32_t b,
                                     struct cs_shading_material *coat, struct cs_arena *arena,
                                     struct cs_error *error) {
    static const struct cs_image none = {0, 0, NULL, NULL};
    const struct cs_image *image = settings->textures ? settings->textures + b : &none;
    const struct cs_material *material = &cs_scene_bodies(settings->scene)[b].material;
    const bool textured = image->width > 0;
    struct cs_surface_style style;
    if (cs_mesh_init(&body->mesh, settings->system, b, textured, arena, error))
        return error->status;
    body->clip_vertices =
        cs_arena_alloc_array(arena, body->mesh.n_vertices, sizeof *body->clip_vertices, error);
    body->hidden = cs_overlay_hides(settings->scene, b);
    body->material = coat;
    cs_style_cloth(&style, material, textured, settings->scene->render.look);
    cs_shading_material_make(coat, &style);
    if (error->status == CS_OK && coat->mode == CS_SURFACE_TEXTURED)
        init_texture(body, image, material->texture_repeat, arena, error);
    return error->status;
}

void cs_body_geometry_update(struct cs_body_geometry *body, uint32_t n,
                             const struct cs_frame *frame) {
    cs_mesh_update(&body->mesh, n, frame);
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

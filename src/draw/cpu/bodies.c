/* bodies.c - vertices of bodies become corners, and their faces triangles. */
#include "draw/cpu/bodies.h"

#include "draw/overlay.h"

#include <string.h>

static enum cs_status init_texture(struct cs_body_picture *body, const struct cs_image *image,
                                   const double repeat[2], struct cs_arena *arena,
                                   struct cs_error *error) {
    body->coat->mips = cs_arena_take(arena, sizeof *body->coat->mips, error);
    body->uv = cs_arena_take_n(arena, body->mesh.n_vertices, 2 * sizeof *body->uv, error);
    if (error->status || cs_mips_make(body->coat->mips, image, body->tone, arena, error))
        return error->status;
    cs_mesh_uv(&body->mesh, repeat, body->uv);
    return CS_OK;
}

enum cs_status cs_body_picture_init(struct cs_body_picture *body,
                                    const struct cs_canvas_settings *settings, uint32_t b,
                                    struct cs_coat *coat, struct cs_arena *arena,
                                    struct cs_error *error) {
    static const struct cs_image none = {0, 0, NULL, NULL};
    const struct cs_image *image = settings->textures ? settings->textures + b : &none;
    const struct cs_material *material = &cs_scene_bodies(settings->scene)[b].material;
    const bool textured = image->width > 0;
    struct cs_surface_style style;
    if (cs_mesh_init(&body->mesh, settings->system, b, textured, arena, error))
        return error->status;
    body->corners = cs_arena_take_n(arena, body->mesh.n_vertices, sizeof *body->corners, error);
    body->hidden = cs_overlay_hides(settings->scene, b);
    body->coat = coat;
    cs_style_cloth(&style, material, textured, settings->scene->render.look);
    cs_coat_make(coat, &style);
    if (error->status == CS_OK && coat->mode == CS_SURFACE_TEXTURED)
        init_texture(body, image, material->texture_repeat, arena, error);
    return error->status;
}

void cs_body_picture_update(struct cs_body_picture *body, uint32_t n,
                            const struct cs_frame *frame) {
    cs_mesh_update(&body->mesh, n, frame);
}

static void set_attributes(const struct cs_body_picture *body, uint32_t i,
                           struct cs_corner *corner) {
    const struct cs_vertex *vertex = body->mesh.vertices + i;
    memcpy(corner->attributes, vertex->normal, sizeof vertex->normal);
    corner->attributes[3] = vertex->value;
    corner->attributes[4] = body->uv ? body->uv[2 * (size_t)i] : 0;
    corner->attributes[5] = body->uv ? body->uv[2 * (size_t)i + 1] : 0;
}

void cs_body_picture_add(struct cs_body_picture *body, const struct cs_lens *lens,
                         const struct cs_triangle_kind *kind, struct cs_triangles *triangles) {
    const struct cs_mesh *mesh = &body->mesh;
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        cs_lens_corner(lens, mesh->vertices[i].place, body->corners + i);
        if (kind->attributes)
            set_attributes(body, i, body->corners + i);
    }
    for (uint32_t k = 0; k + 2 < mesh->n_indices; k += 3) {
        const struct cs_corner *corners[3];
        for (uint32_t i = 0; i < 3; i++)
            corners[i] = body->corners + (mesh->split ? k + i : mesh->indices[k + i]);
        cs_triangles_add(triangles, lens, corners, kind);
    }
}

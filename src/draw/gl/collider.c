/* Draws colliders through OpenGL: as the camera sees them, and as the light does. */
#include "draw/gl/collider.h"

#include "draw/collider_mesh.h"
#include "draw/gl/gl.h"
#include "draw/scene_extent.h"

#include <string.h>

static void upload(struct cs_gl_colliders *colliders, uint32_t i) {
    const struct cs_posed_collider *obstacle = colliders->colliders + i;
    const uint32_t n = cs_collider_mesh_count(obstacle);
    if (n == 0)
        return;
    cs_collider_mesh_fill(obstacle, colliders->cell, colliders->view->eye, colliders->vertices);
    cs_surface_upload(colliders->surfaces + i, colliders->vertices, n);
    if (obstacle->kind == CS_COLLIDER_PLANE)
        return;
    cs_collider_mesh_fill(obstacle, colliders->cell, colliders->view->light,
                          colliders->vertices);
    cs_surface_upload(colliders->shadows + i, colliders->vertices, n);
}

static enum cs_status take(struct cs_gl_colliders *colliders,
                           const struct cs_posed_collider *obstacles, struct cs_arena *arena,
                           struct cs_error *error) {
    const uint32_t n = colliders->n;
    uint32_t most = 0;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t count = cs_collider_mesh_count(obstacles + i);
        most = count > most ? count : most;
    }
    colliders->colliders = cs_arena_alloc_array(arena, n, sizeof *colliders->colliders, error);
    colliders->surfaces = cs_arena_alloc_array(arena, n, sizeof *colliders->surfaces, error);
    colliders->shadows = cs_arena_alloc_array(arena, n, sizeof *colliders->shadows, error);
    colliders->vertices = cs_arena_alloc_array(arena, most, sizeof *colliders->vertices, error);
    return error->status;
}

enum cs_status cs_gl_colliders_init(struct cs_gl_colliders *colliders,
                                    const struct cs_system *system,
                                    const struct cs_view_block *view,
                                    const struct cs_posed_collider *obstacles,
                                    struct cs_arena *arena, struct cs_error *error) {
    colliders->n = system->scene->colliders.n;
    colliders->cell = cs_scene_extent_cell(system);
    colliders->view = view;
    if (take(colliders, obstacles, arena, error))
        return error->status;
    for (uint32_t i = 0; i < colliders->n; i++) {
        // a copy, by which cs_gl_colliders_move sees what has moved
        colliders->colliders[i] = obstacles[i];
        cs_surface_init(colliders->surfaces + i, NULL, 0);
        cs_surface_init(colliders->shadows + i, NULL, 0);
        upload(colliders, i);
    }
    return CS_OK;
}

void cs_gl_colliders_move(struct cs_gl_colliders *colliders,
                          const struct cs_posed_collider *obstacles, bool seen_anew) {
    for (uint32_t i = 0; i < colliders->n; i++) {
        struct cs_posed_collider *now = colliders->colliders + i;
        const bool moved = memcmp(now->centre, obstacles[i].centre, sizeof now->centre) ||
                           memcmp(now->axes, obstacles[i].axes, sizeof now->axes);
        *now = obstacles[i];
        if (moved || seen_anew)
            upload(colliders, i);
    }
}

void cs_gl_colliders_draw(const struct cs_gl_colliders *colliders,
                          const struct cs_surface_program *program) {
    // squares first, because they may be blended
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t i = 0; i < colliders->n; i++) {
            const struct cs_posed_collider *obstacle = colliders->colliders + i;
            const bool square = obstacle->kind == CS_COLLIDER_PLANE;
            struct cs_surface_style style;
            if (!obstacle->collider->visible || square != (pass == 0))
                continue;
            cs_style_solid(&style, obstacle, colliders->cell);
            cs_surface_program_use(program, &style);
            if (square)
                gl.Enable(GL_BLEND);
            cs_surface_draw(colliders->surfaces + i);
            gl.Disable(GL_BLEND);
        }
}

void cs_gl_colliders_draw_shadow(const struct cs_gl_colliders *colliders) {
    for (uint32_t i = 0; i < colliders->n; i++) {
        const struct cs_posed_collider *obstacle = colliders->colliders + i;
        if (obstacle->collider->visible && obstacle->kind != CS_COLLIDER_PLANE)
            cs_surface_draw(colliders->shadows + i);
    }
}

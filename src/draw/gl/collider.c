/* Draws colliders through OpenGL. A sphere's cap depends on its viewer, so each collider has
 * buffers for the camera and for the light. */
#include "draw/gl/collider.h"

#include "draw/gl/gl.h"

/* Fills and uploads a collider for the camera, and for the light unless it is a plane. */
static void upload(struct cs_gl_colliders *colliders, uint32_t i) {
    const struct cs_collider_geometry *solids = &colliders->solids;
    const struct cs_solid *solid = solids->of + i;
    if (solid->n == 0)
        return;
    cs_solids_fill(solids, i, colliders->view->eye);
    cs_surface_upload(colliders->surfaces + i, solids->vertices, solid->n);
    if (cs_shape_is_endless(solid->at.shape))
        return;
    cs_solids_fill(solids, i, colliders->view->light);
    cs_surface_upload(colliders->shadows + i, solids->vertices, solid->n);
}

enum cs_status cs_gl_colliders_init(struct cs_gl_colliders *colliders,
                                    const struct cs_system *system,
                                    const struct cs_view_block *view,
                                    const struct cs_posed_collider *obstacles,
                                    struct cs_arena *arena, struct cs_error *error) {
    const uint32_t n = system->scene->colliders.n;
    colliders->view = view;
    colliders->surfaces = cs_arena_alloc_array(arena, n, sizeof *colliders->surfaces, error);
    colliders->shadows = cs_arena_alloc_array(arena, n, sizeof *colliders->shadows, error);
    if (cs_collider_geometry_init(&colliders->solids, system, obstacles, arena, error))
        return error->status;
    for (uint32_t i = 0; i < n; i++) {
        cs_surface_init(colliders->surfaces + i, NULL, 0);
        cs_surface_init(colliders->shadows + i, NULL, 0);
        upload(colliders, i);
    }
    return CS_OK;
}

void cs_gl_colliders_move(struct cs_gl_colliders *colliders,
                          const struct cs_posed_collider *obstacles, bool seen_anew) {
    for (uint32_t i = 0; i < colliders->solids.n; i++)
        if (cs_solid_move(colliders->solids.of + i, obstacles + i) || seen_anew)
            upload(colliders, i);
}

void cs_gl_colliders_draw(const struct cs_gl_colliders *colliders,
                          const struct cs_surface_program *program) {
    // squares first, because they may be blended
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t i = 0; i < colliders->solids.n; i++) {
            const struct cs_posed_collider *obstacle = &colliders->solids.of[i].at;
            const bool square = cs_shape_is_endless(obstacle->shape);
            struct cs_surface_style style;
            if (!obstacle->collider->visible || square != (pass == 0))
                continue;
            cs_style_solid(&style, obstacle, colliders->solids.cell);
            cs_surface_program_use(program, &style);
            if (square)
                gl.Enable(GL_BLEND);
            cs_surface_draw(colliders->surfaces + i);
            gl.Disable(GL_BLEND);
        }
}

void cs_gl_colliders_draw_shadow(const struct cs_gl_colliders *colliders) {
    for (uint32_t i = 0; i < colliders->solids.n; i++) {
        const struct cs_posed_collider *obstacle = &colliders->solids.of[i].at;
        if (obstacle->collider->visible && !cs_shape_is_endless(obstacle->shape))
            cs_surface_draw(colliders->shadows + i);
    }
}

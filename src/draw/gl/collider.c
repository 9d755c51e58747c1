/* Draws colliders through OpenGL: one ball placed for each sphere, surfaces for the others. */
#include "draw/gl/collider.h"

#include "draw/ball.h"
#include "draw/extent.h"
#include "draw/gl/gl.h"
#include "draw/solid.h"

#include <string.h>

static void upload(struct cs_gl_colliders *colliders, uint32_t i) {
    const uint32_t n = cs_solid_count(colliders->obstacles + i);
    if (n == 0)
        return;
    cs_solid_fill(colliders->obstacles + i, colliders->cell, colliders->vertices);
    cs_surface_upload(colliders->surfaces + i, colliders->vertices, n);
}

static enum cs_status take(struct cs_gl_colliders *colliders, struct cs_arena *arena,
                           struct cs_error *error) {
    uint32_t most = 0;
    for (uint32_t i = 0; i < colliders->n; i++) {
        const uint32_t count = cs_solid_count(colliders->obstacles + i);
        most = count > most ? count : most;
    }
    colliders->surfaces =
        cs_arena_take_n(arena, colliders->n, sizeof *colliders->surfaces, error);
    colliders->vertices = cs_arena_take_n(arena, most, sizeof *colliders->vertices, error);
    return error->status;
}

enum cs_status cs_gl_colliders_init(struct cs_gl_colliders *colliders,
                                    const struct cs_system *system,
                                    const struct cs_obstacle *obstacles, struct cs_arena *arena,
                                    struct cs_error *error) {
    struct cs_vertex *vertices;
    uint32_t n;
    colliders->n = system->scene->colliders.n;
    colliders->cell = cs_extent_cell(system);
    colliders->obstacles =
        cs_arena_take_n(arena, colliders->n, sizeof *colliders->obstacles, error);
    if (!colliders->obstacles)
        return error->status;
    /* a copy, by which cs_gl_colliders_move sees what has moved */
    if (colliders->n > 0)
        memcpy(colliders->obstacles, obstacles, colliders->n * sizeof *obstacles);
    if (cs_ball_make(&vertices, &n, arena, error) || take(colliders, arena, error))
        return error->status;
    /* spheres share one ball, which the shader scales and moves */
    cs_surface_init(&colliders->ball, NULL, 0);
    cs_surface_upload(&colliders->ball, vertices, n);
    for (uint32_t i = 0; i < colliders->n; i++)
        if (cs_solid_count(colliders->obstacles + i) > 0) {
            cs_surface_init(colliders->surfaces + i, NULL, 0);
            upload(colliders, i);
        }
    return CS_OK;
}

void cs_gl_colliders_move(struct cs_gl_colliders *colliders,
                          const struct cs_obstacle *obstacles) {
    for (uint32_t i = 0; i < colliders->n; i++) {
        struct cs_obstacle *now = colliders->obstacles + i;
        const bool moved = memcmp(now->centre, obstacles[i].centre, sizeof now->centre) ||
                           memcmp(now->axes, obstacles[i].axes, sizeof now->axes);
        *now = obstacles[i];
        if (moved)
            upload(colliders, i);
    }
}

void cs_gl_colliders_draw(const struct cs_gl_colliders *colliders,
                          const struct cs_surface_program *program) {
    // squares first, because they may be blended
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t i = 0; i < colliders->n; i++) {
            const struct cs_obstacle *obstacle = colliders->obstacles + i;
            const bool square = obstacle->kind == CS_OBSTACLE_PLANE;
            struct cs_surface_style style;
            if (!obstacle->collider->visible || square != (pass == 0))
                continue;
            cs_style_solid(&style, obstacle, colliders->cell);
            cs_surface_program_use(program, &style);
            if (square)
                gl.Enable(GL_BLEND);
            cs_surface_draw(obstacle->kind == CS_OBSTACLE_SPHERE ? &colliders->ball
                                                                 : colliders->surfaces + i);
            gl.Disable(GL_BLEND);
        }
}

void cs_gl_colliders_draw_shadow(const struct cs_gl_colliders *colliders, int model) {
    for (uint32_t i = 0; i < colliders->n; i++) {
        const struct cs_obstacle *obstacle = colliders->obstacles + i;
        const double *centre = obstacle->centre;
        if (!obstacle->collider->visible || obstacle->kind == CS_OBSTACLE_PLANE)
            continue;
        if (obstacle->kind == CS_OBSTACLE_SPHERE) {
            gl.Uniform4f(model, (float)centre[0], (float)centre[1], (float)centre[2],
                         (float)obstacle->radius);
            cs_surface_draw(&colliders->ball);
        } else {
            gl.Uniform4f(model, 0, 0, 0, 1);
            cs_surface_draw(colliders->surfaces + i);
        }
    }
}

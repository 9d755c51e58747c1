#include "draw/gl/collider.h"

#include "draw/ball.h"
#include "draw/extent.h"
#include "draw/gl/gl.h"

static void init_squares(struct cs_obstacles *obstacles) {
    for (uint32_t i = 0; i < obstacles->scene->colliders.n; i++) {
        struct cs_vertex corners[6];
        if (!cs_solid_square(cs_scene_colliders(obstacles->scene) + i, obstacles->cell,
                             corners))
            continue;
        cs_surface_init(obstacles->squares + i, NULL, 0);
        cs_surface_upload(obstacles->squares + i, corners, 6);
    }
}

enum cs_status cs_obstacles_init(struct cs_obstacles *obstacles, const struct cs_system *system,
                                 struct cs_arena *arena, struct cs_error *error) {
    struct cs_vertex *vertices;
    uint32_t n;
    obstacles->scene = system->scene;
    obstacles->cell = cs_extent_cell(system);
    obstacles->squares =
        cs_arena_take_n(arena, system->scene->colliders.n, sizeof *obstacles->squares, error);
    if (!obstacles->squares || cs_ball_make(&vertices, &n, arena, error) != CS_OK)
        return error->status;
    cs_surface_init(&obstacles->ball, NULL, 0);
    cs_surface_upload(&obstacles->ball, vertices, n);
    init_squares(obstacles);
    return CS_OK;
}

static bool shows_sphere(const struct cs_collider *collider) {
    return collider->visible && collider->sphere.present;
}

void cs_obstacles_draw(const struct cs_obstacles *obstacles,
                       const struct cs_surface_program *program) {
    // squares first, because they may be blended
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t i = 0; i < obstacles->scene->colliders.n; i++) {
            const struct cs_collider *collider = cs_scene_colliders(obstacles->scene) + i;
            struct cs_surface_style style;
            if (!collider->visible || (pass == 1) != collider->sphere.present)
                continue;
            cs_style_solid(&style, collider, obstacles->cell);
            cs_surface_program_use(program, &style);
            if (pass == 1) {
                cs_surface_draw(&obstacles->ball);
                continue;
            }
            gl.Enable(GL_BLEND);
            cs_surface_draw(obstacles->squares + i);
            gl.Disable(GL_BLEND);
        }
}

void cs_obstacles_draw_shadow(const struct cs_obstacles *obstacles, int model) {
    for (uint32_t i = 0; i < obstacles->scene->colliders.n; i++) {
        const struct cs_collider *collider = cs_scene_colliders(obstacles->scene) + i;
        const double *centre = collider->sphere.centre;
        if (!shows_sphere(collider))
            continue;
        gl.Uniform4f(model, (float)centre[0], (float)centre[1], (float)centre[2],
                     (float)collider->sphere.radius);
        cs_surface_draw(&obstacles->ball);
    }
}

#include "draw/gl/collider.h"

#include "draw/gl/ball.h"
#include "draw/gl/extent.h"
#include "draw/gl/gl.h"
#include "draw/matrix.h"

// a square about `middle`, seen from the side of the normal
static void make_square(struct cs_surface *square, const double middle[3],
                        const double normal[3], double extent, double sink) {
    static const signed char signs[6][2] = {{-1, -1}, {1, -1}, {1, 1},
                                            {-1, -1}, {1, 1},  {-1, 1}};
    double across[3], third[3];
    struct cs_vertex corners[6];
    cs_frame_across(normal, across, third);
    for (int k = 0; k < 6; k++) {
        for (int i = 0; i < 3; i++) {
            const double side = signs[k][0] * across[i] + signs[k][1] * third[i];
            corners[k].place[i] = (float)(middle[i] + extent * side - sink * normal[i]);
            corners[k].normal[i] = (float)normal[i];
        }
        corners[k].value = 0;
    }
    cs_surface_init(square, NULL, 0);
    cs_surface_upload(square, corners, 6);
}

static void init_squares(struct cs_obstacles *obstacles) {
    static const double up[3] = {0, 1, 0};
    // a little below its place, or it would show through cloth that lies on it
    const double sink = 0.03 * obstacles->cell;
    for (uint32_t i = 0; i < obstacles->scene->colliders.n; i++) {
        const struct cs_collider *collider = cs_scene_colliders(obstacles->scene) + i;
        const double middle[3] = {0, collider->floor.height, 0};
        if (collider->visible && collider->plane.present)
            make_square(obstacles->squares + i, collider->plane.point, collider->plane.normal,
                        collider->plane.extent, sink);
        else if (collider->visible && collider->floor.present)
            make_square(obstacles->squares + i, middle, up, collider->floor.extent, sink);
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

// three times the height of a chord of one diagonal, for cloth seen at a slant
static double sink_of(const struct cs_obstacles *obstacles, double radius) {
    return fmin(3 * obstacles->cell * obstacles->cell / (4 * radius), radius / 4);
}

static bool shows_sphere(const struct cs_collider *collider) {
    return collider->visible && collider->sphere.present;
}

static void draw_square(const struct cs_obstacles *obstacles, uint32_t i,
                        const struct cs_surface_program *program,
                        struct cs_surface_style *style) {
    const struct cs_collider *collider = cs_scene_colliders(obstacles->scene) + i;
    style->fade = collider->floor.present ? collider->floor.extent : 0;
    cs_surface_program_use(program, style);
    gl.Enable(GL_BLEND);
    cs_surface_draw(obstacles->squares + i);
    gl.Disable(GL_BLEND);
}

static void draw_sphere(const struct cs_obstacles *obstacles, const struct cs_sphere *sphere,
                        const struct cs_surface_program *program,
                        struct cs_surface_style *style) {
    memcpy(style->centre, sphere->centre, sizeof style->centre);
    style->scale = sphere->radius;
    style->sink = sink_of(obstacles, sphere->radius);
    style->specular = 0.22;
    style->shininess = 40;
    cs_surface_program_use(program, style);
    cs_surface_draw(&obstacles->ball);
}

void cs_obstacles_draw(const struct cs_obstacles *obstacles,
                       const struct cs_surface_program *program) {
    // squares first, because they may be blended
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t i = 0; i < obstacles->scene->colliders.n; i++) {
            const struct cs_collider *collider = cs_scene_colliders(obstacles->scene) + i;
            struct cs_surface_style style = {
                .ambient = 1, .diffuse = 1, .specular = 0.04, .shininess = 12, .scale = 1};
            memcpy(style.front, collider->colour, sizeof style.front);
            memcpy(style.back, collider->colour, sizeof style.back);
            if (pass == 0 && collider->visible && !collider->sphere.present)
                draw_square(obstacles, i, program, &style);
            if (pass == 1 && shows_sphere(collider))
                draw_sphere(obstacles, &collider->sphere, program, &style);
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

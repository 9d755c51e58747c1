/* Measures the extent of a scene, and the largest cell of its bodies. */
#include "draw/scene_extent.h"

#include "draw/matrix.h"
#include "draw/mesh.h"
#include "mesh/trimesh.h"

static void grow(double low[3], double high[3], const double place[3]) {
    for (int i = 0; i < 3; i++) {
        low[i] = fmin(low[i], place[i]);
        high[i] = fmax(high[i], place[i]);
    }
}

/* all that a sphere, a box or a capsule may reach */
static void grow_by(double low[3], double high[3], const struct cs_posed_collider *obstacle) {
    for (int i = 0; i < 3; i++) {
        double reach = obstacle->radius;
        for (int k = 0; k < 3; k++)
            reach += fabs(obstacle->axes[k][i]) * obstacle->half_sizes[k];
        low[i] = fmin(low[i], obstacle->centre[i] - reach);
        high[i] = fmax(high[i], obstacle->centre[i] + reach);
    }
}

static void grow_by_mesh(double low[3], double high[3],
                         const struct cs_posed_collider *obstacle) {
    const struct cs_trimesh *mesh = obstacle->collider->mesh.geometry;
    for (size_t v = 0; v < mesh->n; v++) {
        const double *own = mesh->positions + v;
        double place[3];
        cs_collider_to_world(
            obstacle, (double[3]){own[0], own[mesh->n], own[2 * (size_t)mesh->n]}, place);
        grow(low, high, place);
    }
}

struct cs_bounding_sphere cs_scene_extent_solid(const struct cs_system *system, const double *x,
                                                const struct cs_posed_collider *obstacles) {
    const struct cs_scene *scene = system->scene;
    double low[3], high[3], diagonal[3], place[3];
    struct cs_bounding_sphere ball = {.radius = 0};
    cs_mesh_position(system->view.n, x, 0, low);
    memcpy(high, low, sizeof high);
    for (uint32_t i = 0; i < system->view.n; i++) {
        cs_mesh_position(system->view.n, x, i, place);
        grow(low, high, place);
    }
    /* planes are left out: they have no end */
    for (uint32_t i = 0; i < scene->colliders.n; i++) {
        if (!obstacles[i].collider->visible || cs_shape_is_endless(obstacles[i].shape))
            continue;
        if (obstacles[i].shape->bounds == CS_BOUNDS_MESH)
            grow_by_mesh(low, high, obstacles + i);
        else
            grow_by(low, high, obstacles + i);
    }
    for (int i = 0; i < 3; i++)
        ball.centre[i] = (low[i] + high[i]) / 2;
    memcpy(ball.low, low, sizeof low);
    memcpy(ball.high, high, sizeof high);
    cs_subtract(high, low, diagonal);
    /* even a lone particle has some extent: what is drawn scales by the radius */
    ball.radius = fmax(cs_length(diagonal) / 2, 1e-3);
    return ball;
}

double cs_scene_extent_cell(const struct cs_system *system) {
    double cell = 0;
    for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
        const struct cs_cloth *cloth = &cs_scene_bodies(system->scene)[b].cloth;
        if (system->bodies[b].mesh) {
            cell = fmax(cell, system->bodies[b].mesh->edge);
            continue;
        }
        for (int i = 0; i < 2; i++)
            if (cloth->grid[i] > 1)
                cell = fmax(cell, cloth->size[i] / (double)(cloth->grid[i] - 1));
    }
    return cell;
}

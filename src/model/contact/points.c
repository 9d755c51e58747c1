/* Particles copied beside the vertices of mesh colliders, which are posed as any collider is.
 */
#include "model/contact/points.h"

#include "mesh/trimesh.h"
#include "model/contact/obstacle.h"
#include "scene/pairs.h"

#include <string.h>

struct cs_points {
    double *places[2], *velocities; /* (3, n_points) */
};

static double *take(struct cs_system *system, struct cs_error *error) {
    return cs_arena_take_n(&system->arena, 3 * (size_t)system->surfaces->n_points,
                           sizeof(double), error);
}

enum cs_status cs_points_build(struct cs_system *system, struct cs_error *error) {
    if (cs_surfaces_build(system, error) || system->points ||
        system->surfaces->n_points == system->view.n)
        return error->status;
    struct cs_points *points = cs_arena_take(&system->arena, sizeof *points, error);
    if (!points)
        return error->status;
    for (int k = 0; k < 2; k++)
        points->places[k] = take(system, error);
    points->velocities = take(system, error);
    system->points = points;
    return error->status;
}

size_t cs_points_bytes(const struct cs_scene *scene) {
    const size_t points = cs_surfaces_points(scene);
    const bool any = cs_scene_surfaces(scene) > scene->bodies.n;
    return cs_surfaces_bytes(scene) +
           (any ? sizeof(struct cs_points) + 9 * points * sizeof(double) : 0);
}

static void copy_particles(const struct cs_system *system, const double *from, double *to) {
    const size_t n = system->view.n, n_points = system->surfaces->n_points;
    for (size_t c = 0; c < 3; c++) {
        if (from)
            memcpy(to + c * n_points, from + c * n, n * sizeof *to);
        else
            memset(to + c * n_points, 0, n * sizeof *to);
    }
}

/* vertex i of an obstacle: its axes times the place in the mesh */
static void pose_vertex(const struct cs_obstacle *obstacle, size_t i, double p[3]) {
    const struct cs_trimesh *mesh = obstacle->collider->mesh.geometry;
    const double *own = mesh->places + i;
    const size_t n = mesh->n;
    for (int c = 0; c < 3; c++)
        p[c] = obstacle->axes[0][c] * own[0] + obstacle->axes[1][c] * own[n] +
               obstacle->axes[2][c] * own[2 * n] + obstacle->centre[c];
}

/* Sets places or velocities of all obstacles' vertices. */
static void set_vertices(const struct cs_system *system, double t, bool velocities,
                         double *to) {
    const struct cs_surfaces *surfaces = system->surfaces;
    const size_t n_points = surfaces->n_points;
    for (uint32_t s = system->scene->bodies.n; s < surfaces->n_bodies; s++) {
        const uint32_t first = surfaces->first_point[s];
        struct cs_obstacle obstacle;
        cs_obstacle_at(system, s - system->scene->bodies.n, t, &obstacle);
        for (uint32_t i = first; i < surfaces->first_point[s + 1]; i++) {
            double p[3], v[3];
            pose_vertex(&obstacle, i - first, p);
            cs_obstacle_velocity(&obstacle, p, v);
            for (size_t c = 0; c < 3; c++)
                to[c * n_points + i] = velocities ? v[c] : p[c];
        }
    }
}

const double *cs_points_places(const struct cs_system *system, enum cs_points_end end, double t,
                               const double *x) {
    if (!system->points)
        return x;
    copy_particles(system, x, system->points->places[end]);
    set_vertices(system, t, false, system->points->places[end]);
    return system->points->places[end];
}

const double *cs_points_velocities(const struct cs_system *system, double t, const double *v) {
    if (!system->points)
        return v;
    copy_particles(system, v, system->points->velocities);
    set_vertices(system, t, true, system->points->velocities);
    return system->points->velocities;
}

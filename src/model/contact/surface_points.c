/* Copies particles beside the vertices of mesh colliders, which are posed like any collider. */
#include "model/contact/contact_samples.h"
#include "scene/scene.h"

#include "model/contact/posed_collider.h"

#include <string.h>

/* arrays: positions at both ends of a step, then velocities */
enum { VELOCITIES = 2, ARRAYS };

struct cs_points {
    double *of[ARRAYS]; /* (3, n_points) */
    /* (ARRAYS, colliders) poses in the arrays; a collider at rest is not set again */
    struct cs_posed_collider *posed;
};

enum cs_status cs_surface_points_build(struct cs_system *system, struct cs_error *error) {
    if (cs_surfaces_build(system, error) || system->points ||
        system->surfaces->n_points == system->view.n)
        return error->status;
    struct cs_points *points = cs_arena_alloc(&system->arena, sizeof *points, error);
    if (!points)
        return error->status;
    for (int k = 0; k < ARRAYS; k++)
        CS_ARENA_ARRAY(&system->arena, points->of[k], 3 * (size_t)system->surfaces->n_points,
                       error);
    const size_t colliders = system->surfaces->n_bodies - system->scene->bodies.n;
    CS_ARENA_ARRAY(&system->arena, points->posed, ARRAYS * colliders, error);
    system->points = points;
    return error->status;
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

/* Sets positions or velocities of the vertices of a collider. */
static void set_vertices(const struct cs_surfaces *surfaces, uint32_t surface,
                         const struct cs_posed_collider *collider, bool velocities,
                         double *to) {
    const uint32_t first = surfaces->first_point[surface];
    const size_t n_points = surfaces->n_points;
    for (uint32_t i = first; i < surfaces->first_point[surface + 1]; i++) {
        double p[3], v[3];
        cs_posed_collider_vertex(collider, i - first, p, velocities ? v : NULL);
        for (size_t c = 0; c < 3; c++)
            to[c * n_points + i] = velocities ? v[c] : p[c];
    }
}

/* Sets all colliders in one of the arrays. */
static void set_obstacles(const struct cs_system *system, double t, int array) {
    struct cs_points *points = system->points;
    const uint32_t n_bodies = system->scene->bodies.n;
    const uint32_t n = system->surfaces->n_bodies - n_bodies;
    for (uint32_t k = 0; k < n; k++) {
        struct cs_posed_collider collider, *posed = points->posed + (size_t)array * n + k;
        cs_posed_collider_at(system, k, t, &collider);
        // all numbers, and no gaps between them
        if (memcmp(posed, &collider, sizeof collider))
            set_vertices(system->surfaces, n_bodies + k, &collider, array == VELOCITIES,
                         points->of[array]);
        *posed = collider;
    }
}

/* Particles are copied at each call, vertices of a collider only if its pose has changed. */
const double *cs_surface_points_positions(const struct cs_system *system,
                                          enum cs_points_end end, double t, const double *x) {
    if (!system->points)
        return x;
    copy_particles(system, x, system->points->of[end]);
    set_obstacles(system, t, (int)end);
    return system->points->of[end];
}

const double *cs_surface_points_velocities(const struct cs_system *system, double t,
                                           const double *v) {
    if (!system->points)
        return v;
    copy_particles(system, v, system->points->of[VELOCITIES]);
    set_obstacles(system, t, VELOCITIES);
    return system->points->of[VELOCITIES];
}

/* friction_anchors.c - where bristles hang: anchors in the frames of colliders, which follow
 * after each step. */
#include "model/contact/bristle_law.h"

#include "base/vec3.h"
#include "model/contact/contact_samples.h"
#include "scene/body_pairs.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

/* An anchor within the arrays of struct cs_friction_anchors: its coordinates are at[0],
 * at[stride] and at[2 stride]. */
struct anchor {
    double *at;
    size_t stride;
};

/* The anchor of a point; at is NULL if it has none on this collider. */
static struct anchor anchor_of(const struct cs_system *system, uint32_t collider,
                               const struct cs_contact_sample_point *point) {
    const struct cs_friction_anchors *all = system->friction_anchors;
    double *values = !all ? NULL : point->n > 1 ? all->samples : all->particles[collider];
    if (point->n > 1)
        return (struct anchor){values ? values + point->number : NULL,
                               system->contact_samples->n_points};
    return (struct anchor){values ? values + point->particles[0] : NULL, system->view.n};
}

/* kg, of a particle or of a sample, which has HUGE_VAL where it cannot move */
static double mass_of(const struct cs_system *system,
                      const struct cs_contact_sample_point *point) {
    return point->n > 1 ? cs_contact_sample_mass(system, point)
                        : system->mass[point->particles[0]];
}

/* Stores a point in the frame of the collider, which moves and turns with it. */
static void store(struct anchor anchor, const struct cs_posed_collider *collider,
                  const double p[3]) {
    double arm[3];
    for (int c = 0; c < 3; c++)
        arm[c] = p[c] - collider->rotation_centre[c];
    for (size_t k = 0; k < 3; k++)
        anchor.at[k * anchor.stride] = cs_vec3_dot(collider->axes[k], arm);
}

/* Sets the bristle of a point of mass m in kg at p. */
static bool set(const struct cs_posed_collider_law *law, struct anchor anchor,
                const double p[3], double mass, struct cs_bristle *bristle) {
    const struct cs_posed_collider *collider = &law->collider;
    if (!anchor.at)
        return false;
    for (int c = 0; c < 3; c++) {
        double at = collider->rotation_centre[c];
        for (size_t k = 0; k < 3; k++)
            at += collider->axes[k][c] * anchor.at[k * anchor.stride];
        bristle->stretch[c] = p[c] - at;
    }
    bristle->friction = law->sticking_friction;
    bristle->stiffness = law->params.k;
    bristle->damping = 2 * sqrt(law->params.k * mass);
    return true;
}

bool cs_bristle_of_point(const struct cs_system *system, uint32_t collider,
                         const struct cs_posed_collider_law *law,
                         const struct cs_contact_sample_point *point, const double p[3],
                         struct cs_bristle *bristle) {
    return law->sticking_friction > 0 &&
           set(law, anchor_of(system, collider, point), p, mass_of(system, point), bristle);
}

/* --- what a step leaves --- */

/* All points at one collider after a step, or at the start, where v is NULL. */
struct job {
    const struct cs_system *system;
    const double *x, *v;
    uint32_t collider;
    struct cs_posed_collider_law law;
};

/* Moves the anchor of one point, unless it holds. At the start, out of range and tangled, the
 * anchor is the point. */
static void follow(void *arg, const struct cs_contact_sample_point *point) {
    const struct job *job = arg;
    const size_t n = job->system->view.n;
    const struct anchor anchor = anchor_of(job->system, job->collider, point);
    const double mass = mass_of(job->system, point);
    struct cs_point_contact contact;
    struct cs_bristle bristle;
    double p[3], v[3], back[3];
    cs_contact_sample_interpolate(point, n, job->x, p);
    cs_contact_sample_interpolate(point, n, job->v, v);
    // a sample that cannot move keeps its anchor
    if (mass == HUGE_VAL || !set(&job->law, anchor, p, mass, &bristle))
        return;
    if (job->v && !cs_contact_sample_is_tangled(job->system, point) &&
        cs_posed_collider_law_in_range(&job->law, p, v, &contact)) {
        if (!cs_bristle_slips(&contact, &bristle, back))
            return;
        for (int c = 0; c < 3; c++)
            p[c] -= back[c];
    }
    store(anchor, &job->law.collider, p);
}

void cs_friction_anchors_commit(const struct cs_system *system, double t, const double *x,
                                const double *v) {
    struct job job = {.system = system, .x = x, .v = v};
    for (uint32_t c = 0; c < system->scene->colliders.n && system->friction_anchors; c++) {
        job.collider = c;
        cs_posed_collider_law_at(system, c, t, &job.law);
        cs_contact_points_visit(system, c, follow, &job);
    }
}

/* --- making --- */

enum cs_status cs_friction_anchors_build(struct cs_system *system, struct cs_error *error) {
    struct cs_arena *arena = &system->arena;
    const uint32_t n_colliders = system->scene->colliders.n;
    const size_t n3 = 3 * (size_t)system->view.n;
    const size_t of_samples =
        system->contact_samples ? 3 * system->contact_samples->n_points : 0;
    size_t used = 0;
    for (uint32_t c = 0; c < n_colliders; c++)
        used += cs_scene_sticks_to(system->scene, c) ? n3 : 0;
    struct cs_friction_anchors *anchors = cs_arena_alloc(arena, sizeof *anchors, error);
    double **particles = cs_arena_alloc_array(arena, n_colliders, sizeof *particles, error);
    double *values = cs_arena_alloc_array(arena, used + of_samples, sizeof *values, error);
    if (error->status)
        return error->status;
    // one array: particles by collider, then samples
    *anchors = (struct cs_friction_anchors){.values = values,
                                            .n_values = used + of_samples,
                                            .particles = particles,
                                            .samples = of_samples ? values + used : NULL};
    for (uint32_t c = 0; c < n_colliders; c++) {
        particles[c] = cs_scene_sticks_to(system->scene, c) ? values : NULL;
        values += particles[c] ? n3 : 0;
    }
    system->friction_anchors = anchors;
    return CS_OK;
}

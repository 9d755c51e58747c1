/* friction_anchors.c - where bristles hang: anchors in the frames of colliders, which follow
 * after each step. */
#include "model/contact/bristle_law.h"

#include "base/pool.h"
#include "base/vec3.h"
#include "base/vector.h"
#include "model/contact/contact_samples.h"
#include "scene/body_pairs.h"

#include <math.h>
#include <string.h>

/* An anchor within the arrays of struct cs_friction_anchors: its coordinates are at[0],
 * at[stride] and at[2 stride]. */
struct anchor {
    double *at;
    size_t stride;
};

/* The anchor of a particle; at is NULL if it has none on this collider. */
static struct anchor anchor_of_particle(const struct cs_system *system, uint32_t collider,
                                        size_t particle) {
    double *all =
        system->friction_anchors ? system->friction_anchors->particles[collider] : NULL;
    return (struct anchor){all ? all + particle : NULL, system->view.n};
}

static struct anchor anchor_of_sample(const struct cs_system *system, uint32_t number) {
    double *all = system->friction_anchors ? system->friction_anchors->samples : NULL;
    return (struct anchor){all ? all + number : NULL, system->contact_samples->n_points};
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

bool cs_bristle_of_particle(const struct cs_system *system, uint32_t collider,
                            const struct cs_posed_collider_law *law, const double *x,
                            size_t particle, struct cs_bristle *bristle) {
    const size_t n = system->view.n;
    const double p[3] = {x[particle], x[n + particle], x[2 * n + particle]};
    return law->sticking_friction > 0 &&
           set(law, anchor_of_particle(system, collider, particle), p, system->mass[particle],
               bristle);
}

bool cs_bristle_of_sample(const struct cs_system *system,
                          const struct cs_posed_collider_law *law,
                          const struct cs_contact_sample_point *point, const double p[3],
                          struct cs_bristle *bristle) {
    return law->sticking_friction > 0 && set(law, anchor_of_sample(system, point->number), p,
                                             cs_contact_sample_mass(system, point), bristle);
}

/* --- what a step leaves --- */

/* All points after one step, or at the start, where v is NULL. */
struct job {
    const struct cs_system *system;
    double t;
    const double *x, *v;
    uint32_t collider;
    struct cs_posed_collider_law law; /* of that collider */
};

/* A point and its bristle; anchor.at is NULL if it has none. */
struct point {
    struct anchor anchor;
    double p[3], v[3], mass;
};

/* Moves the anchor of one point, unless it holds. */
static void follow(const struct job *job, const struct point *point) {
    struct cs_point_contact contact;
    struct cs_bristle bristle;
    double to[3];
    memcpy(to, point->p, sizeof to);
    if (!set(&job->law, point->anchor, point->p, point->mass, &bristle))
        return;
    // at the start, out of range and tangled, the anchor is the point
    if (job->v && point->mass < HUGE_VAL &&
        cs_posed_collider_law_in_range(&job->law, point->p, point->v, &contact)) {
        double back[3];
        if (!cs_bristle_slips(&contact, &bristle, back))
            return;
        for (int c = 0; c < 3; c++)
            to[c] -= back[c];
    }
    store(point->anchor, &job->law.collider, to);
}

/* Particles [begin, end) on one collider. */
static void follow_particles(void *arg, size_t begin, size_t end) {
    const struct job *job = arg;
    const size_t n = job->system->view.n;
    for (size_t i = begin; i < end; i++) {
        struct point point = {.anchor = anchor_of_particle(job->system, job->collider, i),
                              .mass = cs_system_is_tangled(job->system, (uint32_t)i)
                                          ? HUGE_VAL
                                          : job->system->mass[i]};
        for (size_t c = 0; c < 3; c++) {
            point.p[c] = job->x[c * n + i];
            point.v[c] = job->v ? job->v[c * n + i] : 0;
        }
        follow(job, &point);
    }
}

/* Contact samples of one chunk. */
static void follow_samples(void *arg, uint32_t number) {
    struct job job = *(const struct job *)arg;
    const struct cs_contact_sample_chunk *chunk = job.system->contact_samples->chunks + number;
    const size_t n = job.system->view.n;
    cs_posed_collider_law_at(job.system, chunk->collider, job.t, &job.law);
    for (uint32_t i = chunk->begin; i < chunk->end; i++) {
        struct cs_contact_sample_point sample;
        for (cs_contact_sample_first(chunk, i, &sample); cs_contact_sample_next(&sample);) {
            struct point point = {.anchor = anchor_of_sample(job.system, sample.number),
                                  .mass = cs_contact_sample_mass(job.system, &sample)};
            cs_contact_sample_interpolate(&sample, n, job.x, point.p);
            cs_contact_sample_interpolate(&sample, n, job.v, point.v);
            if (point.mass < HUGE_VAL)
                follow(&job, &point);
        }
    }
}

void cs_friction_anchors_commit(const struct cs_system *system, double t, const double *x,
                                const double *v) {
    struct job job = {.system = system, .t = t, .x = x, .v = v};
    if (!system->friction_anchors)
        return;
    // each anchor is written once, so that threads do not count
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        if (!system->friction_anchors->particles[c])
            continue;
        job.collider = c;
        cs_posed_collider_law_at(system, c, t, &job.law);
        cs_vector_parallel_for(system->view.n, follow_particles, &job);
    }
    if (system->friction_anchors->samples)
        cs_pool_run(system->contact_samples->n_chunks, follow_samples, &job);
}

/* --- making --- */

/* Numbers the samples of all chunks through. */
static void number_samples(struct cs_system *system, struct cs_error *error) {
    struct cs_contact_samples *samples = system->contact_samples;
    uint32_t count = 0;
    for (uint32_t l = 0; l < samples->n_chunks && !error->status; l++) {
        struct cs_contact_sample_chunk *chunk = samples->chunks + l;
        uint32_t *numbers = cs_arena_alloc_array(&system->arena, chunk->end - chunk->begin,
                                                 sizeof *numbers, error);
        for (uint32_t i = chunk->begin; i < chunk->end && numbers; i++) {
            struct cs_contact_sample_point point;
            numbers[i - chunk->begin] = count;
            for (cs_contact_sample_first(chunk, i, &point); cs_contact_sample_next(&point);)
                count++;
        }
        chunk->first_numbers = numbers;
    }
}

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
    if (of_samples && !error->status)
        number_samples(system, error);
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

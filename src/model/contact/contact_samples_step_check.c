/* Tests whether a step resolves the contact of samples with colliders. */
#include "model/contact/contact_samples.h"

#include "base/vector.h"
#include "model/contact/step_check.h"

/* One step. */
struct job {
    const struct cs_contact_samples *covers;
    double t0, t1;
    const double *x0, *x1;
};

/* Tests one sample, with its effective mass; pinned ones are never unresolved. */
static bool is_unresolved(const struct cs_collider_step *passing,
                          const struct cs_contact_sample_point *point) {
    const size_t n = passing->system->view.n;
    const double mass = cs_contact_sample_mass(passing->system, point);
    double from[3], to[3];
    cs_contact_sample_interpolate(point, n, passing->x0, from);
    cs_contact_sample_interpolate(point, n, passing->x1, to);
    return mass < HUGE_VAL && cs_collider_step_misses_contact(passing, mass, from, to);
}

/* Number of unresolved samples in the chunks [begin, end). */
static double count_unresolved(const void *arg, size_t begin, size_t end) {
    const struct job *job = arg;
    double unseen = 0;
    for (size_t l = begin; l < end; l++) {
        const struct cs_contact_sample_chunk *chunk = job->covers->chunks + l;
        struct cs_collider_step passing = {.x0 = job->x0, .x1 = job->x1};
        cs_collider_step_set(&passing, job->covers->system, chunk->collider, job->t0, job->t1);
        if (cs_collider_step_is_far(&passing, chunk->first,
                                    (size_t)chunk->last - chunk->first + 1))
            continue;
        for (uint32_t i = chunk->begin; i < chunk->end; i++) {
            struct cs_contact_sample_point point;
            for (cs_contact_sample_first(chunk, i, &point); cs_contact_sample_next(&point);)
                unseen += is_unresolved(&passing, &point);
        }
    }
    return unseen;
}

bool cs_contact_samples_resolve_step(const struct cs_contact_samples *samples, double t0,
                                     const double *x0, double t1, const double *x1) {
    const struct job job = {samples, t0, t1, x0, x1};
    return cs_vector_sum(samples->n_chunks, count_unresolved, &job) == 0;
}

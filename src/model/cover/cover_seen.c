/* The energy that a step does not see of points between particles. */
#include "model/cover/cover.h"

#include "base/vector.h"
#include "model/contact/share.h"

struct job {
    const struct cs_covers *covers;
    double t0, t1;
    const double *x0, *x1;
};

static bool is_unseen(const struct cs_passing *passing, const struct cs_cover_point *point) {
    const size_t n = passing->system->view.n;
    const double mass = cs_cover_mass(passing->system, point);
    double from[3], to[3];
    cs_cover_mix(point, n, passing->x0, from);
    cs_cover_mix(point, n, passing->x1, to);
    return mass < HUGE_VAL && cs_passing_is_unseen(passing, mass, from, to);
}

static double count_unseen(const void *arg, size_t begin, size_t end) {
    const struct job *job = arg;
    double unseen = 0;
    for (size_t l = begin; l < end; l++) {
        const struct cs_cover_lot *lot = job->covers->lots + l;
        struct cs_passing passing = {.x0 = job->x0, .x1 = job->x1};
        cs_passing_set(&passing, job->covers->system, lot->collider, job->t0, job->t1);
        if (cs_passing_is_far(&passing, lot->first, (size_t)lot->last - lot->first + 1))
            continue;
        for (uint32_t i = lot->begin; i < lot->end; i++) {
            struct cs_cover_point point;
            for (cs_cover_start(lot, i, &point); cs_cover_next(&point);)
                unseen += is_unseen(&passing, &point);
        }
    }
    return unseen;
}

bool cs_covers_are_seen(const struct cs_covers *covers, double t0, const double *x0, double t1,
                        const double *x1) {
    const struct job job = {covers, t0, t1, x0, x1};
    return cs_vector_sum(covers->n_lots, count_unseen, &job) == 0;
}

/* Points in range: found lot by lot, each with what it does to its corners. */
#include "model/cover/cover_force.h"

#include "base/pool.h"
#include "base/vec3.h"

#include <math.h>
#include <string.h>

/* what the points in range are asked for */
enum ask { ASK_FORCE, ASK_CHANGE, ASK_ENERGY, ASK_MATRIX, ASK_BOUND };

struct job {
    struct cs_covers *covers;
    struct cs_pair_set *set;
    enum ask ask;
    struct cs_eval at;
    const struct cs_matrix *matrix;
};

static void give(const double f[3], const struct cs_cover_point *point, struct cs_pair *place) {
    for (uint32_t k = 0; k < place->n; k++)
        for (int c = 0; c < 3; c++)
            place->to[k][c] = point->w[k] * f[c];
}

/* The rows of a point's share have w_i w_j in front of the same block, and the weights add up
 * to 1. */
static void bound(const struct cs_touch *touch, const struct cs_cover_point *point,
                  struct cs_pair_part *part) {
    double stiffness, damping;
    cs_touch_bound(touch, &stiffness, &damping);
    for (uint32_t k = 0; k < point->n; k++) {
        part->of[k] = stiffness * point->w[k];
        part->share[k] = point->w[k] * damping;
    }
}

static void fill_matrix(const struct cs_touch *touch, const struct cs_matrix *matrix,
                        const struct cs_cover_point *point, struct cs_pair *place,
                        struct cs_pair_part *part) {
    memset(place->to, 0, sizeof place->to);
    memset(part->of, 0, sizeof part->of);
    memcpy(part->share, point->w, sizeof point->w);
    part->along = 0;
    cs_touch_add_block(touch, matrix, part->of);
}

static void answer_part(const struct job *job, const struct cs_cover_point *point,
                        const struct cs_touch *touch, struct cs_pair_lot *lot,
                        struct cs_pair *place) {
    struct cs_pair_part *part = cs_pair_lot_part(lot);
    if (part && job->ask == ASK_MATRIX)
        fill_matrix(touch, job->matrix, point, place, part);
    else if (part)
        bound(touch, point, part);
}

static void answer_force(const struct job *job, const struct cs_near *near,
                         const struct cs_cover_point *point, const struct cs_touch *touch,
                         struct cs_pair *place) {
    const size_t n = job->covers->system->view.n;
    const struct cs_touch_parts parts = cs_near_parts(job->at.parts);
    double f[3];
    if (job->ask == ASK_CHANGE) {
        double dp[3], dv[3];
        cs_cover_mix(point, n, job->at.dx, dp);
        cs_cover_mix(point, n, job->at.dv, dv);
        const struct cs_touch_move move = cs_near_move(near, dp, dv);
        cs_touch_jvp(touch, parts, &move, f);
    } else {
        cs_touch_force(touch, parts, f);
    }
    give(f, point, place);
}

static void meet(const struct job *job, const struct cs_near *near,
                 const struct cs_cover_point *point, struct cs_pair_lot *lot) {
    const struct cs_system *system = job->covers->system;
    struct cs_touch touch;
    double p[3], v[3];
    cs_cover_mix(point, system->view.n, job->at.x, p);
    cs_cover_mix(point, system->view.n, job->at.v, v);
    if (!cs_near_touches(near, p, v, &touch) || cs_cover_mass(system, point) == HUGE_VAL)
        return;
    if (job->ask == ASK_ENERGY) {
        lot->energy += cs_law_energy(touch.d, touch.range, touch.k);
        return;
    }
    struct cs_pair *place = cs_pair_lot_next(lot);
    if (!place)
        return;
    place->n = point->n;
    memcpy(place->at, point->at, sizeof point->at);
    if (job->ask == ASK_MATRIX || job->ask == ASK_BOUND)
        answer_part(job, point, &touch, lot, place);
    else
        answer_force(job, near, point, &touch, place);
}

/* middle of the box of particles [first, last], and half its diagonal */
static double box_of(const double *x, size_t n, uint32_t first, uint32_t last,
                     double middle[3]) {
    double squared = 0;
    for (size_t c = 0; c < 3; c++) {
        const double *at = x + c * n;
        double low = at[first], high = low;
        for (size_t i = (size_t)first + 1; i <= last; i++) {
            low = at[i] < low ? at[i] : low;
            high = at[i] > high ? at[i] : high;
        }
        middle[c] = 0.5 * (low + high);
        squared += 0.25 * (high - low) * (high - low);
    }
    return sqrt(squared);
}

/* The same of an item's corners: no point of it is further from the middle. */
static double reach_of(const struct cs_cover_lot *lot, uint32_t item, size_t n, const double *x,
                       double middle[3]) {
    const uint32_t *at = lot->corners + (size_t)lot->each * item;
    double squared = 0;
    for (size_t c = 0; c < 3; c++) {
        double low = x[c * n + at[0]], high = low;
        for (uint32_t k = 1; k < lot->each; k++) {
            const double p = x[c * n + at[k]];
            low = p < low ? p : low;
            high = p > high ? p : high;
        }
        middle[c] = 0.5 * (low + high);
        squared += 0.25 * (high - low) * (high - low);
    }
    return sqrt(squared);
}

static void do_lot(void *arg, uint32_t number) {
    const struct job *job = arg;
    const struct cs_cover_lot *lot = job->covers->lots + number;
    const struct cs_near *near = job->covers->near + lot->collider;
    const size_t n = job->covers->system->view.n;
    struct cs_pair_lot *found = job->set->lots + number;
    double middle[3];
    cs_pair_lot_clear(found);
    const double all = box_of(job->at.x, n, lot->first, lot->last, middle);
    if (!cs_obstacle_is_near(&near->pose, near->pairing.range + all, middle))
        return;
    for (uint32_t i = lot->begin; i < lot->end; i++) {
        struct cs_cover_point point;
        if (!lot->parts[i - lot->begin])
            continue;
        const double reach = near->pairing.range + reach_of(lot, i, n, job->at.x, middle);
        if (cs_obstacle_is_near(&near->pose, reach, middle))
            for (cs_cover_start(lot, i, &point); cs_cover_next(&point);)
                meet(job, near, &point, found);
    }
}

static void do_lots(struct job *job) {
    const struct cs_system *system = job->covers->system;
    for (uint32_t c = 0; c < system->scene->colliders.n; c++)
        cs_near_at(system, c, job->at.t, job->covers->near + c);
    cs_pool_run(job->covers->n_lots, do_lot, job);
    cs_pair_set_count(job->set);
}

void cs_covers_set(struct cs_covers *covers, const struct cs_eval *at) {
    struct job job = {.covers = covers,
                      .set = &covers->now,
                      .ask = at->dx || at->dv ? ASK_CHANGE : ASK_FORCE,
                      .at = *at};
    do_lots(&job);
    cs_pair_set_gather(&covers->now);
}

double cs_covers_energy(struct cs_covers *covers, const struct cs_eval *at) {
    struct job job = {.covers = covers, .set = &covers->now, .ask = ASK_ENERGY, .at = *at};
    do_lots(&job);
    return cs_pair_set_energy(&covers->now);
}

void cs_covers_set_matrix(struct cs_covers *covers, const struct cs_matrix *matrix, bool kept) {
    struct cs_pair_set *set = kept ? &covers->matrix : &covers->now;
    struct job job = {
        .covers = covers,
        .set = set,
        .ask = ASK_MATRIX,
        .at = {.t = matrix->t, .x = matrix->x, .v = matrix->v, .parts = CS_PART_ALL},
        .matrix = matrix};
    set->alone = !kept && matrix->bound;
    do_lots(&job);
    cs_pair_set_gather(set);
    covers->blocks = set;
}

void cs_covers_add_bound(struct cs_covers *covers, const struct cs_eval *at, double *stiffness,
                         double *damping) {
    struct job job = {.covers = covers, .set = &covers->now, .ask = ASK_BOUND, .at = *at};
    do_lots(&job);
    cs_pair_set_add_bound(&covers->now, stiffness, damping);
}

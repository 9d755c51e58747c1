/* What is asked of the pairs: the list made good, and those in range answered. */
#include "model/pair/pairs.h"

#include "model/contact/points.h"
#include "model/pair/close.h"
#include "model/pair/narrow.h"

/* false: no memory */
static bool find(struct cs_pairs *pairs, const double *x) {
    return cs_close_find(&pairs->search, x) &&
           (cs_active_is_there(&pairs->active) || cs_active_find(&pairs->active, x));
}

static void run(struct cs_pairs *pairs, struct cs_narrow *narrow) {
    const struct cs_eval *at = &narrow->at;
    narrow->active = &pairs->active;
    narrow->x = cs_points_places(pairs->system, CS_POINTS_BEGIN, at->t, at->x);
    narrow->v = cs_points_velocities(pairs->system, at->t, at->v);
    cs_meetings_rub(pairs->system, &pairs->meetings);
    if (find(pairs, narrow->x)) {
        cs_narrow_run(narrow);
        return;
    }
    narrow->set->failed = true;
    cs_pair_set_count(narrow->set);
}

void cs_pairs_set(struct cs_pairs *pairs, const struct cs_eval *at) {
    struct cs_narrow narrow = {.set = &pairs->now,
                               .ask = at->dx || at->dv ? CS_PAIR_CHANGE : CS_PAIR_FORCE,
                               .at = *at};
    run(pairs, &narrow);
    cs_pair_set_gather(&pairs->now);
}

double cs_pairs_energy(struct cs_pairs *pairs, const struct cs_eval *at) {
    struct cs_narrow narrow = {.set = &pairs->now, .ask = CS_PAIR_ENERGY, .at = *at};
    run(pairs, &narrow);
    return cs_pair_set_energy(&pairs->now);
}

void cs_pairs_set_matrix(struct cs_pairs *pairs, const struct cs_matrix *matrix, bool kept) {
    struct cs_pair_set *set = kept ? &pairs->matrix : &pairs->now;
    struct cs_narrow narrow = {
        .set = set,
        .ask = CS_PAIR_MATRIX,
        .at = {.t = matrix->t, .x = matrix->x, .v = matrix->v, .parts = CS_PART_ALL},
        .matrix = matrix};
    set->exact = !matrix->psd;
    set->alone = !kept && matrix->bound;
    run(pairs, &narrow);
    cs_pair_set_gather(set);
    pairs->blocks = set;
    if (kept && !set->exact && !cs_product_set(&pairs->product)) {
        set->failed = true;
        set->n = 0;
    }
}

void cs_pairs_multiply(const struct cs_pairs *pairs, const double *p, double *y) {
    if (pairs->matrix.exact)
        cs_pair_set_multiply(&pairs->matrix, p, y);
    else
        cs_product_add(&pairs->product, p, y);
}

void cs_pairs_add_bound(struct cs_pairs *pairs, const struct cs_eval *at, double *stiffness,
                        double *damping) {
    struct cs_narrow narrow = {.set = &pairs->now, .ask = CS_PAIR_BOUND, .at = *at};
    run(pairs, &narrow);
    cs_pair_set_add_bound(&pairs->now, stiffness, damping);
}

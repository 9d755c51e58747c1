/* What is asked of the pairs: the list made good, and those in range answered. */
#include "model/pair/pairs.h"

#include "model/contact/points.h"
#include "model/pair/close.h"
#include "model/pair/narrow.h"

/* those of the close pairs if they are there, else in the list that no product needs; NULL: no
 * memory */
static struct cs_active *find(struct cs_pairs *pairs, const double *x) {
    if (!cs_close_find(&pairs->search, x))
        return NULL;
    for (int k = 0; k < 2; k++)
        if (cs_active_is_there(pairs->lists + k))
            return pairs->lists + k;
    struct cs_active *active = pairs->lists + (pairs->kept.active == pairs->lists);
    return cs_active_find(active, x) ? active : NULL;
}

/* false: no memory */
static bool answer(struct cs_pairs *pairs, struct cs_narrow *narrow) {
    const struct cs_eval *at = &narrow->at;
    narrow->x = cs_points_places(pairs->system, CS_POINTS_BEGIN, at->t, at->x);
    narrow->v = cs_points_velocities(pairs->system, at->t, at->v);
    cs_meetings_rub(pairs->system, &pairs->meetings);
    narrow->active = find(pairs, narrow->x);
    if (!narrow->active)
        return false;
    pairs->now = narrow->active;
    if (narrow->ask != CS_PAIR_ENERGY && !cs_active_gather(pairs->now))
        return false;
    if (narrow->product &&
        !cs_product_begin(narrow->product, pairs->now,
                          narrow->product == &pairs->other && narrow->matrix->bound))
        return false;
    return cs_narrow_run(narrow);
}

static void run(struct cs_pairs *pairs, struct cs_narrow *narrow) {
    if (answer(pairs, narrow))
        return;
    pairs->failed = true;
    pairs->now->n = 0;
}

void cs_pairs_set(struct cs_pairs *pairs, const struct cs_eval *at) {
    struct cs_narrow narrow = {.ask = at->dx || at->dv ? CS_PAIR_CHANGE : CS_PAIR_FORCE,
                               .at = *at};
    run(pairs, &narrow);
}

void cs_pairs_add(const struct cs_pairs *pairs, size_t begin, size_t end, double *f) {
    const struct cs_gather *gather = &pairs->now->gather;
    if (pairs->now->n)
        cs_gather_add(gather, gather->sums, 3, begin, end, f);
}

double cs_pairs_energy(struct cs_pairs *pairs, const struct cs_eval *at) {
    struct cs_narrow narrow = {.ask = CS_PAIR_ENERGY, .at = *at};
    double sum = 0;
    run(pairs, &narrow);
    for (uint32_t l = 0; l < pairs->search.n_lots && pairs->now->n; l++)
        sum += pairs->now->lots[l].energy;
    return sum;
}

/* --- matrices --- */

static struct cs_pair_set *set_of(struct cs_pairs *pairs, const struct cs_matrix *matrix,
                                  bool kept) {
    struct cs_pair_set *set = kept ? &pairs->exact : &pairs->others;
    set->exact = true;
    set->alone = !kept && matrix->bound;
    return set;
}

void cs_pairs_set_matrix(struct cs_pairs *pairs, const struct cs_matrix *matrix, bool kept) {
    struct cs_narrow narrow = {
        .ask = CS_PAIR_MATRIX,
        .at = {.t = matrix->t, .x = matrix->x, .v = matrix->v, .parts = CS_PART_ALL},
        .matrix = matrix};
    if (matrix->psd)
        narrow.product = kept ? &pairs->kept : &pairs->other;
    else
        narrow.set = set_of(pairs, matrix, kept);
    if (kept)
        pairs->kept.active = NULL;
    run(pairs, &narrow);
    if (kept)
        pairs->blocks = matrix->psd ? CS_PAIRS_KEPT : CS_PAIRS_EXACT;
    else
        pairs->blocks = matrix->psd ? CS_PAIRS_OTHER : CS_PAIRS_OTHERS;
}

void cs_pairs_add_blocks(const struct cs_pairs *pairs, size_t begin, size_t end,
                         double *blocks) {
    if (pairs->failed)
        return;
    if (pairs->blocks == CS_PAIRS_EXACT || pairs->blocks == CS_PAIRS_OTHERS)
        cs_pair_set_add_blocks(pairs->blocks == CS_PAIRS_EXACT ? &pairs->exact : &pairs->others,
                               begin, end, blocks);
    else
        cs_product_add_blocks(pairs->blocks == CS_PAIRS_KEPT ? &pairs->kept : &pairs->other,
                              begin, end, blocks);
}

void cs_pairs_multiply(const struct cs_pairs *pairs, const double *p, double *y) {
    if (pairs->failed)
        return;
    if (pairs->kept.active)
        cs_product_add(&pairs->kept, p, y);
    else
        cs_pair_set_multiply(&pairs->exact, p, y);
}

void cs_pairs_add_bound(struct cs_pairs *pairs, const struct cs_eval *at, double *stiffness,
                        double *damping) {
    struct cs_narrow narrow = {.ask = CS_PAIR_BOUND, .at = *at};
    run(pairs, &narrow);
    const struct cs_gather *gather = &pairs->now->gather;
    const size_t n = pairs->system->view.n;
    if (!pairs->now->n)
        return;
    cs_gather_add(gather, gather->sums, 1, 0, n, stiffness);
    cs_gather_add(gather, gather->sums + gather->n_rows, 1, 0, n, damping);
}

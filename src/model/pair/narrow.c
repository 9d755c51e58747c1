/* Pairs in range of a lot: forces, their changes, energies and shares of a clamped matrix are
 * worked out in lanes, what is asked more seldom one by one. */
#include "model/pair/narrow.h"

#include "base/pool.h"
#include "model/contact/near.h"

#include <string.h>

/* eights that wait for each other: what was just written number by number is not at once read
 * as vectors */
enum { TOGETHER = 4 };

/* One lot at work. */
struct work {
    const struct cs_narrow *narrow;
    enum cs_stencil_kind kind;
    struct cs_pair_lot *lot;
};

/* what an obstacle has no place in is 0 for it */
static void read(const double *from, size_t n, const uint32_t at[4], double to[4][3]) {
    for (size_t k = 0; k < 4; k++)
        for (size_t c = 0; c < 3; c++)
            to[k][c] = from && at[k] < n ? from[c * n + at[k]] : 0;
}

static void read_lane(const double *from, size_t n, const uint32_t at[4], uint32_t lane,
                      double to[4][3][CS_PAIR_LANES]) {
    for (size_t k = 0; k < 4; k++)
        for (size_t c = 0; c < 3; c++)
            to[k][c][lane] = from && at[k] < n ? from[c * n + at[k]] : 0;
}

/* --- one by one --- */

/* beside the share of the pair that was put last */
static void add_turn(const struct work *work, const struct cs_reaction *reaction) {
    struct cs_pair_lot *lot = work->lot;
    struct cs_pair_turn *full = cs_arena_grow(lot->full, &lot->full_room, lot->n, sizeof *full);
    lot->failed = lot->failed || !full;
    if (!full)
        return;
    lot->full = full;
    cs_reaction_turn(reaction, work->narrow->matrix, full + lot->n - 1);
}

static void answer(const struct work *work, const struct cs_reaction *reaction,
                   struct cs_pair *pair, struct cs_pair_part *part) {
    const struct cs_narrow *narrow = work->narrow;
    struct cs_pair_share share;
    if (narrow->ask == CS_PAIR_BOUND) {
        cs_reaction_bound(reaction, part->of, part->share);
        return;
    }
    cs_reaction_matrix(reaction, narrow->matrix, pair->to, &share);
    part->along = share.along;
    memcpy(part->share, share.weight, sizeof share.weight);
    memcpy(part->of, share.of, sizeof share.of);
    add_turn(work, reaction);
}

static void add_alone(const struct work *work, const struct cs_pair_lanes *from,
                      uint32_t lane) {
    const struct cs_narrow *narrow = work->narrow;
    const struct cs_system *system = narrow->active->search->system;
    const struct cs_meeting meeting = {from->range[lane], from->k[lane], from->mu[lane]};
    struct cs_reaction reaction;
    const struct cs_facet_form form = {from->rim[lane], from->off[lane], from->bend[lane]};
    double p[4][3], v[4][3];
    struct cs_pair *pair = cs_pair_lot_next(work->lot);
    struct cs_pair_part *part = pair ? cs_pair_lot_part(work->lot) : NULL;
    if (!part)
        return;
    pair->n = 4;
    memcpy(pair->at, from->at[lane], sizeof pair->at);
    read(narrow->x, system->surfaces->n_points, pair->at, p);
    read(narrow->v, system->surfaces->n_points, pair->at, v);
    cs_reaction_measure(&reaction, work->kind, form, p);
    cs_reaction_set(&reaction, &meeting, &system->scene->contact, v);
    answer(work, &reaction, pair, part);
}

/* --- in lanes --- */

/* distances of facets are known */
static void add_energy(const struct work *work, struct cs_pair_lanes *lanes) {
    if (work->kind == CS_STENCIL_EDGES)
        cs_pair_lanes_measure(work->kind, lanes);
    for (uint32_t l = 0; l < lanes->n; l++)
        work->lot->energy += cs_law_energy(lanes->d[l], lanes->range[l], lanes->k[l]);
}

static void push(const struct work *work, struct cs_pair_lanes *lanes) {
    const struct cs_narrow *narrow = work->narrow;
    const struct cs_pair_law law = {narrow->active->search->system->scene->contact,
                                    cs_near_parts(narrow->at.parts)};
    if (narrow->ask == CS_PAIR_CHANGE)
        cs_pair_lanes_change(work->kind, lanes, &law);
    else
        cs_pair_lanes_push(work->kind, lanes, &law);
    for (uint32_t l = 0; l < lanes->n; l++) {
        struct cs_pair *pair = cs_pair_lot_next(work->lot);
        if (!pair)
            break;
        pair->n = 4;
        memcpy(pair->at, lanes->at[l], sizeof pair->at);
        for (int k = 0; k < 4; k++)
            for (int c = 0; c < 3; c++)
                pair->to[k][c] = lanes->to[k][c][l];
    }
}

static void read_factors(const struct cs_pair_factors *factors, uint32_t lane,
                         struct cs_pair *pair, struct cs_pair_part *part) {
    part->along = factors->along[lane];
    for (int k = 0; k < 4; k++) {
        part->share[k] = factors->weight[k][lane];
        for (int c = 0; c < 3; c++)
            pair->to[k][c] = factors->g[k][c][lane];
    }
    for (int e = 0; e < 6; e++)
        part->of[e] = factors->of[e][lane];
}

static void share(const struct work *work, struct cs_pair_lanes *lanes) {
    const struct cs_narrow *narrow = work->narrow;
    struct cs_pair_factors factors;
    cs_pair_lanes_matrix(work->kind, lanes, &narrow->active->search->system->scene->contact,
                         narrow->matrix, &factors);
    for (uint32_t l = 0; l < lanes->n; l++) {
        struct cs_pair *pair = cs_pair_lot_next(work->lot);
        struct cs_pair_part *part = pair ? cs_pair_lot_part(work->lot) : NULL;
        if (!part)
            break;
        pair->n = 4;
        memcpy(pair->at, lanes->at[l], sizeof pair->at);
        read_factors(&factors, l, pair, part);
    }
}

static void act(const struct work *work, struct cs_pair_lanes *lanes) {
    const struct cs_narrow *narrow = work->narrow;
    if (narrow->ask == CS_PAIR_ENERGY)
        add_energy(work, lanes);
    else if (narrow->ask == CS_PAIR_FORCE || narrow->ask == CS_PAIR_CHANGE)
        push(work, lanes);
    else if (narrow->ask == CS_PAIR_MATRIX && !narrow->set->exact)
        share(work, lanes);
    else
        for (uint32_t l = 0; l < lanes->n; l++)
            add_alone(work, lanes, l);
}

/* --- what is in range --- */

/* The stiffness of a matrix that must not be negative is that of the nearest facet alone;
 * friction and damping are those of all, since methods that are linear in a step take their
 * exact slope from the matrix, unless bounds are asked for. */
static void weigh(const struct cs_narrow *narrow, const struct cs_active_block *from,
                  uint32_t l, struct cs_pair_lanes *lanes) {
    const double tau = narrow->active->search->system->scene->contact.damping;
    const bool positive = narrow->ask == CS_PAIR_MATRIX && narrow->matrix->psd;
    const bool rubs = from->mu[l] + tau > 0 && !(positive && narrow->matrix->bound);
    const double count = positive && !rubs ? from->alone[l] : from->count[l];
    lanes->k[l] = count * from->k[l];
    lanes->stiff[l] = (positive ? from->alone[l] : count) * from->k[l];
}

static void fill(const struct cs_narrow *narrow, const struct cs_active_block *from, uint32_t n,
                 struct cs_pair_lanes *lanes) {
    const struct cs_system *system = narrow->active->search->system;
    const size_t n_points = system->surfaces->n_points;
    lanes->n = n;
    memcpy(lanes->at, from->at, sizeof lanes->at);
    memcpy(lanes->range, from->range, sizeof lanes->range);
    memcpy(lanes->mu, from->mu, sizeof lanes->mu);
    memcpy(lanes->rim, from->rim, sizeof lanes->rim);
    memcpy(lanes->off, from->off, sizeof lanes->off);
    memcpy(lanes->bend, from->bend, sizeof lanes->bend);
    memcpy(lanes->d, from->d, sizeof lanes->d);
    for (uint32_t l = 0; l < n; l++) {
        weigh(narrow, from, l, lanes);
        read_lane(narrow->x, n_points, from->at[l], l, lanes->p);
        if (narrow->ask != CS_PAIR_ENERGY)
            read_lane(narrow->v, n_points, from->at[l], l, lanes->v);
        if (narrow->ask == CS_PAIR_CHANGE) {
            read_lane(narrow->at.dx, system->view.n, from->at[l], l, lanes->dp);
            read_lane(narrow->at.dv, system->view.n, from->at[l], l, lanes->dv);
        }
    }
}

static void do_lot(void *arg, uint32_t number) {
    const struct cs_narrow *narrow = arg;
    const struct cs_active_lot *from = narrow->active->lots + number;
    const struct work work = {narrow, from->kind, narrow->set->lots + number};
    struct cs_pair_lanes lanes[TOGETHER];
    cs_pair_lot_clear(work.lot);
    for (size_t first = 0; first < from->n; first += TOGETHER * CS_PAIR_LANES) {
        uint32_t filled = 0;
        for (size_t k = first; k < from->n && filled < TOGETHER; k += CS_PAIR_LANES) {
            const size_t left = from->n - k;
            fill(narrow, from->blocks + k / CS_PAIR_LANES,
                 left < CS_PAIR_LANES ? (uint32_t)left : CS_PAIR_LANES, lanes + filled++);
        }
        for (uint32_t k = 0; k < filled; k++)
            act(&work, lanes + k);
    }
}

void cs_narrow_run(struct cs_narrow *narrow) {
    cs_pool_run(narrow->set->n_lots, do_lot, narrow);
    cs_pair_set_count(narrow->set);
}

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
    struct cs_active_lot *lot;
    uint32_t number;
    const double *rows; /* what was read of its points; NULL: they are read one by one */
};

/* what an obstacle has no place in is 0 for it */
static void read(const double *from, size_t n, const uint32_t at[4], double to[4][3]) {
    for (size_t k = 0; k < 4; k++)
        for (size_t c = 0; c < 3; c++)
            to[k][c] = from && at[k] < n ? from[c * n + at[k]] : 0;
}

/* three columns of rows */
static void read_lane(const double *rows, size_t width, const uint32_t to[4], uint32_t lane,
                      double out[4][3][CS_PAIR_LANES]) {
    for (size_t k = 0; k < 4; k++)
        for (size_t c = 0; c < 3; c++)
            out[k][c][lane] = rows[to[k] * width + c];
}

/* --- one by one --- */

/* beside the share of the pair that was put last */
static void add_turn(const struct work *work, const struct cs_reaction *reaction) {
    struct cs_pair_lot *lot = work->narrow->set->lots + work->number;
    struct cs_pair_turn *full = cs_arena_grow(lot->full, &lot->full_room, lot->n, sizeof *full);
    lot->failed = lot->failed || !full;
    if (!full)
        return;
    lot->full = full;
    cs_reaction_turn(reaction, work->narrow->matrix, full + lot->n - 1);
}

static void add_alone(const struct work *work, const struct cs_pair_lanes *from, uint32_t lane,
                      const uint32_t at[4]) {
    const struct cs_narrow *narrow = work->narrow;
    const struct cs_system *system = narrow->active->search->system;
    const struct cs_meeting meeting = {from->range[lane], from->k[lane], from->mu[lane]};
    struct cs_reaction reaction;
    struct cs_pair_share share;
    const struct cs_facet_form form = {from->rim[lane], from->off[lane], from->bend[lane]};
    double p[4][3], v[4][3];
    struct cs_pair_lot *lot = narrow->set->lots + work->number;
    struct cs_pair *pair = cs_pair_lot_next(lot);
    struct cs_pair_part *part = pair ? cs_pair_lot_part(lot) : NULL;
    if (!part)
        return;
    pair->n = 4;
    memcpy(pair->at, at, sizeof pair->at);
    read(narrow->x, system->surfaces->n_points, pair->at, p);
    read(narrow->v, system->surfaces->n_points, pair->at, v);
    cs_reaction_measure(&reaction, work->lot->kind, form, p);
    cs_reaction_set(&reaction, &meeting, &system->scene->contact, v);
    cs_reaction_matrix(&reaction, narrow->matrix, pair->to, &share);
    part->along = share.along;
    memcpy(part->share, share.weight, sizeof share.weight);
    memcpy(part->of, share.of, sizeof share.of);
    add_turn(work, &reaction);
}

/* --- in lanes --- */

static void read_places(const struct work *work, struct cs_pair_lanes *lanes, size_t first) {
    const struct cs_narrow *narrow = work->narrow;
    const size_t n = narrow->active->search->system->surfaces->n_points;
    for (uint32_t l = 0; l < lanes->n; l++)
        for (size_t k = 0; k < 4; k++)
            for (size_t c = 0; c < 3; c++)
                lanes->p[k][c][l] = narrow->x[c * n + work->lot->at[first + l][k]];
}

/* distances of facets are known */
static void add_energy(const struct work *work, struct cs_pair_lanes *lanes, size_t first) {
    if (work->lot->kind == CS_STENCIL_EDGES) {
        read_places(work, lanes, first);
        cs_pair_lanes_measure(work->lot->kind, lanes);
    }
    for (uint32_t l = 0; l < lanes->n; l++)
        work->lot->energy += cs_law_energy(lanes->d[l], lanes->range[l], lanes->k[l]);
}

static void push(const struct work *work, struct cs_pair_lanes *lanes) {
    const struct cs_narrow *narrow = work->narrow;
    const struct cs_pair_law law = {narrow->active->search->system->scene->contact,
                                    cs_near_parts(narrow->at.parts)};
    if (narrow->ask == CS_PAIR_CHANGE)
        cs_pair_lanes_change(work->lot->kind, lanes, &law);
    else
        cs_pair_lanes_push(work->lot->kind, lanes, &law);
}

static void add_pushes(const struct work *work, const struct cs_pair_lanes *lanes,
                       size_t first) {
    const struct cs_gather *gather = &work->narrow->active->gather;
    uint32_t(*to)[4] = work->lot->to + first;
    double *sums = cs_gather_of(gather->lots + work->number, gather->sums, 3);
    for (uint32_t l = 0; l < lanes->n; l++)
        for (int k = 0; k < 4; k++)
            for (int c = 0; c < 3; c++)
                sums[3 * (size_t)to[l][k] + (size_t)c] += lanes->to[k][c][l];
}

static void share(const struct work *work, struct cs_pair_lanes *lanes, size_t first) {
    const struct cs_narrow *narrow = work->narrow;
    cs_pair_lanes_matrix(work->lot->kind, lanes,
                         &narrow->active->search->system->scene->contact, narrow->matrix,
                         narrow->product->lots[work->number].factors + first / CS_PAIR_LANES);
}

/* stiffness in the first number of each row, damping in as many behind them all */
static void add_bounds(const struct work *work, struct cs_pair_lanes *lanes, size_t first) {
    const struct cs_active *active = work->narrow->active;
    const struct cs_gather *gather = &active->gather;
    uint32_t(*to)[4] = work->lot->to + first;
    double *sums = cs_gather_of(gather->lots + work->number, gather->sums, 1);
    struct cs_pair_bounds bounds;
    cs_pair_lanes_bound(work->lot->kind, lanes, &active->search->system->scene->contact,
                        &bounds);
    for (uint32_t l = 0; l < lanes->n; l++)
        for (int k = 0; k < 4; k++) {
            sums[to[l][k]] += bounds.stiffness[k][l];
            sums[gather->n_rows + to[l][k]] += bounds.damping[k][l];
        }
}

static bool is_force(const struct cs_narrow *narrow) {
    return narrow->ask == CS_PAIR_FORCE || narrow->ask == CS_PAIR_CHANGE;
}

static bool is_in_set(const struct cs_narrow *narrow) {
    return narrow->ask == CS_PAIR_MATRIX && !narrow->matrix->psd;
}

static bool has_rows(const struct cs_narrow *narrow) {
    return narrow->ask != CS_PAIR_ENERGY && !is_in_set(narrow);
}

/* pairs from `first` on */
static void act(const struct work *work, struct cs_pair_lanes *lanes, size_t first) {
    if (work->narrow->ask == CS_PAIR_ENERGY)
        add_energy(work, lanes, first);
    else if (is_force(work->narrow))
        push(work, lanes);
    else if (work->narrow->ask == CS_PAIR_BOUND)
        add_bounds(work, lanes, first);
    else if (!is_in_set(work->narrow))
        share(work, lanes, first);
    else
        for (uint32_t l = 0; l < lanes->n; l++)
            add_alone(work, lanes, l, work->lot->at[first + l]);
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

static void fill(const struct cs_narrow *narrow, const struct cs_active_block *from,
                 struct cs_pair_lanes *lanes) {
    memcpy(lanes->range, from->range, sizeof lanes->range);
    memcpy(lanes->mu, from->mu, sizeof lanes->mu);
    memcpy(lanes->rim, from->rim, sizeof lanes->rim);
    memcpy(lanes->off, from->off, sizeof lanes->off);
    memcpy(lanes->bend, from->bend, sizeof lanes->bend);
    memcpy(lanes->d, from->d, sizeof lanes->d);
    for (uint32_t l = 0; l < lanes->n; l++)
        weigh(narrow, from, l, lanes);
}

/* where the lanes' points are, and what they do: x, v, and changes */
static void fill_points(const struct work *work, size_t first, struct cs_pair_lanes *lanes) {
    const size_t width = work->narrow->active->gather.width;
    uint32_t(*to)[4] = work->lot->to + first;
    for (uint32_t l = 0; l < lanes->n; l++) {
        read_lane(work->rows, width, to[l], l, lanes->p);
        read_lane(work->rows + 3, width, to[l], l, lanes->v);
        if (work->narrow->ask == CS_PAIR_CHANGE) {
            read_lane(work->rows + 6, width, to[l], l, lanes->dp);
            read_lane(work->rows + 9, width, to[l], l, lanes->dv);
        }
    }
}

/* step by step, for the sake of stores and loads; pairs from `first` on */
static void do_some(const struct work *work, size_t first) {
    struct cs_pair_lanes lanes[TOGETHER];
    const size_t left = work->lot->n - first, most = TOGETHER * CS_PAIR_LANES;
    const size_t end = left < most ? left : most;
    for (size_t p = 0; p < end; p += CS_PAIR_LANES) {
        struct cs_pair_lanes *at = lanes + p / CS_PAIR_LANES;
        at->n = end - p < CS_PAIR_LANES ? (uint32_t)(end - p) : CS_PAIR_LANES;
        fill(work->narrow, work->lot->blocks + (first + p) / CS_PAIR_LANES, at);
        if (work->rows)
            fill_points(work, first + p, at);
    }
    for (size_t p = 0; p < end; p += CS_PAIR_LANES)
        act(work, lanes + p / CS_PAIR_LANES, first + p);
    for (size_t p = 0; p < end && is_force(work->narrow); p += CS_PAIR_LANES)
        add_pushes(work, lanes + p / CS_PAIR_LANES, first + p);
}

/* of one lot's rows */
static void clear_sums(const struct cs_narrow *narrow, const struct cs_gather_lot *rows) {
    const struct cs_gather *gather = &narrow->active->gather;
    if (is_force(narrow)) {
        memset(cs_gather_of(rows, gather->sums, 3), 0, 3 * sizeof(double) * rows->n);
    } else if (narrow->ask == CS_PAIR_BOUND) {
        double *stiffness = cs_gather_of(rows, gather->sums, 1);
        memset(stiffness, 0, sizeof *stiffness * rows->n);
        memset(stiffness + gather->n_rows, 0, sizeof *stiffness * rows->n);
    }
}

/* false: there is nothing to do */
static bool begin(const struct work *work) {
    const struct cs_narrow *narrow = work->narrow;
    const struct cs_gather *gather = &narrow->active->gather;
    const struct cs_gather_lot *rows = gather->lots + work->number;
    work->lot->energy = 0;
    if (is_in_set(narrow))
        cs_pair_lot_clear(narrow->set->lots + work->number);
    if (!work->lot->n)
        return false;
    clear_sums(narrow, rows);
    return narrow->ask != CS_PAIR_MATRIX || is_in_set(narrow) ||
           cs_product_lot_begin(narrow->product, work->number);
}

/* all that is needed of the lot's points */
static const double *read_rows(const struct cs_narrow *narrow, uint32_t number) {
    const struct cs_system *system = narrow->active->search->system;
    const struct cs_gather *gather = &narrow->active->gather;
    const size_t n = system->view.n, n_points = system->surfaces->n_points;
    cs_gather_read(gather, number, 3, narrow->v, n_points);
    if (narrow->ask == CS_PAIR_CHANGE) {
        cs_gather_read(gather, number, 6, narrow->at.dx, n);
        cs_gather_read(gather, number, 9, narrow->at.dv, n);
    }
    return cs_gather_read(gather, number, 0, narrow->x, n_points);
}

static void do_lot(void *arg, uint32_t number) {
    const struct cs_narrow *narrow = arg;
    struct work work = {narrow, narrow->active->lots + number, number, NULL};
    if (!begin(&work))
        return;
    if (has_rows(narrow))
        work.rows = read_rows(narrow, number);
    for (size_t p = 0; p < work.lot->n; p += TOGETHER * CS_PAIR_LANES)
        do_some(&work, p);
    if (narrow->ask == CS_PAIR_MATRIX && !is_in_set(narrow))
        cs_product_lot_end(narrow->product, number);
}

bool cs_narrow_run(struct cs_narrow *narrow) {
    const size_t width = narrow->ask == CS_PAIR_CHANGE ? 12 : 6;
    if (has_rows(narrow) && !cs_gather_take(&narrow->active->gather, width))
        return false;
    cs_pool_run(narrow->active->search->n_lots, do_lot, narrow);
    if (is_in_set(narrow)) {
        cs_pair_set_count(narrow->set);
        cs_pair_set_gather(narrow->set);
        return !narrow->set->failed;
    }
    return narrow->ask != CS_PAIR_MATRIX || cs_product_end(narrow->product);
}

/* Pairs in range of a lot: forces, their changes, energies and shares of a clamped matrix are
 * worked out in lanes, what is asked more seldom one by one. */
#include "model/pair/narrow.h"

#include "base/pool.h"
#include "model/contact/near.h"
#include "model/contact/points.h"

#include <string.h>

/* eights that wait for each other: what was just written number by number is not at once read
 * as vectors */
enum { TOGETHER = 4 };

/* One lot at work. */
struct work {
    const struct cs_narrow *narrow;
    enum cs_stencil_kind kind;
    struct cs_pair_lot *lot;
    struct cs_pair_lanes lanes[TOGETHER];
    uint32_t filling; /* of them */
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

/* what cannot move feels nothing, and holds nothing */
static bool is_fixed(const struct cs_system *system, const uint32_t at[4]) {
    bool fixed = true;
    for (int k = 0; k < 4; k++)
        fixed = fixed && cs_points_inverse_mass(system, at[k]) == 0;
    return fixed;
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
    const struct cs_system *system = narrow->search->system;
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
    const struct cs_pair_law law = {narrow->search->system->scene->contact,
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
    cs_pair_lanes_matrix(work->kind, lanes, &narrow->search->system->scene->contact,
                         narrow->matrix, &factors);
    for (uint32_t l = 0; l < lanes->n; l++) {
        struct cs_pair *pair = cs_pair_lot_next(work->lot);
        struct cs_pair_part *part = pair ? cs_pair_lot_part(work->lot) : NULL;
        if (!part)
            break;
        pair->n = 4;
        memcpy(pair->at, lanes->at[l], sizeof pair->at);
        read_factors(&factors, l, pair, part);
        part->along *= lanes->stiff[l];
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

static void empty(struct work *work) {
    for (uint32_t k = 0; k < TOGETHER; k++)
        work->lanes[k].n = 0;
    work->filling = 0;
}

static void act_on_all(struct work *work) {
    for (uint32_t k = 0; k < TOGETHER; k++)
        if (work->lanes[k].n)
            act(work, work->lanes + k);
    empty(work);
}

/* --- what is in range --- */

static struct cs_meeting meeting_of(const struct cs_search *search, const uint32_t at[4]) {
    return *cs_meeting_of(search->meetings, search->body[at[0]], search->body[at[2]]);
}

/* two edges, or a point and a facet */
static void put(struct work *work, const uint32_t at[4], const struct cs_meeting *meeting,
                const struct cs_facet_use *use) {
    const struct cs_narrow *narrow = work->narrow;
    const struct cs_system *system = narrow->search->system;
    const size_t n = system->view.n, n_points = system->surfaces->n_points;
    struct cs_pair_lanes *lanes = work->lanes + work->filling;
    const uint32_t l = lanes->n;
    memcpy(lanes->at[l], at, sizeof lanes->at[l]);
    lanes->range[l] = meeting->range;
    lanes->k[l] = meeting->k;
    lanes->mu[l] = meeting->mu;
    lanes->d[l] = use->d;
    lanes->rim[l] = use->form.rim;
    lanes->off[l] = use->form.off;
    lanes->bend[l] = use->form.e;
    lanes->stiff[l] = use->alone;
    read_lane(narrow->x, n_points, at, l, lanes->p);
    if (narrow->ask != CS_PAIR_ENERGY)
        read_lane(narrow->v, n_points, at, l, lanes->v);
    if (narrow->ask == CS_PAIR_CHANGE) {
        read_lane(narrow->at.dx, n, at, l, lanes->dp);
        read_lane(narrow->at.dv, n, at, l, lanes->dv);
    }
    if (++lanes->n == CS_PAIR_LANES && ++work->filling == TOGETHER)
        act_on_all(work);
}

/* For a matrix that must not be negative: stiffness of the nearest facet alone; friction and
 * damping of all, since methods that are linear in a step take their exact slope from the
 * matrix, unless bounds are asked for. */
static void make_positive(const struct cs_narrow *narrow, double mu, struct cs_facet_use *use) {
    const double tau = narrow->search->system->scene->contact.damping;
    const bool rubs = mu + tau > 0 && !narrow->matrix->bound;
    use->alone /= rubs ? use->count : 1;
    use->count = rubs ? use->count : use->alone;
    use->alone = rubs ? use->alone : 1;
}

/* a point and a triangle: facet by facet */
static void take_facets(struct work *work, const uint32_t at[4], uint32_t triangle) {
    const struct cs_narrow *narrow = work->narrow;
    const uint32_t *body = narrow->search->body;
    const struct cs_meeting whole = meeting_of(narrow->search, at);
    const bool positive = narrow->ask == CS_PAIR_MATRIX && narrow->matrix->psd;
    const struct cs_facets_pair pair = {.at = {at[0], at[1], at[2], at[3]},
                                        .triangle = triangle,
                                        .own = body[at[0]] == body[at[1]],
                                        .range = whole.range};
    struct cs_facet_use uses[CS_FACETS];
    const uint32_t n = cs_facets_find(narrow->facets, &pair, narrow->x, uses);
    for (uint32_t k = 0; k < n; k++) {
        if (positive)
            make_positive(narrow, whole.mu, uses + k);
        else
            uses[k].alone = 1;
        const struct cs_meeting meeting = {CS_FACET_WITHIN * whole.range,
                                           uses[k].count * whole.k, whole.mu};
        if (uses[k].count != 0)
            put(work, uses[k].at, &meeting, uses + k);
    }
}

static void take(struct work *work, const uint32_t pair[2]) {
    const struct cs_search *search = work->narrow->search;
    uint32_t at[4];
    cs_search_corners(search->system->surfaces, work->kind, pair, at);
    if (is_fixed(search->system, at))
        return;
    if (work->kind == CS_STENCIL_EDGES) {
        struct cs_meeting meeting = meeting_of(search, at);
        meeting.range *= CS_MEETING_EDGES;
        put(work, at, &meeting, &(struct cs_facet_use){.alone = 1});
    } else {
        take_facets(work, at, pair[1]);
    }
}

static void do_lot(void *arg, uint32_t number) {
    const struct cs_narrow *narrow = arg;
    const struct cs_search_lot *from = narrow->search->lots + number;
    struct work work;
    work.narrow = narrow;
    work.kind = from->kind;
    work.lot = narrow->set->lots + number;
    empty(&work);
    cs_pair_lot_clear(work.lot);
    for (size_t k = 0; k < from->n_close; k++)
        take(&work, from->close + 2 * k);
    act_on_all(&work);
}

void cs_narrow_run(struct cs_narrow *narrow) {
    cs_pool_run(narrow->set->n_lots, do_lot, narrow);
    cs_pair_set_count(narrow->set);
}

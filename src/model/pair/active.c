/* From close pairs to what is in range of them. */
#include "model/pair/active.h"

#include "base/pool.h"
#include "model/contact/points.h"

#include <stdlib.h>
#include <string.h>

static void finish(void *object) {
    struct cs_active *active = object;
    for (uint32_t l = 0; l < active->search->n_lots; l++)
        free(active->lots[l].blocks), free(active->lots[l].felt), free(active->lots[l].at),
            free(active->lots[l].to);
}

enum cs_status cs_active_init(struct cs_active *active, const struct cs_search *search,
                              const struct cs_facets *facets, struct cs_arena *arena,
                              struct cs_error *error) {
    *active = (struct cs_active){.search = search, .facets = facets};
    active->lots = cs_arena_take_n(arena, search->n_lots, sizeof *active->lots, error);
    if (!error->status)
        cs_arena_own(arena, finish, active, error);
    return error->status ? error->status
                         : cs_gather_init(&active->gather, search->n_lots,
                                          search->system->view.n, arena, error);
}

/* One lot at work. */
struct work {
    const struct cs_active *active;
    const double *x;
    struct cs_active_lot *lot;
    struct cs_facets_pair pairs[CS_FACETS_PAIRS]; /* that wait for each other */
    uint32_t waiting, n_felt;
};

static struct cs_meeting meeting_of(const struct cs_search *search, const uint32_t at[4]) {
    return *cs_meeting_of(search->meetings, search->body[at[0]], search->body[at[2]]);
}

/* a place for one pair more; NULL: no memory */
static struct cs_active_block *next(struct cs_active_lot *lot) {
    const size_t n_blocks = lot->n / CS_PAIR_LANES + 1;
    struct cs_active_block *blocks =
        cs_arena_grow(lot->blocks, &lot->room, n_blocks, sizeof *blocks);
    lot->blocks = blocks ? blocks : lot->blocks;
    uint32_t(*at)[4] = cs_arena_grow(lot->at, &lot->at_room, lot->n + 1, sizeof *at);
    lot->at = at ? at : lot->at;
    lot->failed = lot->failed || !blocks || !at;
    return blocks && at ? blocks + lot->n / CS_PAIR_LANES : NULL;
}

static void put(const struct work *work, const struct cs_facet_use *use, double share) {
    struct cs_active_lot *lot = work->lot;
    const struct cs_meeting meeting = meeting_of(work->active->search, use->at);
    struct cs_active_block *to = next(lot);
    const size_t l = lot->n % CS_PAIR_LANES;
    if (!to)
        return;
    memcpy(lot->at + lot->n++, use->at, sizeof *lot->at);
    to->range[l] = share * meeting.range;
    to->k[l] = meeting.k;
    to->mu[l] = meeting.mu;
    to->count[l] = use->count;
    to->alone[l] = use->alone;
    to->rim[l] = use->form.rim;
    to->off[l] = use->form.off;
    to->bend[l] = use->form.e;
    to->d[l] = use->d;
}

/* --- points and triangles --- */

/* the point that was at work has no more triangles */
static void leave_point(struct work *work) {
    for (uint32_t k = 0; k < work->n_felt; k++)
        if (cs_facets_counts(work->lot->felt + k))
            put(work, work->lot->felt + k, CS_FACET_WITHIN);
    work->n_felt = 0;
}

/* n uses of one point */
static void feel(struct work *work, const struct cs_facet_use *uses, uint32_t n) {
    struct cs_active_lot *lot = work->lot;
    if (work->n_felt && lot->felt->at[0] != uses->at[0])
        leave_point(work);
    struct cs_facet_use *felt =
        cs_arena_grow(lot->felt, &lot->felt_room, (size_t)work->n_felt + n, sizeof *felt);
    lot->failed = lot->failed || !felt;
    if (!felt)
        return;
    lot->felt = felt;
    memcpy(felt + work->n_felt, uses, n * sizeof *uses);
    work->n_felt = cs_facets_join(felt, work->n_felt, n);
}

static void find_facets(struct work *work) {
    struct cs_facet_use uses[CS_FACETS * CS_FACETS_PAIRS];
    const uint32_t n =
        cs_facets_find(work->active->facets, work->pairs, work->waiting, work->x, uses);
    for (uint32_t k = 0, end; k < n; k = end) {
        end = k + 1;
        while (end < n && uses[end].at[0] == uses[k].at[0])
            end++;
        feel(work, uses + k, end - k);
    }
    work->waiting = 0;
}

static void wait(struct work *work, const uint32_t at[4], uint32_t triangle) {
    const struct cs_search *search = work->active->search;
    struct cs_facets_pair *pair = work->pairs + work->waiting++;
    memcpy(pair->at, at, sizeof pair->at);
    pair->triangle = triangle;
    pair->own = search->body[at[0]] == search->body[at[1]];
    pair->range = meeting_of(search, at).range;
    if (work->waiting == CS_FACETS_PAIRS)
        find_facets(work);
}

/* --- both kinds --- */

/* what cannot move feels nothing, and holds nothing */
static bool is_fixed(const struct cs_system *system, const uint32_t at[4]) {
    bool fixed = true;
    for (int k = 0; k < 4; k++)
        fixed = fixed && cs_points_inverse_mass(system, at[k]) == 0;
    return fixed;
}

static void take(struct work *work, const uint32_t pair[2]) {
    const struct cs_search *search = work->active->search;
    struct cs_facet_use edges = {.count = 1, .alone = 1};
    cs_search_corners(search->system->surfaces, work->lot->kind, pair, edges.at);
    if (is_fixed(search->system, edges.at))
        return;
    if (work->lot->kind == CS_STENCIL_EDGES)
        put(work, &edges, CS_MEETING_EDGES);
    else
        wait(work, edges.at, pair[1]);
}

struct job {
    struct cs_active *active;
    const double *x;
};

static void find_lot(void *arg, uint32_t number) {
    const struct job *job = arg;
    const struct cs_search_lot *from = job->active->search->lots + number;
    struct work work;
    work.active = job->active;
    work.x = job->x;
    work.lot = job->active->lots + number;
    work.waiting = work.n_felt = 0;
    work.lot->kind = from->kind;
    work.lot->n = 0;
    work.lot->failed = false;
    for (size_t k = 0; k < from->n_close; k++)
        take(&work, from->close + 2 * k);
    find_facets(&work);
    leave_point(&work);
}

bool cs_active_is_there(const struct cs_active *active) {
    return active->found == active->search->found &&
           active->rubbed == active->search->meetings->rubbed;
}

bool cs_active_find(struct cs_active *active, const double *x) {
    struct job job = {active, x};
    bool failed = false;
    cs_pool_run(active->search->n_lots, find_lot, &job);
    active->n = 0;
    active->gathered = false;
    for (uint32_t l = 0; l < active->search->n_lots; l++) {
        active->n += active->lots[l].n;
        failed = failed || active->lots[l].failed;
    }
    active->found = failed ? 0 : active->search->found;
    active->rubbed = active->search->meetings->rubbed;
    return !failed;
}

static void number_lot(void *arg, uint32_t number) {
    struct cs_active *active = arg;
    struct cs_active_lot *lot = active->lots + number;
    struct cs_gather_lot *rows = active->gather.lots + number;
    uint32_t(*to)[4] = cs_arena_grow(lot->to, &lot->to_room, lot->n, sizeof *to);
    cs_gather_clear(rows);
    rows->failed = lot->n && !to;
    lot->to = to ? to : lot->to;
    // neighbours in the list have points in common
    for (size_t p = 0; p < lot->n && !rows->failed; p++)
        for (int k = 0; k < 4; k++)
            to[p][k] = p && lot->at[p][k] == lot->at[p - 1][k]
                           ? to[p - 1][k]
                           : cs_gather_row(rows, lot->at[p][k]);
}

bool cs_active_gather(struct cs_active *active) {
    if (!active->gathered) {
        cs_pool_run(active->search->n_lots, number_lot, active);
        active->gathered = cs_gather_set(&active->gather);
    }
    return active->gathered;
}

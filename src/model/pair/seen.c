/* The energy of pairs that a step does not see, pair by pair. */
#include "model/pair/seen.h"

#include "base/pool.h"
#include "model/contact/points.h"
#include "model/pair/way.h"

#include <string.h>

/* points of one move, at most */
enum { POINTS_MOST = 64 };
/* pairs that are sieved at a time */
enum { SOME = 256 };
#define NONE UINT32_MAX

struct job {
    struct cs_pairs *pairs;
    double h;        /* s */
    uint32_t unseen; /* a lot that has a pair that goes unseen; NONE */
};

/* One lot at work: ways wait until they are asked about together. */
struct work {
    const struct job *job;
    enum cs_stencil_kind kind;
    struct cs_way_lanes lanes;
    uint32_t waiting;
    bool unseen;
};

/* d (points + 1, and up to a lane less than CS_PAIR_LANES behind) = the smooth distances at the
 * start and at `points` places of the way, the last of them its end; returns whether one is
 * within range */
static bool measure(struct cs_way *way, int points, double range, double *d) {
    struct cs_pair_lanes lanes;
    bool near = false;
    for (int first = 0; first <= points; first += CS_PAIR_LANES) {
        double share[CS_PAIR_LANES];
        for (int l = 0; l < CS_PAIR_LANES; l++)
            share[l] = (first + l) / (double)points;
        for (int k = 0; k < 12; k++)
            for (int l = 0; l < CS_PAIR_LANES; l++)
                lanes.p[k / 3][k % 3][l] =
                    way->from[k / 3][k % 3] + share[l] * way->move[k / 3][k % 3];
        cs_pair_lanes_measure(way->kind, &lanes);
        memcpy(d + first, lanes.d, sizeof lanes.d);
    }
    for (int j = 0; j <= points; j++)
        near = near || d[j] < range;
    return near;
}

/* a way of any length */
static bool is_unseen(const struct job *job, struct cs_way *way, double range, double k) {
    const double along = cs_way_points(cs_way_longest(way), range);
    const int points = along < POINTS_MOST ? 1 + (int)along : POINTS_MOST;
    double d[POINTS_MOST + CS_PAIR_LANES], unseen = 0;
    struct cs_stencil at;
    struct cs_way_start start;
    if (!measure(way, points, range, d))
        return false;
    cs_stencil_set(&at, way->kind, way->from);
    cs_way_begin(way, &at, job->h, range, k, &start);
    for (int j = 1; j <= points; j++)
        unseen = fmax(unseen, cs_way_unseen(&start, j / (double)points, d[j], range, k));
    return unseen > CS_SHARE_UNSEEN * start.has;
}

static bool is_lane_unseen(const struct work *work, uint32_t l) {
    const struct cs_way_lanes *lanes = &work->lanes;
    struct cs_way way = {.kind = work->kind};
    if (lanes->answer[l] < 2)
        return lanes->answer[l] > 0;
    for (int k = 0; k < 4; k++) {
        way.inverse_mass[k] = lanes->inverse_mass[k][l];
        for (int c = 0; c < 3; c++) {
            way.from[k][c] = lanes->from[k][c][l];
            way.move[k][c] = lanes->move[k][c][l];
        }
    }
    return is_unseen(work->job, &way, lanes->range[l], lanes->k[l]);
}

static void ask(struct work *work) {
    if (work->waiting)
        cs_way_lanes_ask(work->kind, &work->lanes, work->job->h);
    for (uint32_t l = 0; l < work->waiting; l++)
        work->unseen = work->unseen || is_lane_unseen(work, l);
    work->waiting = 0;
}

/* the pair waits for others of its kind */
static void take(struct work *work, const uint32_t pair[2]) {
    const struct cs_pairs *pairs = work->job->pairs;
    const struct cs_search *search = &pairs->search;
    struct cs_way_lanes *lanes = &work->lanes;
    const uint32_t l = work->waiting;
    uint32_t at[4];
    cs_search_corners(pairs->system->surfaces, work->kind, pair, at);
    const struct cs_meeting *meeting =
        cs_meeting_of(&pairs->meetings, search->body[at[0]], search->body[at[2]]);
    lanes->range[l] = cs_meeting_range(meeting, work->kind == CS_STENCIL_EDGES);
    lanes->k[l] = meeting->k;
    for (size_t k = 0; k < 4; k++) {
        const double *move = pairs->moves[at[k]].of;
        lanes->inverse_mass[k][l] = move[CS_POINT_MOVE_INVERSE_MASS];
        for (size_t c = 0; c < 3; c++) {
            lanes->from[k][c][l] = move[CS_POINT_MOVE_FROM + c];
            lanes->move[k][c][l] = move[CS_POINT_MOVE_BY + c];
        }
    }
    if (++work->waiting == CS_WAY_LANES)
        ask(work);
}

/* of a lot, those pairs that may come into range */
static void ask_lot(struct work *work, const struct cs_search_lot *lot) {
    const struct cs_pairs *pairs = work->job->pairs;
    const bool edges = lot->kind == CS_STENCIL_EDGES;
    const struct cs_meeting widest = {.range = pairs->meetings.widest};
    const double reach = cs_meeting_range(&widest, edges) * (1 + 1e-9);
    uint32_t some[SOME][2];
    struct cs_point_moves_pairs items = {.surfaces = pairs->system->surfaces, .edges = edges};
    for (size_t p = 0; p < lot->n && !work->unseen; p += SOME) {
        items.items = lot->pairs + 2 * p;
        items.n = lot->n - p < SOME ? lot->n - p : SOME;
        const size_t n = cs_point_moves_sieve(pairs->moves, &items, reach, some[0]);
        for (size_t k = 0; k < n && !work->unseen; k++)
            take(work, some[k]);
    }
    ask(work);
}

static void find_unseen(void *arg, uint32_t number) {
    struct job *job = arg;
    const struct cs_search *search = &job->pairs->search;
    // the one that was unseen before may well be so again
    const uint32_t l = (number + job->pairs->unseen) % search->n_lots;
    struct work work = {.job = job, .kind = search->lots[l].kind};
    if (__atomic_load_n(&job->unseen, __ATOMIC_RELAXED) != NONE)
        return;
    ask_lot(&work, search->lots + l);
    if (work.unseen)
        __atomic_store_n(&job->unseen, l, __ATOMIC_RELAXED);
}

/* of the pairs in the first lots of the list as it is, the one that was refused last before
 * others */
static bool are_seen(struct cs_pairs *pairs, uint32_t lots, double h) {
    struct job job = {pairs, h, NONE};
    cs_pool_run(lots, find_unseen, &job);
    if (job.unseen != NONE)
        pairs->unseen = job.unseen;
    return job.unseen == NONE;
}

bool cs_pairs_are_seen(struct cs_pairs *pairs, double t0, const double *x0, double t1,
                       const double *x1) {
    struct cs_search *search = &pairs->search;
    const double *from = cs_points_places(pairs->system, CS_POINTS_BEGIN, t0, x0);
    const double *to = cs_points_places(pairs->system, CS_POINTS_END, t1, x1);
    cs_point_moves_set(pairs->system, from, to, pairs->moves);
    // what is refused again needs no list that covers the way
    if (search->fresh && !are_seen(pairs, 1, t1 - t0))
        return false;
    return cs_search_cover(search, from, to) && are_seen(pairs, search->n_lots, t1 - t0);
}

/* The energy of pairs that a step does not see, pair by pair. */
#include "model/pair/seen.h"

#include "base/pool.h"
#include "model/contact/points.h"
#include "model/pair/nearness.h"
#include "model/pair/way.h"

#include <string.h>

/* points of one move, at most */
enum { POINTS_MOST = 64 };

struct job {
    const struct cs_pairs *pairs;
    const double *x0, *x1; /* (3, n_points) */
    double h;
    double moves; /* cs_search_moves */
};

/* One lot at work: ways wait until they are asked about together. */
struct work {
    const struct job *job;
    enum cs_stencil_kind kind;
    struct cs_way_lanes lanes;
    uint32_t waiting;
    uint64_t unseen;
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
        work->unseen += is_lane_unseen(work, l);
    work->waiting = 0;
}

/* leaves out pairs so far apart that nothing comes into range on a way as long as any */
static void take(struct work *work, const uint32_t pair[2]) {
    const struct job *job = work->job;
    const struct cs_search *search = &job->pairs->search;
    const size_t n = job->pairs->system->surfaces->n_points;
    struct cs_way_lanes *lanes = &work->lanes;
    const uint32_t l = work->waiting;
    uint32_t at[4];
    double from[4][3];
    cs_search_corners(job->pairs->system->surfaces, work->kind, pair, at);
    const struct cs_meeting *meeting =
        cs_meeting_of(&job->pairs->meetings, search->body[at[0]], search->body[at[2]]);
    const double range =
        meeting->range * (work->kind == CS_STENCIL_EDGES ? CS_MEETING_EDGES : 1);
    for (size_t k = 0; k < 4; k++)
        for (size_t c = 0; c < 3; c++)
            from[k][c] = job->x0[c * n + at[k]];
    if (cs_nearness_is_apart(work->kind, from, range * (1 + job->moves)))
        return;
    lanes->range[l] = range;
    lanes->k[l] = meeting->k;
    for (size_t k = 0; k < 4; k++) {
        lanes->inverse_mass[k][l] = cs_points_inverse_mass(job->pairs->system, at[k]);
        for (size_t c = 0; c < 3; c++) {
            lanes->from[k][c][l] = from[k][c];
            lanes->move[k][c][l] = job->x1[c * n + at[k]] - from[k][c];
        }
    }
    if (++work->waiting == CS_WAY_LANES)
        ask(work);
}

static void count_unseen(void *arg, uint32_t number) {
    const struct job *job = arg;
    struct cs_search_lot *lot = job->pairs->search.lots + number;
    struct work work = {.job = job, .kind = lot->kind};
    for (size_t p = 0; p < lot->n; p++)
        take(&work, lot->pairs + 2 * p);
    ask(&work);
    lot->answer = (double)work.unseen;
}

bool cs_pairs_are_seen(struct cs_pairs *pairs, double t0, const double *x0, double t1,
                       const double *x1) {
    struct job job = {pairs, cs_points_places(pairs->system, CS_POINTS_BEGIN, t0, x0),
                      cs_points_places(pairs->system, CS_POINTS_END, t1, x1), t1 - t0, 0};
    job.moves = cs_search_moves(&pairs->search, job.x0, job.x1);
    if (!cs_search_cover(&pairs->search, job.x0, job.x1))
        return false;
    cs_pool_run(pairs->search.n_lots, count_unseen, &job);
    bool seen = true;
    for (uint32_t l = 0; l < pairs->search.n_lots; l++)
        seen = seen && pairs->search.lots[l].answer == 0;
    return seen;
}

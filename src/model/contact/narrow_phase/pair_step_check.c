/* Energy of pairs that a step does not predict, from the candidates that cover the step.
 *
 * Three filters come in turn: swept boxes; the end of short steps in lanes; all samples of long
 * steps, one pair at a time. The chunk that rejected the last step is asked first, because a
 * step that is halved is often rejected by the same pair again. */
#include "model/contact/narrow_phase/pair_step_check.h"

#include "base/pool.h"
#include "model/contact/narrow_phase/pair_motion.h"
#include "model/contact/surface_points.h"

#include <string.h>

/* largest number of samples of one step; longer steps have coarser samples */
enum { POINTS_MAX = 64 };
/* pairs per call of the swept-box filter */
enum { SOME = 256 };
#define NONE UINT32_MAX

struct job {
    struct cs_pairs *pairs;
    double h; /* s */
    /* a chunk with an unresolved pair; NONE */
    uint32_t unseen;
};

/* One chunk at work; pairs are collected until a block of lanes is full. */
struct work {
    const struct job *job;
    enum cs_pair_kind kind;
    struct cs_pair_motion_lanes lanes;
    uint32_t waiting;
    bool unseen;
};

/* d[0..points] = smooth distances at the start and at `points` equal fractions of the step. d
 * needs room for CS_PAIR_LANES - 1 numbers more. Returns whether one is below the range. */
static bool measure(struct cs_pair_motion *way, int points, double range, double *d) {
    struct cs_pair_lanes lanes;
    bool near = false;
    for (int first = 0; first <= points; first += CS_PAIR_LANES) {
        double share[CS_PAIR_LANES];
        for (int l = 0; l < CS_PAIR_LANES; l++)
            share[l] = (first + l) / (double)points;
        for (int k = 0; k < 12; k++)
            for (int l = 0; l < CS_PAIR_LANES; l++)
                lanes.p[k / 3][k % 3][l] =
                    way->x0[k / 3][k % 3] + share[l] * way->displacement[k / 3][k % 3];
        cs_pair_lanes_measure(way->kind, &lanes);
        memcpy(d + first, lanes.d, sizeof lanes.d);
    }
    for (int j = 0; j <= points; j++)
        near = near || d[j] < range;
    return near;
}

/* Judges a step of any length by its samples. */
static bool is_unresolved(const struct job *job, struct cs_pair_motion *way, double range,
                          double k) {
    const double along = cs_pair_motion_samples(cs_pair_motion_longest(way), range);
    const int points = along < POINTS_MAX ? 1 + (int)along : POINTS_MAX;
    double d[POINTS_MAX + CS_PAIR_LANES], unseen = 0;
    struct cs_pair_distance at;
    struct cs_pair_motion_start start;
    if (!measure(way, points, range, d))
        return false;
    cs_pair_distance_set(&at, way->kind, way->x0);
    cs_pair_motion_begin(way, &at, job->h, range, k, &start);
    for (int j = 1; j <= points; j++)
        unseen = fmax(unseen, cs_pair_motion_unresolved_energy(&start, j / (double)points, d[j],
                                                               range, k));
    return unseen > CS_UNRESOLVED_ENERGY_MAX * start.total_energy;
}

/* Uses the result of a lane, or samples the pair if its step is long. */
static bool is_lane_unresolved(const struct work *work, uint32_t l) {
    const struct cs_pair_motion_lanes *lanes = &work->lanes;
    struct cs_pair_motion way = {.kind = work->kind};
    if (lanes->result[l] < 2)
        return lanes->result[l] > 0;
    for (int k = 0; k < 4; k++) {
        way.inverse_mass[k] = lanes->inverse_mass[k][l];
        for (int c = 0; c < 3; c++) {
            way.x0[k][c] = lanes->x0[k][c][l];
            way.displacement[k][c] = lanes->displacement[k][c][l];
        }
    }
    return is_unresolved(work->job, &way, lanes->range[l], lanes->k[l]);
}

/* Checks the collected pairs. */
static void ask(struct work *work) {
    if (work->waiting)
        cs_pair_motion_lanes_check(work->kind, &work->lanes, work->job->h);
    for (uint32_t l = 0; l < work->waiting; l++)
        work->unseen = work->unseen || is_lane_unresolved(work, l);
    work->waiting = 0;
}

/* Collects a pair until its block of lanes is full. */
static void take(struct work *work, const uint32_t pair[2]) {
    const struct cs_pairs *pairs = work->job->pairs;
    const struct cs_candidates *search = &pairs->candidates;
    struct cs_pair_motion_lanes *lanes = &work->lanes;
    const uint32_t l = work->waiting;
    uint32_t at[4];
    cs_candidate_vertices(pairs->system->surfaces, work->kind, pair, at);
    const struct cs_body_pair_params *params =
        cs_body_pair_params_of(&pairs->body_pairs, search->body[at[0]], search->body[at[2]]);
    lanes->range[l] = cs_body_pair_params_range(params, work->kind == CS_PAIR_EDGE_EDGE);
    lanes->k[l] = params->k;
    for (size_t k = 0; k < 4; k++) {
        const double *move = pairs->point_motion[at[k]].values;
        lanes->inverse_mass[k][l] = move[CS_POINT_MOVE_INVERSE_MASS];
        for (size_t c = 0; c < 3; c++) {
            lanes->x0[k][c][l] = move[CS_POINT_MOVE_FROM + c];
            lanes->displacement[k][c][l] = move[CS_POINT_MOVE_BY + c];
        }
    }
    if (++work->waiting == CS_PAIR_MOTION_LANES)
        ask(work);
}

/* Checks those pairs of a chunk whose swept boxes come within the range. */
static void check_chunk(struct work *work, const struct cs_candidate_chunk *chunk) {
    const struct cs_pairs *pairs = work->job->pairs;
    const bool edges = chunk->kind == CS_PAIR_EDGE_EDGE;
    const struct cs_body_pair_params widest = {.range = pairs->body_pairs.range_max};
    const double reach = cs_body_pair_params_range(&widest, edges) * (1 + 1e-9);
    uint32_t some[SOME][2];
    struct cs_moving_pairs items = {.surfaces = pairs->system->surfaces, .edges = edges};
    for (size_t p = 0; p < chunk->n && !work->unseen; p += SOME) {
        items.items = chunk->pairs + 2 * p;
        items.n = chunk->n - p < SOME ? chunk->n - p : SOME;
        const size_t n = cs_point_motion_filter(pairs->point_motion, &items, reach, some[0]);
        for (size_t k = 0; k < n && !work->unseen; k++)
            take(work, some[k]);
    }
    ask(work);
}

/* Checks one chunk, unless another has been rejected already. The order of chunks affects the
 * time only: the answer is whether any pair is unresolved. */
static void find_unresolved(void *arg, uint32_t number) {
    struct job *job = arg;
    const struct cs_candidates *search = &job->pairs->candidates;
    // the one that was unseen before may well be so again
    const uint32_t l = (number + job->pairs->unresolved_chunk) % search->n_chunks;
    struct work work = {.job = job, .kind = search->chunks[l].kind};
    if (__atomic_load_n(&job->unseen, __ATOMIC_RELAXED) != NONE)
        return;
    check_chunk(&work, search->chunks + l);
    if (work.unseen)
        __atomic_store_n(&job->unseen, l, __ATOMIC_RELAXED);
}

/* Checks `chunks` chunks of the list as it is, from the last rejected one on. */
static bool are_seen(struct cs_pairs *pairs, uint32_t chunks, double h) {
    struct job job = {pairs, h, NONE};
    cs_pool_run(chunks, find_unresolved, &job);
    if (job.unseen != NONE)
        pairs->unresolved_chunk = job.unseen;
    return job.unseen == NONE;
}

bool cs_contact_pairs_resolve_step(struct cs_pairs *pairs, double t0, const double *x0,
                                   double t1, const double *x1) {
    struct cs_candidates *search = &pairs->candidates;
    const double *from = cs_surface_points_positions(pairs->system, CS_POINTS_BEGIN, t0, x0);
    const double *to = cs_surface_points_positions(pairs->system, CS_POINTS_END, t1, x1);
    cs_point_motion_set(pairs->system, from, to, pairs->point_motion);
    // A pair that rejects the step again makes a list that covers the step unnecessary.
    if (search->is_built && !are_seen(pairs, 1, t1 - t0))
        return false;
    return cs_candidates_cover_step(search, from, to) &&
           are_seen(pairs, search->n_chunks, t1 - t0);
}

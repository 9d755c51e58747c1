/* Selects the candidates in range by the single-precision filter, edges then by the distance of
 * their force, in lanes. Points and triangles need no more: their features are asked for the
 * range of each (feature_weights.h). */
#include "model/contact/narrow_phase/active_contacts.h"

#include "base/arena.h"
#include "base/pool.h"

#include <string.h>

/* Blocks of eight that are measured together: a vector load directly after scalar stores to the
 * same addresses would stall. */
enum { TOGETHER = 4, WAITING = TOGETHER * CS_PAIR_LANES };

/* One chunk at work: most pairs end in the distance filter. */
struct work {
    const struct cs_candidates *search;
    struct cs_candidate_chunk *chunk;
    bool collects;                    /* pairs nearby, from the whole list */
    bool has_one_range;               /* of all pairs */
    double reach;                     /* of nearby pairs, in units */
    struct cs_distance_filter filter; /* first: most are held back there */
    float excess[CS_DISTANCE_FILTER]; /* of the reach of nearby pairs over that of pairs in
                                         range */
    struct cs_pair_lanes lanes[TOGETHER];
    uint32_t pairs[WAITING][2], waiting;
};

/* Appends those of the waiting edges that are in range, without a branch. */
static void range_measure(struct work *work) {
    struct cs_candidate_chunk *chunk = work->chunk;
    for (uint32_t k = 0; k < work->waiting; k += CS_PAIR_LANES)
        cs_pair_lanes_measure_edges(work->lanes + k / CS_PAIR_LANES);
    for (uint32_t k = 0; k < work->waiting; k++) {
        const struct cs_pair_lanes *lanes = work->lanes + k / CS_PAIR_LANES;
        const uint32_t l = k % CS_PAIR_LANES;
        // one that is out of range is written over
        memcpy(chunk->in_range + 2 * chunk->n_in_range, work->pairs[k], sizeof work->pairs[k]);
        chunk->n_in_range += lanes->d[l] < lanes->range[l];
    }
    work->waiting = 0;
}

/* Takes a pair that passed the filter: edges wait to be measured. */
static void visit_pair(struct work *work, const uint32_t pair[2]) {
    const struct cs_candidates *candidates = work->search;
    struct cs_candidate_chunk *chunk = work->chunk;
    const size_t n = candidates->system->surfaces->n_points;
    if (chunk->kind == CS_PAIR_POINT_TRIANGLE) {
        memcpy(chunk->in_range + 2 * chunk->n_in_range++, pair, sizeof work->pairs[0]);
        return;
    }
    const uint32_t k = work->waiting++, l = k % CS_PAIR_LANES;
    struct cs_pair_lanes *lanes = work->lanes + k / CS_PAIR_LANES;
    uint32_t at[4];
    cs_candidate_vertices(candidates->system->surfaces, chunk->kind, pair, at);
    memcpy(work->pairs[k], pair, sizeof work->pairs[k]);
    lanes->range[l] = cs_candidate_range_of(candidates, chunk->kind, at);
    for (size_t j = 0; j < 4; j++)
        for (size_t c = 0; c < 3; c++)
            lanes->p[j][c][l] = candidates->x_at_close[c * n + at[j]];
    if (work->waiting == WAITING)
        range_measure(work);
}

/* Runs the filter on the pairs it holds: appends those nearby, and takes those that may be in
 * range. Without a branch: a removed pair is overwritten by the next. */
static void filter_chunk(struct work *work) {
    struct cs_distance_filter *filter = &work->filter;
    struct cs_candidate_chunk *chunk = work->chunk;
    uint32_t taken[CS_DISTANCE_FILTER], n_taken = 0;
    if (filter->n)
        cs_distance_filter_measure(chunk->kind, filter);
    for (uint32_t l = 0; l < filter->n; l++) {
        taken[n_taken] = l;
        n_taken += !(filter->ratio[l] + work->excess[l] > 0);
    }
    // long steps have no use for these
    for (uint32_t l = 0; work->collects && l < filter->n; l++) {
        memcpy(chunk->nearby + 2 * chunk->n_nearby, filter->pairs[l], sizeof *filter->pairs);
        chunk->n_nearby += !(filter->ratio[l] > 0);
    }
    filter->n = 0;
    for (uint32_t k = 0; k < n_taken; k++)
        visit_pair(work, filter->pairs[taken[k]]);
}

/* Sets the reach of nearby pairs, and its excess over that of pairs in range, for the pair that
 * is added next. Motions are bounded in ranges of triangles, those of edges are shorter. */
static void set_reach(struct work *work, const uint32_t at[4]) {
    const struct cs_candidates *candidates = work->search;
    const double unit = candidates->inverse_unit;
    const double range = unit * cs_candidate_range_of(candidates, work->chunk->kind, at);
    work->reach = range;
    if (work->collects)
        work->reach += CS_CANDIDATES_NEARBY * unit *
                       cs_candidate_range_of(candidates, CS_PAIR_POINT_TRIANGLE, at);
    work->excess[work->filter.n] =
        cs_distance_filter_bound((float)work->reach) - cs_distance_filter_bound((float)range);
}

/* Puts n pairs of a kind, a constant, into the filter. */
CS_INLINE void put(struct work *work, enum cs_pair_kind kind, const uint32_t *pairs, size_t n) {
    const struct cs_candidates *candidates = work->search;
    for (size_t k = 0; k < n; k++) {
        uint32_t at[4];
        cs_candidate_vertices(candidates->system->surfaces, kind, pairs + 2 * k, at);
        if (!work->has_one_range)
            set_reach(work, at);
        if (cs_distance_filter_add(&work->filter, candidates->scaled_points, at, work->reach,
                                   pairs + 2 * k))
            filter_chunk(work);
    }
}

/* If all ranges are equal, they are set once. The points of the first pair stand for all. */
static void begin_work(struct work *work) {
    const struct cs_candidates *candidates = work->search;
    const uint32_t any[4] = {0};
    work->has_one_range =
        candidates->body_pairs->range_min == candidates->body_pairs->range_max;
    work->waiting = 0;
    for (work->filter.n = CS_DISTANCE_FILTER; work->has_one_range && work->filter.n;) {
        work->filter.n--;
        set_reach(work, any);
    }
    work->filter.n = 0;
}

/* One search of all chunks: of the pairs nearby, or of the whole list. */
struct job {
    const struct cs_candidates *candidates;
    bool searches_nearby, collects;
};

static void find_chunk(void *arg, uint32_t number) {
    const struct job *job = arg;
    struct cs_candidate_chunk *chunk = job->candidates->chunks + number;
    struct work work;
    work.search = job->candidates;
    work.chunk = chunk;
    const uint32_t *pairs = job->searches_nearby ? chunk->nearby : chunk->pairs;
    const size_t n = job->searches_nearby ? chunk->n_nearby : chunk->n;
    // room for all pairs
    chunk->failed = !CS_ARENA_REALLOC(chunk->in_range, chunk->close_capacity, 2 * chunk->n) ||
                    !CS_ARENA_REALLOC(chunk->nearby, chunk->nearby_capacity,
                                      job->collects ? 2 * chunk->n : 0);
    chunk->n_in_range = 0;
    chunk->n_nearby = job->collects ? 0 : chunk->n_nearby;
    if (chunk->failed || !n)
        return;
    work.collects = job->collects;
    begin_work(&work);
    if (chunk->kind == CS_PAIR_EDGE_EDGE)
        put(&work, CS_PAIR_EDGE_EDGE, pairs, n);
    else
        put(&work, CS_PAIR_POINT_TRIANGLE, pairs, n);
    filter_chunk(&work);
    range_measure(&work);
}

bool cs_candidates_find_in_range(struct cs_candidates *candidates, const double *x) {
    const size_t bytes = 3 * sizeof *x * candidates->system->surfaces->n_points;
    if (candidates->has_close_pairs && !memcmp(candidates->x_at_close, x, bytes))
        return true;
    struct job job = {.candidates = candidates};
    if (!cs_candidates_update(candidates, x)) {
        candidates->has_close_pairs = false;
        return false;
    }
    // measuring motions costs about a quarter of a candidate per point
    const bool has_many = candidates->n_listed > candidates->system->surfaces->n_points;
    job.searches_nearby = has_many && cs_candidates_is_nearby(candidates, x);
    job.collects =
        has_many && !job.searches_nearby && candidates->has_close_pairs &&
        cs_candidates_max_motion(candidates, candidates->x_at_close, x) <= CS_CANDIDATES_NEARBY;
    memcpy(candidates->x_at_close, x, bytes);
    if (candidates->n_listed)
        cs_candidates_scale_points(candidates, x);
    cs_pool_run(candidates->n_chunks, find_chunk, &job);
    bool failed = false;
    for (uint32_t l = 0; l < candidates->n_chunks; l++)
        failed = failed || candidates->chunks[l].failed;
    candidates->has_close_pairs = !failed;
    candidates->close_count++;
    candidates->has_nearby = (job.searches_nearby || job.collects) && !failed;
    if (job.collects) {
        candidates->nearby_build = candidates->n_builds;
        memcpy(candidates->x_at_nearby, x, bytes);
    }
    return !failed;
}

/* Finds the active contacts among the pairs in range.
 *
 * Pairs of a chunk come in the order (point, triangle). The features of consecutive triangles
 * of one point are collected and merged (feature_weights.h), until another point begins. */
#include "model/contact/narrow_phase/active_contacts.h"

#include "base/pool.h"
#include "model/contact/contact_samples.h"

#include <stdlib.h>
#include <string.h>

static void finish_active(void *object) {
    struct cs_active_contacts *active = object;
    for (uint32_t l = 0; l < active->candidates->n_chunks; l++)
        free(active->chunks[l].blocks), free(active->chunks[l].features),
            free(active->chunks[l].points), free(active->chunks[l].rows);
}

enum cs_status cs_active_contacts_init(struct cs_active_contacts *active,
                                       const struct cs_candidates *search,
                                       const struct cs_feature_weights *weights,
                                       struct cs_arena *arena, struct cs_error *error) {
    *active = (struct cs_active_contacts){.candidates = search, .feature_weights = weights};
    CS_ARENA_ARRAY(arena, active->chunks, search->n_chunks, error);
    if (!error->status)
        cs_arena_adopt(arena, finish_active, active, error);
    return error->status ? error->status
                         : cs_gather_init(&active->force_gather, search->n_chunks,
                                          search->system->view.n, arena, error);
}

/* One chunk at work. Queries are collected so that feature_weights_find can measure in lanes.
 */
struct work {
    const struct cs_active_contacts *active;
    const double *x;
    struct cs_active_chunk *chunk;
    struct cs_feature_query pairs[CS_FEATURE_QUERY_PAIRS]; /* that wait for each other */
    uint32_t waiting, n_felt;
};

static struct cs_body_pair_params meeting_of(const struct cs_candidates *search,
                                             const uint32_t at[4]) {
    return *cs_body_pair_params_of(search->body_pairs, search->body[at[0]],
                                   search->body[at[2]]);
}

/* Makes room for one pair more; NULL if out of memory. */
static struct cs_active_lanes *next(struct cs_active_chunk *chunk) {
    const size_t n_blocks = chunk->n / CS_PAIR_LANES + 1;
    const bool there = CS_ARENA_REALLOC(chunk->blocks, chunk->capacity, n_blocks) &&
                       CS_ARENA_REALLOC(chunk->points, chunk->points_capacity, chunk->n + 1);
    chunk->failed = chunk->failed || !there;
    return there ? chunk->blocks + chunk->n / CS_PAIR_LANES : NULL;
}

/* Appends a feature or edge pair. */
static void put(const struct work *work, const struct cs_weighted_feature *feature) {
    const bool edges = work->chunk->kind == CS_PAIR_EDGE_EDGE;
    struct cs_active_chunk *chunk = work->chunk;
    const struct cs_body_pair_params params =
        meeting_of(work->active->candidates, feature->points);
    struct cs_active_lanes *to = next(chunk);
    const size_t l = chunk->n % CS_PAIR_LANES;
    if (!to)
        return;
    memcpy(chunk->points + chunk->n++, feature->points, sizeof *chunk->points);
    to->range[l] = cs_pair_contact_range(&params, edges);
    to->k[l] = cs_body_pair_params_stiffness(&params, edges);
    to->friction[l] = params.friction;
    to->weight[l] = feature->weight;
    to->psd_weight[l] = feature->psd_weight;
    to->is_edge[l] = feature->kind.is_edge;
    to->is_off_plane[l] = feature->kind.is_off_plane;
    to->blend_radius[l] = feature->kind.e;
    to->d[l] = feature->d;
    to->rate[l] = to->k[l] * params.inverse_mass;
}

/* --- points and triangles --- */

/* Appends the merged features of a point whose triangles have all been seen. Features whose
 * weights cancelled are dropped. */
static void finish_point(struct work *work) {
    for (uint32_t k = 0; k < work->n_felt; k++)
        if (cs_feature_weights_counts(work->chunk->features + k))
            put(work, work->chunk->features + k);
    work->n_felt = 0;
}

/* Merges n features of one point with those collected so far. */
static void add_features(struct work *work, const struct cs_weighted_feature *features,
                         uint32_t n) {
    struct cs_active_chunk *chunk = work->chunk;
    if (work->n_felt && chunk->features->points[0] != features->points[0])
        finish_point(work);
    if (!CS_ARENA_REALLOC(chunk->features, chunk->features_capacity,
                          (size_t)work->n_felt + n)) {
        chunk->failed = true;
        return;
    }
    memcpy(chunk->features + work->n_felt, features, n * sizeof *features);
    work->n_felt = cs_feature_weights_join(chunk->features, work->n_felt, n);
}

/* Finds the features of the waiting queries, and hands them on point by point. */
static void find_facets(struct work *work) {
    struct cs_weighted_feature features[CS_FEATURES_PER_TRIANGLE * CS_FEATURE_QUERY_PAIRS];
    const uint32_t n = cs_feature_weights_find(work->active->feature_weights, work->pairs,
                                               work->waiting, work->x, features);
    for (uint32_t k = 0, end; k < n; k = end) {
        end = k + 1;
        while (end < n && features[end].points[0] == features[k].points[0])
            end++;
        add_features(work, features + k, end - k);
    }
    work->waiting = 0;
}

/* Query of a candidate: a point and a triangle. */
static struct cs_feature_query query_of(const struct cs_candidates *candidates,
                                        const uint32_t pair[2]) {
    struct cs_feature_query query = {.triangle = pair[1]};
    cs_candidate_vertices(candidates->system->surfaces, CS_PAIR_POINT_TRIANGLE, pair,
                          query.points);
    query.same_body = candidates->body[query.points[0]] == candidates->body[query.points[1]];
    query.range = meeting_of(candidates, query.points).range;
    return query;
}

/* Adds a point-triangle pair to the waiting queries. */
static void queue_pair(struct work *work, const uint32_t pair[2]) {
    work->pairs[work->waiting++] = query_of(work->active->candidates, pair);
    if (work->waiting == CS_FEATURE_QUERY_PAIRS)
        find_facets(work);
}

/* --- both kinds --- */

/* Returns whether no point of a pair can move: such pairs have no effect. */
static bool is_fixed(const struct cs_system *system, const uint32_t at[4]) {
    bool fixed = true;
    for (int k = 0; k < 4; k++)
        fixed = fixed && cs_surface_points_inverse_mass(system, at[k]) == 0;
    return fixed;
}

/* Takes a pair in range: edges at once, a point and triangle into the queue. */
static void visit_pair(struct work *work, const uint32_t pair[2]) {
    const struct cs_candidates *search = work->active->candidates;
    struct cs_weighted_feature edges = {.weight = 1, .psd_weight = 1};
    cs_candidate_vertices(search->system->surfaces, work->chunk->kind, pair, edges.points);
    if (is_fixed(search->system, edges.points))
        return;
    if (work->chunk->kind == CS_PAIR_EDGE_EDGE)
        put(work, &edges);
    else
        queue_pair(work, pair);
}

struct job {
    struct cs_active_contacts *active;
    const double *x;
};

static void find_chunk(void *arg, uint32_t number) {
    const struct job *job = arg;
    const struct cs_candidate_chunk *from = job->active->candidates->chunks + number;
    struct work work;
    work.active = job->active;
    work.x = job->x;
    work.chunk = job->active->chunks + number;
    work.waiting = work.n_felt = 0;
    work.chunk->kind = from->kind;
    work.chunk->n = 0;
    work.chunk->failed = false;
    for (size_t k = 0; k < from->n_in_range; k++)
        visit_pair(&work, from->in_range + 2 * k);
    find_facets(&work);
    finish_point(&work);
}

bool cs_active_contacts_is_there(const struct cs_active_contacts *active) {
    return active->candidates_version == active->candidates->close_count &&
           active->params_version == active->candidates->body_pairs->params_version;
}

bool cs_active_contacts_find(struct cs_active_contacts *active, const double *x) {
    struct job job = {active, x};
    bool failed = false;
    cs_pool_run(active->candidates->n_chunks, find_chunk, &job);
    active->n = 0;
    active->is_gathered = false;
    for (uint32_t l = 0; l < active->candidates->n_chunks; l++) {
        active->n += active->chunks[l].n;
        failed = failed || active->chunks[l].failed;
    }
    active->candidates_version = failed ? 0 : active->candidates->close_count;
    active->params_version = active->candidates->body_pairs->params_version;
    return !failed;
}

/* Assigns rows to the points of a chunk. Consecutive pairs share points, which saves most
 * look-ups in the table. */
static void number_chunk(void *arg, uint32_t number) {
    struct cs_active_contacts *active = arg;
    struct cs_active_chunk *chunk = active->chunks + number;
    struct cs_gather_chunk *rows = active->force_gather.chunks + number;
    cs_gather_clear(rows);
    rows->failed = !CS_ARENA_REALLOC(chunk->rows, chunk->rows_capacity, chunk->n);
    uint32_t(*to)[4] = chunk->rows;
    // neighbours in the list have points in common
    for (size_t p = 0; p < chunk->n && !rows->failed; p++)
        for (int k = 0; k < 4; k++)
            to[p][k] = p && chunk->points[p][k] == chunk->points[p - 1][k]
                           ? to[p - 1][k]
                           : cs_gather_row(rows, chunk->points[p][k]);
}

bool cs_active_contacts_gather(struct cs_active_contacts *active) {
    if (!active->is_gathered) {
        cs_pool_run(active->candidates->n_chunks, number_chunk, active);
        active->is_gathered = cs_gather_set(&active->force_gather);
    }
    return active->is_gathered;
}

/* --- the sum of the features of a point --- */

/* Adds a feature at the start of the step to the model of its point. */
static void add_slope(const struct cs_feature_positions *x, size_t n,
                      const struct cs_weighted_feature *use, double range, double k,
                      struct cs_point_energy *energy) {
    struct cs_mesh_feature feature;
    double p[4][3], g[4][3], approach = 0;
    for (size_t j = 0; j < 12; j++)
        p[j / 3][j % 3] = x->from[j % 3 * n + use->points[j / 3]];
    cs_mesh_feature_set(&feature, use->kind, p);
    cs_mesh_feature_to_points(feature.g, g);
    for (size_t j = 0; j < 12; j++)
        approach -= g[j / 3][j % 3] * (x->to[j % 3 * n + use->points[j / 3]] - p[j / 3][j % 3]);
    const struct cs_barrier barrier = cs_barrier_at(feature.d, range, use->weight * k);
    energy->first += barrier.force * approach;
    energy->second += 0.5 * barrier.stiffness * approach * approach;
}

/* Index of the first candidate of a point; these are in the order of points. */
static size_t first_of(const struct cs_candidate_chunk *chunk, uint32_t point) {
    size_t begin = 0, end = chunk->n;
    while (begin < end) {
        const size_t middle = (begin + end) / 2;
        if (chunk->pairs[2 * middle] < point)
            begin = middle + 1;
        else
            end = middle;
    }
    return begin;
}

/* Adds the features of n queries of one point to its sum. */
static void add_point_energy(const struct cs_feature_weights *features,
                             const struct cs_candidates *candidates,
                             const struct cs_feature_query *queries, uint32_t n,
                             const struct cs_feature_positions *x,
                             struct cs_point_energy *energy) {
    struct cs_weighted_feature uses[CS_FEATURES_PER_TRIANGLE * CS_FEATURE_QUERY_PAIRS];
    const uint32_t found = cs_feature_weights_find_between(features, queries, n, x, uses);
    for (uint32_t u = 0; u < found; u++) {
        const struct cs_body_pair_params params = meeting_of(candidates, uses[u].points);
        const double range = cs_pair_contact_range(&params, false);
        energy->energy += uses[u].weight * cs_barrier_energy(uses[u].d, range, params.k);
        if (x->fraction == 0)
            add_slope(x, features->surfaces->n_points, uses + u, range, params.k, energy);
    }
}

struct cs_point_energy cs_point_energy_find(const struct cs_feature_weights *features,
                                            const struct cs_candidates *candidates,
                                            const struct cs_candidate_chunk *chunk,
                                            uint32_t point,
                                            const struct cs_feature_positions *x) {
    struct cs_feature_query queries[CS_FEATURE_QUERY_PAIRS];
    struct cs_point_energy energy = {0, 0, 0};
    uint32_t n = 0;
    for (size_t k = first_of(chunk, point); k < chunk->n && chunk->pairs[2 * k] == point; k++) {
        queries[n++] = query_of(candidates, chunk->pairs + 2 * k);
        if (n < CS_FEATURE_QUERY_PAIRS)
            continue;
        add_point_energy(features, candidates, queries, n, x, &energy);
        n = 0;
    }
    add_point_energy(features, candidates, queries, n, x, &energy);
    return energy;
}

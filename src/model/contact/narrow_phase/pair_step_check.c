/* Energy of pairs that a step does not predict, from the candidates that cover the step.
 *
 * Filters come in turn: swept boxes; then samples of the step. Edges that remain reject it. A
 * point and a triangle reject it if the sum of all features of the point, by which it is
 * pushed, is unresolved too. The chunk that rejected the last step is asked first, because a
 * step that is halved is often rejected by the same pair again. */
#include "model/contact/narrow_phase/contact_pairs.h"

#include "base/pool.h"
#include "base/vector.h"
#include "model/contact/contact_samples.h"
#include "model/contact/narrow_phase/pair_contact.h"
#include "model/contact/step_check.h"

#include <math.h>

struct job {
    struct cs_pairs *pairs;
    const double *from, *to; /* (3,n_points) m, both ends of the step */
    double h;                /* s */
    bool nearby;             /* the pairs nearby suffice */
    bool impacts;            /* cs_impacts_are_resolved */
    double missed_max;       /* of the energy of a pair */
    uint32_t n_checked;      /* chunks that are resolved, from the last rejected one on */
    /* a chunk with an unresolved pair; NONE */
    uint32_t unseen;
};

/* A pair whose points move along straight lines during a step. */
struct way {
    enum cs_pair_kind kind;
    double from[4][3], by[4][3]; /* m */
    struct cs_barrier_model model;
    /* J, by which what is missed is judged: psi(d) at the start, the kinetic energy of the
     * relative motion of the contact points, and psi(D/2), which keeps pairs that barely touch
     * from being judged, unless psi itself is */
    double energy;
    double approach; /* m, first-order decrease -g.dx of the distance over the whole step */
    int parts;
};

/* m, largest relative displacement of a point of one side and a point of the other. Contact
 * points are convex combinations of the points, so none moves further relative to the other
 * side. */
static double longest_of(const struct way *way) {
    const int first = way->kind == CS_PAIR_EDGE_EDGE ? 2 : 1;
    double most = 0;
    for (int i = 0; i < first; i++)
        for (int j = first; j < 4; j++) {
            double apart[3];
            for (int c = 0; c < 3; c++)
                apart[c] = way->by[i][c] - way->by[j][c];
            most = fmax(most, cs_vec3_dot(apart, apart));
        }
    return sqrt(most);
}

/* Sets a way whose points are at[4]. The effective mass of the contact points is 1 / sum (w_k^2
 * / m_k), infinite if all are pinned. */
static void set_way(const struct job *job, const uint32_t at[4], struct way *way) {
    const struct cs_pairs *pairs = job->pairs;
    const bool edges = way->kind == CS_PAIR_EDGE_EDGE;
    const struct cs_body_pair_params *params = cs_body_pair_params_of(
        &pairs->body_pairs, pairs->candidates.body[at[0]], pairs->candidates.body[at[2]]);
    const double range = cs_pair_contact_range(params, edges);
    const double k = cs_body_pair_params_stiffness(params, edges);
    struct cs_pair_contact contact;
    double v[3] = {0}, inverse = 0;
    for (size_t j = 0; j < 12; j++) {
        const double *move = pairs->point_motion[at[j / 3]].values;
        way->from[j / 3][j % 3] = move[CS_POINT_MOVE_FROM + j % 3];
        way->by[j / 3][j % 3] = move[CS_POINT_MOVE_BY + j % 3];
    }
    const double d = cs_pair_contact_measure_whole(&contact, way->kind, range, way->from);
    way->approach = 0;
    for (int j = 0; j < 4; j++) {
        const double w = contact.weight[j];
        for (int c = 0; c < 3; c++)
            v[c] += w * way->by[j][c] / job->h;
        inverse += w * w * pairs->point_motion[at[j]].values[CS_POINT_MOVE_INVERSE_MASS];
        way->approach -= cs_vec3_dot(contact.g[j], way->by[j]);
    }
    way->model = cs_barrier_model_at(d, range, k, !job->impacts);
    way->energy = (inverse > 0 ? 0.5 * cs_vec3_dot(v, v) / inverse : HUGE_VAL) +
                  way->model.held +
                  (job->impacts ? 0 : cs_barrier_energy(0.5 * range, range, k));
    way->parts = cs_step_parts(longest_of(way), range);
}

/* J, what the model misses after the fraction `share` of the way. */
static double missed_at(const struct way *way, double share) {
    struct cs_pair_contact contact;
    double p[4][3];
    for (int j = 0; j < 12; j++)
        p[j / 3][j % 3] = way->from[j / 3][j % 3] + share * way->by[j / 3][j % 3];
    return cs_barrier_missed(
        &way->model, cs_pair_contact_measure_whole(&contact, way->kind, way->model.range, p),
        share * way->approach);
}

/* pairs per call of the swept-box filter */
enum { SOME = 256 };

#define NONE UINT32_MAX

/* One chunk at work. */
struct work {
    struct job *job;
    const struct cs_candidate_chunk *chunk;
    /* the last point whose sum is resolved, or NONE */
    uint32_t resolved_point;
    bool unseen;
};

/* Judges a point, a triangle of which is unresolved, by all its features: on its way from one
 * triangle to the next, what one loses the other gains. The kinetic energy is that against this
 * triangle. */
static bool is_point_unresolved(struct work *work, const struct way *way, uint32_t point) {
    const struct job *job = work->job;
    struct cs_feature_positions x = {job->from, job->to, 0};
    bool unresolved = false;
    if (point == work->resolved_point)
        return false;
    const struct cs_point_energy energy = cs_point_energy_find(
        &job->pairs->feature_weights, &job->pairs->candidates, work->chunk, point, &x);
    const double most =
        job->missed_max * (way->energy - way->model.held + fmax(energy.energy, 0));
    for (int j = 1; j <= way->parts && !unresolved; j++) {
        x.fraction = j / (double)way->parts;
        const double seen =
            energy.energy +
            (job->impacts ? 0 : x.fraction * (energy.first + x.fraction * energy.second));
        const struct cs_point_energy at = cs_point_energy_find(
            &job->pairs->feature_weights, &job->pairs->candidates, work->chunk, point, &x);
        unresolved = fabs(at.energy - seen) > most;
    }
    work->resolved_point = unresolved ? NONE : point;
    return unresolved;
}

/* Tells whether a pair is unresolved, with all features of its point if it is by this triangle
 * alone. */
static bool is_unresolved(struct work *work, const uint32_t pair[2]) {
    struct way way = {.kind = work->chunk->kind};
    uint32_t at[4];
    bool missed = false;
    cs_candidate_vertices(work->job->pairs->system->surfaces, way.kind, pair, at);
    set_way(work->job, at, &way);
    for (int j = 1; j <= way.parts && !missed; j++)
        missed = missed_at(&way, j / (double)way.parts) > work->job->missed_max * way.energy;
    return missed &&
           (way.kind == CS_PAIR_EDGE_EDGE || is_point_unresolved(work, &way, pair[0]));
}

/* Checks those candidates of a chunk whose swept boxes come within the range. */
static void check_chunk(struct work *work) {
    const struct cs_pairs *pairs = work->job->pairs;
    const struct cs_candidate_chunk *chunk = work->chunk;
    const bool edges = chunk->kind == CS_PAIR_EDGE_EDGE;
    const struct cs_body_pair_params widest = {.range = pairs->body_pairs.range_max};
    const double reach = cs_body_pair_params_range(&widest, edges) * (1 + 1e-9);
    struct cs_moving_pairs items = {.surfaces = pairs->system->surfaces, .edges = edges};
    const uint32_t *all = work->job->nearby ? chunk->nearby : chunk->pairs;
    const size_t n_all = work->job->nearby ? chunk->n_nearby : chunk->n;
    uint32_t some[SOME][2];
    for (size_t p = 0; p < n_all && !work->unseen; p += SOME) {
        items.items = all + 2 * p;
        items.n = n_all - p < SOME ? n_all - p : SOME;
        const size_t n = cs_point_motion_filter(pairs->point_motion, &items, reach, some[0]);
        for (size_t k = 0; k < n && !work->unseen; k++)
            work->unseen = is_unresolved(work, some[k]);
    }
}

/* Checks one chunk, unless another has been rejected already. The order of chunks affects the
 * time only: the answer is whether any pair is unresolved. */
static void find_unresolved(void *arg, uint32_t number) {
    struct job *job = arg;
    const struct cs_candidates *search = &job->pairs->candidates;
    // the one that was unseen before may well be so again
    const uint32_t l =
        (number + job->n_checked + job->pairs->unresolved_chunk) % search->n_chunks;
    struct work work = {.job = job, .chunk = search->chunks + l, .resolved_point = NONE};
    if (__atomic_load_n(&job->unseen, __ATOMIC_RELAXED) != NONE)
        return;
    check_chunk(&work);
    if (work.unseen)
        __atomic_store_n(&job->unseen, l, __ATOMIC_RELAXED);
}

/* Checks the list as it is up to a number of chunks, from the last rejected one on. */
static bool are_seen(struct job *job, uint32_t chunks) {
    cs_pool_run(chunks - job->n_checked, find_unresolved, job);
    job->n_checked = chunks;
    if (job->unseen != NONE)
        job->pairs->unresolved_chunk = job->unseen;
    return job->unseen == NONE;
}

bool cs_contact_pairs_resolve_step(struct cs_pairs *pairs, double t0, const double *x0,
                                   double t1, const double *x1) {
    struct cs_candidates *search = &pairs->candidates;
    const double *from = cs_surface_points_positions(pairs->system, CS_POINTS_BEGIN, t0, x0);
    const double *to = cs_surface_points_positions(pairs->system, CS_POINTS_END, t1, x1);
    struct job job = {.pairs = pairs, .from = from, .to = to, .h = t1 - t0, .unseen = NONE};
    const uint64_t build = search->n_builds;
    job.impacts = cs_impacts_are_resolved(pairs->system);
    job.missed_max = cs_step_missed_max(pairs->system);
    cs_point_motion_set(pairs->system, from, to, pairs->point_motion);
    // Pairs in range anywhere on the way are nearby, because the motion from where these were
    // collected is largest at one of its ends. A pair that rejects the step again makes a list
    // that covers the step unnecessary.
    job.nearby = cs_candidates_is_nearby(search, from) && cs_candidates_is_nearby(search, to);
    if (search->is_built && !are_seen(&job, 1))
        return false;
    if (!cs_candidates_cover_step(search, from, to))
        return false;
    if (search->n_builds != build) {
        job.nearby = false;
        job.n_checked = 0;
    }
    return are_seen(&job, search->n_chunks);
}

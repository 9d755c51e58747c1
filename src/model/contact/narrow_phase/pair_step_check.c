/* Energy of pairs that a step does not predict, from the candidates that cover the step.
 *
 * Filters come in turn: swept boxes; then all samples of a step, eight pairs at a time in
 * lanes. Edges that remain reject the step. A point and a triangle reject it if the sum of all
 * features of the point, by which it is pushed, is unresolved too. The
 * chunk that rejected the last step is asked first, because a step that is halved is often
 * rejected by the same pair again. */
#include "model/contact/narrow_phase/contact_pairs.h"

#include "base/pool.h"
#include "base/vector.h"
#include "model/contact/barrier_law.h"
#include "model/contact/contact_samples.h"
#include "model/contact/narrow_phase/pair_contact.h"
#include "model/contact/step_check.h"

#include <math.h>

/* A pair whose points move along straight lines during a step, and the contact
 * energy that a second-order model at the start of the step misses.
 *
 *   e = |psi(d(s)) - (psi + F a + K a^2/2)|,   a = -s g.dx
 *
 * with psi, F, K at the start, dx the whole displacement and s the fraction of it. The step
 * resolves the contact if e is at most CS_UNRESOLVED_ENERGY_MAX of the energy of the pair. */

/* largest number of samples of one step; longer steps have coarser samples */
enum { SAMPLES_MAX = 64 };

/* Eight pairs in lanes; lanes without a pair hold unspecified numbers. */
enum { LANES = 8 };

struct lanes {
    double x0[4][3][LANES], displacement[4][3][LANES], inverse_mass[4][LANES];
    double range[LANES], k[LANES];
    /* at the start, in J: psi(d); and the energy of the pair, psi(d) + kinetic energy of the
     * relative motion of its contact points + psi(D/2) */
    double contact_energy[LANES], total_energy[LANES];
    /* N, N/m; m, first-order decrease -g.dx of the distance over the whole step */
    double force[LANES], stiffness[LANES], approach[LANES];
    /* equal parts of the step, at whose ends it is sampled: they are at most half a range of
     * relative motion, so that no contact is passed over */
    double parts[LANES];
    /* of the samples so far: least distance in m, largest e in J */
    double nearest[LANES], missed[LANES];
};

/* m2, squared relative displacement of points i and j */
CS_INLINE double relative_squared(const struct lanes *lanes, int l, int i, int j) {
    double r[3];
    CS_UNROLLED
    for (int c = 0; c < 3; c++)
        r[c] = lanes->displacement[i][c][l] - lanes->displacement[j][c][l];
    return cs_vec3_dot(r, r);
}

/* m, largest relative displacement of a point of one side and a point of the other. Contact
 * points are convex combinations of the points, so none moves further relative to the other
 * side. */
CS_INLINE double longest_of(enum cs_pair_kind kind, const struct lanes *lanes, int l) {
    const bool edges = kind == CS_PAIR_EDGE_EDGE;
    double most = edges ? 0 : cs_fmax(relative_squared(lanes, l, 0, 1), 0);
    most = cs_fmax(relative_squared(lanes, l, 0, 2), most);
    most = cs_fmax(relative_squared(lanes, l, 0, 3), most);
    most = edges ? cs_fmax(relative_squared(lanes, l, 1, 2), most) : most;
    most = edges ? cs_fmax(relative_squared(lanes, l, 1, 3), most) : most;
    return sqrt(most);
}

/* Samples one lane after the fraction `share` of the step. */
CS_INLINE void sample_lane(enum cs_pair_kind kind, struct lanes *lanes, int l, double share) {
    struct cs_pair_contact at;
    double p[4][3];
    CS_UNROLLED
    for (int j = 0; j < 12; j++)
        p[j / 3][j % 3] =
            lanes->x0[j / 3][j % 3][l] + share * lanes->displacement[j / 3][j % 3][l];
    const double range = lanes->range[l], k = lanes->k[l], come = share * lanes->approach[l];
    const double d = cs_pair_contact_measure_whole(&at, kind, range, p);
    const double seen = lanes->contact_energy[l] + lanes->force[l] * come +
                        0.5 * lanes->stiffness[l] * come * come;
    const double missed = fabs(cs_barrier_energy(d, range, k) - seen);
    lanes->nearest[l] = d < lanes->nearest[l] ? d : lanes->nearest[l];
    lanes->missed[l] = missed > lanes->missed[l] ? missed : lanes->missed[l];
}

/* Sets the model of one lane; h: seconds of the whole step. The effective mass of the contact
 * points is 1 / sum (w_k^2 / m_k), infinite if all are pinned. psi(D/2) keeps pairs that barely
 * touch from being judged. */
CS_INLINE void begin_lane(enum cs_pair_kind kind, struct lanes *lanes, int l, double h) {
    struct cs_pair_contact at;
    const double range = lanes->range[l], k = lanes->k[l];
    double p[4][3], v[3] = {0}, inverse = 0, approach = 0;
    CS_UNROLLED
    for (int j = 0; j < 12; j++)
        p[j / 3][j % 3] = lanes->x0[j / 3][j % 3][l];
    const double d = cs_pair_contact_measure_whole(&at, kind, range, p);
    for (int j = 0; j < 4; j++) {
        double by[3];
        CS_UNROLLED
        for (int c = 0; c < 3; c++) {
            by[c] = lanes->displacement[j][c][l];
            v[c] += at.weight[j] * by[c] / h;
        }
        inverse += at.weight[j] * at.weight[j] * lanes->inverse_mass[j][l];
        approach -= cs_vec3_dot(at.g[j], by);
    }
    // not used where all points are pinned
    const double kinetic = 0.5 * cs_vec3_dot(v, v) / inverse;
    const struct cs_barrier barrier = cs_barrier_at(d, range, k);
    const double along = longest_of(kind, lanes, l) / (0.5 * range);
    lanes->nearest[l] = d;
    lanes->missed[l] = 0;
    lanes->approach[l] = approach;
    lanes->force[l] = barrier.force;
    lanes->stiffness[l] = barrier.stiffness;
    lanes->contact_energy[l] = cs_barrier_energy(d, range, k);
    lanes->total_energy[l] = (inverse > 0 ? kinetic : HUGE_VAL) + lanes->contact_energy[l] +
                             cs_barrier_energy(0.5 * range, range, k);
    lanes->parts[l] = 1 + (int)(along < SAMPLES_MAX - 1 ? along : SAMPLES_MAX - 1);
}

CS_INLINE void begin_all(enum cs_pair_kind kind, struct lanes *restrict lanes, double h) {
    for (int l = 0; l < LANES; l++)
        begin_lane(kind, lanes, l, h);
}

/* Samples all lanes after part j of their steps; those of fewer parts at their end again. */
CS_INLINE void sample_all(enum cs_pair_kind kind, struct lanes *restrict lanes, double j) {
    for (int l = 0; l < LANES; l++) {
        const double share = j / lanes->parts[l];
        sample_lane(kind, lanes, l, share < 1 ? share : 1);
    }
}

CS_PAIR_KERNEL(static, begin_lanes, begin_all, (struct lanes *restrict lanes, double h),
               (lanes, h))
CS_PAIR_KERNEL(static, sample_lanes, sample_all, (struct lanes *restrict lanes, double j),
               (lanes, j))

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

/* Samples the steps of the first n lanes at the ends of all their parts. Where impacts are
 * resolved, a constant replaces the second-order model: e is then the change of psi. */
static void sample_steps(enum cs_pair_kind kind, struct lanes *lanes, uint32_t n,
                         const struct job *job) {
    double parts = 1;
    begin_lanes(kind, lanes, job->h);
    for (uint32_t l = 0; l < n; l++) {
        const double range = lanes->range[l];
        parts = cs_fmax(parts, lanes->parts[l]);
        lanes->approach[l] = job->impacts ? 0 : lanes->approach[l];
        lanes->total_energy[l] -=
            job->impacts ? cs_barrier_energy(0.5 * range, range, lanes->k[l]) : 0;
    }
    for (double j = 1; j <= parts; j++)
        sample_lanes(kind, lanes, j);
}

/* pairs per call of the swept-box filter */
enum { SOME = 256 };

#define NONE UINT32_MAX

/* One chunk at work; pairs are collected until a block of lanes is full. */
struct work {
    struct job *job;
    const struct cs_candidate_chunk *chunk;
    enum cs_pair_kind kind;
    struct lanes lanes;
    uint32_t points[LANES]; /* of points and triangles */
    uint32_t waiting;
    /* the last point whose sum is resolved, or NONE */
    uint32_t resolved_point;
    bool unseen;
};

/* Judges the point of a lane, a triangle of which is unresolved, by all its features: on its
 * way from one triangle to the next, what one loses the other gains. The kinetic energy is that
 * against this triangle. */
static bool is_point_unresolved(struct work *work, uint32_t l) {
    const struct cs_candidates *candidates = &work->job->pairs->candidates;
    const struct lanes *lanes = &work->lanes;
    const uint32_t point = work->points[l];
    bool unresolved = false;
    if (point == work->resolved_point)
        return false;
    struct cs_feature_positions x = {work->job->from, work->job->to, 0};
    const struct cs_point_energy energy = cs_point_energy_find(
        &work->job->pairs->feature_weights, candidates, work->chunk, point, &x);
    const double total =
        lanes->total_energy[l] - lanes->contact_energy[l] + fmax(energy.energy, 0);
    for (double j = 1; j <= lanes->parts[l] && !unresolved; j++) {
        const double share = j / lanes->parts[l];
        const double seen =
            energy.energy +
            (work->job->impacts ? 0 : share * (energy.first + share * energy.second));
        x.fraction = share;
        const struct cs_point_energy at = cs_point_energy_find(
            &work->job->pairs->feature_weights, candidates, work->chunk, point, &x);
        unresolved = fabs(at.energy - seen) > work->job->missed_max * total;
    }
    work->resolved_point = unresolved ? NONE : point;
    return unresolved;
}

/* Tells whether the pair of a lane is unresolved, with all features of its point if it is by
 * this triangle alone. A pair that is out of range at all samples is resolved. */
static bool is_lane_unresolved(struct work *work, uint32_t l) {
    const struct lanes *lanes = &work->lanes;
    return lanes->nearest[l] < lanes->range[l] &&
           lanes->missed[l] > work->job->missed_max * lanes->total_energy[l] &&
           (work->kind == CS_PAIR_EDGE_EDGE || is_point_unresolved(work, l));
}

/* Checks the collected pairs. */
static void ask(struct work *work) {
    if (work->waiting)
        sample_steps(work->kind, &work->lanes, work->waiting, work->job);
    for (uint32_t l = 0; l < work->waiting && !work->unseen; l++)
        work->unseen = is_lane_unresolved(work, l);
    work->waiting = 0;
}

/* Collects a pair until its block of lanes is full. */
static void visit_pair(struct work *work, const uint32_t pair[2]) {
    const struct cs_pairs *pairs = work->job->pairs;
    const struct cs_candidates *search = &pairs->candidates;
    struct lanes *lanes = &work->lanes;
    const uint32_t l = work->waiting;
    uint32_t at[4];
    cs_candidate_vertices(pairs->system->surfaces, work->kind, pair, at);
    const struct cs_body_pair_params *params =
        cs_body_pair_params_of(&pairs->body_pairs, search->body[at[0]], search->body[at[2]]);
    lanes->range[l] = cs_pair_contact_range(params, work->kind == CS_PAIR_EDGE_EDGE);
    work->points[l] = pair[0];
    lanes->k[l] = cs_body_pair_params_stiffness(params, work->kind == CS_PAIR_EDGE_EDGE);
    for (size_t k = 0; k < 4; k++) {
        const double *move = pairs->point_motion[at[k]].values;
        lanes->inverse_mass[k][l] = move[CS_POINT_MOVE_INVERSE_MASS];
        for (size_t c = 0; c < 3; c++) {
            lanes->x0[k][c][l] = move[CS_POINT_MOVE_FROM + c];
            lanes->displacement[k][c][l] = move[CS_POINT_MOVE_BY + c];
        }
    }
    if (++work->waiting == LANES)
        ask(work);
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
            visit_pair(work, some[k]);
    }
    ask(work);
}

/* Checks one chunk, unless another has been rejected already. The order of chunks affects the
 * time only: the answer is whether any pair is unresolved. */
static void find_unresolved(void *arg, uint32_t number) {
    struct job *job = arg;
    const struct cs_candidates *search = &job->pairs->candidates;
    // the one that was unseen before may well be so again
    const uint32_t l =
        (number + job->n_checked + job->pairs->unresolved_chunk) % search->n_chunks;
    struct work work = {.job = job,
                        .chunk = search->chunks + l,
                        .kind = search->chunks[l].kind,
                        .resolved_point = NONE};
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
    job.missed_max = job.impacts ? CS_IMPACT_CHANGE_MAX : CS_UNRESOLVED_ENERGY_MAX;
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

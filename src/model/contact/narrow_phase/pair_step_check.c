/* Energy of pairs that a step does not predict, from the candidates that cover the step.
 *
 * Filters come in turn: swept boxes; then samples of the step. Edges that remain reject it. A
 * point and a triangle reject it if the sum of all features of the point, by which it is
 * pushed, is unresolved too. The chunk that rejected the last step is asked first, because a
 * step that is halved is often rejected by the same pair again. */
#include "model/contact/narrow_phase/contact_pairs.h"

#include "base/pool.h"
#include "model/contact/contact_samples.h"
#include "model/contact/narrow_phase/pair_contact.h"
#include "model/contact/step_check.h"

#include <math.h>

struct job {
    struct cs_pairs *pairs;
    const double *from, *to; /* (3,n_points) m, both ends of the step */
    double h;                /* s */
    bool nearby;             /* the pairs nearby suffice */
    double slopes;           /* 1 if F and K are known, 0 if psi alone is */
    double missed_max;       /* of the energy of a pair */
    uint32_t n_checked;      /* chunks that are resolved, from the last rejected one on */
    /* a chunk with an unresolved pair; NONE */
    uint32_t unseen;
};

/* Pairs of one kind whose points move along straight lines during a step, one in a lane. Lanes
 * without a pair hold unspecified numbers. */
enum { LANES = 8 };

struct ways {
    double from[4][3][LANES], by[4][3][LANES]; /* m */
    double inverse_mass[4][LANES];             /* 1/kg */
    double range[LANES], k[LANES];             /* m, N/m */
    /* struct cs_barrier_model at the start */
    double held[LANES], force[LANES], stiffness[LANES];
    /* J, by which what is missed is judged: psi(d) at the start, the kinetic energy of the
     * relative motion of the contact points, and psi(D/2), which keeps pairs that barely touch
     * from being judged, unless psi itself is */
    double energy[LANES];
    double approach[LANES];    /* m, first-order decrease -g.dx of the distance over the step */
    double parts[LANES];       /* cs_step_parts */
    double missed[LANES];      /* J, by the model, at most among the samples */
    uint32_t points[LANES], n; /* first of each pair */
};

/* m, largest relative displacement of a point of one side and a point of the other. Contact
 * points are convex combinations of the points, so none moves further relative to the other
 * side. */
CS_INLINE double longest_of(enum cs_pair_kind kind, const struct ways *ways, int l) {
    const int first = kind == CS_PAIR_EDGE_EDGE ? 2 : 1;
    double most = 0;
    CS_UNROLLED
    for (int k = 0; k < 2 + first; k++) {
        const double(*a)[LANES] = ways->by[k % first],
              (*b)[LANES] = ways->by[first + k / first];
        const double r[3] = {a[0][l] - b[0][l], a[1][l] - b[1][l], a[2][l] - b[2][l]};
        most = cs_fmax(cs_vec3_dot(r, r), most);
    }
    return sqrt(most);
}

/* m, distance of a lane after the fraction `share` of the step. */
CS_INLINE double measure(enum cs_pair_kind kind, const struct ways *ways, int l, double share,
                         struct cs_pair_contact *contact) {
    double p[4][3];
    CS_UNROLLED
    for (int j = 0; j < 12; j++)
        p[j / 3][j % 3] = ways->from[j / 3][j % 3][l] + share * ways->by[j / 3][j % 3][l];
    return cs_pair_contact_measure_whole(contact, kind, ways->range[l], p);
}

/* Sets the model of a lane. The effective mass of the contact points is 1 / sum (w_k^2 / m_k),
 * infinite if all are pinned. */
CS_INLINE void begin(enum cs_pair_kind kind, struct ways *ways, int l, double h,
                     double slopes) {
    const double range = ways->range[l], k = ways->k[l];
    struct cs_pair_contact contact;
    double v[3] = {0}, inverse = 0, approach = 0;
    const double d = measure(kind, ways, l, 0, &contact);
    for (int j = 0; j < 4; j++) {
        const double by[3] = {ways->by[j][0][l], ways->by[j][1][l], ways->by[j][2][l]};
        const double w = contact.weight[j];
        for (int c = 0; c < 3; c++)
            v[c] += w * by[c] / h;
        inverse += w * w * ways->inverse_mass[j][l];
        approach -= cs_vec3_dot(contact.g[j], by);
    }
    const struct cs_barrier_model model = cs_barrier_model_at(d, range, k, true);
    const double kinetic = 0.5 * cs_vec3_dot(v, v) / inverse;
    ways->held[l] = model.held;
    ways->force[l] = model.force;
    ways->stiffness[l] = model.stiffness;
    ways->approach[l] = slopes * approach;
    ways->energy[l] = (inverse > 0 ? kinetic : HUGE_VAL) + model.held +
                      slopes * cs_barrier_energy(0.5 * range, range, k);
    ways->parts[l] = cs_step_parts(longest_of(kind, ways, l), range);
    ways->missed[l] = 0;
}

/* Samples a lane after part j of its step; one of fewer parts at its end again. */
CS_INLINE void sample(enum cs_pair_kind kind, struct ways *ways, int l, double j) {
    struct cs_pair_contact contact;
    const double part = j / ways->parts[l], share = part < 1 ? part : 1;
    const struct cs_barrier_model model = {ways->range[l], ways->k[l], ways->held[l],
                                           ways->force[l], ways->stiffness[l]};
    const double missed = cs_barrier_missed(&model, measure(kind, ways, l, share, &contact),
                                            share * ways->approach[l]);
    ways->missed[l] = cs_fmax(missed, ways->missed[l]);
}

/* Sets all lanes from their motion in a step of h seconds; slopes: as in struct job. */
CS_INLINE void sample_all(enum cs_pair_kind kind, struct ways *restrict ways, double h,
                          double slopes) {
    double parts = 1;
    for (int l = 0; l < LANES; l++)
        begin(kind, ways, l, h, slopes);
    for (uint32_t l = 0; l < ways->n; l++)
        parts = cs_fmax(ways->parts[l], parts);
    for (double j = 1; j <= parts; j++)
        for (int l = 0; l < LANES; l++)
            sample(kind, ways, l, j);
}

CS_PAIR_KERNEL(static, sample_ways, sample_all,
               (struct ways *restrict ways, double h, double slopes), (ways, h, slopes))

/* pairs per call of the swept-box filter */
enum { SOME = 256 };

#define NONE UINT32_MAX

/* One chunk at work. */
struct work {
    struct job *job;
    const struct cs_candidate_chunk *chunk;
    struct ways ways;
    /* the last point whose sum is resolved, or NONE */
    uint32_t resolved_point;
    bool unseen;
};

/* Judges the point of a lane, a triangle of which is unresolved, by all its features: on its
 * way from one triangle to the next, what one loses the other gains. The kinetic energy is that
 * against this triangle. */
static bool is_point_unresolved(struct work *work, uint32_t l) {
    const struct job *job = work->job;
    const struct ways *ways = &work->ways;
    const uint32_t point = ways->points[l];
    struct cs_feature_positions x = {job->from, job->to, 0};
    bool unresolved = false;
    if (point == work->resolved_point)
        return false;
    const struct cs_point_energy energy = cs_point_energy_find(
        &job->pairs->feature_weights, &job->pairs->candidates, work->chunk, point, &x);
    const double most =
        job->missed_max * (ways->energy[l] - ways->held[l] + fmax(energy.energy, 0));
    for (double j = 1; j <= ways->parts[l] && !unresolved; j++) {
        x.fraction = j / ways->parts[l];
        const double change = x.fraction * (energy.first + x.fraction * energy.second);
        const struct cs_point_energy at = cs_point_energy_find(
            &job->pairs->feature_weights, &job->pairs->candidates, work->chunk, point, &x);
        unresolved = fabs(at.energy - (energy.energy + job->slopes * change)) > most;
    }
    work->resolved_point = unresolved ? NONE : point;
    return unresolved;
}

/* Checks the collected pairs: a point and a triangle by all features of the point if the pair
 * is unresolved by itself. */
static void check_ways(struct work *work) {
    struct ways *ways = &work->ways;
    const struct job *job = work->job;
    const enum cs_pair_kind kind = work->chunk->kind;
    if (ways->n)
        sample_ways(kind, ways, job->h, job->slopes);
    for (uint32_t l = 0; l < ways->n && !work->unseen; l++)
        work->unseen = ways->missed[l] > job->missed_max * ways->energy[l] &&
                       (kind == CS_PAIR_EDGE_EDGE || is_point_unresolved(work, l));
    ways->n = 0;
}

/* Collects a pair until all lanes have one. */
static void add_way(struct work *work, const uint32_t pair[2]) {
    const struct cs_pairs *pairs = work->job->pairs;
    const bool edges = work->chunk->kind == CS_PAIR_EDGE_EDGE;
    struct ways *ways = &work->ways;
    const uint32_t l = ways->n;
    uint32_t at[4];
    cs_candidate_vertices(pairs->system->surfaces, work->chunk->kind, pair, at);
    const struct cs_body_pair_params *params = cs_body_pair_params_of(
        &pairs->body_pairs, pairs->candidates.body[at[0]], pairs->candidates.body[at[2]]);
    ways->range[l] = cs_pair_contact_range(params, edges);
    ways->k[l] = cs_body_pair_params_stiffness(params, edges);
    ways->points[l] = pair[0];
    for (size_t j = 0; j < 4; j++) {
        const double *move = pairs->point_motion[at[j]].values;
        ways->inverse_mass[j][l] = move[CS_POINT_MOVE_INVERSE_MASS];
        for (size_t c = 0; c < 3; c++) {
            ways->from[j][c][l] = move[CS_POINT_MOVE_FROM + c];
            ways->by[j][c][l] = move[CS_POINT_MOVE_BY + c];
        }
    }
    if (++ways->n == LANES)
        check_ways(work);
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
            add_way(work, some[k]);
    }
    check_ways(work);
}

/* Checks one chunk, unless another has been rejected already. The order of chunks affects the
 * time only: the answer is whether any pair is unresolved. */
static void find_unresolved(void *arg, uint32_t number) {
    struct job *job = arg;
    const struct cs_candidates *search = &job->pairs->candidates;
    // the one that was unseen before may well be so again
    const uint32_t l =
        (number + job->n_checked + job->pairs->unresolved_chunk) % search->n_chunks;
    const struct cs_candidate_chunk *chunk = search->chunks + l;
    if (__atomic_load_n(&job->unseen, __ATOMIC_RELAXED) != NONE ||
        !(job->nearby ? chunk->n_nearby : chunk->n))
        return;
    struct work work = {.job = job, .chunk = chunk, .resolved_point = NONE};
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
    job.slopes = cs_impacts_are_resolved(pairs->system) ? 0 : 1;
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

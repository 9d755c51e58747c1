/* Evaluates the pairs in range of each chunk in lanes; Hessians of exact matrices and lagged
 * friction pair by pair.
 *
 * Order of one chunk: gather x, v and directions of its points into rows; fill four blocks of
 * eight pairs; evaluate them; add their results to the rows of the chunk in the order of pairs.
 * Particles sum their rows afterwards, in the order of chunks (force_gather.h). No sum depends
 * on the number of threads.
 *
 * Positive semi-definite surrogate. The exact derivative of the force of a pair is -K g g^T + F
 * H. With ck < 0 the first part enters the solver's matrix with the right sign; F H has
 * eigenvalues of both signs and is left out, as in a Gauss-Newton method. A feature with
 * negative weight would subtract stiffness, so that psd_weight replaces the weight: the nearest
 * feature alone counts. What remains is a sum of K g g^T with factors >= 0. An
 * iteration of Newton that converges with it has the exact solution, because its residual has
 * the exact force. */
#include "model/contact/narrow_phase/narrow_phase.h"

#include "base/pool.h"
#include "model/contact/collider_params.h"
#include "model/contact/contact_samples.h"
#include "model/contact/lagged_friction.h"
#include "model/contact/narrow_phase/pair_lanes.h"
#include "scene/contact_keys.h"
#include "scene/scene.h"

#include <string.h>

/* Blocks that are filled before any is evaluated: a vector load directly after scalar stores to
 * the same addresses would stall. */
enum { TOGETHER = 4 };

/* One chunk at work. */
struct work {
    const struct cs_narrow_phase *narrow;
    struct cs_active_chunk *chunk;
    uint32_t number;
    /* gathered data of its points */
    const double *rows;
};

/* --- one by one --- */

/* Stores the friction of a block of pairs. The velocities are those of colliders alone. */
static void store_lagged(const struct work *work, struct cs_pair_lanes *lanes, size_t first) {
    const struct cs_narrow_phase *narrow = work->narrow;
    struct cs_pair_contact contact;
    for (uint32_t l = 0; l < lanes->n; l++) {
        cs_pair_lanes_contact(work->chunk->kind, lanes, l, narrow->system->scene->contact,
                              &contact);
        cs_lagged_friction_store(narrow->system->lagged_friction,
                                 narrow->first_lagged + work->number, &contact.contact, 4,
                                 work->chunk->points[first + l], contact.weight);
    }
}

/* --- in lanes --- */

/* Adds the energies of a block to its chunk. The distances of features are known already. */
static void add_energy(const struct work *work, struct cs_pair_lanes *lanes) {
    if (work->chunk->kind == CS_PAIR_EDGE_EDGE)
        cs_pair_lanes_measure_edges(lanes);
    for (uint32_t l = 0; l < lanes->n; l++)
        work->chunk->energy += cs_barrier_energy(lanes->d[l], lanes->range[l], lanes->k[l]);
}

/* Sets out of a block to forces, their change, or bounds. */
static void push(const struct work *work, struct cs_pair_lanes *lanes) {
    const struct cs_narrow_phase *narrow = work->narrow;
    const struct cs_pair_lane_constants constants = {*narrow->system->scene->contact,
                                                     cs_force_parts_of(narrow->eval.parts)};
    if (narrow->query == CS_QUERY_JVP)
        cs_pair_lanes_jvp(work->chunk->kind, lanes, &constants);
    else if (narrow->query == CS_QUERY_BOUND)
        cs_pair_lanes_bound(work->chunk->kind, lanes, &constants);
    else
        cs_pair_lanes_force(work->chunk->kind, lanes, &constants);
}

/* numbers that a row sums */
static size_t width_of(const struct cs_narrow_phase *narrow) {
    return narrow->query == CS_QUERY_BOUND ? 2 : 3;
}

/* Adds the results of a block to the rows of its points, pair by pair. */
static void add_pushes(const struct work *work, struct cs_pair_lanes *lanes, size_t first) {
    const struct cs_gather *gather = &work->narrow->contacts->force_gather;
    const size_t width = width_of(work->narrow);
    cs_pair_lanes_add(lanes->out, width, work->chunk->rows + first, lanes->n,
                      cs_gather_of(gather->chunks + work->number, gather->row_sums, width));
}

/* Reads what friction by its chord depends on: columns 6 to 11 of the rows, and masses. */
static void read_pulls(const struct work *work, size_t first, uint32_t n,
                       struct cs_pair_pulls *pulls) {
    const struct cs_system *system = work->narrow->system;
    const size_t width = work->narrow->contacts->force_gather.width;
    cs_pair_lanes_read(work->rows + 6, width, work->chunk->rows + first, n, pulls->all);
    cs_pair_lanes_read(work->rows + 9, width, work->chunk->rows + first, n, pulls->contact);
    for (uint32_t l = 0; l < n; l++)
        for (size_t k = 0; k < 4; k++)
            pulls->inverse_mass[k][l] =
                cs_surface_points_inverse_mass(system, work->chunk->points[first + l][k]);
}

/* Stores the matrix terms of a block, which the operator multiplies with later. */
static void share(const struct work *work, struct cs_pair_lanes *lanes, size_t first) {
    const struct cs_narrow_phase *narrow = work->narrow;
    const struct cs_contact_keys *keys = narrow->system->scene->contact;
    const struct cs_pair_matrix_chunk *terms = narrow->result->chunks + work->number;
    struct cs_pair_factors *factors = terms->factors + first / CS_PAIR_LANES;
    if (narrow->matrix->chord) {
        struct cs_pair_pulls pulls;
        read_pulls(work, first, lanes->n, &pulls);
        cs_pair_lanes_chord_matrix(work->chunk->kind, lanes, keys, narrow->matrix, &pulls,
                                   factors);
    } else
        cs_pair_lanes_matrix(work->chunk->kind, lanes, keys, narrow->matrix, factors);
    for (uint32_t l = 0; l < lanes->n && narrow->result->exact; l++) {
        struct cs_pair_contact contact;
        cs_pair_lanes_contact(work->chunk->kind, lanes, l, keys, &contact);
        cs_pair_matrix_set_hessian(&contact, narrow->matrix, terms->hessians + first + l);
    }
}

/* Returns whether rows sum the results. */
static bool is_summed(const struct cs_narrow_phase *narrow) {
    return narrow->query == CS_QUERY_FORCE || narrow->query == CS_QUERY_JVP ||
           narrow->query == CS_QUERY_BOUND;
}

/* a matrix with friction by its chord */
static bool has_chord(const struct cs_narrow_phase *narrow) {
    return narrow->query == CS_QUERY_MATRIX && narrow->matrix->chord;
}

/* Evaluates a block whose pairs begin at `first`. */
static void evaluate_block(const struct work *work, struct cs_pair_lanes *lanes, size_t first) {
    if (work->narrow->query == CS_QUERY_ENERGY)
        add_energy(work, lanes);
    else if (is_summed(work->narrow))
        push(work, lanes);
    else if (work->narrow->query == CS_QUERY_LAGGED)
        store_lagged(work, lanes, first);
    else
        share(work, lanes, first);
}

/* --- active contacts of a chunk --- */

/* Sets the stiffness of one lane. In a positive semi-definite matrix the barrier's curvature
 * has the weight of the nearest feature alone. Friction and damping keep the full weights,
 * because methods that are linear in a step take their exact slope from the matrix; they give
 * this up only if matrix.bound asks for an upper bound. */
static void psd_stiffness(const struct cs_narrow_phase *narrow,
                          const struct cs_active_lanes *from, uint32_t l,
                          struct cs_pair_lanes *lanes) {
    const struct cs_contact_keys *keys = narrow->system->scene->contact;
    const bool positive = narrow->query == CS_QUERY_MATRIX && narrow->matrix->psd;
    const bool rubs = lanes->friction[l] + keys->damping + keys->loss > 0 &&
                      !(positive && narrow->matrix->bound);
    const double count = positive && !rubs ? from->psd_weight[l] : from->weight[l];
    lanes->k[l] = count * from->k[l];
    lanes->psd_stiffness[l] = (positive ? from->psd_weight[l] : count) * from->k[l];
}

/* Copies the parameters of a block of active contacts. */
static void fill(const struct cs_narrow_phase *narrow, const struct cs_active_lanes *from,
                 struct cs_pair_lanes *lanes) {
    memcpy(lanes->range, from->range, sizeof lanes->range);
    if (cs_lagged_friction_acts(narrow->system))
        memset(lanes->friction, 0, sizeof lanes->friction);
    else
        memcpy(lanes->friction, from->friction, sizeof lanes->friction);
    memcpy(lanes->is_edge, from->is_edge, sizeof lanes->is_edge);
    memcpy(lanes->is_off_plane, from->is_off_plane, sizeof lanes->is_off_plane);
    memcpy(lanes->blend_radius, from->blend_radius, sizeof lanes->blend_radius);
    memcpy(lanes->d, from->d, sizeof lanes->d);
    memcpy(lanes->rate, from->rate, sizeof lanes->rate);
    for (uint32_t l = 0; l < lanes->n; l++)
        psd_stiffness(narrow, from, l, lanes);
}

/* Copies positions, velocities and directions of a block from the rows: columns 0, 3, 6, 9. */
static void fill_points(const struct work *work, size_t first, struct cs_pair_lanes *lanes) {
    const size_t width = work->narrow->contacts->force_gather.width;
    uint32_t(*to)[4] = work->chunk->rows + first;
    cs_pair_lanes_read(work->rows, width, to, lanes->n, lanes->p);
    cs_pair_lanes_read(work->rows + 3, width, to, lanes->n, lanes->v);
    if (work->narrow->query != CS_QUERY_JVP)
        return;
    cs_pair_lanes_read(work->rows + 6, width, to, lanes->n, lanes->dp);
    cs_pair_lanes_read(work->rows + 9, width, to, lanes->n, lanes->dv);
}

/* Handles up to TOGETHER blocks from pair `first` on, in three passes: fill, evaluate, add.
 * Separate passes keep scalar stores away from vector loads. */
static void do_some(const struct work *work, size_t first) {
    struct cs_pair_lanes lanes[TOGETHER];
    const size_t left = work->chunk->n - first, most = TOGETHER * CS_PAIR_LANES;
    const size_t end = left < most ? left : most;
    for (size_t p = 0; p < end; p += CS_PAIR_LANES) {
        struct cs_pair_lanes *at = lanes + p / CS_PAIR_LANES;
        at->n = end - p < CS_PAIR_LANES ? (uint32_t)(end - p) : CS_PAIR_LANES;
        fill(work->narrow, work->chunk->blocks + (first + p) / CS_PAIR_LANES, at);
        fill_points(work, first + p, at);
    }
    for (size_t p = 0; p < end; p += CS_PAIR_LANES)
        evaluate_block(work, lanes + p / CS_PAIR_LANES, first + p);
    for (size_t p = 0; p < end && is_summed(work->narrow); p += CS_PAIR_LANES)
        add_pushes(work, lanes + p / CS_PAIR_LANES, first + p);
}

/* Prepares a chunk; returns false if it has no pairs or no memory. */
static bool begin(const struct work *work) {
    const struct cs_narrow_phase *narrow = work->narrow;
    const struct cs_gather *gather = &narrow->contacts->force_gather;
    const struct cs_gather_chunk *chunk = gather->chunks + work->number;
    work->chunk->energy = 0;
    if (!work->chunk->n)
        return false;
    if (is_summed(narrow))
        memset(cs_gather_of(chunk, gather->row_sums, width_of(narrow)), 0,
               width_of(narrow) * sizeof(double) * chunk->n);
    return narrow->query != CS_QUERY_MATRIX ||
           cs_pair_matrix_chunk_begin(narrow->result, work->number);
}

/* Gathers x, v, and for a Jacobian product dx and dv, of the points of a chunk. Directions
 * exist for particles only: points of colliders have 0. */
static const double *read_rows(const struct cs_narrow_phase *narrow, uint32_t number) {
    const struct cs_system *system = narrow->system;
    const struct cs_gather *gather = &narrow->contacts->force_gather;
    const size_t n = system->view.n, n_points = system->surfaces->n_points;
    cs_gather_read(gather, number, 3, narrow->v, n_points);
    if (narrow->query == CS_QUERY_JVP) {
        cs_gather_read(gather, number, 6, narrow->eval.dx, n);
        cs_gather_read(gather, number, 9, narrow->eval.dv, n);
    }
    if (has_chord(narrow)) {
        cs_gather_read(gather, number, 6, narrow->matrix->chord->all, n);
        cs_gather_read(gather, number, 9, narrow->matrix->chord->contact, n);
    }
    return cs_gather_read(gather, number, 0, narrow->x, n_points);
}

static void do_chunk(void *arg, uint32_t number) {
    const struct cs_narrow_phase *narrow = arg;
    struct work work = {narrow, narrow->contacts->chunks + number, number, NULL};
    if (!begin(&work))
        return;
    work.rows = read_rows(narrow, number);
    for (size_t p = 0; p < work.chunk->n; p += TOGETHER * CS_PAIR_LANES)
        do_some(&work, p);
    if (narrow->query == CS_QUERY_MATRIX)
        cs_pair_matrix_chunk_end(narrow->result, number);
}

/* A row has 6 columns, or 12 for a Jacobian product and friction by its chord. */
bool cs_narrow_phase_run(struct cs_narrow_phase *narrow) {
    const size_t width = narrow->query == CS_QUERY_JVP || has_chord(narrow) ? 12 : 6;
    if (!cs_gather_reserve(&narrow->contacts->force_gather, width))
        return false;
    cs_pool_run(narrow->contacts->candidates->n_chunks, do_chunk, narrow);
    return narrow->query != CS_QUERY_MATRIX || cs_pair_matrix_end(narrow->result);
}

/* Rebuilds the candidate list when particles have moved by more than its margin.
 *
 * Validity: the displacements of a body since the list was built lie in a box with middle m and
 * half-diagonal r. Two points of bodies a and b have then moved relative to each other by at
 * most r_a + r_b + |m_a - m_b|. The list is valid while this is at most 2 margins for all pairs
 * of bodies with contact, a = b included. */
#include "model/contact/broad_phase/candidate_list.h"

#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void finish_candidates(void *object) {
    struct cs_candidates *candidates = object;
    for (uint32_t l = 0; l < candidates->n_chunks; l++) {
        free(candidates->chunks[l].pairs);
        free(candidates->chunks[l].in_range);
        free(candidates->chunks[l].nearby);
    }
}

/* Positions are scaled by the largest range, which is near the size of the primitives. */
enum cs_status cs_candidates_init(struct cs_candidates *candidates, struct cs_system *system,
                                  const struct cs_body_pair_table *table,
                                  struct cs_error *error) {
    struct cs_arena *arena = &system->arena;
    const struct cs_surfaces *surfaces = system->surfaces;
    const uint32_t n = surfaces->n_points;
    *candidates = (struct cs_candidates){.system = system,
                                         .body_pairs = table,
                                         .margin = CS_CANDIDATES_MARGIN * table->range_min,
                                         .inverse_unit = 1 / table->range_max};
    candidates->body = cs_arena_alloc_array(arena, n, sizeof *candidates->body, error);
    CS_ARENA_ARRAY(arena, candidates->x_at_build, 3 * (size_t)n, error);
    CS_ARENA_ARRAY(arena, candidates->x_at_close, 3 * (size_t)n, error);
    CS_ARENA_ARRAY(arena, candidates->x_at_nearby, 3 * (size_t)n, error);
    CS_ARENA_ARRAY(arena, candidates->scaled_points, n, error);
    CS_ARENA_ARRAY(arena, candidates->body_motion, 4 * (size_t)table->n_bodies, error);
    if (error->status ||
        cs_primitive_search_init(&candidates->search, surfaces, arena, error) ||
        !CS_ARENA_ARRAY(arena, candidates->chunks, candidates->search.n_chunks, error))
        return error->status;
    candidates->n_chunks = candidates->search.n_chunks;
    for (uint32_t b = 0; b < table->n_bodies; b++)
        for (uint32_t i = surfaces->first_point[b]; i < surfaces->first_point[b + 1]; i++)
            candidates->body[i] = b;
    // chunks of points come first
    for (uint32_t l = candidates->search.n_point_chunks; l < candidates->n_chunks; l++)
        candidates->chunks[l].kind = CS_PAIR_EDGE_EDGE;
    cs_arena_adopt(arena, finish_candidates, candidates, error);
    return error->status;
}

/* --- how long the list is good --- */

/* Middle of the box of a body's displacements since `from`, and half its diagonal. */
static void measure_drift(const struct cs_candidates *candidates, uint32_t body,
                          const double *from, const double *x) {
    const struct cs_surfaces *surfaces = candidates->system->surfaces;
    const uint32_t first = surfaces->first_point[body];
    const size_t n = surfaces->n_points, count = surfaces->first_point[body + 1] - first;
    double *drift = candidates->body_motion + 4 * (size_t)body, squared = 0;
    for (size_t c = 0; c < 3; c++) {
        double low, high;
        cs_vector_span(count, x + c * n + first, from + c * n + first, &low, &high);
        drift[c] = 0.5 * (low + high);
        squared += 0.25 * (high - low) * (high - low);
    }
    drift[3] = sqrt(squared);
}

/* Bound of the relative displacement of two bodies in m; NaN fails every comparison. */
static double apart(const struct cs_candidates *candidates, size_t body, size_t other) {
    const double *a = candidates->body_motion + 4 * body,
                 *b = candidates->body_motion + 4 * other;
    double squared = 0;
    for (int c = 0; c < 3; c++)
        squared += (a[c] - b[c]) * (a[c] - b[c]);
    return a[3] + b[3] + sqrt(squared);
}

/* Drifts of all bodies with contact. */
static void measure_drifts(const struct cs_candidates *candidates, const double *from,
                           const double *x) {
    for (uint32_t b = 0; b < candidates->body_pairs->n_bodies; b++)
        if (candidates->body_pairs->has_partner[b])
            measure_drift(candidates, b, from, x);
}

/* Returns whether the list is valid at x. */
static bool is_good(const struct cs_candidates *candidates, const double *x) {
    const struct cs_body_pair_table *table = candidates->body_pairs;
    bool good = candidates->is_built;
    if (good)
        measure_drifts(candidates, candidates->x_at_build, x);
    for (uint32_t a = 0; a < table->n_bodies && good; a++)
        for (uint32_t b = a; b < table->n_bodies; b++)
            good = good && (!(cs_body_pair_params_of(table, a, b)->range > 0) ||
                            apart(candidates, a, b) <= 2 * candidates->margin_now);
    return good;
}

/* Builds the list at x_at_build for a margin; returns false if out of memory. */
static bool build(struct cs_candidates *candidates, double margin) {
    candidates->n_builds++;
    candidates->margin_now = margin;
    cs_candidates_scale_points(candidates, candidates->x_at_build);
    candidates->is_built = cs_candidates_find(candidates);
    return candidates->is_built;
}

bool cs_candidates_update(struct cs_candidates *candidates, const double *x) {
    if (is_good(candidates, x))
        return true;
    memcpy(candidates->x_at_build, x, 3 * sizeof *x * candidates->system->surfaces->n_points);
    return build(candidates, candidates->margin);
}

/* --- for a whole move --- */

/* Bounds of a body along an axis at both ends of a move. */
static void find_bounds(const struct cs_candidates *candidates, uint32_t body, size_t axis,
                        const double *x0, const double *x1, double bounds[2]) {
    const struct cs_surfaces *surfaces = candidates->system->surfaces;
    const size_t first = axis * surfaces->n_points;
    bounds[0] = HUGE_VAL, bounds[1] = -HUGE_VAL;
    for (size_t i = first + surfaces->first_point[body];
         i < first + surfaces->first_point[body + 1]; i++) {
        bounds[0] = fmin(bounds[0], fmin(x0[i], x1[i]));
        bounds[1] = fmax(bounds[1], fmax(x0[i], x1[i]));
    }
}

/* Returns whether the boxes of two bodies come within their range during a move. */
static bool may_come_near(const struct cs_candidates *candidates, uint32_t a, uint32_t b,
                          const double *x0, const double *x1) {
    const double range = cs_body_pair_params_of(candidates->body_pairs, a, b)->range;
    bool near = true;
    for (size_t c = 0; c < 3; c++) {
        double first[2], second[2];
        find_bounds(candidates, a, c, x0, x1, first);
        find_bounds(candidates, b, c, x0, x1, second);
        near = near && !(first[0] - range > second[1] || second[0] > first[1] + range);
    }
    return near;
}

/* m, largest relative motion from x0 to x1 of particles that may meet; bodies that stay away
 * from each other do not count. *within: that of particles of one body. */
static double largest_move(const struct cs_candidates *candidates, const double *x0,
                           const double *x1, double *within) {
    const struct cs_body_pair_table *table = candidates->body_pairs;
    double most = 0;
    *within = 0;
    measure_drifts(candidates, x0, x1);
    for (uint32_t a = 0; a < table->n_bodies; a++)
        for (uint32_t b = a; b < table->n_bodies; b++) {
            // without a range the two do not push each other
            const double range = cs_body_pair_params_of(table, a, b)->range;
            const double move = apart(candidates, a, b);
            if (range > 0 && move > most && (a == b || may_come_near(candidates, a, b, x0, x1)))
                most = move;
            if (range > 0 && move > *within && a == b)
                *within = move;
        }
    return most;
}

/* Largest multiple of the step by which the state of a new list lies ahead of its start. */
#define AHEAD 2

/* m, margin of a list for a step whose largest relative motions are `move`, and `within` a
 * body; 0: it would be too long. A list built in the middle of the way must cover half of it in
 * both directions: a relative motion of move/2 = 2 margins. Where bodies pass each other and
 * few pairs are listed the search costs more than the list: one for four such steps is made.
 * Chosen by trial on bear_heap, where bears fall. */
static double margin_for(const struct cs_candidates *candidates, double move, double within) {
    const double least = fmax(candidates->margin, 0.25 * move);
    const double most =
        CS_CANDIDATES_FAR_MARGINS * CS_CANDIDATES_MARGIN * candidates->body_pairs->range_min;
    if (!(least <= most))
        return 0;
    return candidates->n_listed < 3 * (size_t)candidates->system->surfaces->n_points &&
                   within < 0.5 * move
               ? fmin(fmax(least, move), most)
               : least;
}

/* A list that is valid at both ends is valid on the straight way too, because each relative
 * displacement is a convex function along it. The factor 1 + 1e-9 exceeds the rounding of
 * motions. */
bool cs_candidates_cover_step(struct cs_candidates *candidates, const double *x0,
                              const double *x1) {
    const size_t n = candidates->system->surfaces->n_points;
    if (is_good(candidates, x0) && is_good(candidates, x1))
        return true;
    double within;
    const double move = largest_move(candidates, x0, x1, &within) * (1 + 1e-9);
    const double margin = margin_for(candidates, move, within);
    if (!(margin > 0))
        return false;
    // The next step probably continues like this one, so that the list is built as far ahead as
    // it still covers the start.
    const double along = fmin(2 * margin / move, AHEAD);
    for (size_t i = 0; i < 3 * n; i++)
        candidates->x_at_build[i] = x0[i] + along * (x1[i] - x0[i]);
    return build(candidates, margin);
}

bool cs_candidates_is_nearby(const struct cs_candidates *candidates, const double *x) {
    return candidates->has_nearby && candidates->nearby_build == candidates->n_builds &&
           cs_candidates_max_motion(candidates, candidates->x_at_nearby, x) <=
               CS_CANDIDATES_NEARBY * (1 - 1e-6);
}

/* Comparisons are written so that NaN wins and stays. */
double cs_candidates_max_motion(const struct cs_candidates *candidates, const double *x0,
                                const double *x1) {
    const struct cs_body_pair_table *table = candidates->body_pairs;
    double most = 0;
    measure_drifts(candidates, x0, x1);
    for (uint32_t a = 0; a < table->n_bodies; a++)
        for (uint32_t b = a; b < table->n_bodies; b++) {
            const double range = cs_body_pair_params_of(table, a, b)->range;
            const double moves = apart(candidates, a, b) / range;
            // not a number stays
            most = range > 0 && !(moves <= most) ? moves : most;
        }
    return most;
}

/* The force term of contact between surfaces: a body with itself, two bodies, or a body and a
 * mesh collider. Updates the candidate list and evaluates the pairs in range.
 *
 * Two lists of active contacts exist. The solver's matrix refers to one until it is replaced,
 * while forces at other states use the other. A list is reused as long as its pairs are those
 * in range. */
#include "model/contact/narrow_phase/contact_pairs.h"

#include "base/vector.h"
#include "model/contact/contact_samples.h"
#include "model/contact/narrow_phase/narrow_phase.h"
#include "model/force/terms.h"
#include "scene/body_pairs.h"

#include <clothsim/clones.h>

/* Refuses a body with two primitives closer than its thickness: contact would push it apart
 * from the first step on, because its edges leave no room for such a thickness. */
static enum cs_status check_start(const struct cs_pairs *pairs, struct cs_error *error) {
    const struct cs_candidates *search = &pairs->candidates;
    const size_t n = pairs->system->view.n;
    for (uint32_t l = 0; l < search->n_chunks; l++)
        for (size_t p = 0; p < search->chunks[l].n; p++) {
            uint32_t at[4];
            double places[4][3];
            struct cs_pair_contact contact;
            cs_candidate_vertices(pairs->system->surfaces, search->chunks[l].kind,
                                  search->chunks[l].pairs + 2 * p, at);
            const uint32_t body = search->body[at[0]];
            if (body != search->body[at[2]])
                continue;
            for (size_t k = 0; k < 4; k++)
                cs_point_read(pairs->system->start, n, at[k], places[k]);
            const double range =
                cs_pair_contact_range(cs_body_pair_params_of(&pairs->body_pairs, body, body),
                                      search->chunks[l].kind == CS_PAIR_EDGE_EDGE);
            const double d =
                cs_pair_contact_measure_whole(&contact, search->chunks[l].kind, range, places);
            const uint32_t first = pairs->system->bodies[body].first;
            if (d < range)
                return cs_fail(error, CS_ERR_SCENE,
                               "bodies[%u].self_contact: layers are only %.3g m apart at the "
                               "start (particles %u and %u), expected at least the thickness, "
                               "%.3g m; reduce bodies[%u].thickness",
                               body, d, at[0] - first, at[2] - first, range, body);
        }
    return CS_OK;
}

/* Prepares both lists of active contacts and both matrices. */
static enum cs_status init_answers(struct cs_pairs *pairs, struct cs_arena *arena,
                                   struct cs_error *error) {
    const uint32_t n_chunks = pairs->candidates.n_chunks;
    for (int k = 0; k < 2; k++)
        if (cs_active_contacts_init(pairs->lists + k, &pairs->candidates,
                                    &pairs->feature_weights, arena, error))
            return error->status;
    return cs_pair_matrix_init(&pairs->solver_matrix, n_chunks, arena, error)
               ? error->status
               : cs_pair_matrix_init(&pairs->other_matrix, n_chunks, arena, error);
}

/* Order: surfaces, parameters of pairs, candidate list, features, queries; then the first list,
 * at the start positions, which check_start reads. */
static enum cs_status build(struct cs_system *system, struct cs_error *error) {
    if (cs_surface_points_build(system, error))
        return error->status;
    struct cs_pairs *pairs = cs_arena_alloc(&system->arena, sizeof *pairs, error);
    if (!pairs || cs_body_pair_table_build(system, &pairs->body_pairs, error) ||
        cs_candidates_init(&pairs->candidates, system, &pairs->body_pairs, error) ||
        cs_feature_weights_init(&pairs->feature_weights, system->surfaces, &system->arena,
                                error))
        return error->status;
    pairs->system = system;
    CS_ARENA_ARRAY(&system->arena, pairs->point_motion, system->surfaces->n_points, error);
    pairs->current_contacts = pairs->lists;
    if (init_answers(pairs, &system->arena, error))
        return error->status;
    if (!cs_candidates_update(
            &pairs->candidates,
            cs_surface_points_positions(system, CS_POINTS_BEGIN, 0, system->start)))
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the contact pairs");
    system->pairs = pairs;
    return check_start(pairs, error);
}

/* Active contacts at x: those of a list that fits, else found into the list that the solver's
 * matrix does not use; NULL if out of memory. */
static struct cs_active_contacts *find_active(struct cs_pairs *pairs, const double *x) {
    if (!cs_candidates_find_in_range(&pairs->candidates, x))
        return NULL;
    for (int k = 0; k < 2; k++)
        if (cs_active_contacts_is_there(pairs->lists + k))
            return pairs->lists + k;
    struct cs_active_contacts *active =
        pairs->lists + (pairs->solver_matrix.contacts == pairs->lists);
    return cs_active_contacts_find(active, x) ? active : NULL;
}

/* Runs one query; returns false if out of memory. */
static bool answer(struct cs_pairs *pairs, struct cs_narrow_phase *narrow) {
    const struct cs_eval *at = &narrow->eval;
    narrow->system = pairs->system;
    narrow->x = cs_surface_points_positions(pairs->system, CS_POINTS_BEGIN, at->t, at->x);
    narrow->v = cs_surface_points_velocities(pairs->system, at->t, at->v);
    cs_body_pair_table_update_friction(pairs->system, &pairs->body_pairs);
    narrow->contacts = find_active(pairs, narrow->x);
    if (!narrow->contacts)
        return false;
    pairs->current_contacts = narrow->contacts;
    if (!cs_active_contacts_gather(pairs->current_contacts))
        return false;
    if (narrow->result &&
        !cs_pair_matrix_begin(narrow->result, pairs->current_contacts, !narrow->matrix->psd,
                              narrow->result == &pairs->other_matrix && narrow->matrix->bound))
        return false;
    return cs_narrow_phase_run(narrow);
}

/* Runs one query. Out of memory is remembered, and the query then has no pairs. */
static void run(struct cs_pairs *pairs, struct cs_narrow_phase *narrow) {
    if (answer(pairs, narrow))
        return;
    pairs->failed = true;
    pairs->current_contacts->n = 0;
}

/* The query is a Jacobian product as soon as one direction is given. */
static void prepare(const struct cs_system *system, const struct cs_eval *at) {
    struct cs_narrow_phase narrow = {.query = at->dx || at->dv ? CS_QUERY_JVP : CS_QUERY_FORCE,
                                     .eval = *at};
    run(system->pairs, &narrow);
}

/* Power in W that the vertices of colliders give at the state of the last force: -f.v of each.
 */
static double power_of(const struct cs_system *system, const struct cs_eval *at) {
    const struct cs_pairs *pairs = system->pairs;
    const struct cs_gather *gather = &pairs->current_contacts->force_gather;
    const size_t n_points = system->surfaces->n_points;
    const double *v = system->points && pairs->current_contacts->n
                          ? cs_surface_points_velocities(system, at->t, at->v)
                          : NULL;
    double power = 0;
    for (uint32_t l = 0; l < gather->n_chunks && v; l++) {
        const double *f = cs_gather_of(gather->chunks + l, gather->row_sums, 3);
        for (uint32_t row = 0; row < gather->chunks[l].n; row++)
            for (size_t c = 0; c < 3 && gather->chunks[l].points[row] >= system->view.n; c++)
                power -= f[3 * row + c] * v[c * n_points + gather->chunks[l].points[row]];
    }
    return power;
}

/* Adds the result at the particles of the block. */
static void add_pair_forces(const struct cs_system *system, const struct cs_eval *at,
                            double *f) {
    const struct cs_active_contacts *contacts = system->pairs->current_contacts;
    if (contacts->n)
        cs_gather_add(&contacts->force_gather, contacts->force_gather.row_sums, 3,
                      at->block->begin, at->block->end, f);
    if (at->power && at->block->begin == 0)
        at->power[0] += power_of(system, at);
}

static double energy(const struct cs_system *system, const struct cs_eval *at) {
    struct cs_pairs *pairs = system->pairs;
    struct cs_narrow_phase narrow = {.query = CS_QUERY_ENERGY, .eval = *at};
    double sum = 0;
    run(pairs, &narrow);
    for (uint32_t l = 0; l < pairs->candidates.n_chunks && pairs->current_contacts->n; l++)
        sum += pairs->current_contacts->chunks[l].energy;
    return sum;
}

static uint32_t friction_chunks(const struct cs_system *system) {
    return system->pairs->candidates.n_chunks;
}

static void store_friction(const struct cs_system *system, double t, const double *x,
                           uint32_t first) {
    struct cs_narrow_phase narrow = {
        .query = CS_QUERY_LAGGED, .eval = {.t = t, .x = x}, .first_lagged = first};
    run(system->pairs, &narrow);
}

/* --- matrices --- */

/* A new solver matrix first releases the list of active contacts that the old one used. */
static void prepare_matrix(const struct cs_system *system, const struct cs_matrix *matrix,
                           bool kept) {
    struct cs_pairs *pairs = system->pairs;
    struct cs_pair_matrix *result = kept ? &pairs->solver_matrix : &pairs->other_matrix;
    struct cs_narrow_phase narrow = {
        .query = CS_QUERY_MATRIX,
        .eval = {.t = matrix->t, .x = matrix->x, .v = matrix->v, .parts = CS_PART_ALL},
        .matrix = matrix,
        .result = result};
    if (kept)
        result->contacts = NULL;
    run(pairs, &narrow);
    pairs->blocks = result;
}

static void add_blocks(const struct cs_system *system, const struct cs_matrix *matrix,
                       size_t begin, size_t end, double *blocks) {
    (void)matrix;
    if (!system->pairs->failed)
        cs_pair_matrix_add_blocks(system->pairs->blocks, begin, end, blocks);
}

static void add_product(const struct cs_system *system, const double *p, double *y) {
    if (!system->pairs->failed)
        cs_pair_matrix_apply(&system->pairs->solver_matrix, p, y);
}

static void add_approach(const struct cs_system *system, const struct cs_matrix *matrix,
                         double *y) {
    if (!system->pairs->failed)
        cs_pair_matrix_approach(&system->pairs->solver_matrix, system->surfaces->n_points,
                                cs_surface_points_velocities(system, matrix->t, matrix->v), y);
}

static void add_bound_at(const struct cs_system *system, const struct cs_eval *at,
                         const struct cs_gershgorin *sums) {
    struct cs_pairs *pairs = system->pairs;
    struct cs_narrow_phase narrow = {.query = CS_QUERY_BOUND, .eval = *at};
    run(pairs, &narrow);
    const struct cs_gather *gather = &pairs->current_contacts->force_gather;
    if (pairs->current_contacts->n)
        cs_gather_add(gather, gather->row_sums, 2, 0, system->view.n, sums->stiffness);
}

static struct cs_plan_row plan_pairs(const struct cs_scene *scene) {
    const bool built = cs_scene_has_body_contact(scene);
    return (struct cs_plan_row){
        .built = built,
        .reason = built ? "self_contact, pairs of bodies, or a mesh collider" : NULL};
}

const struct cs_term cs_term_pairs = {
    .name = "contact pairs",
    CS_CONTACT_TERM,
    .plan = plan_pairs,
    .build = build,
    .prepare = prepare,
    .add_force = add_pair_forces,
    .add_jvp = add_pair_forces,
    .energy = energy,
    .prepare_matrix = prepare_matrix,
    .add_blocks = add_blocks,
    .add_matrix_product = add_product,
    .add_approach = add_approach,
    .friction_chunks = friction_chunks,
    .store_friction = store_friction,
    .add_state_bound = add_bound_at,
};

/* Motion of surface points, and the swept-box test of pairs on all numbers of a point at once.
 */

/* One call of cs_point_motion_set. */
struct setting {
    const struct cs_system *system;
    const double *x0, *x1;
    struct cs_point_motion *motion;
};

static void set_some(void *arg, size_t begin, size_t end) {
    const struct setting *setting = arg;
    const size_t n = setting->system->surfaces->n_points;
    for (size_t i = begin; i < end; i++) {
        double *move = setting->motion[i].values;
        for (size_t c = 0; c < 3; c++) {
            const double from = setting->x0[c * n + i];
            move[CS_POINT_MOVE_FROM + c] = from;
            move[CS_POINT_MOVE_BY + c] = setting->x1[c * n + i] - from;
        }
        move[CS_POINT_MOVE_INVERSE_MASS] =
            cs_surface_points_inverse_mass(setting->system, (uint32_t)i);
    }
}

void cs_point_motion_set(const struct cs_system *system, const double *x0, const double *x1,
                         struct cs_point_motion *motion) {
    struct setting setting = {system, x0, x1, motion};
    cs_vector_parallel_for(system->surfaces->n_points, set_some, &setting);
}

/* 1 if the swept boxes of both primitives may come within reach. Differences of the bounds of
 * both sides are taken for positions and displacements alike; point p[1] belongs to the first
 * side of two edges, else to the triangle. */
CS_INLINE uint32_t boxes_may_overlap(bool edges, const double *restrict p[4], double reach) {
    double below[CS_POINT_MOVE_NUMBERS], above[CS_POINT_MOVE_NUMBERS];
    for (int k = 0; k < CS_POINT_MOVE_NUMBERS; k++) {
        const double a = p[0][k], b = p[1][k], c = p[2][k], d = p[3][k];
        const double low = cs_fmin(c, d), high = cs_fmax(c, d);
        const double least = edges ? cs_fmin(a, b) : a, most = edges ? cs_fmax(a, b) : a;
        below[k] = least - (edges ? high : cs_fmax(b, high));
        above[k] = most - (edges ? low : cs_fmin(b, low));
    }
    uint32_t meet = 1;
    for (int c = 0; c < 3; c++) {
        const double closing = below[CS_POINT_MOVE_BY + c],
                     opening = above[CS_POINT_MOVE_BY + c];
        meet &= below[c] + (closing < 0 ? closing : 0) <= reach;
        meet &= above[c] + (opening > 0 ? opening : 0) >= -reach;
    }
    return meet;
}

CS_INLINE size_t filter(bool edges, const struct cs_point_motion *restrict motion,
                        const struct cs_moving_pairs *pairs, double reach, uint32_t *out) {
    const uint32_t *of = edges ? pairs->surfaces->edges : pairs->surfaces->triangles;
    size_t n = 0;
    for (size_t k = 0; k < 2 * pairs->n; k += 2) {
        const uint32_t i = pairs->items[k], j = pairs->items[k + 1];
        const uint32_t *first = edges ? of + 2 * (size_t)i : &i;
        const uint32_t *second = of + (edges ? 2 : 3) * (size_t)j;
        const double *p[4] = {motion[first[0]].values,
                              motion[edges ? first[1] : second[0]].values,
                              motion[edges ? second[0] : second[1]].values,
                              motion[edges ? second[1] : second[2]].values};
        // Compaction without a branch: a rejected pair is overwritten by the next.
        out[2 * n] = i;
        out[2 * n + 1] = j;
        n += boxes_may_overlap(edges, p, reach);
    }
    return n;
}

CS_CLONES static size_t sieve_triangles(const struct cs_point_motion *motion,
                                        const struct cs_moving_pairs *pairs, double reach,
                                        uint32_t *out) {
    return filter(false, motion, pairs, reach, out);
}

CS_CLONES static size_t sieve_edges(const struct cs_point_motion *motion,
                                    const struct cs_moving_pairs *pairs, double reach,
                                    uint32_t *out) {
    return filter(true, motion, pairs, reach, out);
}

size_t cs_point_motion_filter(const struct cs_point_motion *motion,
                              const struct cs_moving_pairs *pairs, double reach,
                              uint32_t *out) {
    return pairs->edges ? sieve_edges(motion, pairs, reach, out)
                        : sieve_triangles(motion, pairs, reach, out);
}

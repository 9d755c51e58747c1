/* Builds the contact pairs of a system, and refuses bodies that start too close to themselves.
 */
#include "model/contact/narrow_phase/contact_pairs.h"
#include "model/contact/surface_points.h"

/* Refuses a body with two primitives closer than its thickness: contact would push it apart
 * from the first step on, because its edges leave no room for such a thickness. */
static enum cs_status check_start(const struct cs_pairs *pairs, struct cs_error *error) {
    const struct cs_candidates *search = &pairs->candidates;
    const size_t n = pairs->system->view.n;
    for (uint32_t l = 0; l < search->n_chunks; l++)
        for (size_t p = 0; p < search->chunks[l].n; p++) {
            uint32_t at[4];
            double places[4][3];
            struct cs_pair_distance s;
            cs_candidate_vertices(pairs->system->surfaces, search->chunks[l].kind,
                                  search->chunks[l].pairs + 2 * p, at);
            const uint32_t body = search->body[at[0]];
            if (body != search->body[at[2]])
                continue;
            for (size_t k = 0; k < 4; k++)
                for (size_t c = 0; c < 3; c++)
                    places[k][c] = pairs->system->start[c * n + at[k]];
            cs_pair_distance_set(&s, search->chunks[l].kind, places);
            const double range = cs_body_pair_params_range(
                cs_body_pair_params_of(&pairs->body_pairs, body, body),
                search->chunks[l].kind == CS_PAIR_EDGE_EDGE);
            const uint32_t first = pairs->system->bodies[body].first;
            if (s.d < range)
                return cs_fail(error, CS_ERR_SCENE,
                               "bodies[%u].self_contact: layers are only %.3g m apart at the "
                               "start (particles %u and %u), expected at least the thickness, "
                               "%.3g m; reduce bodies[%u].thickness",
                               body, s.d, at[0] - first, at[2] - first, range, body);
        }
    return CS_OK;
}

/* Prepares both lists of active contacts and the four matrices. */
static enum cs_status init_answers(struct cs_pairs *pairs, struct cs_arena *arena,
                                   struct cs_error *error) {
    const uint32_t n = pairs->system->view.n, n_chunks = pairs->candidates.n_chunks;
    for (int k = 0; k < 2; k++)
        if (cs_active_contacts_init(pairs->lists + k, &pairs->candidates,
                                    &pairs->feature_weights, arena, error))
            return error->status;
    if (cs_psd_operator_init(&pairs->solver_psd, n_chunks, arena, error) ||
        cs_psd_operator_init(&pairs->other_psd, n_chunks, arena, error) ||
        cs_contact_set_init(&pairs->solver_exact, n, n_chunks, arena, error))
        return error->status;
    return cs_contact_set_init(&pairs->other_exact, n, n_chunks, arena, error);
}

/* Order: surfaces, parameters of pairs, candidate list, features, queries; then the first list,
 * at the start positions, which check_start reads. */
enum cs_status cs_pairs_build(struct cs_system *system, struct cs_error *error) {
    if (cs_surface_points_build(system, error))
        return error->status;
    struct cs_pairs *pairs = cs_arena_alloc(&system->arena, sizeof *pairs, error);
    if (!pairs || cs_body_pair_table_build(system, &pairs->body_pairs, error) ||
        cs_candidates_init(&pairs->candidates, system, &pairs->body_pairs, error) ||
        cs_feature_weights_init(&pairs->feature_weights, system->surfaces, &system->arena,
                                error))
        return error->status;
    pairs->system = system;
    pairs->point_motion = cs_arena_alloc_array(&system->arena, system->surfaces->n_points,
                                               sizeof *pairs->point_motion, error);
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

/* Makes the pairs of a system, and refuses what starts too near to itself. */
#include "model/contact/points.h"
#include "model/pair/pairs.h"

/* Two parts of one body within its thickness would push it apart from the first step on: the
 * scene has a thickness that its edges have no room for. */
static enum cs_status check_start(const struct cs_pairs *pairs, struct cs_error *error) {
    const struct cs_search *search = &pairs->search;
    const size_t n = pairs->system->view.n;
    for (uint32_t l = 0; l < search->n_lots; l++)
        for (size_t p = 0; p < search->lots[l].n; p++) {
            uint32_t at[4];
            double places[4][3];
            struct cs_stencil s;
            cs_search_corners(pairs->system->surfaces, search->lots[l].kind,
                              search->lots[l].pairs + 2 * p, at);
            const uint32_t body = search->body[at[0]];
            if (body != search->body[at[2]])
                continue;
            for (size_t k = 0; k < 4; k++)
                for (size_t c = 0; c < 3; c++)
                    places[k][c] = pairs->system->start[c * n + at[k]];
            cs_stencil_set(&s, search->lots[l].kind, places);
            const double range = cs_meeting_range(cs_meeting_of(&pairs->meetings, body, body),
                                                  search->lots[l].kind == CS_STENCIL_EDGES);
            const uint32_t first = pairs->system->bodies[body].first;
            if (s.d < range)
                return cs_fail(error, CS_ERR_SCENE,
                               "bodies[%u].self_contact: parts of it start %.3g m from each "
                               "other (its particles %u and %u), expected at least its "
                               "thickness, %.3g m; give a smaller bodies[%u].thickness",
                               body, s.d, at[0] - first, at[2] - first, range, body);
        }
    return CS_OK;
}

static enum cs_status init_answers(struct cs_pairs *pairs, struct cs_arena *arena,
                                   struct cs_error *error) {
    const uint32_t n = pairs->system->view.n, n_lots = pairs->search.n_lots;
    for (int k = 0; k < 2; k++)
        if (cs_active_init(pairs->lists + k, &pairs->search, &pairs->facets, arena, error))
            return error->status;
    if (cs_product_init(&pairs->kept, n_lots, arena, error) ||
        cs_product_init(&pairs->other, n_lots, arena, error) ||
        cs_pair_set_init(&pairs->exact, n, n_lots, arena, error))
        return error->status;
    return cs_pair_set_init(&pairs->others, n, n_lots, arena, error);
}

enum cs_status cs_pairs_build(struct cs_system *system, struct cs_error *error) {
    if (cs_points_build(system, error))
        return error->status;
    struct cs_pairs *pairs = cs_arena_take(&system->arena, sizeof *pairs, error);
    if (!pairs || cs_meetings_build(system, &pairs->meetings, error) ||
        cs_search_init(&pairs->search, system, &pairs->meetings, error) ||
        cs_facets_init(&pairs->facets, system->surfaces, &system->arena, error))
        return error->status;
    pairs->system = system;
    pairs->moves = cs_arena_take_n(&system->arena, system->surfaces->n_points,
                                   sizeof *pairs->moves, error);
    pairs->now = pairs->lists;
    if (init_answers(pairs, &system->arena, error))
        return error->status;
    if (!cs_search_update(&pairs->search,
                          cs_points_places(system, CS_POINTS_BEGIN, 0, system->start)))
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the pairs of contact");
    system->pairs = pairs;
    return check_start(pairs, error);
}

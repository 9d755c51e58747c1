/* Blocks of grids: which are flat, and what is then passed over. */
#include "model/pair/search_flat.h"

#include <math.h>
#include <string.h>

static const struct cs_cluster_span nowhere = {{HUGE_VALF, HUGE_VALF},
                                               {-HUGE_VALF, -HUGE_VALF}};

/* --- made once --- */

/* points whose numbers are floats too */
enum { POINTS_MOST = 1 << 24 };

static bool is_grid(const struct cs_system *system, const struct cs_meetings *meetings,
                    uint32_t body) {
    if (body >= system->scene->bodies.n || !(cs_meeting_of(meetings, body, body)->range > 0))
        return false;
    const struct cs_body_range *range = system->bodies + body;
    return !range->mesh && range->columns > 1 && range->rows > 1 &&
           range->first + range->count <= POINTS_MOST;
}

static void add_grid(struct cs_search_flat *flat, const struct cs_body_range *range,
                     struct cs_flat **grid, struct cs_arena *arena, struct cs_error *error) {
    *grid = cs_arena_take(arena, sizeof **grid, error);
    if (error->status)
        return;
    // rows are numbered through by points, so that no two grids have one in common
    **grid = (struct cs_flat){.first = range->first,
                              .columns = range->columns,
                              .rows = range->rows,
                              .first_row = range->first,
                              .first_block = flat->n_blocks};
    if (!cs_flat_init(*grid, arena, error))
        flat->n_blocks += (*grid)->across * (*grid)->down;
}

enum cs_status cs_search_flat_init(struct cs_search_flat *flat, const struct cs_system *system,
                                   const struct cs_meetings *meetings, struct cs_arena *arena,
                                   struct cs_error *error) {
    const size_t n = system->surfaces->n_points;
    *flat = (struct cs_search_flat){.meetings = meetings, .n_points = n};
    flat->grids = cs_arena_take_n(arena, meetings->n_bodies, sizeof(struct cs_flat *), error);
    for (uint32_t b = 0; b < meetings->n_bodies && !error->status; b++)
        if (is_grid(system, meetings, b))
            add_grid(flat, system->bodies + b, flat->grids + b, arena, error);
    for (int kind = 0; kind < 2 && flat->n_blocks; kind++)
        flat->round[kind] =
            cs_arena_take_n(arena, flat->n_blocks, sizeof *flat->round[kind], error);
    if (flat->n_blocks)
        flat->from = cs_arena_take_n(arena, 3 * n, sizeof *flat->from, error);
    return error->status;
}

/* --- at a state --- */

/* the block in `down` and `across` with those round it */
static struct cs_cluster_span round_of(const struct cs_flat *grid, uint32_t down,
                                       uint32_t across) {
    const uint32_t top = CS_FLAT_BLOCK * (down ? down - 1 : 0);
    const uint32_t end = CS_FLAT_BLOCK * (down + 2);
    const uint32_t last = end < grid->rows ? end : grid->rows - 1;
    return (struct cs_cluster_span){
        {(float)(grid->first_row + top), (float)(CS_FLAT_BLOCK * (across ? across - 1 : 0))},
        {(float)(grid->first_row + last), (float)(CS_FLAT_BLOCK * (across + 2))}};
}

/* m, that parts of a body must be apart for a margin */
static double needed(const struct cs_search_flat *flat, uint32_t body, bool edges,
                     double margin) {
    return cs_meeting_range(cs_meeting_of(flat->meetings, body, body), edges) + 2 * margin;
}

static uint32_t find_in(const struct cs_flat *grid, double apart,
                        struct cs_cluster_span *round) {
    uint32_t n = 0;
    for (uint32_t b = 0; b < grid->across * grid->down; b++) {
        const bool is = grid->apart[b] >= apart;
        round[grid->first_block + b] =
            is ? round_of(grid, b / grid->across, b % grid->across) : nowhere;
        n += is;
    }
    return n;
}

static void keep(struct cs_search_flat *flat, const double *x, double margin) {
    memcpy(flat->from, x, 3 * flat->n_points * sizeof *x);
    flat->held = margin;
}

void cs_search_flat_find(struct cs_search_flat *flat, const double *x, double margin) {
    flat->n_flat = 0;
    for (uint32_t b = 0; b < flat->meetings->n_bodies; b++) {
        struct cs_flat *grid = flat->grids[b];
        if (grid)
            cs_flat_measure(grid, x, flat->n_points);
        for (int kind = 0; kind < 2 && grid; kind++)
            flat->n_flat += find_in(grid, needed(flat, b, kind == CS_STENCIL_EDGES, margin),
                                    flat->round[kind]);
    }
    if (flat->n_flat)
        keep(flat, x, margin);
}

static bool is_still(const struct cs_flat *grid, double apart,
                     const struct cs_cluster_span *round) {
    bool still = true;
    for (uint32_t b = 0; b < grid->across * grid->down; b++)
        still = still && (round[grid->first_block + b].first[0] == nowhere.first[0] ||
                          grid->apart[b] >= apart);
    return still;
}

bool cs_search_flat_renew(struct cs_search_flat *flat, const double *x, double margin) {
    bool still = true;
    for (uint32_t b = 0; b < flat->meetings->n_bodies && still; b++) {
        struct cs_flat *grid = flat->grids[b];
        if (grid)
            cs_flat_measure(grid, x, flat->n_points);
        for (int kind = 0; kind < 2 && grid; kind++)
            still = still && is_still(grid, needed(flat, b, kind == CS_STENCIL_EDGES, margin),
                                      flat->round[kind]);
    }
    if (still)
        keep(flat, x, margin);
    return still;
}

/* When a list is made, and for how long it is good. */
#include "model/pair/search.h"

#include "model/pair/search_find.h"

#include <clothsim/clones.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void finish(void *object) {
    struct cs_search *search = object;
    for (uint32_t l = 0; l < search->n_lots; l++) {
        free(search->lots[l].pairs);
        free(search->lots[l].close);
    }
    cs_search_find_finish(search);
}

static void cut(struct cs_search_lot *lots, enum cs_stencil_kind kind, uint32_t n) {
    for (uint32_t begin = 0; begin < n; begin += CS_SEARCH_LOT)
        lots[begin / CS_SEARCH_LOT] = (struct cs_search_lot){
            .kind = kind,
            .begin = begin,
            .end = n - begin > CS_SEARCH_LOT ? begin + CS_SEARCH_LOT : n};
}

enum cs_status cs_search_init(struct cs_search *search, struct cs_system *system,
                              const struct cs_meetings *meetings, struct cs_error *error) {
    struct cs_arena *arena = &system->arena;
    const struct cs_surfaces *surfaces = system->surfaces;
    const uint32_t n = surfaces->n_points;
    const uint32_t point_lots = (n + CS_SEARCH_LOT - 1) / CS_SEARCH_LOT;
    const uint32_t edge_lots = (surfaces->n_edges + CS_SEARCH_LOT - 1) / CS_SEARCH_LOT;
    *search = (struct cs_search){.system = system,
                                 .meetings = meetings,
                                 .margin = CS_SEARCH_MARGIN * meetings->least,
                                 .inverse = 1 / meetings->widest,
                                 .n_lots = point_lots + edge_lots};
    search->body = cs_arena_take_n(arena, n, sizeof *search->body, error);
    search->from = cs_arena_take_n(arena, 3 * (size_t)n, sizeof *search->from, error);
    search->close_at = cs_arena_take_n(arena, 3 * (size_t)n, sizeof *search->from, error);
    search->rough = cs_arena_take_n(arena, n, sizeof *search->rough, error);
    search->lots = cs_arena_take_n(arena, search->n_lots, sizeof *search->lots, error);
    search->drift =
        cs_arena_take_n(arena, 4 * (size_t)meetings->n_bodies, sizeof *search->drift, error);
    if (error->status || cs_search_flat_init(&search->flat, system, meetings, arena, error) ||
        cs_search_find_init(search, arena, error))
        return error->status;
    for (uint32_t b = 0; b < meetings->n_bodies; b++)
        for (uint32_t i = surfaces->first_point[b]; i < surfaces->first_point[b + 1]; i++)
            search->body[i] = b;
    cut(search->lots, CS_STENCIL_TRIANGLE, n);
    cut(search->lots + point_lots, CS_STENCIL_EDGES, surfaces->n_edges);
    cs_arena_own(arena, finish, search, error);
    return error->status;
}

/* --- how long the list is good --- */

/* several vectors: of fewer the compiler makes single numbers */
enum { LANES = 32 };

/* least and greatest move of each lane */
struct span {
    double low[LANES], high[LANES];
};

CS_INLINE void widen(struct span *span, const double *now, const double *then) {
    for (int l = 0; l < LANES; l++) {
        const double move = now[l] - then[l];
        span->low[l] = move < span->low[l] ? move : span->low[l];
        span->high[l] = move > span->high[l] ? move : span->high[l];
    }
}

/* Into lane 0: least and greatest of now - then, the first one where that is not a number. By
 * lanes, as each comparison waits for the one before it. */
CS_CLONES static void find_span(const double *now, const double *then, size_t count,
                                struct span *out) {
    struct span span;
    for (int l = 0; l < LANES; l++)
        span.low[l] = span.high[l] = now[0] - then[0];
    for (size_t i = 0; i + LANES <= count; i += LANES)
        widen(&span, now + i, then + i);
    for (size_t i = count - count % LANES; i < count; i++) {
        const double move = now[i] - then[i];
        span.low[0] = move < span.low[0] ? move : span.low[0];
        span.high[0] = move > span.high[0] ? move : span.high[0];
    }
    for (int l = 1; l < LANES; l++) {
        span.low[0] = span.low[l] < span.low[0] ? span.low[l] : span.low[0];
        span.high[0] = span.high[l] > span.high[0] ? span.high[l] : span.high[0];
    }
    *out = span;
}

/* middle of the box about a body's moves since `then`, and half its diagonal */
static void measure_drift(const struct cs_search *search, uint32_t body, const double *from,
                          const double *x) {
    const struct cs_surfaces *surfaces = search->system->surfaces;
    const uint32_t first = surfaces->first_point[body];
    const size_t n = surfaces->n_points, count = surfaces->first_point[body + 1] - first;
    double *drift = search->drift + 4 * (size_t)body, squared = 0;
    for (size_t c = 0; c < 3; c++) {
        struct span span;
        find_span(x + c * n + first, from + c * n + first, count, &span);
        const double low = span.low[0], high = span.high[0];
        drift[c] = 0.5 * (low + high);
        squared += 0.25 * (high - low) * (high - low);
    }
    drift[3] = sqrt(squared);
}

/* what two bodies have moved by against each other at most; NAN counts as too far */
static double apart(const double *a, const double *b) {
    double squared = 0;
    for (int c = 0; c < 3; c++)
        squared += (a[c] - b[c]) * (a[c] - b[c]);
    return a[3] + b[3] + sqrt(squared);
}

static void measure_drifts(const struct cs_search *search, const double *from,
                           const double *x) {
    for (uint32_t b = 0; b < search->meetings->n_bodies; b++)
        if (search->meetings->any[b])
            measure_drift(search, b, from, x);
}

static bool is_good(const struct cs_search *search, const double *x) {
    const struct cs_meetings *meetings = search->meetings;
    bool good = search->fresh;
    if (good)
        measure_drifts(search, search->from, x);
    for (uint32_t a = 0; a < meetings->n_bodies && good; a++)
        for (uint32_t b = a; b < meetings->n_bodies; b++)
            good = good && (!(cs_meeting_of(meetings, a, b)->range > 0) ||
                            apart(search->drift + 4 * (size_t)a,
                                  search->drift + 4 * (size_t)b) <= 2 * search->held);
    return good;
}

/* m, that flat parts are to be good for in a list that is good for so much */
static double flat_margin(const struct cs_search *search, double margin) {
    const double usual = CS_SEARCH_FLAT_MARGIN * search->meetings->least;
    return margin < usual ? margin : usual;
}

/* whether what was flat has not moved too far to be it still */
static bool is_flat(const struct cs_search *search, const double *x) {
    const struct cs_search_flat *flat = &search->flat;
    bool good = true;
    if (flat->n_flat)
        measure_drifts(search, flat->from, x);
    for (uint32_t b = 0; flat->n_flat && b < search->meetings->n_bodies; b++)
        good = good && (!flat->grids[b] || search->drift[4 * (size_t)b + 3] <= flat->held);
    return good;
}

/* The list of the state `from`. false: no memory */
static bool build(struct cs_search *search, double margin, double flat) {
    cs_search_flat_find(&search->flat, search->from, flat);
    search->builds++;
    search->held = margin;
    cs_search_round(search, search->from);
    search->fresh = cs_search_find(search) && cs_search_list(search);
    return search->fresh;
}

bool cs_search_update(struct cs_search *search, const double *x) {
    const double flat = flat_margin(search, search->margin);
    if (is_good(search, x) &&
        (is_flat(search, x) || cs_search_flat_renew(&search->flat, x, flat)))
        return true;
    memcpy(search->from, x, 3 * sizeof *x * search->system->surfaces->n_points);
    return build(search, search->margin, flat);
}

/* --- for a whole move --- */

/* box about a body at both ends of a move, grown */
static struct cs_cell_box body_box(const struct cs_search *search, uint32_t body,
                                   const double *x0, const double *x1, double grow) {
    const struct cs_surfaces *surfaces = search->system->surfaces;
    const size_t n = surfaces->n_points;
    struct cs_cell_box box;
    for (size_t c = 0; c < 3; c++) {
        box.low[c] = HUGE_VAL;
        box.high[c] = -HUGE_VAL;
        for (size_t i = surfaces->first_point[body]; i < surfaces->first_point[body + 1]; i++) {
            box.low[c] = fmin(box.low[c], fmin(x0[c * n + i], x1[c * n + i]) - grow);
            box.high[c] = fmax(box.high[c], fmax(x0[c * n + i], x1[c * n + i]) + grow);
        }
    }
    return box;
}

/* whether two bodies come within their range of each other, as boxes, from x0 to x1 */
static bool may_come_near(const struct cs_search *search, uint32_t a, uint32_t b,
                          const double *x0, const double *x1) {
    const double range = cs_meeting_of(search->meetings, a, b)->range;
    const struct cs_cell_box first = body_box(search, a, x0, x1, range);
    const struct cs_cell_box second = body_box(search, b, x0, x1, 0);
    return cs_cell_boxes_meet(&first, &second);
}

/* The most by which particles that may meet move against each other, from x0 to x1; bodies that
 * stay away from each other do not count. */
static double largest_move(const struct cs_search *search, const double *x0, const double *x1) {
    const struct cs_meetings *meetings = search->meetings;
    double most = 0;
    measure_drifts(search, x0, x1);
    for (uint32_t a = 0; a < meetings->n_bodies; a++)
        for (uint32_t b = a; b < meetings->n_bodies; b++) {
            const double range = cs_meeting_of(meetings, a, b)->range;
            const double move =
                apart(search->drift + 4 * (size_t)a, search->drift + 4 * (size_t)b);
            if (range > 0 && move > most && (a == b || may_come_near(search, a, b, x0, x1)))
                most = move;
        }
    return most;
}

static bool is_covered(const struct cs_search *search, const double *x0, const double *x1) {
    return is_good(search, x0) && is_good(search, x1) && is_flat(search, x0) &&
           is_flat(search, x1);
}

/* ways of a step, at most, that the middle of a list lies ahead of it */
#define AHEAD 2

bool cs_search_cover(struct cs_search *search, const double *x0, const double *x1) {
    const size_t n = search->system->surfaces->n_points;
    if (is_covered(search, x0, x1))
        return true;
    const double move = largest_move(search, x0, x1) * (1 + 1e-9);
    // half of the way lies to both sides of its middle, and each particle goes half of that
    const double margin = fmax(search->margin, 0.25 * move);
    if (!(margin <= CS_SEARCH_FAR * CS_SEARCH_MARGIN * search->meetings->least))
        return false;
    // the next step goes on much as this one: the list is made as far along as it covers this
    const double along = fmin(2 * margin / move, AHEAD);
    for (size_t i = 0; i < 3 * n; i++)
        search->from[i] = x0[i] + along * (x1[i] - x0[i]);
    return build(search, margin, fmax(flat_margin(search, search->margin), 0.5 * along * move));
}

double cs_search_moves(const struct cs_search *search, const double *x0, const double *x1) {
    const struct cs_meetings *meetings = search->meetings;
    double most = 0;
    measure_drifts(search, x0, x1);
    for (uint32_t a = 0; a < meetings->n_bodies; a++)
        for (uint32_t b = a; b < meetings->n_bodies; b++) {
            const double range = cs_meeting_of(meetings, a, b)->range;
            const double moves =
                apart(search->drift + 4 * (size_t)a, search->drift + 4 * (size_t)b) / range;
            // not a number stays
            most = range > 0 && !(moves <= most) ? moves : most;
        }
    return most;
}

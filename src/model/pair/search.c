/* Lists of pairs: boxes into cells, then for each point and edge the boxes that it meets. */
#include "model/pair/search.h"

#include "base/pool.h"
#include "model/pair/nearness.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void finish(void *object) {
    struct cs_search *search = object;
    for (uint32_t l = 0; l < search->n_lots; l++)
        free(search->lots[l].pairs);
    cs_cells_finish(&search->triangles);
    cs_cells_finish(&search->edges);
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
    const uint32_t n = surfaces->n_points, n_boxes = surfaces->n_triangles + surfaces->n_edges;
    const uint32_t point_lots = (n + CS_SEARCH_LOT - 1) / CS_SEARCH_LOT;
    const uint32_t edge_lots = (surfaces->n_edges + CS_SEARCH_LOT - 1) / CS_SEARCH_LOT;
    *search = (struct cs_search){.system = system,
                                 .meetings = meetings,
                                 .margin = CS_SEARCH_MARGIN * meetings->least,
                                 .n_lots = point_lots + edge_lots};
    search->body = cs_arena_take_n(arena, n, sizeof *search->body, error);
    search->from = cs_arena_take_n(arena, 3 * (size_t)n, sizeof *search->from, error);
    search->boxes = cs_arena_take_n(arena, n_boxes, sizeof *search->boxes, error);
    search->lots = cs_arena_take_n(arena, search->n_lots, sizeof *search->lots, error);
    search->drift =
        cs_arena_take_n(arena, 4 * (size_t)meetings->n_bodies, sizeof *search->drift, error);
    if (error->status)
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

/* middle of the box about a body's moves since `then`, and half its diagonal */
static void measure_drift(const struct cs_search *search, uint32_t body, const double *from,
                          const double *x) {
    const struct cs_surfaces *surfaces = search->system->surfaces;
    const uint32_t first = surfaces->first_point[body];
    const size_t n = surfaces->n_points, count = surfaces->first_point[body + 1] - first;
    double *drift = search->drift + 4 * (size_t)body, squared = 0;
    for (size_t c = 0; c < 3; c++) {
        const double *now = x + c * n + first, *then = from + c * n + first;
        double low = now[0] - then[0], high = low;
        for (size_t i = 1; i < count; i++) {
            const double move = now[i] - then[i];
            low = move < low ? move : low;
            high = move > high ? move : high;
        }
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

/* --- the list --- */

struct job {
    struct cs_search *search;
    const double *x;
};

/* box about particles, grown to all sides */
static struct cs_cell_box box_of(const struct job *job, const uint32_t *at, size_t count,
                                 double grow) {
    const size_t n = job->search->system->surfaces->n_points;
    struct cs_cell_box box;
    for (size_t c = 0; c < 3; c++) {
        const double *x = job->x + c * n;
        box.low[c] = box.high[c] = x[at[0]];
        for (size_t k = 1; k < count; k++) {
            box.low[c] = x[at[k]] < box.low[c] ? x[at[k]] : box.low[c];
            box.high[c] = x[at[k]] > box.high[c] ? x[at[k]] : box.high[c];
        }
        box.low[c] -= grow;
        box.high[c] += grow;
    }
    return box;
}

/* a body that meets none has empty boxes, which are in no cell */
static void fill_boxes(const struct job *job, const uint32_t *corners, size_t each, uint32_t n,
                       struct cs_cell_box *boxes) {
    const struct cs_search *search = job->search;
    // both boxes of a pair share the reach; the last bits are for rounding
    const double reach = (search->meetings->widest + 2 * search->held) * (1 + 1e-9);
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t *at = corners + each * i;
        boxes[i] = search->meetings->any[search->body[at[0]]]
                       ? box_of(job, at, each, 0.5 * reach)
                       : (struct cs_cell_box){{1, 1, 1}, {0, 0, 0}};
    }
}

static bool overlap(const struct cs_cell_box *a, const struct cs_cell_box *b) {
    bool apart = false;
    for (int c = 0; c < 3; c++)
        apart |= a->low[c] > b->high[c] || b->low[c] > a->high[c];
    return !apart;
}

static bool share_corner(const uint32_t at[4], enum cs_stencil_kind kind) {
    if (kind == CS_STENCIL_TRIANGLE)
        return at[0] == at[1] || at[0] == at[2] || at[0] == at[3];
    return at[0] == at[2] || at[0] == at[3] || at[1] == at[2] || at[1] == at[3];
}

static bool is_near(const struct job *job, enum cs_stencil_kind kind, const uint32_t pair[2]) {
    const struct cs_search *search = job->search;
    const size_t n = search->system->surfaces->n_points;
    uint32_t at[4];
    double p[4][3];
    cs_search_corners(search->system->surfaces, kind, pair, at);
    if (share_corner(at, kind))
        return false;
    const double range =
        cs_meeting_of(search->meetings, search->body[at[0]], search->body[at[2]])->range;
    const double reach = (range + 2 * search->held) * (1 + 1e-9);
    if (!(range > 0))
        return false;
    for (size_t k = 0; k < 4; k++)
        for (size_t c = 0; c < 3; c++)
            p[k][c] = job->x[c * n + at[k]];
    const double squared =
        kind == CS_STENCIL_EDGES ? cs_nearness_edges(p) : cs_nearness_triangle(p);
    return squared < reach * reach;
}

static void keep(struct cs_search_lot *lot, uint32_t first, uint32_t second) {
    uint32_t *pairs = cs_arena_grow(lot->pairs, &lot->room, lot->n + 1, 2 * sizeof *pairs);
    lot->failed = lot->failed || !pairs;
    if (!pairs)
        return;
    lot->pairs = pairs;
    pairs[2 * lot->n] = first;
    pairs[2 * lot->n + 1] = second;
    lot->n++;
}

/* the rows of a first are short */
static void sort_row(uint32_t *pairs, size_t n) {
    for (size_t i = 1; i < n; i++) {
        const uint32_t second = pairs[2 * i + 1];
        size_t j = i;
        for (; j > 0 && pairs[2 * j - 1] > second; j--)
            pairs[2 * j + 1] = pairs[2 * j - 1];
        pairs[2 * j + 1] = second;
    }
}

/* Two boxes meet in several cells. The one that counts is that of the lower corner of what they
 * share: the higher of both first cells along each axis. The other box is in the cell `at`, so
 * that its first cell is not above it. */
static bool is_first_cell(const struct cs_cells *cells, const struct cs_cell_box *other,
                          const uint32_t first[3], const uint32_t at[3]) {
    bool counts = true;
    for (int c = 0; c < 3; c++)
        counts =
            counts && (at[c] == first[c] || cs_cells_along(cells, other->low[c], c) == at[c]);
    return counts;
}

/* Pairs of one point or edge. */
static void find_pairs(const struct job *job, struct cs_search_lot *lot, uint32_t item) {
    const struct cs_search *search = job->search;
    const struct cs_surfaces *surfaces = search->system->surfaces;
    const bool edges = lot->kind == CS_STENCIL_EDGES;
    const struct cs_cells *cells = edges ? &search->edges : &search->triangles;
    const struct cs_cell_box *boxes = search->boxes + (edges ? surfaces->n_triangles : 0);
    const double reach = (search->meetings->widest + 2 * search->held) * (1 + 1e-9);
    const struct cs_cell_box box = edges ? boxes[item] : box_of(job, &item, 1, 0.5 * reach);
    const size_t before = lot->n;
    uint32_t first[3], last[3], at[3];
    cs_cells_span(cells, &box, first, last);
    for (at[2] = first[2]; at[2] <= last[2]; at[2]++)
        for (at[1] = first[1]; at[1] <= last[1]; at[1]++)
            for (at[0] = first[0]; at[0] <= last[0]; at[0]++) {
                const size_t cell = cs_cells_at(cells, at[0], at[1], at[2]);
                for (uint32_t s = cells->starts[cell]; s < cells->starts[cell + 1]; s++) {
                    const uint32_t other = cells->items[s];
                    if ((edges && other <= item) || !overlap(&box, boxes + other))
                        continue;
                    if (is_first_cell(cells, boxes + other, first, at) &&
                        is_near(job, lot->kind, (uint32_t[2]){item, other}))
                        keep(lot, item, other);
                }
            }
    if (lot->n > before)
        sort_row(lot->pairs + 2 * before, lot->n - before);
}

static void list_lot(void *arg, uint32_t number) {
    const struct job *job = arg;
    const struct cs_search *search = job->search;
    const struct cs_surfaces *surfaces = search->system->surfaces;
    struct cs_search_lot *lot = search->lots + number;
    const bool edges = lot->kind == CS_STENCIL_EDGES;
    const struct cs_cells *cells = edges ? &search->edges : &search->triangles;
    lot->n = 0;
    lot->failed = false;
    for (uint32_t i = lot->begin; i < lot->end && cells->dim[0]; i++)
        if (search->meetings->any[search->body[edges ? surfaces->edges[2 * (size_t)i] : i]])
            find_pairs(job, lot, i);
}

/* The list of the state `from`. false: no memory */
static bool build(struct cs_search *search, double margin) {
    const struct cs_surfaces *surfaces = search->system->surfaces;
    struct job job = {search, search->from};
    struct cs_cell_box *edges = search->boxes + surfaces->n_triangles;
    search->builds++;
    search->held = margin;
    fill_boxes(&job, surfaces->triangles, 3, surfaces->n_triangles, search->boxes);
    fill_boxes(&job, surfaces->edges, 2, surfaces->n_edges, edges);
    bool failed = !cs_cells_fill(&search->triangles, search->boxes, surfaces->n_triangles) ||
                  !cs_cells_fill(&search->edges, edges, surfaces->n_edges);
    cs_pool_run(search->n_lots, list_lot, &job);
    for (uint32_t l = 0; l < search->n_lots; l++)
        failed = failed || search->lots[l].failed;
    search->fresh = !failed;
    return !failed;
}

bool cs_search_update(struct cs_search *search, const double *x) {
    if (is_good(search, x))
        return true;
    memcpy(search->from, x, 3 * sizeof *x * search->system->surfaces->n_points);
    return build(search, search->margin);
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
            if (!(range > 0) || move <= most)
                continue;
            const struct cs_cell_box first = body_box(search, a, x0, x1, range);
            const struct cs_cell_box second = body_box(search, b, x0, x1, 0);
            if (a == b || overlap(&first, &second))
                most = move;
        }
    return most;
}

bool cs_search_cover(struct cs_search *search, const double *x0, const double *x1) {
    const size_t n = search->system->surfaces->n_points;
    if (is_good(search, x0) && is_good(search, x1))
        return true;
    // a quarter of the move lies to both sides of the middle, for each of two particles
    const double margin =
        fmax(search->margin, 0.25 * largest_move(search, x0, x1) * (1 + 1e-9));
    if (!(margin <= CS_SEARCH_FAR * search->margin))
        return false;
    for (size_t i = 0; i < 3 * n; i++)
        search->from[i] = x0[i] + 0.5 * (x1[i] - x0[i]);
    return build(search, margin);
}

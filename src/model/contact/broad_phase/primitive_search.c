/* Clusters of all primitives, and the pairs of a move.
 *
 * A body that moves as a whole must not find itself on its way. So each body b is searched in a
 * frame that moves with the middle m of its own displacements: with positions in [p, P] at the
 * start and displacements in [d, D], the box of a primitive in that frame is
 *
 *   [p + min(0, d - m), P + max(0, D - m)]
 *
 * Boxes of two primitives in a common frame overlap if their swept boxes do, because
 * min(0, d - m) + min(0, m - D) <= min(0, d - D). */
#include "model/contact/broad_phase/primitive_search.h"

#include "base/pool.h"

#include <clothsim/clones.h>
#include <math.h>

/* clusters per batch, and clusters whose boxes one job sets */
enum { BATCH = 8, TOGETHER = 64 };

/* Coordinates from this magnitude in m on count as not finite. */
#define FAR 1e30

/* Fraction of the largest coordinate by which boxes grow: far more than the rounding of frames.
 */
#define ROUNDING 1e-12

static const struct cs_aabb empty = {{HUGE_VAL, HUGE_VAL, HUGE_VAL},
                                     {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};

/* --- made once --- */

static void finish_search(void *object) {
    struct cs_primitive_search *search = object;
    for (uint32_t b = 0; b < search->n_batches; b++)
        cs_nearby_clusters_finish(&search->batches[b].nearby);
    cs_aabb_clusters_finish(&search->triangles);
    cs_aabb_clusters_finish(&search->edges);
}

static enum cs_status alloc_boxes(struct cs_aabb_clusters *clusters, struct cs_arena *arena,
                                  struct cs_error *error) {
    CS_ARENA_ARRAY(arena, clusters->clusters, clusters->n, error);
    CS_ARENA_ARRAY(arena, clusters->cluster_boxes, clusters->n, error);
    return error->status;
}

static uint32_t count_batches(uint32_t clusters) {
    return (clusters + BATCH - 1) / BATCH;
}

/* Splits the clusters into batches. */
static enum cs_status alloc_batches(struct cs_primitive_search *search, struct cs_arena *arena,
                                    struct cs_error *error) {
    search->n_point_batches = count_batches(search->points.n);
    search->n_batches = search->n_point_batches + count_batches(search->edges.n);
    CS_ARENA_ARRAY(arena, search->batches, search->n_batches, error);
    for (uint32_t b = 0; b < search->n_batches && !error->status; b++) {
        const bool edges = b >= search->n_point_batches;
        const uint32_t n = edges ? search->edges.n : search->points.n;
        const uint32_t begin = BATCH * (edges ? b - search->n_point_batches : b);
        search->batches[b] = (struct cs_primitive_batch){
            .edges = edges, .begin = begin, .end = n - begin > BATCH ? begin + BATCH : n};
    }
    return error->status;
}

enum cs_status cs_primitive_search_init(struct cs_primitive_search *search,
                                        const struct cs_system *system, struct cs_arena *arena,
                                        struct cs_error *error) {
    const struct cs_surfaces *s = system->surfaces;
    const struct cs_body_range *grids = system->bodies;
    const uint32_t n = s->n_bodies, n_grids = system->scene->bodies.n;
    const struct cs_cluster_input points = {NULL, 1, s->first_point, n, grids, n_grids},
                                  edges = {s->edges, 2, s->first_edge, n, grids, n_grids},
                                  triangles = {s->triangles, 3,      s->first_triangle, n,
                                               grids,        n_grids};
    *search = (struct cs_primitive_search){.surfaces = s};
    search->body_sweeps = cs_arena_alloc_array(arena, n, sizeof *search->body_sweeps, error);
    if (error->status || cs_cluster_input_build(&points, &search->points, arena, error) ||
        cs_cluster_input_build(&edges, &search->edges, arena, error) ||
        cs_cluster_input_build(&triangles, &search->triangles, arena, error) ||
        alloc_boxes(&search->edges, arena, error) ||
        alloc_boxes(&search->triangles, arena, error) || alloc_batches(search, arena, error))
        return error->status;
    cs_arena_adopt(arena, finish_search, search, error);
    return error->status;
}

/* --- the pairs of a move --- */

/* One query, and a batch at work. */
struct move {
    struct cs_primitive_search *search;
    const struct cs_move_query *query;
    double grow[2]; /* m, of one box of a pair with a triangle, and of two edges */
    uint32_t first_batch;
};
struct work {
    const struct move *move;
    struct cs_primitive_batch *batch;
    uint32_t number;
    uint32_t pairs[CS_SEARCH_PAIRS][2];
    size_t n;
};

/* Swept box of an item by its one to three vertices; empty for CS_NO_ITEM, and if a vertex is
 * not finite. */
CS_INLINE struct cs_swept_aabb sweep_item(const struct move *move, uint32_t each,
                                          uint32_t item) {
    const struct cs_surfaces *surfaces = move->search->surfaces;
    const size_t n = surfaces->n_points;
    const double *x0 = move->query->x0, *x1 = move->query->x1;
    const uint32_t *points = each == 1   ? &item
                             : each == 2 ? surfaces->edges + 2 * (size_t)item
                                         : surfaces->triangles + 3 * (size_t)item;
    struct cs_swept_aabb swept = cs_swept_aabb_empty();
    if (item == CS_NO_ITEM)
        return swept;
    bool finite = true;
    for (uint32_t k = 0; k < each; k++) {
        for (size_t i = points[k]; i < 3 * n; i += n)
            finite &= fabs(x0[i]) < FAR && (!x1 || fabs(x1[i]) < FAR);
        cs_swept_aabb_add_point(&swept, n, points[k], x0, x1);
    }
    return finite ? swept : cs_swept_aabb_empty();
}

static void sweep_body(void *arg, uint32_t body) {
    const struct move *move = arg;
    const uint32_t *first = move->search->surfaces->first_point;
    struct cs_swept_aabb boxes = cs_swept_aabb_empty();
    for (uint32_t i = first[body]; i < first[body + 1]; i++) {
        const struct cs_swept_aabb one = sweep_item(move, 1, i);
        cs_swept_aabb_merge(&boxes, &one);
    }
    move->search->body_sweeps[body] = boxes;
}

/* Box of a swept box in the frame of a body, grown. */
CS_INLINE struct cs_aabb box_in_frame(const struct move *move,
                                      const struct cs_swept_aabb *swept, uint32_t body,
                                      double grow) {
    const struct cs_swept_aabb *boxes = move->search->body_sweeps + body;
    struct cs_aabb box;
    if (!(swept->position_max[0] >= swept->position_min[0]))
        return empty;
    for (int c = 0; c < 3; c++) {
        box.low[c] = swept->position_min[c] - grow;
        box.high[c] = swept->position_max[c] + grow;
    }
    for (int c = 0; c < 3 && move->query->x1; c++) {
        const double middle = 0.5 * (boxes->motion_min[c] + boxes->motion_max[c]);
        const double back = swept->motion_min[c] - middle, on = swept->motion_max[c] - middle;
        box.low[c] += (back < 0 ? back : 0);
        box.high[c] += (on > 0 ? on : 0);
    }
    return box;
}

/* The boxes of edges or triangles to be set. */
struct filling {
    const struct move *move;
    struct cs_aabb_clusters *clusters;
    bool edges;
};

/* Sets the boxes of the items of a cluster in the frame of their body, and their common box. */
static void fill_cluster(const struct filling *filling, uint32_t cluster) {
    const uint32_t *items = filling->clusters->items + CS_AABB_CLUSTER * (size_t)cluster;
    struct cs_aabb all = empty;
    for (uint32_t lane = 0; lane < CS_AABB_CLUSTER; lane++) {
        const struct cs_swept_aabb swept = filling->edges
                                               ? sweep_item(filling->move, 2, items[lane])
                                               : sweep_item(filling->move, 3, items[lane]);
        const struct cs_aabb box =
            box_in_frame(filling->move, &swept, filling->clusters->body[cluster],
                         filling->move->grow[filling->edges]);
        cs_aabb_cluster_set(filling->clusters->clusters + cluster, lane, &box);
        cs_aabb_merge(&all, &box);
    }
    filling->clusters->cluster_boxes[cluster] = all;
}

static void fill_some(void *arg, uint32_t block) {
    const struct filling *filling = arg;
    const uint32_t n = filling->clusters->n;
    for (uint32_t k = TOGETHER * block; k < TOGETHER * (block + 1) && k < n; k++)
        fill_cluster(filling, k);
}

/* Sets the boxes of all clusters and sorts them into cells; returns false if out of memory. */
static bool fill_clusters(const struct move *move, struct cs_aabb_clusters *clusters,
                          bool edges) {
    struct filling filling = {move, clusters, edges};
    cs_pool_run((clusters->n + TOGETHER - 1) / TOGETHER, fill_some, &filling);
    return cs_aabb_clusters_sort(clusters);
}

/* Hands over the pairs that were collected. */
static void hand_over(struct work *work) {
    const struct cs_move_query *query = work->move->query;
    if (work->n)
        query->take(query->arg, work->number, (const uint32_t(*)[2])work->pairs, work->n);
    work->n = 0;
}

/* Collects the pairs of an item with those found near it; of two edges once. */
static void collect(struct work *work, uint32_t item, const uint32_t *others, uint32_t n,
                    bool once) {
    for (uint32_t l = 0; l < n; l++) {
        if (once && others[l] <= item)
            continue;
        work->pairs[work->n][0] = item;
        work->pairs[work->n][1] = others[l];
        if (++work->n == CS_SEARCH_PAIRS)
            hand_over(work);
    }
}

/* Finds the pairs of one cluster with the primitives of one body. */
static void find_in_body(struct work *work, const uint32_t *items,
                         const struct cs_swept_aabb *sweeps, const struct cs_swept_aabb *all,
                         uint32_t body) {
    const struct move *move = work->move;
    const bool once = work->batch->edges && !move->query->pierce;
    const struct cs_aabb_clusters *others =
        once ? &move->search->edges : &move->search->triangles;
    struct cs_nearby_clusters *nearby = &work->batch->nearby;
    nearby->body = body;
    nearby->first_item = once ? items[0] : 0;
    const struct cs_aabb box = box_in_frame(move, all, body, move->grow[once]);
    if (!cs_nearby_clusters_find(nearby, others, &box)) {
        work->batch->failed = true;
        return;
    }
    for (uint32_t k = 0; k < CS_AABB_CLUSTER && nearby->n; k++) {
        const struct cs_aabb one = box_in_frame(move, sweeps + k, body, move->grow[once]);
        if (one.low[0] <= one.high[0])
            collect(work, items[k], nearby->items,
                    cs_nearby_clusters_items(nearby, others, &one), once);
    }
}

/* Finds all pairs of one cluster. Bodies that stay away from it are passed over. */
static void find_cluster(struct work *work, uint32_t cluster) {
    const struct move *move = work->move;
    const bool edges = work->batch->edges;
    const struct cs_aabb_clusters *of = edges ? &move->search->edges : &move->search->points;
    const uint32_t *items = of->items + CS_AABB_CLUSTER * (size_t)cluster;
    const uint32_t own = of->body[cluster];
    struct cs_swept_aabb sweeps[CS_AABB_CLUSTER], all = cs_swept_aabb_empty();
    for (uint32_t k = 0; k < CS_AABB_CLUSTER; k++) {
        sweeps[k] = edges ? sweep_item(move, 2, items[k]) : sweep_item(move, 1, items[k]);
        cs_swept_aabb_merge(&all, sweeps + k);
    }
    const bool once = edges && !move->query->pierce;
    for (uint32_t body = once ? own : 0; body < move->search->surfaces->n_bodies; body++)
        if (move->query->may_meet(move->query->arg, own, body) &&
            cs_swept_aabbs_overlap(&all, move->search->body_sweeps + body,
                                   2 * move->grow[once]))
            find_in_body(work, items, sweeps, &all, body);
}

static void find_batch(void *arg, uint32_t job) {
    const struct move *move = arg;
    const uint32_t number = move->first_batch + job;
    struct work work = {
        .move = move, .batch = move->search->batches + number, .number = number};
    work.batch->failed = false;
    for (uint32_t k = work.batch->begin; k < work.batch->end; k++)
        find_cluster(&work, k);
    hand_over(&work);
}

/* m, largest coordinate or displacement of all bodies */
static double largest(const struct move *move) {
    double most = 0;
    for (uint32_t b = 0; b < move->search->surfaces->n_bodies; b++) {
        const struct cs_swept_aabb *boxes = move->search->body_sweeps + b;
        for (int c = 0; c < 3 && boxes->position_max[c] >= boxes->position_min[c]; c++) {
            most = fmax(most, fmax(fabs(boxes->position_min[c]), fabs(boxes->position_max[c])));
            if (move->query->x1)
                most = fmax(most, fmax(fabs(boxes->motion_min[c]), fabs(boxes->motion_max[c])));
        }
    }
    return most;
}

bool cs_primitive_search_move(struct cs_primitive_search *search,
                              const struct cs_move_query *query) {
    struct move move = {.search = search,
                        .query = query,
                        .first_batch = query->pierce ? search->n_point_batches : 0};
    cs_pool_run(search->surfaces->n_bodies, sweep_body, &move);
    for (int k = 0; k < 2; k++)
        move.grow[k] = 0.5 * query->reach[k] + ROUNDING * largest(&move);
    bool failed = !fill_clusters(&move, &search->triangles, false) ||
                  (!query->pierce && !fill_clusters(&move, &search->edges, true));
    cs_pool_run(search->n_batches - move.first_batch, find_batch, &move);
    for (uint32_t b = move.first_batch; b < search->n_batches; b++)
        failed = failed || search->batches[b].failed;
    return !failed;
}

/* Trees of all primitives, and the pairs of a move.
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
#include <stdlib.h>

/* leaves whose boxes one job sets */
enum { TOGETHER = 64 };

/* Coordinates from this magnitude in m on count as not finite. */
#define FAR 1e30

/* Fraction of the largest coordinate by which boxes grow: far more than the rounding of frames.
 */
#define ROUNDING 1e-12

static uint32_t count_chunks(uint32_t items) {
    return (items + CS_SEARCH_CHUNK - 1) / CS_SEARCH_CHUNK;
}

enum cs_status cs_primitive_search_init(struct cs_primitive_search *search,
                                        const struct cs_surfaces *s, struct cs_arena *arena,
                                        struct cs_error *error) {
    const uint32_t n = s->n_bodies, n_points = count_chunks(s->n_points);
    *search = (struct cs_primitive_search){.surfaces = s,
                                           .n_point_chunks = n_points,
                                           .n_chunks = n_points + count_chunks(s->n_edges)};
    CS_ARENA_ARRAY(arena, search->body_sweeps, n, error);
    if (error->status || cs_aabb_tree_init(&search->edges, s->first_edge, n, arena, error))
        return error->status;
    return cs_aabb_tree_init(&search->triangles, s->first_triangle, n, arena, error);
}

/* --- the pairs of a move --- */

/* One query, and a chunk at work. */
struct move {
    struct cs_primitive_search *search;
    const struct cs_move_query *query;
    double grow[2]; /* m, of one box of a pair with a triangle, and of two edges */
    bool finite;    /* all coordinates are */
    uint32_t first_chunk;
};
struct work {
    const struct move *move;
    bool edges, once; /* items are edges; others are edges too, and each pair is sought once */
    uint32_t chunk;
    struct cs_near_list near; /* leaves near the items at hand */
    uint32_t pairs[CS_SEARCH_PAIRS][2];
    size_t n;
};

/* Returns whether all of some coordinates are below FAR. */
CS_CLONES static bool all_finite(const double *x, size_t n) {
    uint32_t far = 0;
    for (size_t i = 0; i < n; i++)
        far += fabs(x[i]) < FAR ? 0 : 1;
    return far == 0;
}

/* The same of those of a point, at both ends. */
static bool point_is_finite(const struct move *move, size_t i) {
    const size_t n = move->search->surfaces->n_points;
    bool finite = true;
    for (; i < 3 * n; i += n)
        finite &= all_finite(move->query->x0 + i, 1) &&
                  (!move->query->x1 || all_finite(move->query->x1 + i, 1));
    return finite;
}

/* Swept box of an item by its one to three vertices; empty if one is not finite. each, rests:
 * constants, so that there are no loops. */
CS_INLINE struct cs_swept_aabb sweep_vertices(const struct move *move, const uint32_t each,
                                              const bool rests, uint32_t item) {
    const struct cs_surfaces *surfaces = move->search->surfaces;
    const double *x0 = move->query->x0, *x1 = rests ? NULL : move->query->x1;
    const uint32_t *points = each == 1   ? &item
                             : each == 2 ? surfaces->edges + 2 * (size_t)item
                                         : surfaces->triangles + 3 * (size_t)item;
    struct cs_swept_aabb swept = cs_swept_aabb_empty();
    bool finite = true;
    for (uint32_t k = 0; k < each; k++) {
        finite = finite && (move->finite || point_is_finite(move, points[k]));
        cs_swept_aabb_add_point(&swept, surfaces->n_points, points[k], x0, x1);
    }
    return finite ? swept : cs_swept_aabb_empty();
}

CS_INLINE struct cs_swept_aabb sweep_item(const struct move *move, const uint32_t each,
                                          uint32_t item) {
    return move->query->x1 ? sweep_vertices(move, each, false, item)
                           : sweep_vertices(move, each, true, item);
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
    const bool moves = move->query->x1 && swept->position_max[0] >= swept->position_min[0];
    struct cs_aabb box;
    for (int c = 0; c < 3; c++) {
        double low = swept->position_min[c] - grow, high = swept->position_max[c] + grow;
        const double middle = 0.5 * (boxes->motion_min[c] + boxes->motion_max[c]);
        const double back = swept->motion_min[c] - middle, on = swept->motion_max[c] - middle;
        low += (moves ? (back < 0 ? back : 0) : 0);
        high += (moves ? (on > 0 ? on : 0) : 0);
        box.low[c] = (float)low;
        box.high[c] = (float)high;
    }
    return box;
}

/* The boxes of edges or triangles to be set. */
struct filling {
    const struct move *move;
    struct cs_aabb_tree *tree;
    bool edges;
};

/* Sets the boxes of the items of a leaf in the frame of their body. */
static void fill_leaf(const struct filling *filling, uint32_t leaf) {
    const struct cs_aabb_tree *tree = filling->tree;
    const uint32_t body = cs_surfaces_body(tree->first_leaf, tree->n_bodies, leaf);
    const uint32_t first = cs_aabb_tree_item(tree, body, leaf), end = tree->first[body + 1];
    for (uint32_t lane = 0; lane < CS_AABB_NODE && first + lane < end; lane++) {
        const struct cs_swept_aabb swept = filling->edges
                                               ? sweep_item(filling->move, 2, first + lane)
                                               : sweep_item(filling->move, 3, first + lane);
        const struct cs_aabb box =
            box_in_frame(filling->move, &swept, body, filling->move->grow[filling->edges]);
        cs_aabb_node_set(tree->levels[0] + leaf, lane, &box);
    }
}

static void fill_some(void *arg, uint32_t block) {
    const struct filling *filling = arg;
    const uint32_t n = filling->tree->n_nodes[0];
    for (uint32_t k = TOGETHER * block; k < TOGETHER * (block + 1) && k < n; k++)
        fill_leaf(filling, k);
}

/* Sets the boxes of a tree. */
static void fill_tree(const struct move *move, struct cs_aabb_tree *tree, bool edges) {
    struct filling filling = {move, tree, edges};
    cs_pool_run((tree->n_nodes[0] + TOGETHER - 1) / TOGETHER, fill_some, &filling);
    cs_aabb_tree_fit(tree);
}

/* Hands over the pairs that were collected. */
static void hand_over(struct work *work) {
    const struct cs_move_query *query = work->move->query;
    if (work->n)
        query->take(query->arg, work->chunk, (const uint32_t(*)[2])work->pairs, work->n);
    work->n = 0;
}

/* Collects the pairs of an item with those of a leaf, whose first is given, by a mask. */
static void collect(struct work *work, uint32_t item, uint32_t first, uint32_t bits) {
    // only later ones; leaves are sought from that of the first of sixteen items on, so that an
    // item is at most 30 after the first of a leaf
    if (work->once && item >= first)
        bits &= (uint32_t)(UINT64_MAX << (item - first + 1));
    for (; bits; bits &= bits - 1) {
        work->pairs[work->n][0] = item;
        work->pairs[work->n][1] = first + (uint32_t)__builtin_ctz(bits);
        if (++work->n == CS_SEARCH_PAIRS)
            hand_over(work);
    }
}

/* Finds the pairs of one item in the leaves near it. */
static void find_item(struct work *work, const struct cs_aabb_tree *others, uint32_t item,
                      const struct cs_swept_aabb *sweep) {
    struct cs_aabb box;
    for (size_t k = 0; k < work->near.n; k++) {
        const struct cs_near_leaves *near = work->near.items + k;
        if (k == 0 || near->body != near[-1].body)
            box = box_in_frame(work->move, sweep, near->body, work->move->grow[work->once]);
        for (uint32_t some = cs_aabb_node_overlaps(&near->boxes, &box); some;
             some &= some - 1) {
            const uint32_t leaf = near->leaves[__builtin_ctz(some)];
            collect(work, item, cs_aabb_tree_item(others, near->body, leaf),
                    cs_aabb_node_overlaps(others->levels[0] + leaf, &box));
        }
    }
}

/* Finds all pairs of up to CS_AABB_NODE items of a body, from `first` on. Bodies that stay away
 * from them are passed over. */
static void find_items(struct work *work, uint32_t own, uint32_t first, uint32_t n) {
    const struct move *move = work->move;
    const bool once = work->once;
    const struct cs_aabb_tree *others = once ? &move->search->edges : &move->search->triangles;
    struct cs_swept_aabb sweeps[CS_AABB_NODE], all = cs_swept_aabb_empty();
    for (uint32_t k = 0; k < n; k++) {
        sweeps[k] =
            work->edges ? sweep_item(move, 2, first + k) : sweep_item(move, 1, first + k);
        cs_swept_aabb_merge(&all, sweeps + k);
    }
    work->near.n = 0;
    // leaves once for all items, in the order of bodies
    for (uint32_t body = once ? own : 0; body < move->search->surfaces->n_bodies; body++) {
        const struct cs_aabb box = box_in_frame(move, &all, body, move->grow[once]);
        if (move->query->may_meet(move->query->arg, own, body) &&
            cs_swept_aabbs_overlap(&all, move->search->body_sweeps + body,
                                   2 * move->grow[once]))
            cs_aabb_tree_find(others, body, once ? first : 0, &box, &work->near);
    }
    for (uint32_t k = 0; k < n && work->near.n; k++)
        find_item(work, others, first + k, sweeps + k);
}

/* Goes through a chunk by items of one body. */
static void find_chunk(void *arg, uint32_t job) {
    const struct move *move = arg;
    struct cs_primitive_search *search = move->search;
    const struct cs_surfaces *s = search->surfaces;
    struct work work = {.move = move, .chunk = move->first_chunk + job};
    work.edges = work.chunk >= search->n_point_chunks;
    work.once = work.edges && !move->query->pierce;
    const uint32_t *first = work.edges ? s->first_edge : s->first_point;
    uint32_t item =
        CS_SEARCH_CHUNK * (work.edges ? work.chunk - search->n_point_chunks : work.chunk);
    const uint32_t all = first[s->n_bodies];
    const uint32_t end = all - item > CS_SEARCH_CHUNK ? item + CS_SEARCH_CHUNK : all;
    // a chunk may have items of several bodies
    for (uint32_t n; item < end; item += n) {
        const uint32_t body = cs_surfaces_body(first, s->n_bodies, item);
        const uint32_t left = (first[body + 1] < end ? first[body + 1] : end) - item;
        n = left < CS_AABB_NODE ? left : CS_AABB_NODE;
        find_items(&work, body, item, n);
    }
    hand_over(&work);
    free(work.near.items);
    if (work.near.failed)
        __atomic_store_n(&search->failed, true, __ATOMIC_RELAXED);
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
                        .first_chunk = query->pierce ? search->n_point_chunks : 0};
    const size_t n = 3 * (size_t)search->surfaces->n_points;
    move.finite = all_finite(query->x0, n) && (!query->x1 || all_finite(query->x1, n));
    search->failed = false;
    cs_pool_run(search->surfaces->n_bodies, sweep_body, &move);
    for (int k = 0; k < 2; k++)
        move.grow[k] = 0.5 * query->reach[k] + ROUNDING * largest(&move);
    fill_tree(&move, &search->triangles, false);
    if (!query->pierce)
        fill_tree(&move, &search->edges, true);
    cs_pool_run(search->n_chunks - move.first_chunk, find_chunk, &move);
    return !search->failed;
}

/* primitive_search.h - the search for pairs of points, edges and triangles whose boxes overlap,
 * at a state or swept along straight lines.
 *
 * Edges and triangles are in trees (aabb_tree.h). Points and edges ask them in chunks, which
 * threads share. The candidate list of a state (candidates_find.c),
 * crossings and first collisions (ccd/crossings.h) ask it. */
#ifndef CS_BROAD_PHASE_PRIMITIVE_SEARCH_H
#define CS_BROAD_PHASE_PRIMITIVE_SEARCH_H

#include "model/contact/broad_phase/aabb_tree.h"
#include "model/system/surfaces.h"

#include <float.h>

/* Bounding box of points at the start of a move, and bounding box of their displacements, in m.
 * The two are kept apart, so that the common part of two motions cancels in a test. */
struct cs_swept_aabb {
    double position_min[3], position_max[3];
    double motion_min[3], motion_max[3];
};

/* Box of no points: the neutral element of merging. */
static inline struct cs_swept_aabb cs_swept_aabb_empty(void) {
    const double b = DBL_MAX;
    return (struct cs_swept_aabb){{b, b, b}, {-b, -b, -b}, {b, b, b}, {-b, -b, -b}};
}

/* Extends [*low, *high] to contain [below, above]. NaN extends nothing. */
static inline void cs_swept_aabb_widen(double *low, double *high, double below, double above) {
    // not a number widens nothing
    *low = below < *low ? below : *low;
    *high = above > *high ? above : *high;
}

/* Adds point i of (3,n), which moves from x0 to x1; x1 NULL: it stays, and no displacement is
 * added. */
static inline void cs_swept_aabb_add_point(struct cs_swept_aabb *swept_box, size_t n, size_t i,
                                           const double *x0, const double *x1) {
    for (size_t c = 0; c < 3; c++) {
        const double x = x0[c * n + i], move = x1 ? x1[c * n + i] - x : 0;
        cs_swept_aabb_widen(swept_box->position_min + c, swept_box->position_max + c, x, x);
        if (x1)
            cs_swept_aabb_widen(swept_box->motion_min + c, swept_box->motion_max + c, move,
                                move);
    }
}

/* Extends a box to contain another. */
static inline void cs_swept_aabb_merge(struct cs_swept_aabb *swept_box,
                                       const struct cs_swept_aabb *other) {
    for (size_t c = 0; c < 3; c++) {
        cs_swept_aabb_widen(swept_box->position_min + c, swept_box->position_max + c,
                            other->position_min[c], other->position_max[c]);
        cs_swept_aabb_widen(swept_box->motion_min + c, swept_box->motion_max + c,
                            other->motion_min[c], other->motion_max[c]);
    }
}

/* Returns whether points of a may come within `reach` in m of points of b, along each axis, at
 * the same fraction s in [0, 1] of the move. Per axis the difference of two points is
 *
 *   a0 - b0 + s (da - db) >= position_min(a) - position_max(b) + min(0, motion_min(a) -
 * motion_max(b))
 *
 * and likewise from above. Only relative displacements enter: a common motion costs nothing.
 * For boxes at rest the test is exact; otherwise it is conservative, since s may differ per
 * axis. NaN counts as no overlap. */
static inline bool cs_swept_aabbs_overlap(const struct cs_swept_aabb *a,
                                          const struct cs_swept_aabb *b, double reach) {
    for (size_t c = 0; c < 3; c++) {
        const double closing = a->motion_min[c] - b->motion_max[c],
                     opening = a->motion_max[c] - b->motion_min[c];
        const double low =
            a->position_min[c] - b->position_max[c] + (closing < 0 ? closing : 0);
        const double high =
            a->position_max[c] - b->position_min[c] + (opening > 0 ? opening : 0);
        if (!(low <= reach && high >= -reach))
            return false;
    }
    return true;
}

/* Points or edges per chunk, the unit of work of threads. The order of sums depends on the
 * chunk size, never on threads. */
enum { CS_SEARCH_CHUNK = 128 };

/* All primitives of a system. */
struct cs_primitive_search {
    const struct cs_surfaces *surfaces; /* borrowed */
    struct cs_aabb_tree edges, triangles;
    uint32_t n_point_chunks, n_chunks; /* chunks of points come before those of edges */
    /* (n_bodies) of the last move */
    struct cs_swept_aabb *body_sweeps;
    bool failed; /* there was no memory */
};

/* Makes the trees of all primitives. The arena owns all memory. CS_ERR_MEMORY. */
enum cs_status cs_primitive_search_init(struct cs_primitive_search *search,
                                        const struct cs_surfaces *surfaces,
                                        struct cs_arena *arena, struct cs_error *error);

/* most pairs that are handed over at once */
enum { CS_SEARCH_PAIRS = 256 };

/* A query for the pairs of a move. All pointers are borrowed. */
struct cs_move_query {
    const double *x0, *x1; /* (3,n_points) m; x1 NULL: at rest */
    double reach[2];       /* m, of pairs with a triangle, and of two edges */
    /* edges are sought with triangles; else points with triangles, and edges with edges */
    bool pierce;
    /* whether primitives of bodies a and b count */
    bool (*may_meet)(const void *arg, uint32_t a, uint32_t b);
    /* receives pairs of a chunk (n, 2), up to CS_SEARCH_PAIRS, in ascending order of the first
     * and then of the second item; of edges the smaller first */
    void (*take)(void *arg, uint32_t chunk, const uint32_t (*pairs)[2], size_t n);
    void *arg;
};

/* Hands over all pairs whose swept boxes come within reach (cs_swept_aabbs_overlap), each once,
 * and some more; those with a common vertex are not left out. Points that are not finite are in
 * no pair. Chunks run in parallel. Returns false if out of memory; pairs are then missing. */
bool cs_primitive_search_move(struct cs_primitive_search *search,
                              const struct cs_move_query *query);

#endif

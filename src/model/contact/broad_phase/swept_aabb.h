/* swept_aabb.h - swept bounding boxes of points that move along straight lines. */
#ifndef CS_SWEPT_AABB_H
#define CS_SWEPT_AABB_H

#include <float.h>
#include <stdbool.h>
#include <stddef.h>

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

/* Adds point i of (3,n), which moves from x0 to x1; x1 NULL: it stays. */
static inline void cs_swept_aabb_add_point(struct cs_swept_aabb *swept_box, size_t n, size_t i,
                                           const double *x0, const double *x1) {
    for (size_t c = 0; c < 3; c++) {
        const double x = x0[c * n + i], move = x1 ? x1[c * n + i] - x : 0;
        cs_swept_aabb_widen(swept_box->position_min + c, swept_box->position_max + c, x, x);
        cs_swept_aabb_widen(swept_box->motion_min + c, swept_box->motion_max + c, move, move);
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

#endif

/* distance_filter.h - which pairs may be nearer to each other than a reach: in single
 * precision, all of a chunk at once, so that the question costs a few nanoseconds a pair.
 *
 * What it lets through is to be asked in double; what it holds back is further apart for
 * certain. Single precision moves a place by 6e-8 of what it is, and the foot of a
 * perpendicular along a sliver by 1e-3 of the longest edge, where slivers are at last taken for
 * segments; more than twice that is allowed. */
#ifndef CS_BROAD_PHASE_DISTANCE_FILTER_H
#define CS_BROAD_PHASE_DISTANCE_FILTER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* pairs that are asked about together */
enum { CS_DISTANCE_FILTER = 64 };

/* A place against the first of all, in units of a length that the caller chooses: about that of
 * the things themselves, so that their squares are far from the ends of the numbers. */
struct cs_scaled_point {
    float xyz0[4]; /* the last is 0 */
};

/* Pairs of one kind; lanes from n on have numbers that mean nothing. */
struct cs_distance_filter {
    float points[4][3][CS_DISTANCE_FILTER]; /* a point and a triangle's corners, or the ends of
                                               two edges */
    float max_distance[CS_DISTANCE_FILTER]; /* in their units */
    float ratio[CS_DISTANCE_FILTER];        /* of its distance squared over the reach's: for
                                               cs_distance_filter_run */
    uint32_t pairs[CS_DISTANCE_FILTER][2];  /* the caller's */
    uint32_t n;
};

/* places [begin, end) of x (3, n); inverse: 1/unit */
void cs_distance_filter_scale_points(const double *x, size_t n, double inverse, size_t begin,
                                     size_t end, struct cs_scaled_point *places);

/* Adds a pair; there must be room. Returns whether that was the last of it. */
static inline bool cs_distance_filter_add(struct cs_distance_filter *filter,
                                          const struct cs_scaled_point *places,
                                          const uint32_t at[4], double reach,
                                          const uint32_t pair[2]) {
    const uint32_t l = filter->n++;
    for (int k = 0; k < 4; k++)
        for (int c = 0; c < 3; c++)
            filter->points[k][c][l] = places[at[k]].xyz0[c];
    filter->max_distance[l] = (float)reach;
    filter->pairs[l][0] = pair[0];
    filter->pairs[l][1] = pair[1];
    return filter->n == CS_DISTANCE_FILTER;
}

/* Empties the distance filter: the pairs that may be nearer than their reach come first in
 * distance filter->pairs, in the order in which they were added; returns how many. Pairs with
 * places that are not finite are among them. */
uint32_t cs_distance_filter_run(struct cs_distance_filter *filter, bool edges);

#endif

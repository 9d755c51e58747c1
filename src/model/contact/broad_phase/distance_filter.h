/* distance_filter.h - removes pairs that are certainly out of range, in single precision, 64 at
 * a time, for a few nanoseconds per pair.
 *
 * Pairs that pass must be tested again in double precision; pairs that are removed are
 * guaranteed to be out of range. R is the reach, P the distance of the pair's first point from
 * the origin, L the root of the sum of squares of the edges u, v and the difference w. A pair
 * is removed if its distance d in single precision satisfies
 *
 *   d^2 > 1.02 R^2 + 102 ((1e-6 P)^2 + (2e-3 L)^2) >= (R + 1e-6 P + 2e-3 L)^2
 *
 * which needs no square root. The inequality is (a + b)^2 <= (1 + 1/50) a^2 + (1 + 50) b^2,
 * then (b1 + b2)^2 <= 2 (b1^2 + b2^2). Why 1e-6 P + 2e-3 L exceeds the error of d, with the
 * unit roundoff eps = 2^-24 = 6e-8:
 *
 * - Positions are rounded by eps of their size, so two contact points move apart by at most
 *   about 2 eps (P + L) = 1.2e-7 (P + L). 1e-6 P is eight times that.
 * - Let s be the sine of the angle of u and v. The errors of u x v and a c - b^2 are a few
 *   eps |u| |v| and eps a c. Relative to their size, s |u| |v| and s^2 a c, these are eps/s and
 *   eps/s^2.
 * - The normal of a triangle then turns by about eps/s, and the height over its plane is off by
 *   L eps/s. Feet are off by eps/s^2 along an edge, and by L eps/s across it. A foot wrongly
 *   taken for outside is that close to an edge, whose distance then stands for the plane's. A
 *   foot wrongly taken for inside gives a distance that is too small, which is safe.
 * - The parameter of two edges is off by eps/s^2 too. The parameters found from it are optimal
 *   again, and along both edges together the distance changes by at most s per length: again
 *   L eps/s.
 * - Up to s^2 = 1e-6, s = 1e-3, a triangle is reduced to its edges: none of its points is
 *   further than s L = 1e-3 L from them. Edges up to there start from an end, which by the
 *   argument above costs at most s L. Beyond, eps/s is below 6e-5 per rounding.
 *
 * The largest of these is 1e-3 L, for slivers; 2e-3 L leaves twice as much. */
#ifndef CS_BROAD_PHASE_DISTANCE_FILTER_H
#define CS_BROAD_PHASE_DISTANCE_FILTER_H

#include "model/contact/pair_distance.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* capacity: pairs that are tested together */
enum { CS_DISTANCE_FILTER = 64 };

/* A position relative to the first point of all, in a unit that the caller chooses. A unit near
 * the size of the primitives keeps squares far from the ends of the range of floats. */
struct cs_scaled_point {
    float xyz0[4]; /* the last is 0 */
};

/* Pairs of one kind; lanes from n on hold unspecified numbers. */
struct cs_distance_filter {
    /* a point and the vertices of a triangle, or the ends of two edges, in units */
    float points[4][3][CS_DISTANCE_FILTER];
    /* reach R in units */
    float max_distance[CS_DISTANCE_FILTER];
    /* d^2 less the right side above; positive: the pair is removed */
    float ratio[CS_DISTANCE_FILTER];
    /* identity of each pair; only the caller reads it */
    uint32_t pairs[CS_DISTANCE_FILTER][2];
    uint32_t n;
};

/* Sets places [begin, end) from x (3, n) in m; inverse: 1/unit in 1/m. */
void cs_distance_filter_scale_points(const double *x, size_t n, double inverse, size_t begin,
                                     size_t end, struct cs_scaled_point *points);

/* Adds a pair with the points at[4]; there must be room. Returns whether the filter is full. */
static inline bool cs_distance_filter_add(struct cs_distance_filter *filter,
                                          const struct cs_scaled_point *points,
                                          const uint32_t at[4], double reach,
                                          const uint32_t pair[2]) {
    const uint32_t l = filter->n++;
    for (int k = 0; k < 4; k++)
        for (int c = 0; c < 3; c++)
            filter->points[k][c][l] = points[at[k]].xyz0[c];
    filter->max_distance[l] = (float)reach;
    filter->pairs[l][0] = pair[0];
    filter->pairs[l][1] = pair[1];
    return filter->n == CS_DISTANCE_FILTER;
}

/* Sets `ratio` of all lanes. */
void cs_distance_filter_measure(enum cs_pair_kind kind, struct cs_distance_filter *filter);

/* R^2 of the inequality above with its factor, to change the reach after measuring. */
static inline float cs_distance_filter_bound(float reach) {
    return 1.02f * reach * reach;
}

/* Empties the filter and returns how many pairs pass. These come first in filter->pairs, in the
 * order in which they were added. Pairs with positions that are not finite pass. */
uint32_t cs_distance_filter_run(enum cs_pair_kind kind, struct cs_distance_filter *filter);

#endif

/* point_motion.h - the points of all surfaces during a step, each with all of it in one place:
 * what is asked of a step reads the points of pairs, which lie anywhere. */
#ifndef CS_CONTACT_POINT_MOTION_H
#define CS_CONTACT_POINT_MOTION_H

#include "model/system/surfaces.h"

/* A line of the cache: where the step begins in m, 1/kg as cs_surface_points_inverse_mass, the
 * way to where it ends in m, and 0. */
enum {
    CS_POINT_MOVE_FROM = 0,
    CS_POINT_MOVE_INVERSE_MASS = 3,
    CS_POINT_MOVE_BY = 4,
    CS_POINT_MOVE_NUMBERS = 8
};
struct cs_point_motion {
    double values[CS_POINT_MOVE_NUMBERS];
};

/* Sets moves (n_points) to the straight ways from x0 to x1 (3,n_points). */
void cs_point_motion_set(const struct cs_system *system, const double *x0, const double *x1,
                         struct cs_point_motion *moves);

/* Pairs of a point and a triangle, or of two edges. */
struct cs_moving_pairs {
    const struct cs_surfaces *surfaces;
    bool edges;
    const uint32_t *items; /* (n, 2) by their numbers */
    size_t n;
};

/* Copies to out (n, 2) those of the pairs whose two parts may come as near to each other as
 * reach, in m, at one share of the move: cs_swept_aabbs_overlap (swept_aabb.h) of their own
 * points. Returns how many; a few nanoseconds a pair. */
size_t cs_point_motion_filter(const struct cs_point_motion *moves,
                              const struct cs_moving_pairs *pairs, double reach, uint32_t *out);

#endif

/* point_motion.h - start, displacement and inverse mass of every surface point, one cache line
 * per point, because pairs access points at random. */
#ifndef CS_CONTACT_POINT_MOTION_H
#define CS_CONTACT_POINT_MOTION_H

#include "model/system/surfaces.h"

/* Indices of the eight numbers of a point: start (3, m), inverse mass (1/kg), displacement (3,
 * m), and one that is 0. */
enum {
    CS_POINT_MOVE_FROM = 0,
    CS_POINT_MOVE_INVERSE_MASS = 3,
    CS_POINT_MOVE_BY = 4,
    CS_POINT_MOVE_NUMBERS = 8
};
struct cs_point_motion {
    double values[CS_POINT_MOVE_NUMBERS];
};

/* Sets moves (n_points) for the straight motion from x0 to x1 (3,n_points). */
void cs_point_motion_set(const struct cs_system *system, const double *x0, const double *x1,
                         struct cs_point_motion *moves);

/* Pairs of a point and a triangle, or of two edges; borrowed. */
struct cs_moving_pairs {
    const struct cs_surfaces *surfaces;
    bool edges;
    const uint32_t *items; /* (n, 2) by their numbers */
    size_t n;
};

/* Copies to out (n, 2) the pairs whose primitives may come within `reach` in m at one fraction
 * of the move: cs_swept_aabbs_overlap (swept_aabb.h) of their own points. Returns how many; a
 * few nanoseconds per pair. out must have room for all pairs. */
size_t cs_point_motion_filter(const struct cs_point_motion *moves,
                              const struct cs_moving_pairs *pairs, double reach, uint32_t *out);

#endif

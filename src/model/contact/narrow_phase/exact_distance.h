/* exact_distance.h - the true distances of points, triangles and edges, squared: where the
 * smooth ones of pair_distance.h must not be asked, since they may jump where the true ones
 * move little. */
#ifndef CS_NARROW_PHASE_EXACT_DISTANCE_H
#define CS_NARROW_PHASE_EXACT_DISTANCE_H

#include "model/contact/pair_distance.h"

/* Pairs of one kind; lanes that hold none have numbers that mean nothing. */
enum { CS_EXACT_DISTANCE_LANES = 8 };
struct cs_exact_distance_lanes {
    double p[4][3][CS_EXACT_DISTANCE_LANES];
    double squared[CS_EXACT_DISTANCE_LANES];
};

/* squared = of point p[0] from the triangle p[1] p[2] p[3], or of the edges p[0] p[1] and
 * p[2] p[3]. Exact but for rounding; triangles without area and edges without length are what
 * is left of them. Not finite, or 0, where p is not finite. */
void cs_exact_distance_measure(enum cs_pair_kind kind, struct cs_exact_distance_lanes *lanes);

#endif

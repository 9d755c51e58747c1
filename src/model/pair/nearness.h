/* nearness.h - the true distances of points, triangles and edges, squared: where the smooth
 * ones of stencil.h must not be asked, since they may jump where the true ones move little. */
#ifndef CS_PAIR_NEARNESS_H
#define CS_PAIR_NEARNESS_H

#include "model/pair/stencil.h"

/* Pairs of one kind; lanes that hold none have numbers that mean nothing. */
enum { CS_NEARNESS_LANES = 8 };
struct cs_nearness_lanes {
    double p[4][3][CS_NEARNESS_LANES];
    double squared[CS_NEARNESS_LANES];
};

/* squared = of point p[0] from the triangle p[1] p[2] p[3], or of the edges p[0] p[1] and
 * p[2] p[3]. Exact but for rounding; triangles without area and edges without length are what
 * is left of them. Not finite, or 0, where p is not finite. */
void cs_nearness_measure(enum cs_stencil_kind kind, struct cs_nearness_lanes *lanes);

#endif

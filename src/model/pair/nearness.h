/* nearness.h - the true distances of points, triangles and edges, squared: where the smooth
 * ones of stencil.h must not be asked, since they may jump where the true ones move little. */
#ifndef CS_PAIR_NEARNESS_H
#define CS_PAIR_NEARNESS_H

#include "model/pair/stencil.h"

/* true where they are further apart than range along one of the axes, and so in space: a test
 * of a few nanoseconds. Of numbers that are not finite it may say either. */
bool cs_nearness_is_apart(enum cs_stencil_kind kind, double p[4][3], double range);

/* Of point p[0] from the triangle p[1] p[2] p[3], and of the edges p[0] p[1] and p[2] p[3].
 * Exact but for rounding; triangles without area and edges without length are what is left of
 * them. Not finite, or 0, where p is not finite. */
double cs_nearness_triangle(double p[4][3]);
double cs_nearness_edges(double p[4][3]);

#endif

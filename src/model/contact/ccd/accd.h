/* accd.h - true distances of points, edges and triangles, and how far a move may go before it
 * closes one. */
#ifndef CS_ACCD_H
#define CS_ACCD_H

#include <stdbool.h>

/* The two kinds of pairs: point p[0] against triangle p[1..3], and edge p[0..1] against edge
 * p[2..3]. */
enum cs_primitive_pair_kind { CS_PRIMITIVE_POINT_TRIANGLE, CS_PRIMITIVE_EDGE_EDGE };

/* The square of the distance in m2. */
double cs_exact_distance_squared(enum cs_primitive_pair_kind kind, const double p[4][3]);

/* From this distance in m on a pair is taken to touch: rounding may have closed it, and a gap
 * that only ever shrinks comes to an end. */
#define CS_ACCD_DISTANCE_MIN 1e-9

/* A share 0..1 of the straight moves of the four points from p, within which the pair does not
 * meet: additive continuous collision detection (Li et al. 2021). The distance shrinks by no
 * more than the points move against their mean, so nine tenths of it are gone at a time, until
 * the move ends or a tenth of the first distance is left. 0: the pair touches at the start and
 * moves. At most `most`, which ends the search early. Moves that are not finite give `most`. */
double cs_accd_safe_fraction(enum cs_primitive_pair_kind kind, const double p[4][3],
                             const double moves[4][3], double most);

#endif

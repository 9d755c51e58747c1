/* accd.h - true distances of points, edges and triangles, and collision-free fractions of their
 * moves by additive continuous collision detection (ACCD). */
#ifndef CS_ACCD_H
#define CS_ACCD_H

#include "model/contact/pair_distance.h"

/* Squared distance in m2 of a pair with the points p (4,3) in m. */
double cs_exact_distance_squared(enum cs_pair_kind kind, const double p[4][3]);

/* m; a pair this close counts as touching. Smaller gaps are not told from rounding, and a gap
 * that only shrinks would never end the iteration. */
#define CS_ACCD_DISTANCE_MIN 1e-9

/* Returns a fraction, 0 to 1, of the straight moves of four points from p within which the pair
 * does not meet (Li et al. 2021).
 *
 * With the mean move taken off, l = largest move of one side + largest of the other bounds the
 * change of the distance: d(s + ds) >= d(s) - l ds. So s may grow by 0.9 d(s)/l without a
 * contact. This is repeated until the move ends or a tenth of the first distance is left. A
 * rigid translation has l = 0 and costs nothing.
 *
 * `most` is an upper bound of the result and ends the search early. 0: the pair touches at the
 * start and moves. Moves that are not finite give `most`. */
double cs_accd_safe_fraction(enum cs_pair_kind kind, const double p[4][3],
                             const double moves[4][3], double most);

#endif

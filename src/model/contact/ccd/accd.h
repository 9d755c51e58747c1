/* accd.h - true distances of points, edges and triangles, and collision-free fractions of their
 * moves by additive continuous collision detection (ACCD). */
#ifndef CS_ACCD_H
#define CS_ACCD_H

#include "model/system/particle_system.h"

#include <stdbool.h>

/* Point p[0] against triangle p[1..3], and edge p[0..1] against edge p[2..3]. */
enum cs_primitive_pair_kind { CS_PRIMITIVE_POINT_TRIANGLE, CS_PRIMITIVE_EDGE_EDGE };

/* Squared distance in m2 of a pair with the points p (4,3) in m. */
double cs_exact_distance_squared(enum cs_primitive_pair_kind kind, const double p[4][3]);

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
double cs_accd_safe_fraction(enum cs_primitive_pair_kind kind, const double p[4][3],
                             const double moves[4][3], double most);

/* Collision-free fraction of a step, computed from contact's candidate
 * list. */

/* Returns whether the candidate list contains all pairs of primitives that may meet on the way
 * from x0 to x1: contact is defined between all bodies, or `apart` says that the others may
 * cross, and the move is short. If so, the list covers the whole way afterwards. */
bool cs_accd_candidates_suffice(const struct cs_system *system, bool apart, const double *x0,
                                const double *x1);

/* cs_crossings_safe_fraction over the pairs of the list, bit for bit the same. With all
 * threads. Only after cs_accd_candidates_suffice returned true for the same x0 and x1. */
double cs_accd_candidates_safe_fraction(const struct cs_system *system, const double *x0,
                                        const double *x1);

#endif

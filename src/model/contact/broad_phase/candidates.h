/* candidates.h - which pairs of points and triangles, and of edges, may be in range.
 *
 * A list holds all pairs whose true distance was below their range, of edges the share of it
 * that these feel, + 2 margins when it was made,
 * and is good until particles have moved by more than that against each other: each body's
 * moves are taken against the middle of the moves of its particles, so that what falls as a
 * whole costs nothing. The smooth distance is never below the true one, so that none is missed.
 *
 * What the list holds beyond the pairs in range is not seen by anyone: a pair out of range adds
 * nothing at all, not even 0, and the pairs stand in the order of their keys (kind, first,
 * second) whatever the list. Sums are therefore functions of the state, and their bits the same
 * for every margin and at every age of the list.
 */
#ifndef CS_BROAD_PHASE_CANDIDATES_H
#define CS_BROAD_PHASE_CANDIDATES_H

#include "model/contact/broad_phase/candidate_list.h"

/* the margin as a share of the least range */
#define CS_CANDIDATES_MARGIN 0.35

/* Takes the fixed arrays from the system's arena, which then owns the lists too. CS_ERR_MEMORY.
 */
enum cs_status cs_candidates_init(struct cs_candidates *candidates, struct cs_system *system,
                                  const struct cs_body_pair_table *body_pairs,
                                  struct cs_error *error);

/* Makes the list good for x (3,n_points). false: there is no memory for it. */
bool cs_candidates_update(struct cs_candidates *candidates, const double *x);

/* Makes the list good for all states on the straight way from x0 to x1 (3,n_points). false:
 * there is no memory, or bodies that are near each other move so far against each other, or a
 * body within itself, that it would be too long: more than CS_CANDIDATES_FAR_MARGINS margins,
 * whatever the one in use. */
enum { CS_CANDIDATES_FAR_MARGINS = 8 };
bool cs_candidates_cover_step(struct cs_candidates *candidates, const double *x0,
                              const double *x1);

/* The most by which two bodies that meet, or one within itself, move against each other from x0
 * to x1, as a multiple of their range; not a number where a place is none. */
double cs_candidates_max_motion(const struct cs_candidates *candidates, const double *x0,
                                const double *x1);

/* Up to that many, a list that covers the way has all pairs that may come as near to each other
 * on it as a tenth of where they start: for with the start s, the least gap g <= s/10 and the
 * move m, s <= g + m, and so g <= m/9, which must be less than what edges feel. */
#define CS_CANDIDATES_ACCD_LIMIT (8.9 * CS_EDGE_RANGE_RATIO)

#endif

/* crossings.h - crossings of surfaces with each other and themselves: counts edges that pierce
 * triangles, and finds the first pair that meets in a step. Both ask the broad phase for pairs
 * (broad_phase/primitive_search.h), or its list where that holds all of them. */
#ifndef CS_CROSSINGS_H
#define CS_CROSSINGS_H

#include "base/text.h"
#include "model/contact/pair_distance.h"
#include "model/system/surfaces.h"

/* Number of crossings, and the first pair by (edge, triangle) if n > 0. */
struct cs_crossing_count {
    uint64_t n;
    uint32_t edge, triangle; /* the first pair by their numbers, where n > 0 */
};

/* Builds system->crossings in the system's arena, and the surfaces if they are missing.
 * CS_ERR_MEMORY. */
enum cs_status cs_crossings_build(struct cs_system *system, struct cs_error *error);

/* Counts the edges that pierce triangles at x (3,n) and t, exactly as edge_triangle.h defines
 * it: pairs of an edge and a triangle without a common particle, not both of colliders. The
 * result is the same on every machine and for any number of threads. */
struct cs_crossing_count cs_crossings_count(const struct cs_system *system, double t,
                                            const double *x);

/* The same at the start, only for bodies between which contact is defined (scene/body_pairs.h).
 */
struct cs_crossing_count cs_crossings_start(const struct cs_system *system);

/* As cs_crossings_count, and sets marks (n_triangles of system->surfaces) to 1 for pierced
 * triangles and those next to piercing edges, else 0. */
struct cs_crossing_count cs_crossings_mark(const struct cs_system *system, double t,
                                           const double *x, uint8_t *marks);

/* "12 edges go through triangles, the first from particle ..., through ..." */
void cs_crossings_print(const struct cs_system *system, const struct cs_crossing_count *count,
                        struct cs_text *out);

/* The first pair that meets in a move. */
struct cs_first_collision {
    double fraction; /* 0 to 1, collision-free part of the move; 1: no pair meets */
    /* the pair, where fraction is below 1 */
    enum cs_pair_kind kind;
    uint32_t points[4];
};

/* Finds the first collision of the straight move from x0 (3,n) at t0 to x1 at t1 among the
 * pairs of a point and a triangle, and of two edges, without a common particle (accd.h).
 * Fraction 0: a pair touches at x0 and moves. Pairs that cross at x0 already are not detected.
 * They are those of the list of contact's candidates if it holds all pairs that may meet, in
 * about a fifth of the time of a search, and the same to the bit. */
struct cs_first_collision cs_crossings_first_collision(const struct cs_system *system,
                                                       double t0, const double *x0, double t1,
                                                       const double *x1);

/* Its fraction alone. */
static inline double cs_crossings_safe_fraction(const struct cs_system *system, double t0,
                                                const double *x0, double t1, const double *x1) {
    return cs_crossings_first_collision(system, t0, x0, t1, x1).fraction;
}

/* Returns whether that list holds all pairs that may meet on the way from x0 to x1
 * (3,n_points): contact is defined between all bodies, or the limit is for those with contact
 * alone, and the move is short. If so, the list covers the whole way afterwards. */
bool cs_crossings_list_suffices(const struct cs_system *system, const double *x0,
                                const double *x1);

/* Returns whether a search ran out of memory: pairs are missing, and the run must end. */
bool cs_crossings_failed(const struct cs_system *system);

#endif

/* crossing_policy.h - the surfaces of a system against each other and themselves: how many
 * edges go through triangles, and how far a move may go before the first does. */
#ifndef CS_CROSSINGS_H
#define CS_CROSSINGS_H

#include "model/contact/ccd/representative_triangles.h"

/* What a count found. */
struct cs_crossing_count {
    uint64_t n;
    uint32_t edge, triangle; /* the first pair by their numbers, where n > 0 */
};

struct cs_crossings;

/* Makes system->crossings in the system's arena. CS_ERR_MEMORY. */
enum cs_status cs_crossings_build(struct cs_system *system, struct cs_error *error);

/* Counts the edges that go through triangles at x (3,n) and t: pairs of an edge and a triangle
 * without a particle in common, not both of obstacles, exactly as edge_triangle.h says. The
 * same on every machine and for every number of threads. */
struct cs_crossing_count cs_crossings_count(const struct cs_system *system, double t,
                                            const double *x);

/* The same at the start, of those alone that keep off each other (scene/body_pairs.h). */
struct cs_crossing_count cs_crossings_start(const struct cs_system *system);

/* The same as cs_crossings_count, and marks the triangles that are gone through and those
 * beside the edges that go through: marks (n_triangles of system->surfaces), 1 or 0. */
struct cs_crossing_count cs_crossings_mark(const struct cs_system *system, double t,
                                           const double *x, uint8_t *marks);

/* "12 edges go through triangles, the first from particle ..., through ..." */
void cs_crossings_print(const struct cs_system *system, const struct cs_crossing_count *count,
                        struct cs_text *out);

/* The largest share 0..1 of the straight move from x0 (3,n) at t0 to x1 at t1 in which no two
 * parts meet, by accd.h over all pairs of a point and a triangle and of two edges without a
 * particle in common. 0: a pair touches at x0, and moves. What crosses at x0 already is not
 * seen. */
double cs_crossings_safe_fraction(const struct cs_system *system, double t0, const double *x0,
                                  double t1, const double *x1);

#endif

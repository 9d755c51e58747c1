/* candidate_list.h - the candidate list: pairs of points and triangles, and of edges, that may
 * be in range, with a margin as in Verlet's list (Verlet 1967); in chunks, with the data of the
 * search.
 *
 * The list holds all pairs whose true distance was below range + 2 margins when it was built
 * (for edges, their fraction of the range). It is valid while no two points of a pair have
 * moved relative to each other by more than 2 margins. Motion is measured per body against the
 * middle of the displacements of its particles, so that a body that falls as a whole costs
 * nothing. The smooth distance is never below the true one, so no pair in range is missed.
 *
 * The additional pairs have no effect: a pair out of range adds nothing at all, not even 0, and
 * pairs are in the order of their keys (kind, first, second) in every list. Sums are therefore
 * functions of the state; their bits are the same for every margin and every age of the list.
 */
#ifndef CS_BROAD_PHASE_CANDIDATE_LIST_H
#define CS_BROAD_PHASE_CANDIDATE_LIST_H

#include "model/contact/body_pair_params.h"
#include "model/contact/broad_phase/distance_filter.h"
#include "model/contact/broad_phase/primitive_search.h"
#include "model/contact/pair_distance.h"

/* Candidates of the points or edges of a chunk of the search. */
struct cs_candidate_chunk {
    enum cs_pair_kind kind;
    uint32_t *pairs;    /* (n, 2): point and triangle, or edge and a later edge; ascending */
    size_t n, capacity; /* room in pairs */
    bool failed;        /* there was no memory */
    /* (n_in_range, 2) pairs in range, of cs_candidates_find_in_range */
    uint32_t *in_range;
    size_t n_in_range, close_capacity;
    /* (n_nearby, 2) those within CS_CANDIDATES_NEARBY ranges more, and perhaps some beyond */
    uint32_t *nearby;
    size_t n_nearby, nearby_capacity;
};

/* Ranges beyond the own one up to which candidates are nearby: explicit steps move less. */
#define CS_CANDIDATES_NEARBY 0.25

/* The candidate list of a system, its validity and the data of the search. */
struct cs_candidates {
    const struct cs_system *system;              /* borrowed */
    const struct cs_body_pair_table *body_pairs; /* borrowed */
    /* m, usual margin of a list */
    double margin;
    /* m, margin of the current list; larger after cs_candidates_cover_step */
    double margin_now;
    /* (n_points) body of each point */
    uint32_t *body;
    /* (3,n_points) m, state of the current list */
    double *x_at_build;
    struct cs_primitive_search search;
    struct cs_candidate_chunk *chunks; /* (n_chunks), as in the search: points first */
    uint32_t n_chunks;
    size_t n_listed; /* pairs in all chunks */
    /* (n_points) positions of the last state that was scaled */
    struct cs_scaled_point *scaled_points;
    /* 1/m, scale of scaled_points */
    double inverse_unit;
    double
        *body_motion; /* (4, n_bodies) middle of the moves of a body, and how far they reach */
    bool is_built;    /* the list was made */
    /* (3,n_points) m, state of the pairs in range */
    double *x_at_close;
    /* pairs in range belong to x_at_close */
    bool has_close_pairs;
    /* A search of the whole list collects pairs nearby if states follow each other closely. One
     * has, at x_at_nearby (3,n_points), and n_builds of its list. Only time depends on it. */
    bool has_nearby;
    double *x_at_nearby;
    uint64_t nearby_build;
    /* number of times that pairs in range were found: a version */
    uint64_t close_count;
    /* number of lists built */
    uint64_t n_builds;
};

/* Sets scaled_points to the positions x (3, n_points), with all threads. */
void cs_candidates_scale_points(struct cs_candidates *candidates, const double *x);

/* m, range of a candidate. If all ranges are equal, the bodies of the points are not read. */
static inline double cs_candidate_range_of(const struct cs_candidates *candidates,
                                           enum cs_pair_kind kind, const uint32_t at[4]) {
    const struct cs_body_pair_table *table = candidates->body_pairs;
    const struct cs_body_pair_params widest = {.range = table->range_max};
    return cs_body_pair_params_range(
        table->range_min == table->range_max
            ? &widest
            : cs_body_pair_params_of(table, candidates->body[at[0]], candidates->body[at[2]]),
        kind == CS_PAIR_EDGE_EDGE);
}

/* Sets at[4] to the points of a pair: point and triangle, or both ends of both edges. */
static inline void cs_candidate_vertices(const struct cs_surfaces *surfaces,
                                         enum cs_pair_kind kind, const uint32_t pair[2],
                                         uint32_t at[4]) {
    if (kind == CS_PAIR_EDGE_EDGE) {
        for (size_t k = 0; k < 4; k++)
            at[k] = surfaces->edges[2 * (size_t)pair[k / 2] + k % 2];
        return;
    }
    at[0] = pair[0];
    for (size_t k = 0; k < 3; k++)
        at[1 + k] = surfaces->triangles[3 * (size_t)pair[1] + k];
}

/* Fills all chunks for the state x_at_build, which scaled_points must hold too, and the margin
 * margin_now, with all threads. Returns false if out of memory. */
bool cs_candidates_find(struct cs_candidates *candidates);

/* Margin in units of the smallest range. A larger one makes longer lists that are rebuilt less
 * often. Chosen by trial. */
#define CS_CANDIDATES_MARGIN 0.35

/* Prepares an empty list. Fixed arrays come from the system's arena, which then owns the lists
 * too. body_pairs is borrowed. CS_ERR_MEMORY. */
enum cs_status cs_candidates_init(struct cs_candidates *candidates, struct cs_system *system,
                                  const struct cs_body_pair_table *body_pairs,
                                  struct cs_error *error);

/* Makes the list valid at x (3,n_points) in m; rebuilds it if particles have moved by more than
 * its margin. Returns false if out of memory. */
bool cs_candidates_update(struct cs_candidates *candidates, const double *x);

/* Makes the list valid for all states on the straight way from x0 to x1 (3,n_points). Returns
 * false if out of memory, or if nearby bodies, or parts of one, move so far relative to each
 * other that the list would become too long: more than CS_CANDIDATES_FAR_MARGINS usual margins.
 */
enum { CS_CANDIDATES_FAR_MARGINS = 8 };
bool cs_candidates_cover_step(struct cs_candidates *candidates, const double *x0,
                              const double *x1);

/* Largest relative motion from x0 to x1 of two bodies with contact, or within one, in units of
 * their range; NaN if a position is NaN. */
double cs_candidates_max_motion(const struct cs_candidates *candidates, const double *x0,
                                const double *x1);

/* Returns whether all pairs of the current list that are in range at x are among those nearby:
 * such a pair was further apart where these were collected by at most its relative motion. */
bool cs_candidates_is_nearby(const struct cs_candidates *candidates, const double *x);

/* Largest motion, in ranges, up to which a list that covers the way contains all pairs that
 * ACCD can stop. ACCD stops a pair whose gap g has fallen to a tenth of its start s. With the
 * motion m, s <= g + m and g <= s/10 give g <= m/9. That must be below the range of edges; 8.9
 * leaves room for rounding. */
#define CS_CANDIDATES_ACCD_LIMIT (8.9 * CS_EDGE_RANGE_RATIO)

#endif

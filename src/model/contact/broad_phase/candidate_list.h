/* candidate_list.h - the candidate list in chunks, and the data of the search. */
#ifndef CS_BROAD_PHASE_CANDIDATE_LIST_H
#define CS_BROAD_PHASE_CANDIDATE_LIST_H

#include "model/contact/broad_phase/candidates_flat.h"
#include "model/contact/broad_phase/distance_filter.h"
#include "model/contact/pair_distance.h"

/* Points or edges per chunk, and clusters per batch: the units of work of threads. The order of
 * sums depends on the chunk size, never on threads. */
enum { CS_CANDIDATE_CHUNK = 128, CS_CANDIDATE_BATCH = 8 };

/* Candidates of the points or edges [begin, end). */
struct cs_candidate_chunk {
    enum cs_pair_kind kind;
    uint32_t begin, end;
    uint32_t *pairs;    /* (n, 2): point and triangle, or edge and a later edge; ascending */
    size_t n, capacity; /* room in pairs */
    bool failed;        /* there was no memory */
    uint32_t
        /* (n_in_range, 2) pairs in range, of cs_candidates_find_in_range */
        *in_range;
    size_t n_in_range, close_capacity;
    /* answer of one chunk to a query over all candidates; the query defines it */
    double result;
};

/* Candidates of the items in the clusters [begin, end), item by item. */
struct cs_candidate_batch {
    enum cs_pair_kind kind;
    uint32_t begin, end;
    uint32_t *pairs; /* (n, 2) */
    size_t n, capacity;
    bool failed; /* there was no memory */
    /* work: clusters near the one at hand, of its own body and of others */
    struct cs_nearby_clusters query[2];
};

/* Candidates of one item: pairs begin to begin + n - 1 of a batch. */
struct cs_candidate_range {
    uint32_t batch, begin, n;
};

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
    struct cs_aabb_clusters points, triangles, edges;
    struct cs_candidates_flat flat_regions;
    struct cs_candidate_batch *batches;
    struct cs_candidate_range *rows[2]; /* of points, and of edges */
    struct cs_candidate_chunk *chunks;  /* points first */
    uint32_t n_batches, n_chunks;
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
    /* number of times that pairs in range were found: a version */
    uint64_t close_count;
    /* number of lists built */
    uint64_t n_builds;
};

/* Fills all chunks from the batches in the order of keys, with all threads. Returns false if
 * out of memory. */
bool cs_candidates_merge_batches(struct cs_candidates *candidates);

/* Sets scaled_points to the positions x (3, n_points), with all threads. */
void cs_candidates_scale_points(struct cs_candidates *candidates, const double *x);

/* m, range of a candidate. If all ranges are equal, the bodies of the points are not read. */
static inline double cs_candidate_range_of(const struct cs_candidates *candidates,
                                           enum cs_pair_kind kind, const uint32_t at[4]) {
    const struct cs_body_pair_table *meetings = candidates->body_pairs;
    const struct cs_body_pair_params widest = {.range = meetings->range_max};
    return cs_body_pair_params_range(meetings->range_min == meetings->range_max
                                         ? &widest
                                         : cs_body_pair_params_of(meetings,
                                                                  candidates->body[at[0]],
                                                                  candidates->body[at[2]]),
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

#endif

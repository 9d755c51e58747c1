/* candidate_list.h - the list of pairs that are near at a state, in chunks. */
#ifndef CS_BROAD_PHASE_CANDIDATE_LIST_H
#define CS_BROAD_PHASE_CANDIDATE_LIST_H

#include "model/contact/broad_phase/candidates_flat.h"
#include "model/contact/broad_phase/distance_filter.h"
#include "model/contact/pair_distance.h"

/* Points, or edges, whose pairs are in one chunk, and clusters of them for which pairs are
 * looked for together: they are one thread's. */
enum { CS_CANDIDATE_CHUNK = 128, CS_CANDIDATE_BATCH = 8 };

/* Pairs of the points or edges [begin, end). */
struct cs_candidate_chunk {
    enum cs_pair_kind kind;
    uint32_t begin, end;
    uint32_t *pairs;    /* (n, 2): point and triangle, or edge and a later edge; ascending */
    size_t n, capacity; /* room in pairs */
    bool failed;        /* there was no memory */
    uint32_t
        *in_range; /* (n_close, 2) those of them in range, of cs_candidates_find_in_range */
    size_t n_in_range, close_capacity;
    double result; /* to a question about the pairs of each chunk: who asks sets it */
};

/* Pairs of the points or edges in clusters [begin, end), one item after the other. */
struct cs_candidate_batch {
    enum cs_pair_kind kind;
    uint32_t begin, end;
    uint32_t *pairs; /* (n, 2) */
    size_t n, capacity;
    bool failed;                        /* there was no memory */
    struct cs_nearby_clusters query[2]; /* a cluster's, of its own body and of others */
};

/* Where those of an item are: pairs [begin, begin + n) of a batch. */
struct cs_candidate_range {
    uint32_t batch, begin, n;
};

struct cs_candidates {
    const struct cs_system *system;              /* borrowed */
    const struct cs_body_pair_table *body_pairs; /* borrowed */
    double margin;                               /* m, of new lists */
    double margin_now;  /* m, of the list as it is: more after cs_candidates_cover_step */
    uint32_t *body;     /* (n_points) of each point */
    double *x_at_build; /* (3,n_points) where the list was made */
    struct cs_aabb_clusters points, triangles, edges;
    struct cs_candidates_flat flat_regions;
    struct cs_candidate_batch *batches;
    struct cs_candidate_range *rows[2]; /* of points, and of edges */
    struct cs_candidate_chunk *chunks;  /* points first */
    uint32_t n_batches, n_chunks;
    size_t n_listed;                       /* pairs in all chunks */
    struct cs_scaled_point *scaled_points; /* (n_points) of the last state that was looked at */
    double inverse_unit;                   /* 1/m, of their unit */
    double
        *body_motion; /* (4, n_bodies) middle of the moves of a body, and how far they reach */
    bool is_built;    /* the list was made */
    double *x_at_close;   /* (3,n_points) where close pairs were found */
    bool has_close_pairs; /* they were */
    uint64_t close_count; /* how often */
    uint64_t n_builds;    /* lists that were made */
};

/* Fills all chunks from the batches, in the order of keys, with all threads. false: no memory.
 */
bool cs_candidates_merge_batches(struct cs_candidates *candidates);

/* Sets search->rough to the places x (3, n_points), with all threads. */
void cs_candidates_scale_points(struct cs_candidates *candidates, const double *x);

/* m, within which a pair of the list is felt: where all ranges are one, the bodies are not
 * asked for. */
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

/* Points of a pair. */
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

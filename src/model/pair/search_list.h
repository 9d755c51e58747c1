/* search_list.h - the list of pairs that are near at a state, in lots. */
#ifndef CS_PAIR_SEARCH_LIST_H
#define CS_PAIR_SEARCH_LIST_H

#include "model/near/sieve.h"
#include "model/pair/search_flat.h"
#include "model/pair/stencil.h"

/* Points, or edges, whose pairs are in one lot, and clusters of them for which pairs are looked
 * for together: they are one thread's. */
enum { CS_SEARCH_LOT = 128, CS_SEARCH_BATCH = 8 };

/* Pairs of the points or edges [begin, end). */
struct cs_search_lot {
    enum cs_stencil_kind kind;
    uint32_t begin, end;
    uint32_t *pairs; /* (n, 2): point and triangle, or edge and a later edge; ascending */
    size_t n, room;  /* room in pairs */
    bool failed;     /* there was no memory */
    uint32_t *close; /* (n_close, 2) those of them in range, of cs_close_find */
    size_t n_close, close_room;
    double answer; /* to a question about the pairs of each lot: who asks sets it */
};

/* Pairs of the points or edges in clusters [begin, end), one item after the other. */
struct cs_search_batch {
    enum cs_stencil_kind kind;
    uint32_t begin, end;
    uint32_t *pairs; /* (n, 2) */
    size_t n, room;
    bool failed;                    /* there was no memory */
    struct cs_cluster_near near[2]; /* a cluster's, of its own body and of others */
};

/* Where those of an item are: pairs [begin, begin + n) of a batch. */
struct cs_search_row {
    uint32_t batch, begin, n;
};

struct cs_search {
    const struct cs_system *system;     /* borrowed */
    const struct cs_meetings *meetings; /* borrowed */
    double margin;                      /* m, of new lists */
    double held;    /* m, of the list as it is: more after cs_search_cover */
    uint32_t *body; /* (n_points) of each point */
    double *from;   /* (3,n_points) where the list was made */
    struct cs_clusters points, triangles, edges;
    struct cs_search_flat flat;
    struct cs_search_batch *batches;
    struct cs_search_row *rows[2]; /* of points, and of edges */
    struct cs_search_lot *lots;    /* points first */
    uint32_t n_batches, n_lots;
    size_t n_listed;              /* pairs in all lots */
    struct cs_sieve_place *rough; /* (n_points) of the last state that was looked at */
    double inverse;               /* 1/m, of their unit */
    double *drift;    /* (4, n_bodies) middle of the moves of a body, and how far they reach */
    bool fresh;       /* the list was made */
    double *close_at; /* (3,n_points) where close pairs were found */
    bool closed;      /* they were */
    uint64_t found;   /* how often */
    uint64_t builds;  /* lists that were made */
};

/* Fills all lots from the batches, in the order of keys, with all threads. false: no memory. */
bool cs_search_list(struct cs_search *search);

/* Sets search->rough to the places x (3, n_points), with all threads. */
void cs_search_round(struct cs_search *search, const double *x);

/* m, within which a pair of the list is felt: where all ranges are one, the bodies are not
 * asked for. */
static inline double cs_search_range_of(const struct cs_search *search,
                                        enum cs_stencil_kind kind, const uint32_t at[4]) {
    const struct cs_meetings *meetings = search->meetings;
    const struct cs_meeting widest = {.range = meetings->widest};
    return cs_meeting_range(
        meetings->least == meetings->widest
            ? &widest
            : cs_meeting_of(meetings, search->body[at[0]], search->body[at[2]]),
        kind == CS_STENCIL_EDGES);
}

/* Points of a pair. */
static inline void cs_search_corners(const struct cs_surfaces *surfaces,
                                     enum cs_stencil_kind kind, const uint32_t pair[2],
                                     uint32_t at[4]) {
    if (kind == CS_STENCIL_EDGES) {
        for (size_t k = 0; k < 4; k++)
            at[k] = surfaces->edges[2 * (size_t)pair[k / 2] + k % 2];
        return;
    }
    at[0] = pair[0];
    for (size_t k = 0; k < 3; k++)
        at[1 + k] = surfaces->triangles[3 * (size_t)pair[1] + k];
}

#endif

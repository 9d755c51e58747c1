/* search.h - which pairs of points and triangles, and of edges, may be in range.
 *
 * A list holds all pairs whose true distance was below their range + 2 margin when it was made,
 * and is good until particles have moved by more than that against each other: each body's
 * moves are taken against the middle of the moves of its particles, so that what falls as a
 * whole costs nothing. The smooth distance is never below the true one, so that none is missed.
 *
 * What the list holds beyond the pairs in range is not seen by anyone: a pair out of range adds
 * nothing at all, not even 0, and the pairs stand in the order of their keys (kind, first,
 * second) whatever the list. Sums are therefore functions of the state, and their bits the same
 * for every margin and at every age of the list.
 */
#ifndef CS_PAIR_SEARCH_H
#define CS_PAIR_SEARCH_H

#include "model/pair/cells.h"
#include "model/pair/meeting.h"
#include "model/pair/stencil.h"

/* Points, or edges, whose pairs are listed together: they are one thread's. */
enum { CS_SEARCH_LOT = 128 };

/* the margin as a share of the least range */
#define CS_SEARCH_MARGIN 0.35

/* Pairs of the points or edges [begin, end). */
struct cs_search_lot {
    enum cs_stencil_kind kind;
    uint32_t begin, end;
    uint32_t *pairs; /* (n, 2): point and triangle, or edge and a later edge; ascending */
    size_t n, room;  /* room in pairs */
    bool failed;     /* there was no memory */
};

struct cs_search {
    const struct cs_system *system;     /* borrowed */
    const struct cs_meetings *meetings; /* borrowed */
    double margin;                      /* m, of new lists */
    double held;               /* m, of the list as it is: more after cs_search_cover */
    uint32_t *body;            /* (n_points) of each point */
    double *from;              /* (3,n_points) where the list was made */
    struct cs_cell_box *boxes; /* of triangles, then of edges */
    struct cs_cells triangles, edges;
    struct cs_search_lot *lots; /* points first */
    uint32_t n_lots;
    double *drift;   /* (4, n_bodies) middle of the moves of a body, and how far they reach */
    bool fresh;      /* the list was made */
    uint64_t builds; /* lists that were made */
};

/* Takes the fixed arrays from the system's arena, which then owns the lists too. CS_ERR_MEMORY.
 */
enum cs_status cs_search_init(struct cs_search *search, struct cs_system *system,
                              const struct cs_meetings *meetings, struct cs_error *error);

/* Makes the list good for x (3,n_points). false: there is no memory for it. */
bool cs_search_update(struct cs_search *search, const double *x);

/* Makes the list good for all states on the straight way from x0 to x1 (3,n_points). false:
 * there is no memory, or bodies that are near each other move so far against each other, or a
 * body within itself, that it would be too long: more than CS_SEARCH_FAR margins. */
enum { CS_SEARCH_FAR = 8 };
bool cs_search_cover(struct cs_search *search, const double *x0, const double *x1);

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

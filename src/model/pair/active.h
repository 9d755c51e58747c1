/* active.h - the pairs in range at a state, found once for all that is asked there: of a point
 * and a triangle the facets that the point feels, each once whatever the number of triangles
 * that have it. */
#ifndef CS_PAIR_ACTIVE_H
#define CS_PAIR_ACTIVE_H

#include "model/pair/facets.h"
#include "model/pair/gather.h"
#include "model/pair/lanes.h"
#include "model/pair/search.h"

/* Eight pairs as lanes take them; after the last pair numbers mean nothing. */
struct cs_active_block {
    double range[CS_PAIR_LANES], k[CS_PAIR_LANES], mu[CS_PAIR_LANES];
    double count[CS_PAIR_LANES], alone[CS_PAIR_LANES]; /* as in struct cs_facet_use */
    double rim[CS_PAIR_LANES], off[CS_PAIR_LANES], bend[CS_PAIR_LANES];
    double d[CS_PAIR_LANES]; /* m, of facets */
};

/* Those of one lot of the search. */
struct cs_active_lot {
    enum cs_stencil_kind kind;
    struct cs_active_block *blocks;
    uint32_t (*at)[4]; /* (n) points of each pair */
    uint32_t (*to)[4]; /* (n) and their rows, of cs_active_gather */
    size_t n;          /* pairs */
    size_t room, at_room, to_room;
    struct cs_facet_use *felt; /* of one point, while they are found */
    size_t felt_room;
    double energy; /* J, where it was asked for */
    bool failed;   /* there was no memory */
};

struct cs_active {
    const struct cs_search *search; /* borrowed, as facets are */
    const struct cs_facets *facets;
    struct cs_active_lot *lots; /* those of the search */
    uint64_t found;             /* the search's number of close pairs that they are of */
    uint64_t rubbed;            /* and the meetings' of frictions */
    size_t n;                   /* pairs of all lots */
    struct cs_gather gather;    /* with the lots' numbers */
    bool gathered;              /* it is set */
};

/* Fixed arrays from the arena, which then owns what grows too. CS_ERR_MEMORY. */
enum cs_status cs_active_init(struct cs_active *active, const struct cs_search *search,
                              const struct cs_facets *facets, struct cs_arena *arena,
                              struct cs_error *error);

/* Whether they are those of the search's close pairs. */
bool cs_active_is_there(const struct cs_active *active);

/* Sets them to those of the close pairs that were found at x (3, n_points). false: no memory.
 * With all threads. */
bool cs_active_find(struct cs_active *active, const double *x);

/* Gives rows to all their points, where it is not done yet. false: no memory. With all threads.
 */
bool cs_active_gather(struct cs_active *active);

#endif

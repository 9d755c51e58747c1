/* active_contacts.h - the pairs in range at a state, found once for all that is asked there: of
 * a point and a triangle the features that the point feels, each once whatever the number of
 * triangles that have it. */
#ifndef CS_NARROW_PHASE_ACTIVE_CONTACTS_H
#define CS_NARROW_PHASE_ACTIVE_CONTACTS_H

#include "model/contact/broad_phase/candidates.h"
#include "model/contact/narrow_phase/feature_weights.h"
#include "model/contact/narrow_phase/force_gather.h"
#include "model/contact/narrow_phase/pair_lanes.h"

/* Eight pairs as lanes take them; after the last pair numbers mean nothing. */
struct cs_active_lanes {
    double range[CS_PAIR_LANES], k[CS_PAIR_LANES], friction[CS_PAIR_LANES];
    double weight[CS_PAIR_LANES],
        psd_weight[CS_PAIR_LANES]; /* as in struct cs_weighted_feature */
    double is_edge[CS_PAIR_LANES], is_off_plane[CS_PAIR_LANES], blend_radius[CS_PAIR_LANES];
    double d[CS_PAIR_LANES]; /* m, of features */
};

/* Those of one chunk of the search. */
struct cs_active_chunk {
    enum cs_pair_kind kind;
    struct cs_active_lanes *blocks;
    uint32_t (*points)[4]; /* (n) points of each pair */
    uint32_t (*rows)[4];   /* (n) and their rows, of cs_active_contacts_gather */
    size_t n;              /* pairs */
    size_t capacity, points_capacity, rows_capacity;
    struct cs_weighted_feature *features; /* of one point, while they are found */
    size_t features_capacity;
    double energy; /* J, where it was asked for */
    bool failed;   /* there was no memory */
};

struct cs_active_contacts {
    const struct cs_candidates *candidates; /* borrowed, as features are */
    const struct cs_feature_weights *feature_weights;
    struct cs_active_chunk *chunks; /* those of the search */
    uint64_t candidates_version;    /* the search's number of close pairs that they are of */
    uint64_t friction_version;      /* and the meetings' of frictions */
    size_t n;                       /* pairs of all chunks */
    struct cs_gather force_gather;  /* with the chunks' numbers */
    bool is_gathered;               /* it is set */
};

/* Fixed arrays from the arena, which then owns what grows too. CS_ERR_MEMORY. */
enum cs_status cs_active_contacts_init(struct cs_active_contacts *active,
                                       const struct cs_candidates *search,
                                       const struct cs_feature_weights *facets,
                                       struct cs_arena *arena, struct cs_error *error);

/* Whether they are those of the search's close pairs. */
bool cs_active_contacts_is_there(const struct cs_active_contacts *active);

/* Sets them to those of the close pairs that were found at x (3, n_points). false: no memory.
 * With all threads. */
bool cs_active_contacts_find(struct cs_active_contacts *active, const double *x);

/* Gives rows to all their points, where it is not done yet. false: no memory. With all threads.
 */
bool cs_active_contacts_gather(struct cs_active_contacts *active);

#endif

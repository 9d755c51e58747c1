/* active_contacts.h - the active contacts of a state, cached for all evaluations at it. A
 * point-triangle pair contributes the features (face, edge, vertex) in range; a feature shared
 * by several triangles is listed once. */
#ifndef CS_NARROW_PHASE_ACTIVE_CONTACTS_H
#define CS_NARROW_PHASE_ACTIVE_CONTACTS_H

#include "model/contact/broad_phase/candidate_list.h"
#include "model/contact/force_gather.h"
#include "model/contact/narrow_phase/feature_weights.h"
#include "model/contact/narrow_phase/pair_lanes.h"
#include "model/contact/pair_distance.h"

/* Parameters of eight pairs in the layout of struct cs_pair_lanes; unspecified after the last
 * pair. */
struct cs_active_lanes {
    double range[CS_PAIR_LANES], k[CS_PAIR_LANES], friction[CS_PAIR_LANES];
    double weight[CS_PAIR_LANES],
        psd_weight[CS_PAIR_LANES]; /* as in struct cs_weighted_feature */
    double is_edge[CS_PAIR_LANES], is_off_plane[CS_PAIR_LANES], blend_radius[CS_PAIR_LANES];
    double d[CS_PAIR_LANES];    /* m, of features */
    double rate[CS_PAIR_LANES]; /* 1/s2, as in struct cs_pair_lanes */
};

/* Active contacts of one candidate chunk. */
struct cs_active_chunk {
    enum cs_pair_kind kind;
    struct cs_active_lanes *blocks;
    uint32_t (*points)[4]; /* (n) points of each pair */
    uint32_t (*rows)[4];   /* (n) and their rows, of cs_active_contacts_gather */
    /* number of pairs */
    size_t n;
    size_t capacity, points_capacity, rows_capacity;
    struct cs_weighted_feature *features; /* of one point, while they are found */
    size_t features_capacity;
    /* J, of the last energy query */
    double energy;
    /* out of memory: pairs are missing */
    bool failed;
};

/* All active contacts of a state, with the versions of what they were found from. */
struct cs_active_contacts {
    const struct cs_candidates *candidates; /* borrowed, as features are */
    const struct cs_feature_weights *feature_weights;
    /* (n_chunks of the candidates) */
    struct cs_active_chunk *chunks;
    /* close_count of the candidates at that time; 0: none were found */
    uint64_t candidates_version;
    /* params_version of the body pairs at that time */
    uint64_t params_version;
    size_t n;                      /* pairs of all chunks */
    struct cs_gather force_gather; /* with the chunks' numbers */
    bool is_gathered;              /* it is set */
};

/* Prepares an empty cache. search and facets are borrowed and must outlive it; the arena owns
 * all memory. CS_ERR_MEMORY. */
enum cs_status cs_active_contacts_init(struct cs_active_contacts *active,
                                       const struct cs_candidates *search,
                                       const struct cs_feature_weights *weights,
                                       struct cs_arena *arena, struct cs_error *error);

/* Returns whether the cache still belongs to the close pairs and frictions in force. */
bool cs_active_contacts_is_there(const struct cs_active_contacts *active);

/* Finds the active contacts among the pairs in range at x (3, n_points), with all threads.
 * Returns false if out of memory; the cache is then invalid. */
bool cs_active_contacts_find(struct cs_active_contacts *active, const double *x);

/* Assigns rows to the points of all pairs, unless done already, with all threads. Returns false
 * if out of memory. */
bool cs_active_contacts_gather(struct cs_active_contacts *active);

/* Energy in J of all features of a point, and the terms of its second-order model for a whole
 * straight step: F a and K a^2/2 summed over the features, with the approach a of each. */
struct cs_point_energy {
    double energy, first, second;
};

/* Sums the features of a point at x, from all its candidates in a chunk. The terms of the model
 * are set at fraction 0 only. */
struct cs_point_energy cs_point_energy_find(const struct cs_feature_weights *features,
                                            const struct cs_candidates *candidates,
                                            const struct cs_candidate_chunk *chunk,
                                            uint32_t point,
                                            const struct cs_feature_positions *x);

/* Candidates in range at a state, found once for all evaluations at it.
 */

/* Sets the pairs in range of all chunks at x (3,n_points): edges by the smooth distance, points
 * and triangles by the distance filter, with some beyond. Updates the candidate list first if
 * it does not cover x. Does nothing if x equals the last one to the bit. Returns false if out
 * of memory. With all threads. */
bool cs_candidates_find_in_range(struct cs_candidates *candidates, const double *x);

#endif

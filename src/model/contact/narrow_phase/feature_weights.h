/* feature_weights.h - which features of a triangle a point feels, and how often each counts. */
#ifndef CS_NARROW_PHASE_FEATURE_WEIGHTS_H
#define CS_NARROW_PHASE_FEATURE_WEIGHTS_H

#include "model/contact/narrow_phase/mesh_feature.h"
#include "model/system/surfaces.h"

/* How the triangles of all surfaces hang together. */
struct cs_feature_weights {
    const struct cs_surfaces *surfaces; /* borrowed */
    uint32_t *opposite_vertex; /* (n_triangles, 3) the corner beyond the rim opposite each
                         corner; CS_NO_POINT: it is the surface's border */
    double *vertex_share;      /* (n_points) of a corner in each of its triangles */
    uint32_t *vertex_edges;    /* (n_points + 1) the edges whose first end a point is */
};
#define CS_NO_POINT UINT32_MAX

/* Needs the surfaces; memory from the arena. CS_ERR_MEMORY. */
enum cs_status cs_feature_weights_init(struct cs_feature_weights *features,
                                       const struct cs_surfaces *surfaces,
                                       struct cs_arena *arena, struct cs_error *error);

/* A feature in range, as the first rim of its triangle. */
struct cs_weighted_feature {
    uint32_t points[4];
    double d;          /* m */
    double weight;     /* how often it counts: below 0 it is taken away */
    double psd_weight; /* and where nothing may be taken away, so that a sum is not negative: of
                     the feature that is nearest alone. Over a flat mesh the same is left. */
    struct cs_feature_kind form;
    uint32_t shared_feature[2]; /* the ends of a rim, or a corner and CS_NO_POINT, that is the
                          same seen from all its triangles; twice that: it is not */
};

/* Three rims, three corners and the plane. */
enum { CS_FEATURES_PER_TRIANGLE = 7, CS_FEATURE_QUERY_PAIRS = 32 };

/* A point and a triangle. */
struct cs_feature_query {
    uint32_t points[4], triangle; /* the point and the corners */
    bool same_body;               /* the triangle is of the point's own body */
    double range;                 /* m */
};

/* Fills uses (n CS_FEATURES_PER_TRIANGLE) with what the points of n <= CS_FEATURE_QUERY_PAIRS
 * pairs feel of their triangles at x (3, n_points), one pair after the other, and returns how
 * many they are. What is the same function of the state is one: rims and corners near the foot
 * are the plane, and a rim beyond its end is a corner. */
uint32_t cs_feature_weights_find(const struct cs_feature_weights *features,
                                 const struct cs_feature_query *pairs, uint32_t n,
                                 const double *x, struct cs_weighted_feature *uses);

/* Adds to `n` uses of one point, without any that is there twice, `more` that stand behind
 * them, and returns how many that makes. */
uint32_t cs_feature_weights_join(struct cs_weighted_feature *uses, uint32_t n, uint32_t more);

/* Whether anything is left of it: counts are whole shares of a triangle. */
static inline bool cs_feature_weights_counts(const struct cs_weighted_feature *use) {
    return fabs(use->weight) > 1e-9 || fabs(use->psd_weight) > 1e-9;
}

#endif

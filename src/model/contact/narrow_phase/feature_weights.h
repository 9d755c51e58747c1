/* feature_weights.h - selects the features of a triangle that a point feels, with the
 * inclusion-exclusion weight of each. Theory: mesh_feature.h. */
#ifndef CS_NARROW_PHASE_FEATURE_WEIGHTS_H
#define CS_NARROW_PHASE_FEATURE_WEIGHTS_H

#include "model/contact/narrow_phase/mesh_feature.h"
#include "model/system/surfaces.h"

/* Adjacency of the triangles of all surfaces; built once, constant afterwards. */
struct cs_feature_weights {
    const struct cs_surfaces *surfaces; /* borrowed */
    /* (n_triangles, 3) for each vertex of a triangle, the far vertex of the neighbour across
     * the edge opposite to it; CS_NO_POINT at the border of the surface */
    uint32_t *opposite_vertex;
    /* (n_points) weight of a vertex in each of its triangles; they sum to 1 - t + e over t
     * triangles and e inner edges: 1 at an inner vertex, 0 at a border */
    double *vertex_share;
    /* (n_points + 1) edges that have point i as first end: vertex_edges[i] to vertex_edges[i +
     * 1] - 1 in surfaces->edges */
    uint32_t *vertex_edges;
};
#define CS_NO_POINT UINT32_MAX

/* Builds the adjacency. surfaces is borrowed and must outlive it; the arena owns the arrays.
 * CS_ERR_MEMORY; the content is then unspecified. */
enum cs_status cs_feature_weights_init(struct cs_feature_weights *features,
                                       const struct cs_surfaces *surfaces,
                                       struct cs_arena *arena, struct cs_error *error);

/* A feature in range. Its points are rotated so that the feature is the first edge of the
 * triangle, points[1] to points[2], or its first end, or the plane. */
struct cs_weighted_feature {
    uint32_t points[4];
    /* m, distance of mesh_feature.h */
    double d;
    /* multiplicity in the energy of the triangle: negative for an edge whose energy is
     * subtracted */
    double weight;
    /* multiplicity in a positive semi-definite matrix: that of the nearest feature alone, never
     * negative. Over a flat mesh both weights have the same sums per point. */
    double psd_weight;
    struct cs_feature_kind kind;
    /* identity of a feature that all its triangles measure alike: both ends of an edge in
     * ascending order, or a vertex and CS_NO_POINT; CS_NO_POINT twice if it still depends on
     * the plane of its triangle */
    uint32_t shared_feature[2];
};

/* Three edges, three vertices and the plane; and the largest number of queries of one call. */
enum { CS_FEATURES_PER_TRIANGLE = 7, CS_FEATURE_QUERY_PAIRS = 32 };

/* A point and a triangle that are candidates. */
struct cs_feature_query {
    /* the point and the vertices; the number of the triangle */
    uint32_t points[4], triangle;
    bool same_body; /* the triangle is of the point's own body */
    double range;   /* m */
};

/* Positions (3,n_points) in m at a fraction of the straight way between two states. */
struct cs_feature_positions {
    const double *from, *to;
    double fraction;
};

/* Finds the features that the points of n <= CS_FEATURE_QUERY_PAIRS pairs feel at the positions
 * x, and returns their number. `uses` must hold n CS_FEATURES_PER_TRIANGLE of them;
 * they come pair by pair in the order of the queries.
 *
 * Features with the same distance as a function of the state are merged: edges and vertices
 * near the foot become the plane, and an edge beyond its end becomes the vertex. */
uint32_t cs_feature_weights_find_between(const struct cs_feature_weights *features,
                                         const struct cs_feature_query *pairs, uint32_t n,
                                         const struct cs_feature_positions *x,
                                         struct cs_weighted_feature *uses);

/* The same at one state x (3,n_points). */
static inline uint32_t cs_feature_weights_find(const struct cs_feature_weights *features,
                                               const struct cs_feature_query *pairs, uint32_t n,
                                               const double *x,
                                               struct cs_weighted_feature *uses) {
    return cs_feature_weights_find_between(features, pairs, n,
                                           &(struct cs_feature_positions){x, x, 0}, uses);
}

/* Merges `more` features behind the first n into these, and returns the new number. All are of
 * one point. Equal shared features are merged by adding their weights; the first n must contain
 * none twice. */
uint32_t cs_feature_weights_join(struct cs_weighted_feature *features, uint32_t n,
                                 uint32_t more);

/* Returns whether a feature has any weight left. Weights are multiples of a vertex share, far
 * above 1e-9, so that only the rounding of cancelled weights is below it. */
static inline bool cs_feature_weights_counts(const struct cs_weighted_feature *feature) {
    return fabs(feature->weight) > 1e-9 || fabs(feature->psd_weight) > 1e-9;
}

#endif

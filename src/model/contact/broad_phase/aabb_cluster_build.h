/* aabb_cluster_build.h - assigns items to clusters: items of a grid by blocks, others in their
 * order. */
#ifndef CS_BROAD_PHASE_AABB_CLUSTER_BUILD_H
#define CS_BROAD_PHASE_AABB_CLUSTER_BUILD_H

#include "model/contact/broad_phase/aabb_clusters.h"
#include "model/contact/broad_phase/flat_regions.h"

/* Points, edges or triangles of all bodies; everything is borrowed during the call. */
struct cs_cluster_input {
    const uint32_t *vertices; /* (n, each) points of an item; NULL: it is one itself */
    uint32_t vertices_per_item;
    const uint32_t *first; /* (n_bodies + 1) items of each body */
    uint32_t n_bodies;
    struct cs_flat_region *const *flat_regions; /* (n_bodies) NULL: the body is none */
};

/* Allocates and fills all of the clusters but their boxes. Rectangles exist if one body is a
 * grid. The arena owns the arrays. CS_ERR_MEMORY. */
enum cs_status cs_cluster_input_build(const struct cs_cluster_input *order,
                                      struct cs_aabb_clusters *clusters, struct cs_arena *arena,
                                      struct cs_error *error);

#endif

/* primitive_search.h - the search for pairs of points, edges and triangles whose boxes overlap.
 *
 * All primitives of a system are in clusters (aabb_clusters.h), and the clusters of points and
 * of edges in batches, which threads share. Two queries use them: the candidate list of a state
 * (candidates_find.c), and the pairs of a move below, which are asked for crossings and first
 * collisions (ccd/crossings.h). */
#ifndef CS_BROAD_PHASE_PRIMITIVE_SEARCH_H
#define CS_BROAD_PHASE_PRIMITIVE_SEARCH_H

#include "model/contact/broad_phase/aabb_cluster_build.h"
#include "model/contact/broad_phase/swept_aabb.h"
#include "model/system/surfaces.h"

/* The points or edges in the clusters [begin, end), and the work of the thread that has them.
 */
struct cs_primitive_batch {
    bool edges;
    uint32_t begin, end;
    /* clusters near the one at hand: of its own body and of others */
    struct cs_nearby_clusters near[2];
    bool failed; /* there was no memory */
};

/* All primitives of a system. */
struct cs_primitive_search {
    const struct cs_surfaces *surfaces; /* borrowed */
    /* points have no boxes of their own */
    struct cs_aabb_clusters points, edges, triangles;
    /* (n_batches) those of points first */
    struct cs_primitive_batch *batches;
    uint32_t n_batches, n_point_batches;
    /* (n_bodies) of the last move */
    struct cs_swept_aabb *body_sweeps;
};

/* Assigns all primitives to clusters and batches. flat_regions: (n_bodies) or NULL, as in
 * struct cs_cluster_input. The arena owns all memory. CS_ERR_MEMORY. */
enum cs_status cs_primitive_search_init(struct cs_primitive_search *search,
                                        const struct cs_surfaces *surfaces,
                                        struct cs_flat_region *const *flat_regions,
                                        struct cs_arena *arena, struct cs_error *error);

/* Sets the boxes of clusters of edges or triangles by `box_of`, with all threads, and sorts
 * them into cells. box_of gives an empty box for CS_NO_ITEM. Returns false if out of memory. */
typedef struct cs_aabb cs_item_box(const void *arg, uint32_t item);
bool cs_aabb_clusters_fill(struct cs_aabb_clusters *clusters, cs_item_box *box_of,
                           const void *arg);

extern const struct cs_aabb cs_aabb_empty;

/* most pairs that are handed over at once */
enum { CS_SEARCH_PAIRS = 256 };

/* A query for the pairs of a move. All pointers are borrowed. */
struct cs_move_query {
    const double *x0, *x1; /* (3,n_points) m; x1 NULL: at rest */
    double reach;          /* m */
    /* edges are sought with triangles; else points with triangles, and edges with edges */
    bool pierce;
    /* whether primitives of bodies a and b count */
    bool (*may_meet)(const void *arg, uint32_t a, uint32_t b);
    /* receives pairs of a batch (n, 2), up to CS_SEARCH_PAIRS; of edges the smaller first */
    void (*take)(void *arg, uint32_t batch, const uint32_t (*pairs)[2], size_t n);
    void *arg;
};

/* Hands over all pairs whose swept boxes come within reach (swept_aabb.h), each once, and some
 * more; those with a common vertex are not left out. Points that are not finite are in no pair.
 * Batches run in parallel, each in an order that depends on the positions alone. Returns false
 * if out of memory; pairs are then missing. */
bool cs_primitive_search_move(struct cs_primitive_search *search,
                              const struct cs_move_query *query);

#endif

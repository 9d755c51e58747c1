/* shape_clusters.h - cuts a body into overlapping clusters for shape matching. */
#ifndef CS_SHAPE_CLUSTERS_H
#define CS_SHAPE_CLUSTERS_H

#include "base/arena.h"

#include <stdint.h>

struct cs_body;
struct cs_shape_clusters;

struct cs_system;

/* Clusters of one body; the arena of cs_shape_clusters_make owns the arrays. */
struct cs_shape_clusters {
    uint32_t n;
    uint32_t *begin; /* (n + 1) offsets into items */
    uint32_t *items; /* particles within the body, ascending in each part */
};

/* Least particles per cluster, before overlap is added. */
enum { CS_SHAPE_CLUSTER_SIZE_MIN = 4 };

/* Cuts a body with shape matching, whose mesh is complete, into body->shape_matching.clusters
 * parts. A part is halved (or as near to halves as the number allows) across the longest side
 * of its box in the undeformed body, before its placement; the halves are halved again. Then
 * each cluster receives all particles in its own box, enlarged on all sides by `overlap` times
 * the longest side. Overlap goes by distance and not by edges, so a finer mesh overlaps as
 * widely (Mueller et al. 2005, sec. 4.3). The body must have at least CS_SHAPE_CLUSTER_SIZE_MIN
 * particles per cluster. Returns CS_ERR_MEMORY if out of memory. */
enum cs_status cs_shape_clusters_make(const struct cs_body *body,
                                      struct cs_shape_clusters *clusters,
                                      struct cs_arena *arena, struct cs_error *error);

/* Fills the clusters of the system's view from its bodies, in the system's arena. Returns
 * CS_ERR_MEMORY if out of memory. */
enum cs_status cs_shape_clusters_build(struct cs_system *system, struct cs_error *error);

/* Sets alpha and beta of the clusters to the scene's values, which ramps change. */
void cs_shape_clusters_refresh(struct cs_system *system);

/* Bound in J on the energy that a deformation stores: the energy of all clusters if each
 * collapsed to a point, with the stiffness m alpha / step^2 per particle. A cluster without a
 * step uses the frame's. */
double cs_shape_clusters_energy(const struct cs_system *system);

#endif

/* shape_clusters.h - a body cut into overlapping parts that keep their shapes (shape matching).
 */
#ifndef CS_SHAPE_CLUSTERS_H
#define CS_SHAPE_CLUSTERS_H

#include "base/arena.h"
#include "scene/scene.h"

struct cs_system;

struct cs_shape_clusters {
    uint32_t n;
    uint32_t *begin; /* (n + 1) offsets into items */
    uint32_t *items; /* particles within the body, ascending in each part */
};

/* Particles that a part has at least, before it takes in others. */
enum { CS_SHAPE_CLUSTER_SIZE_MIN = 4 };

/* Cuts a matched body, its mesh finished, into body->shape_matching.clusters parts: halves (or
 * as near to halves as the number allows) across the longest side of the box about the body as
 * it was given, before its placement, and halves of these. Then each part takes in all
 * particles in its own box, grown to all sides by `overlap` times its longest side: edges are
 * not asked for, and a finer mesh overlaps as widely (Mueller et al. 2005, sec. 4.3). The body
 * has at least CS_SHAPE_CLUSTER_SIZE_MIN particles a part. CS_ERR_MEMORY. */
enum cs_status cs_shape_clusters_make(const struct cs_body *body,
                                      struct cs_shape_clusters *clusters,
                                      struct cs_arena *arena, struct cs_error *error);

/* Gives the system's view the clusters of its bodies, in the arena. CS_ERR_MEMORY. */
enum cs_status cs_shape_clusters_build(struct cs_system *system, struct cs_error *error);

/* Energy in J that the clusters would hold if each were collapsed to a point: a bound on what a
 * deformation stores, with the stiffness m alpha/step^2 of a particle, the frame being the step
 * where none is given. */
double cs_shape_clusters_energy(const struct cs_system *system);

#endif

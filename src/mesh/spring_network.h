/* spring_network.h - springs through the inside of a closed mesh (soft-body thesis, sec. 6.3).
 */
#ifndef CS_SPRING_NETWORK_H
#define CS_SPRING_NETWORK_H

#include "mesh/trimesh.h"

enum cs_placement {
    CS_PLACEMENT_RANDOM,
    CS_PLACEMENT_OPPOSED_NORMALS,
    CS_PLACEMENT_NEAREST,
};

/* springs through the inside of a closed mesh (soft-body thesis, sec. 6.3 and 6.4) */
struct cs_spring_network {
    bool present;
    int32_t placement;  /* enum cs_placement */
    int64_t springs;    /* wanted from each particle */
    int64_t candidates; /* of which the nearest is taken */
    int64_t tries;      /* draws for one spring at most */
    int64_t seed;
    double surface; /* stiffness of surface springs over that of inner ones */
};

/* Numbers that are the same everywhere: SplitMix64 (Steele, Lea and Flood 2014). */
struct cs_rng {
    uint64_t state;
};
uint64_t cs_rng_next(struct cs_rng *draws);

/* Fills mesh->inner, the mesh finished and closed. For each vertex in turn, `springs` partners
 * are drawn, none twice and none at the other end of an edge:
 *   random            the first that is drawn;
 *   opposed-normals   the first whose normal m has n.m <= -1/2 with the vertex's own n;
 *   nearest           the nearest of the first `candidates` such, or of fewer where `tries`
 *                     draws do not bring so many.
 * Where `tries` draws bring none, there is no spring. CS_ERR_MEMORY. */
enum cs_status cs_spring_network_make(const struct cs_spring_network *network,
                                      struct cs_trimesh *mesh, struct cs_arena *arena,
                                      struct cs_error *error);

#endif

/* spring_network.h - springs through the inside of a closed mesh (soft-body thesis, sec. 6.3).
 */
#ifndef CS_SPRING_NETWORK_H
#define CS_SPRING_NETWORK_H

#include "mesh/trimesh.h"

/* Choice of a vertex's partners; see cs_spring_network_make. */
enum cs_placement {
    CS_PLACEMENT_RANDOM,
    CS_PLACEMENT_OPPOSED_NORMALS,
    CS_PLACEMENT_NEAREST,
};

/* Keys of a network in the scene (soft-body thesis, sec. 6.3 and 6.4). */
struct cs_spring_network {
    bool present;
    int32_t placement;  /* enum cs_placement */
    int64_t springs;    /* wanted from each particle */
    int64_t candidates; /* of `nearest`: the nearest of so many is taken */
    int64_t tries;      /* draws per spring, at most */
    int64_t seed;
    double surface; /* stiffness of surface springs over that of inner ones */
};

/* Random numbers with the same bits everywhere: SplitMix64 (Steele, Lea and Flood 2014). */
struct cs_rng {
    uint64_t state;
};
/* Returns the next 64 bits. */
uint64_t cs_rng_next(struct cs_rng *rng);

/* Fills mesh->network_springs of a finished, closed mesh; memory from the arena. Each vertex in
 * turn draws `springs` partners. No pair is joined twice, nor if an edge joins it:
 *   random            the first candidate that is drawn;
 *   opposed-normals   the first whose normal m has n.m <= -1/2 with the vertex's own n, that is
 *                     an angle of 120 degrees or more: it lies across the body;
 *   nearest           the nearest of the first `candidates` of this kind, or of fewer if
 * `tries`
 *                     draws do not find so many.
 * A spring is left out if `tries` draws find no candidate. Fails with CS_ERR_MEMORY. */
enum cs_status cs_spring_network_make(const struct cs_spring_network *network,
                                      struct cs_trimesh *mesh, struct cs_arena *arena,
                                      struct cs_error *error);

#endif

/* order.h - which items make a cluster together: those of a grid that are in one block of it,
 * others as they come. */
#ifndef CS_NEAR_ORDER_H
#define CS_NEAR_ORDER_H

#include "model/near/clusters.h"
#include "model/near/flat.h"

/* Points, edges or triangles of bodies. */
struct cs_order {
    const uint32_t *corners; /* (n, each) points of an item; NULL: it is one itself */
    uint32_t each;
    const uint32_t *first; /* (n_bodies + 1) items of each body */
    uint32_t n_bodies;
    struct cs_flat *const *grids; /* (n_bodies) NULL: the body is none */
};

/* Takes and fills what clusters have for good: all but their boxes. Spans where there is a
 * grid. CS_ERR_MEMORY. */
enum cs_status cs_order_build(const struct cs_order *order, struct cs_clusters *clusters,
                              struct cs_arena *arena, struct cs_error *error);

#endif

/* boxes.h - boxes about points, edges and triangles, alone and in their clusters. */
#ifndef CS_NEAR_BOXES_H
#define CS_NEAR_BOXES_H

#include "model/near/clusters.h"

#include <math.h>

/* Items of one kind at a state. */
struct cs_boxes {
    const double *x; /* (3, n) */
    size_t n;
    const uint32_t *corners; /* (items, each); NULL: an item is a point itself */
    uint32_t each;
    const uint32_t *body; /* (n) of each point */
    const bool *any;      /* of each body: it meets one; else boxes are empty */
};

static const struct cs_cell_box cs_box_none = {{HUGE_VAL, HUGE_VAL, HUGE_VAL},
                                               {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};

/* About an item, grown to all sides; empty for CS_NO_ITEM. */
struct cs_cell_box cs_box_of(const struct cs_boxes *boxes, uint32_t item, double grow);

/* Sets the boxes of clusters and their cells, with all threads. false: no memory. */
bool cs_boxes_fill(const struct cs_boxes *boxes, struct cs_clusters *clusters);

#endif

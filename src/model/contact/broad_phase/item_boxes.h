/* item_boxes.h - boxes about points, edges and triangles, alone and in their clusters. */
#ifndef CS_BROAD_PHASE_ITEM_BOXES_H
#define CS_BROAD_PHASE_ITEM_BOXES_H

#include "model/contact/broad_phase/aabb_clusters.h"

#include <math.h>

/* Items of one kind at a state. */
struct cs_item_boxes {
    const double *x; /* (3, n) */
    size_t n;
    const uint32_t *vertices; /* (items, each); NULL: an item is a point itself */
    uint32_t vertices_per_item;
    const uint32_t *body;    /* (n) of each point */
    const bool *is_nonempty; /* of each body: it meets one; else boxes are empty */
};

static const struct cs_aabb cs_box_none = {{HUGE_VAL, HUGE_VAL, HUGE_VAL},
                                           {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};

/* About an item, grown to all sides; empty for CS_NO_ITEM. */
struct cs_aabb cs_item_box(const struct cs_item_boxes *boxes, uint32_t item, double grow);

/* Sets the boxes of clusters and their cells, with all threads. false: no memory. */
bool cs_item_boxes_fill(const struct cs_item_boxes *boxes, struct cs_aabb_clusters *clusters);

#endif

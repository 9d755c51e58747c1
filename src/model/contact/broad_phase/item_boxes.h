/* item_boxes.h - bounding boxes of points, edges and triangles, and of their clusters. */
#ifndef CS_BROAD_PHASE_ITEM_BOXES_H
#define CS_BROAD_PHASE_ITEM_BOXES_H

#include "model/contact/broad_phase/aabb_clusters.h"

#include <math.h>

/* Items of one kind at a state; all pointers are borrowed. */
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

/* Box of an item, grown by `grow` in m to all sides; empty for CS_NO_ITEM, and for bodies
 * without contact. */
struct cs_aabb cs_item_box(const struct cs_item_boxes *boxes, uint32_t item, double grow);

/* Sets the boxes of all clusters and sorts them into cells, with all threads. Returns false if
 * out of memory. */
bool cs_item_boxes_fill(const struct cs_item_boxes *boxes, struct cs_aabb_clusters *clusters);

#endif

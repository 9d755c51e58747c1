/* Bounding boxes of items, merged into those of clusters. */
#include "model/contact/broad_phase/item_boxes.h"

#include "base/pool.h"

struct cs_aabb cs_item_box(const struct cs_item_boxes *boxes, uint32_t item, double grow) {
    struct cs_aabb box;
    if (item == CS_NO_ITEM)
        return cs_box_none;
    const uint32_t *at =
        boxes->vertices ? boxes->vertices + (size_t)boxes->vertices_per_item * item : &item;
    if (!boxes->is_nonempty[boxes->body[at[0]]])
        return cs_box_none;
    for (size_t c = 0; c < 3; c++) {
        const double *x = boxes->x + c * boxes->n;
        box.low[c] = box.high[c] = x[at[0]];
        for (uint32_t k = 1; k < boxes->vertices_per_item; k++) {
            box.low[c] = x[at[k]] < box.low[c] ? x[at[k]] : box.low[c];
            box.high[c] = x[at[k]] > box.high[c] ? x[at[k]] : box.high[c];
        }
        box.low[c] -= grow;
        box.high[c] += grow;
    }
    return box;
}

struct filling {
    const struct cs_item_boxes *boxes;
    struct cs_aabb_clusters *clusters;
};

/* clusters per job */
enum { TOGETHER = 64 };

static void fill_cluster(const struct filling *filling, uint32_t number) {
    struct cs_aabb_clusters *clusters = filling->clusters;
    struct cs_aabb all = cs_box_none;
    for (uint32_t lane = 0; lane < CS_AABB_CLUSTER; lane++) {
        const struct cs_aabb box = cs_item_box(
            filling->boxes, clusters->items[CS_AABB_CLUSTER * (size_t)number + lane], 0);
        cs_aabb_cluster_set(clusters->clusters + number, lane, &box);
        cs_aabb_merge(&all, &box);
    }
    clusters->cluster_boxes[number] = all;
}

static void fill_some(void *arg, uint32_t block) {
    const struct filling *filling = arg;
    for (uint32_t k = TOGETHER * block; k < TOGETHER * (block + 1) && k < filling->clusters->n;
         k++)
        fill_cluster(filling, k);
}

bool cs_item_boxes_fill(const struct cs_item_boxes *boxes, struct cs_aabb_clusters *clusters) {
    struct filling filling = {boxes, clusters};
    cs_pool_run((clusters->n + TOGETHER - 1) / TOGETHER, fill_some, &filling);
    return cs_aabb_clusters_sort(clusters);
}

/* Boxes of items, joined to those of clusters. */
#include "model/near/boxes.h"

#include "base/pool.h"

struct cs_cell_box cs_box_of(const struct cs_boxes *boxes, uint32_t item, double grow) {
    struct cs_cell_box box;
    if (item == CS_NO_ITEM)
        return cs_box_none;
    const uint32_t *at = boxes->corners ? boxes->corners + (size_t)boxes->each * item : &item;
    if (!boxes->any[boxes->body[at[0]]])
        return cs_box_none;
    for (size_t c = 0; c < 3; c++) {
        const double *x = boxes->x + c * boxes->n;
        box.low[c] = box.high[c] = x[at[0]];
        for (uint32_t k = 1; k < boxes->each; k++) {
            box.low[c] = x[at[k]] < box.low[c] ? x[at[k]] : box.low[c];
            box.high[c] = x[at[k]] > box.high[c] ? x[at[k]] : box.high[c];
        }
        box.low[c] -= grow;
        box.high[c] += grow;
    }
    return box;
}

struct filling {
    const struct cs_boxes *boxes;
    struct cs_clusters *clusters;
};

/* clusters that are filled together */
enum { TOGETHER = 64 };

static void fill_cluster(const struct filling *filling, uint32_t number) {
    struct cs_clusters *clusters = filling->clusters;
    struct cs_cell_box all = cs_box_none;
    for (uint32_t lane = 0; lane < CS_CLUSTER; lane++) {
        const struct cs_cell_box box =
            cs_box_of(filling->boxes, clusters->items[CS_CLUSTER * (size_t)number + lane], 0);
        cs_cluster_set(clusters->of + number, lane, &box);
        cs_cell_box_join(&all, &box);
    }
    clusters->boxes[number] = all;
}

static void fill_some(void *arg, uint32_t block) {
    const struct filling *filling = arg;
    for (uint32_t k = TOGETHER * block; k < TOGETHER * (block + 1) && k < filling->clusters->n;
         k++)
        fill_cluster(filling, k);
}

bool cs_boxes_fill(const struct cs_boxes *boxes, struct cs_clusters *clusters) {
    struct filling filling = {boxes, clusters};
    cs_pool_run((clusters->n + TOGETHER - 1) / TOGETHER, fill_some, &filling);
    return cs_clusters_sort(clusters);
}

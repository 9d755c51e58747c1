/* Clusters near a box from the cells of the grids, then their items in lanes. */
#include "model/contact/broad_phase/aabb_clusters.h"

#include "base/arena.h"

#include <clothsim/clones.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Uniform grid of boxes: chooses the cell size, counts, fills. */

/* m, longest side; negative: the box is empty */
static double longest_side(const struct cs_aabb *box) {
    double side = -1;
    for (int c = 0; c < 3; c++) {
        const double along = box->high[c] - box->low[c];
        side = along > side ? along : side;
    }
    return side;
}

/* Boxes of one grid: those with side_min < longest side <= side_max. */
struct set {
    const struct cs_aabb *boxes; /* (n) */
    uint32_t n;
    double side_min, side_max; /* m */
};

/* Cell along one axis of a coordinate; those outside the grid have the first or last one. */
static uint32_t index_of(const struct cs_uniform_grid *grid, double place, int axis) {
    const double end = grid->dim[axis] - 1;
    const double at = (place - grid->origin[axis]) * grid->inverse_cell_size;
    return (uint32_t)(at > 0 ? at < end ? at : end : 0);
}

/* Number of a cell: x runs fastest. */
static size_t cell_of(const struct cs_uniform_grid *grid, uint32_t x, uint32_t y, uint32_t z) {
    return ((size_t)z * grid->dim[1] + y) * grid->dim[0] + x;
}

/* Limits per box: cells, and entries in cells; FEW is added to both. Beyond either the cells
 * grow by LARGER = 2^(1/3) per side, so that their number halves. Chosen by trial. */
enum { CELLS_EACH = 8, PLACES_EACH = 32, FEW = 4096 };

#define LARGER 1.26

/* Returns whether a box is empty or belongs to another grid. */
static bool is_out(const struct set *boxes, uint32_t i) {
    const double side = longest_side(boxes->boxes + i);
    return !(side >= 0 && side > boxes->side_min && side <= boxes->side_max);
}

/* Sets lower corner and extent of all boxes; returns their mean longest side, 0 without boxes.
 */
static double measure_boxes(const struct set *boxes, double low[3], double extent[3]) {
    double high[3], sum = 0;
    uint32_t count = 0;
    for (int c = 0; c < 3; c++) {
        low[c] = HUGE_VAL;
        high[c] = -HUGE_VAL;
    }
    for (uint32_t i = 0; i < boxes->n; i++) {
        const struct cs_aabb *box = boxes->boxes + i;
        if (is_out(boxes, i))
            continue;
        for (int c = 0; c < 3; c++) {
            low[c] = fmin(low[c], box->low[c]);
            high[c] = fmax(high[c], box->high[c]);
        }
        sum += longest_side(box);
        count++;
    }
    for (int c = 0; c < 3; c++)
        extent[c] = high[c] - low[c];
    return count ? sum / count : 0;
}

/* Sets the number of cells along each axis; returns false if there are more than `most`. */
static bool divide(struct cs_uniform_grid *grid, const double extent[3], double size,
                   double most) {
    double all = 1;
    grid->inverse_cell_size = 1 / size;
    for (int c = 0; c < 3; c++) {
        const double number = floor(extent[c] * grid->inverse_cell_size) + 1;
        all *= number;
        if (!(all <= most))
            return false;
        grid->dim[c] = (uint32_t)number;
    }
    return true;
}

/* First and last cell along each axis that a box touches. */
static void grid_range(const struct cs_uniform_grid *grid, const struct cs_aabb *box,
                       uint32_t first[3], uint32_t last[3]) {
    for (int c = 0; c < 3; c++) {
        first[c] = index_of(grid, box->low[c], c);
        last[c] = index_of(grid, box->high[c], c);
    }
}

/* Adds 1 to each cell that a box touches, or stores the item at the position that the cell's
 * count gives; returns the number of cells. */
static size_t visit(struct cs_uniform_grid *grid, const struct cs_aabb *box, uint32_t item,
                    bool put) {
    uint32_t first[3], last[3];
    size_t places = 0;
    grid_range(grid, box, first, last);
    for (uint32_t z = first[2]; z <= last[2]; z++)
        for (uint32_t y = first[1]; y <= last[1]; y++)
            for (uint32_t x = first[0]; x <= last[0]; x++, places++) {
                uint32_t *count = grid->cell_starts + cell_of(grid, x, y, z);
                if (put)
                    grid->items[--*count] = item;
                else
                    ++*count;
            }
    return places;
}

/* Counts the entries of all cells; stops early at too many. Returns false if out of memory. */
static bool count_all(struct cs_uniform_grid *grid, const struct set *boxes, size_t *places) {
    const size_t all = (size_t)grid->dim[0] * grid->dim[1] * grid->dim[2];
    *places = 0;
    if (!CS_ARENA_REALLOC(grid->cell_starts, grid->starts_capacity, all + 1))
        return false;
    memset(grid->cell_starts, 0, (all + 1) * sizeof *grid->cell_starts);
    for (uint32_t i = 0; i < boxes->n && *places <= (size_t)PLACES_EACH * boxes->n + FEW; i++)
        if (!is_out(boxes, i))
            *places += visit(grid, boxes->boxes + i, i, false);
    return true;
}

/* Stores the items. Running sums make each start the end of its cell; filling from the last box
 * to the first brings it down to the begin, with items in ascending order. */
static bool fill_all(struct cs_uniform_grid *grid, const struct set *boxes, size_t places) {
    const size_t all = (size_t)grid->dim[0] * grid->dim[1] * grid->dim[2];
    if (!CS_ARENA_REALLOC(grid->items, grid->items_capacity, places))
        return false;
    for (size_t c = 1; c < all; c++)
        grid->cell_starts[c] += grid->cell_starts[c - 1];
    grid->cell_starts[all] = (uint32_t)places;
    for (uint32_t i = boxes->n; i--;)
        if (!is_out(boxes, i))
            visit(grid, boxes->boxes + i, i, true);
    return true;
}

/* Enlarges the cells until both limits hold; returns false if out of memory. */
static bool fill(struct cs_uniform_grid *grid, const struct set *boxes, const double extent[3],
                 double size) {
    size_t places;
    for (;; size *= LARGER) {
        if (!divide(grid, extent, size, (double)CELLS_EACH * boxes->n + FEW))
            continue;
        if (!count_all(grid, boxes, &places))
            return false;
        if (places <= (size_t)PLACES_EACH * boxes->n + FEW)
            return fill_all(grid, boxes, places);
    }
}

/* Puts each box into every cell that it touches; empty boxes into none. Cells are about as
 * large as the mean box, and larger if there would be too many. If boxes are not finite or all
 * are empty, there are no cells (dim 0). Returns false if out of memory, again with dim 0. */
static bool grid_fill(struct cs_uniform_grid *grid, const struct set *boxes) {
    double extent[3];
    const double size = measure_boxes(boxes, grid->origin, extent);
    const bool some = size > 0 && extent[0] + extent[1] + extent[2] < HUGE_VAL;
    const bool filled = !some || fill(grid, boxes, extent, size);
    if (!some || !filled)
        memset(grid->dim, 0, sizeof grid->dim);
    return filled;
}

/* Frees the memory; the grid is empty afterwards. */
static void grid_finish(struct cs_uniform_grid *grid) {
    free(grid->cell_starts);
    free(grid->items);
    *grid = (struct cs_uniform_grid){0};
}

/* Multiple of the usual longest side above which a box goes into the second grid. Chosen by
 * trial. */
#define LARGE 8

void cs_aabb_cluster_set(struct cs_aabb_cluster *cluster, uint32_t lane,
                         const struct cs_aabb *box) {
    for (int c = 0; c < 3; c++) {
        // of an empty one no number is true of anything, even of a box without end
        const bool some = box->high[c] >= box->low[c];
        cluster->low[c][lane] = some ? (float)box->low[c] : NAN;
        cluster->high[c][lane] = some ? (float)box->high[c] : NAN;
    }
}

/* Two boxes may share several cells. The pair is taken in one of them only: the lower corner of
 * the intersection, which has the higher of both first cells along each axis. The other box is
 * in the cell `at`, so its first cell is not above it. */
static bool is_first_cell(const struct cs_uniform_grid *grid, const struct cs_aabb *other,
                          const uint32_t first[3], const uint32_t at[3]) {
    bool counts = true;
    for (int c = 0; c < 3; c++)
        counts = counts && (at[c] == first[c] || index_of(grid, other->low[c], c) == at[c]);
    return counts;
}

/* Appends a cluster to the result; returns false if out of memory. */
static bool add_cluster(struct cs_nearby_clusters *nearby, uint32_t cluster,
                        const struct cs_aabb *box) {
    static const struct cs_aabb none = {{1, 1, 1}, {0, 0, 0}};
    const size_t group = nearby->n / CS_AABB_CLUSTER;
    if (!CS_ARENA_REALLOC(nearby->clusters, nearby->clusters_capacity, nearby->n + 1) ||
        !CS_ARENA_REALLOC(nearby->boxes, nearby->boxes_capacity, group + 1))
        return false;
    for (uint32_t l = 0; l < CS_AABB_CLUSTER && nearby->n % CS_AABB_CLUSTER == 0; l++)
        cs_aabb_cluster_set(nearby->boxes + group, l, &none);
    cs_aabb_cluster_set(nearby->boxes + group, nearby->n % CS_AABB_CLUSTER, box);
    nearby->clusters[nearby->n++] = cluster;
    return true;
}

/* Mean longest side of the boxes up to a length; 0 if there are none. */
static double mean_side(const struct cs_aabb_clusters *clusters, double most) {
    double sum = 0;
    uint32_t count = 0;
    for (uint32_t k = 0; k < clusters->n; k++) {
        const double side = longest_side(clusters->cluster_boxes + k);
        const bool counts = side >= 0 && side <= most;
        sum += counts ? side : 0;
        count += counts;
    }
    return count ? sum / count : 0;
}

/* Few large triangles, as of a floor, would enlarge the cells until all else shares a few of
 * them. The mean of the boxes below the mean is not affected, and LARGE times it separates
 * both. */
bool cs_aabb_clusters_sort(struct cs_aabb_clusters *clusters) {
    const double most = LARGE * mean_side(clusters, mean_side(clusters, HUGE_VAL));
    const struct set small = {clusters->cluster_boxes, clusters->n, -1, most};
    const struct set large = {clusters->cluster_boxes, clusters->n, most, HUGE_VAL};
    return grid_fill(clusters->grid, &small) && grid_fill(clusters->grid + 1, &large);
}

void cs_aabb_clusters_finish(struct cs_aabb_clusters *clusters) {
    grid_finish(clusters->grid);
    grid_finish(clusters->grid + 1);
}

/* A query by one box in one grid. */
struct looking {
    const struct cs_aabb_clusters *clusters;
    const struct cs_uniform_grid *grid;
    const struct cs_aabb *box;
    uint32_t first[3];
};

/* Appends the clusters of one cell that pass all restrictions, each from one cell only. */
static bool add_cell(struct cs_nearby_clusters *nearby, const struct looking *looking,
                     const uint32_t at[3]) {
    const struct cs_aabb_clusters *clusters = looking->clusters;
    const struct cs_uniform_grid *grid = looking->grid;
    const size_t cell = cell_of(grid, at[0], at[1], at[2]);
    bool there = true;
    for (uint32_t s = grid->cell_starts[cell]; s < grid->cell_starts[cell + 1]; s++) {
        const uint32_t cluster = grid->items[s];
        const struct cs_aabb *other = clusters->cluster_boxes + cluster;
        if (clusters->max_item[cluster] >= nearby->first_item &&
            clusters->body[cluster] == nearby->body && cs_aabbs_overlap(looking->box, other) &&
            is_first_cell(grid, other, looking->first, at))
            there = there && add_cluster(nearby, cluster, other);
    }
    return there;
}

/* Appends the clusters of all cells that the box touches. */
static bool add_cells(struct cs_nearby_clusters *nearby, struct looking *looking) {
    uint32_t last[3], at[3];
    bool there = true;
    if (!looking->grid->dim[0])
        return true;
    grid_range(looking->grid, looking->box, looking->first, last);
    const struct cs_uniform_grid *grid = looking->grid;
    const uint32_t *starts = grid->cell_starts;
    for (at[2] = looking->first[2]; at[2] <= last[2]; at[2]++)
        for (at[1] = looking->first[1]; at[1] <= last[1]; at[1]++) {
            // most rows of cells are empty
            const size_t begin = cell_of(grid, looking->first[0], at[1], at[2]);
            if (starts[begin] == starts[begin + last[0] - looking->first[0] + 1])
                continue;
            for (at[0] = looking->first[0]; at[0] <= last[0]; at[0]++)
                there = there && add_cell(nearby, looking, at);
        }
    return there;
}

bool cs_nearby_clusters_find(struct cs_nearby_clusters *nearby,
                             const struct cs_aabb_clusters *clusters,
                             const struct cs_aabb *box) {
    bool there = true;
    nearby->n = 0;
    for (int k = 0; k < 2 && box->high[0] >= box->low[0]; k++) {
        struct looking looking = {clusters, clusters->grid + k, box, {0}};
        there = there && add_cells(nearby, &looking);
    }
    return there &&
           CS_ARENA_REALLOC(nearby->items, nearby->items_capacity, CS_AABB_CLUSTER * nearby->n);
}

/* Bit mask of the lanes whose boxes overlap a box. Comparisons with NaN are false, so that
 * empty lanes never match. */
CS_INLINE uint32_t overlap_mask(const struct cs_aabb_cluster *restrict cluster,
                                const float low[3], const float high[3]) {
    uint32_t bits = 0;
    for (int l = 0; l < CS_AABB_CLUSTER; l++) {
        uint32_t hit = cluster->low[0][l] <= high[0];
        hit &= cluster->low[1][l] <= high[1];
        hit &= cluster->low[2][l] <= high[2];
        hit &= cluster->high[0][l] >= low[0];
        hit &= cluster->high[1][l] >= low[1];
        hit &= cluster->high[2][l] >= low[2];
        bits |= hit << l;
    }
    return bits;
}

/* Items by two levels of masks: clusters, then their items. */
CS_CLONES static uint32_t find_items(const struct cs_nearby_clusters *nearby,
                                     const struct cs_aabb_clusters *of, const float low[3],
                                     const float high[3], uint32_t *items) {
    uint32_t n = 0;
    for (size_t k = 0; k < nearby->n; k += CS_AABB_CLUSTER)
        for (uint32_t some = overlap_mask(nearby->boxes + k / CS_AABB_CLUSTER, low, high); some;
             some &= some - 1) {
            const uint32_t cluster = nearby->clusters[k + (uint32_t)__builtin_ctz(some)];
            for (uint32_t bits = overlap_mask(of->clusters + cluster, low, high); bits;
                 bits &= bits - 1)
                items[n++] =
                    of->items[CS_AABB_CLUSTER * cluster + (uint32_t)__builtin_ctz(bits)];
        }
    return n;
}

uint32_t cs_nearby_clusters_items(struct cs_nearby_clusters *nearby,
                                  const struct cs_aabb_clusters *clusters,
                                  const struct cs_aabb *box) {
    float low[3], high[3];
    for (int c = 0; c < 3; c++) {
        low[c] = (float)box->low[c];
        high[c] = (float)box->high[c];
    }
    return find_items(nearby, clusters, low, high, nearby->items);
}

void cs_nearby_clusters_finish(struct cs_nearby_clusters *nearby) {
    free(nearby->clusters);
    free(nearby->boxes);
    free(nearby->items);
}

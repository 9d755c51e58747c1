/* uniform_grid.h - axis-aligned boxes sorted into the cells of a uniform grid by counting:
 * integer keys, no pointers, items of a cell in ascending order. */
#ifndef CS_BROAD_PHASE_UNIFORM_GRID_H
#define CS_BROAD_PHASE_UNIFORM_GRID_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Axis-aligned bounding box in m; empty if high is below low. */
struct cs_aabb {
    double low[3], high[3]; /* m */
};

/* Boxes that touch overlap, and so do boxes with NaN: a broad phase must not lose them. */
static inline bool cs_aabbs_overlap(const struct cs_aabb *a, const struct cs_aabb *b) {
    bool apart = false;
    for (int c = 0; c < 3; c++)
        apart |= a->low[c] > b->high[c] || b->low[c] > a->high[c];
    return !apart;
}

/* Extends a box, which may be empty, to contain another. */
static inline void cs_aabb_merge(struct cs_aabb *box, const struct cs_aabb *other) {
    for (int c = 0; c < 3; c++) {
        box->low[c] = other->low[c] < box->low[c] ? other->low[c] : box->low[c];
        box->high[c] = other->high[c] > box->high[c] ? other->high[c] : box->high[c];
    }
}

/* Cells in compressed row format: cell c has items[cell_starts[c]] to [cell_starts[c + 1] - 1].
 */
struct cs_uniform_grid {
    /* lower corner in m; 1 / edge of a cell in 1/m */
    double origin[3], inverse_cell_size;
    uint32_t dim[3];
    /* (cells + 1) and the items of all cells */
    uint32_t *cell_starts, *items;
    size_t starts_capacity, items_capacity;
};

/* m, longest side; negative: the box is empty */
static inline double cs_aabb_longest_side(const struct cs_aabb *box) {
    double side = -1;
    for (int c = 0; c < 3; c++) {
        const double along = box->high[c] - box->low[c];
        side = along > side ? along : side;
    }
    return side;
}

/* Boxes of one grid: those with side_min < longest side <= side_max. */
struct cs_aabb_set {
    const struct cs_aabb *boxes; /* (n) */
    uint32_t n;
    double side_min, side_max; /* m */
};

/* Puts each box into every cell that it touches; empty boxes into none. Cells are about as
 * large as the mean box, and larger if there would be too many. If boxes are not finite or all
 * are empty, there are no cells (dim 0). Returns false if out of memory, again with dim 0. */
bool cs_uniform_grid_fill(struct cs_uniform_grid *cells, const struct cs_aabb_set *boxes);

/* First and last cell along each axis that a box touches. */
void cs_uniform_grid_range(const struct cs_uniform_grid *cells, const struct cs_aabb *box,
                           uint32_t first[3], uint32_t last[3]);

/* Cell along one axis of a coordinate; those outside the grid have the first or last one. */
static inline uint32_t cs_uniform_grid_index(const struct cs_uniform_grid *cells, double place,
                                             int axis) {
    const double end = cells->dim[axis] - 1;
    const double at = (place - cells->origin[axis]) * cells->inverse_cell_size;
    return (uint32_t)(at > 0 ? at < end ? at : end : 0);
}

/* Number of a cell: x runs fastest. */
static inline size_t cs_uniform_grid_cell(const struct cs_uniform_grid *cells, uint32_t x,
                                          uint32_t y, uint32_t z) {
    return ((size_t)z * cells->dim[1] + y) * cells->dim[0] + x;
}

/* Frees the memory; the grid is empty afterwards. */
void cs_uniform_grid_finish(struct cs_uniform_grid *cells);

#endif

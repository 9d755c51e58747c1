/* uniform_grid.h - boxes sorted into the cells of a uniform grid by counting: integer keys, no
 * pointers, items of a cell ascending. */
#ifndef CS_BROAD_PHASE_UNIFORM_GRID_H
#define CS_BROAD_PHASE_UNIFORM_GRID_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct cs_aabb {
    double low[3], high[3]; /* m */
};

/* Boxes that are not finite meet. */
static inline bool cs_aabbs_overlap(const struct cs_aabb *a, const struct cs_aabb *b) {
    bool apart = false;
    for (int c = 0; c < 3; c++)
        apart |= a->low[c] > b->high[c] || b->low[c] > a->high[c];
    return !apart;
}

/* Makes a box that is empty, or about others, one about another too. */
static inline void cs_aabb_merge(struct cs_aabb *box, const struct cs_aabb *other) {
    for (int c = 0; c < 3; c++) {
        box->low[c] = other->low[c] < box->low[c] ? other->low[c] : box->low[c];
        box->high[c] = other->high[c] > box->high[c] ? other->high[c] : box->high[c];
    }
}

struct cs_uniform_grid {
    double origin[3], inverse_cell_size; /* corner of the grid, 1/edge of a cell */
    uint32_t dim[3];
    uint32_t *cell_starts, *items; /* cell c holds items[starts[c]..starts[c + 1]) */
    size_t starts_capacity, items_capacity;
};

/* m, the longest; below 0: it is empty */
static inline double cs_aabb_longest_side(const struct cs_aabb *box) {
    double side = -1;
    for (int c = 0; c < 3; c++) {
        const double along = box->high[c] - box->low[c];
        side = along > side ? along : side;
    }
    return side;
}

/* The boxes of one grid: those whose longest side is above `least` and not above `most`. */
struct cs_aabb_set {
    const struct cs_aabb *boxes; /* (n) */
    uint32_t n;
    double side_min, side_max; /* m */
};

/* Puts box i into every cell that it touches; empty boxes (high below low) into none. Cells are
 * about as large as the boxes on average, and larger where there would be too many. Where boxes
 * are not finite, or all empty, there is no cell (dim 0), and so it is where false says that
 * there was no memory. */
bool cs_uniform_grid_fill(struct cs_uniform_grid *cells, const struct cs_aabb_set *boxes);

/* Cells that a box touches, first and last along each axis. */
void cs_uniform_grid_range(const struct cs_uniform_grid *cells, const struct cs_aabb *box,
                           uint32_t first[3], uint32_t last[3]);

/* Cell along one axis of a place, the first or last one outside. */
static inline uint32_t cs_uniform_grid_index(const struct cs_uniform_grid *cells, double place,
                                             int axis) {
    const double end = cells->dim[axis] - 1;
    const double at = (place - cells->origin[axis]) * cells->inverse_cell_size;
    return (uint32_t)(at > 0 ? at < end ? at : end : 0);
}

/* Number of a cell. */
static inline size_t cs_uniform_grid_cell(const struct cs_uniform_grid *cells, uint32_t x,
                                          uint32_t y, uint32_t z) {
    return ((size_t)z * cells->dim[1] + y) * cells->dim[0] + x;
}

/* Gives the memory back. */
void cs_uniform_grid_finish(struct cs_uniform_grid *cells);

#endif

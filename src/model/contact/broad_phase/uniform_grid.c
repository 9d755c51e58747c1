/* Uniform grid of boxes: chooses the cell size, counts, fills. */
#include "model/contact/broad_phase/uniform_grid.h"

#include "base/arena.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Limits per box: cells, and entries in cells; FEW is added to both. Beyond either the cells
 * grow by LARGER = 2^(1/3) per side, so that their number halves. Chosen by trial. */
enum { CELLS_EACH = 8, PLACES_EACH = 32, FEW = 4096 };
#define LARGER 1.26

/* Returns whether a box is empty or belongs to another grid. */
static bool is_out(const struct cs_aabb_set *boxes, uint32_t i) {
    const double side = cs_aabb_longest_side(boxes->boxes + i);
    return !(side >= 0 && side > boxes->side_min && side <= boxes->side_max);
}

/* Sets lower corner and extent of all boxes; returns their mean longest side, 0 without boxes.
 */
static double measure(const struct cs_aabb_set *boxes, double low[3], double extent[3]) {
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
        sum += cs_aabb_longest_side(box);
        count++;
    }
    for (int c = 0; c < 3; c++)
        extent[c] = high[c] - low[c];
    return count ? sum / count : 0;
}

/* Sets the number of cells along each axis; returns false if there are more than `most`. */
static bool divide(struct cs_uniform_grid *cells, const double extent[3], double size,
                   double most) {
    double all = 1;
    cells->inverse_cell_size = 1 / size;
    for (int c = 0; c < 3; c++) {
        const double number = floor(extent[c] * cells->inverse_cell_size) + 1;
        all *= number;
        if (!(all <= most))
            return false;
        cells->dim[c] = (uint32_t)number;
    }
    return true;
}

void cs_uniform_grid_range(const struct cs_uniform_grid *cells, const struct cs_aabb *box,
                           uint32_t first[3], uint32_t last[3]) {
    for (int c = 0; c < 3; c++) {
        first[c] = cs_uniform_grid_index(cells, box->low[c], c);
        last[c] = cs_uniform_grid_index(cells, box->high[c], c);
    }
}

/* Adds 1 to each cell that a box touches, or stores the item at the position that the cell's
 * count gives; returns the number of cells. */
static size_t visit(struct cs_uniform_grid *cells, const struct cs_aabb *box, uint32_t item,
                    bool put) {
    uint32_t first[3], last[3];
    size_t places = 0;
    cs_uniform_grid_range(cells, box, first, last);
    for (uint32_t z = first[2]; z <= last[2]; z++)
        for (uint32_t y = first[1]; y <= last[1]; y++)
            for (uint32_t x = first[0]; x <= last[0]; x++, places++) {
                uint32_t *count = cells->cell_starts + cs_uniform_grid_cell(cells, x, y, z);
                if (put)
                    cells->items[--*count] = item;
                else
                    ++*count;
            }
    return places;
}

/* Counts the entries of all cells; stops early at too many. Returns false if out of memory. */
static bool count_all(struct cs_uniform_grid *cells, const struct cs_aabb_set *boxes,
                      size_t *places) {
    const size_t all = (size_t)cells->dim[0] * cells->dim[1] * cells->dim[2];
    uint32_t *starts =
        cs_arena_realloc(cells->cell_starts, &cells->starts_capacity, all + 1, sizeof *starts);
    *places = 0;
    if (!starts)
        return false;
    cells->cell_starts = starts;
    memset(starts, 0, (all + 1) * sizeof *starts);
    for (uint32_t i = 0; i < boxes->n && *places <= (size_t)PLACES_EACH * boxes->n + FEW; i++)
        if (!is_out(boxes, i))
            *places += visit(cells, boxes->boxes + i, i, false);
    return true;
}

/* Stores the items. Running sums make each start the end of its cell; filling from the last box
 * to the first brings it down to the begin, with items in ascending order. */
static bool fill_all(struct cs_uniform_grid *cells, const struct cs_aabb_set *boxes,
                     size_t places) {
    const size_t all = (size_t)cells->dim[0] * cells->dim[1] * cells->dim[2];
    uint32_t *items =
        cs_arena_realloc(cells->items, &cells->items_capacity, places, sizeof *items);
    if (!items && places)
        return false;
    cells->items = items;
    for (size_t c = 1; c < all; c++)
        cells->cell_starts[c] += cells->cell_starts[c - 1];
    cells->cell_starts[all] = (uint32_t)places;
    for (uint32_t i = boxes->n; i--;)
        if (!is_out(boxes, i))
            visit(cells, boxes->boxes + i, i, true);
    return true;
}

/* Enlarges the cells until both limits hold; returns false if out of memory. */
static bool fill(struct cs_uniform_grid *cells, const struct cs_aabb_set *boxes,
                 const double extent[3], double size) {
    size_t places;
    for (;; size *= LARGER) {
        if (!divide(cells, extent, size, (double)CELLS_EACH * boxes->n + FEW))
            continue;
        if (!count_all(cells, boxes, &places))
            return false;
        if (places <= (size_t)PLACES_EACH * boxes->n + FEW)
            return fill_all(cells, boxes, places);
    }
}

bool cs_uniform_grid_fill(struct cs_uniform_grid *cells, const struct cs_aabb_set *boxes) {
    double extent[3];
    const double size = measure(boxes, cells->origin, extent);
    const bool some = size > 0 && extent[0] + extent[1] + extent[2] < HUGE_VAL;
    const bool filled = !some || fill(cells, boxes, extent, size);
    if (!some || !filled)
        memset(cells->dim, 0, sizeof cells->dim);
    return filled;
}

void cs_uniform_grid_finish(struct cs_uniform_grid *cells) {
    free(cells->cell_starts);
    free(cells->items);
    *cells = (struct cs_uniform_grid){0};
}

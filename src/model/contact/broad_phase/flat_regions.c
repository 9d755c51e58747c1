/* Measures flat regions: boxes of the edges of each block, then the bound of (s - r) / sqrt(2)
 * over each block and its neighbours. Theory: flat_regions.h.
 *
 * The cost is one pass over the edges and 9 boxes per block, a small part of a search for
 * pairs. */
#include "model/contact/broad_phase/flat_regions.h"

#include "base/pool.h"

#include <math.h>

enum cs_status cs_flat_region_init(struct cs_flat_region *flat, struct cs_arena *arena,
                                   struct cs_error *error) {
    flat->n_blocks_x = (flat->columns - 2) / CS_FLAT_REGION_BLOCK + 1;
    flat->n_blocks_y = (flat->rows - 2) / CS_FLAT_REGION_BLOCK + 1;
    const size_t blocks = (size_t)flat->n_blocks_x * flat->n_blocks_y;
    flat->edges = cs_arena_alloc_array(arena, blocks, sizeof *flat->edges, error);
    flat->min_distance = cs_arena_alloc_array(arena, blocks, sizeof *flat->min_distance, error);
    return error->status;
}

/* A grid at a state. */
struct measuring {
    struct cs_flat_region *flat;
    const double *x;
    size_t n;
};

static void extend_bounds(double *low, double *high, double low_too, double high_too) {
    *low = low_too < *low ? low_too : *low;
    *high = high_too > *high ? high_too : *high;
}

/* boxes of no edge */
static const struct cs_flat_region_edges none = {
    {{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {HUGE_VAL, HUGE_VAL, HUGE_VAL}},
    {{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}},
    0};

/* Adds the edges from the points in rows [top, end) and columns [left, right) to the next
 * point; way 0: along the row, 1: across the rows. */
static void add_edges(const struct measuring *at, const uint32_t top, uint32_t end,
                      uint32_t left, uint32_t right, int way,
                      struct cs_flat_region_edges *edges) {
    const size_t columns = at->flat->columns, step = way ? columns : 1;
    for (size_t c = 0; c < 3; c++)
        for (size_t row = top; row < end; row++) {
            const double *x = at->x + c * at->n + at->flat->first + row * columns;
            for (size_t column = left; column < right; column++) {
                const double edge = x[column + step] - x[column];
                extend_bounds(&edges->low[way][c], &edges->high[way][c], edge, edge);
                edges->sum += edge;
            }
        }
}

/* Boxes of one row of blocks. Edges between blocks count in both. */
static void box_row(void *arg, uint32_t down) {
    const struct measuring *at = arg;
    const struct cs_flat_region *flat = at->flat;
    const uint32_t top = CS_FLAT_REGION_BLOCK * down;
    const uint32_t end =
        top + CS_FLAT_REGION_BLOCK < flat->rows ? top + CS_FLAT_REGION_BLOCK : flat->rows - 1;
    for (uint32_t across = 0; across < flat->n_blocks_x; across++) {
        const uint32_t left = CS_FLAT_REGION_BLOCK * across, last = left + CS_FLAT_REGION_BLOCK;
        const uint32_t right = last < flat->columns ? last : flat->columns - 1;
        struct cs_flat_region_edges edges = none;
        add_edges(at, top, end + 1, left, right, 0, &edges);
        add_edges(at, top, end, left, right + 1, 1, &edges);
        flat->edges[(size_t)down * flat->n_blocks_x + across] = edges;
    }
}

/* Boxes of a block and those around it. */
static struct cs_flat_region_edges join(const struct cs_flat_region *flat, uint32_t down,
                                        uint32_t across) {
    struct cs_flat_region_edges all = none;
    for (uint32_t i = down ? down - 1 : 0; i <= down + 1 && i < flat->n_blocks_y; i++)
        for (uint32_t j = across ? across - 1 : 0; j <= across + 1 && j < flat->n_blocks_x;
             j++) {
            const struct cs_flat_region_edges *one =
                flat->edges + (size_t)i * flat->n_blocks_x + j;
            for (int k = 0; k < 6; k++)
                extend_bounds(&all.low[k / 3][k % 3], &all.high[k / 3][k % 3],
                              one->low[k / 3][k % 3], one->high[k / 3][k % 3]);
            all.sum += one->sum;
        }
    return all;
}

/* (s - r) / sqrt(2). A = (u v) has the columns of box centres, and s^2 is the smaller
 * eigenvalue of A^T A = (a b; b c):
 *
 *   s^2 = (a + c - sqrt((a - c)^2 + 4 b^2)) / 2
 *
 * r is the Frobenius norm of the half-widths, an upper bound of the spectral norm. 0.707106 is
 * 1.1e-6 below 1/sqrt(2), far more than the rounding of the rest. NaN if an edge is not finite,
 * so that no comparison calls the block flat. */
static double bound_of(const struct cs_flat_region_edges *edges) {
    double a = 0, b = 0, c = 0, reach = 0 * edges->sum;
    for (int k = 0; k < 3; k++) {
        const double u = 0.5 * (edges->low[0][k] + edges->high[0][k]);
        const double v = 0.5 * (edges->low[1][k] + edges->high[1][k]);
        const double along = 0.5 * (edges->high[0][k] - edges->low[0][k]);
        const double over = 0.5 * (edges->high[1][k] - edges->low[1][k]);
        a += u * u;
        b += u * v;
        c += v * v;
        reach += along * along + over * over;
    }
    const double least = 0.5 * (a + c - sqrt((a - c) * (a - c) + 4 * b * b));
    return 0.707106 * (sqrt(least > 0 ? least : 0) - sqrt(reach));
}

/* Bounds of one row of blocks, after all boxes are set. */
static void part_row(void *arg, uint32_t down) {
    const struct measuring *at = arg;
    const struct cs_flat_region *flat = at->flat;
    for (uint32_t across = 0; across < flat->n_blocks_x; across++) {
        const struct cs_flat_region_edges all = join(flat, down, across);
        flat->min_distance[(size_t)down * flat->n_blocks_x + across] = bound_of(&all);
    }
}

void cs_flat_region_measure(struct cs_flat_region *flat, const double *x, size_t n) {
    struct measuring measuring = {flat, x, n};
    cs_pool_run(flat->n_blocks_y, box_row, &measuring);
    cs_pool_run(flat->n_blocks_y, part_row, &measuring);
}

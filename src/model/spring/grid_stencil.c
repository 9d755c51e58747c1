/* Computes the springs of a grid's row tile by tile and adds them; scheme in grid_stencil.h. */
#include "model/spring/grid_stencil.h"

/* One tile: particles [start, start + count) of the row. rows holds the results, by direction
 * and component, with a margin on either side. */
struct tile {
    const struct spring_job *job;
    const struct row_stencil *fan;
    const struct stencil_kernel *kernel;
    size_t parts; /* results per spring */
    /* rows of a direction, and from one to the next; zeros if the direction does not exist */
    const double *results[CS_DIRECTIONS];
    size_t strides[CS_DIRECTIONS];
    size_t start, count, column; /* of its first particle, where rows are packed */
    _Alignas(64) double rows[CS_DIRECTIONS * NUMBERS_PER_SPRING_MAX * PADDED_TILE];
};

/* Results of a direction; entry i belongs to particle i of the tile. */
CS_INLINE double *rows_of(struct tile *tile, unsigned way) {
    return tile->rows + way * tile->parts * PADDED_TILE + BEFORE;
}

/* Particles of the row that begin a spring of a direction are [begin_of, end_of): the leftmost
 * has none down left, the rightmost none right or down right, the last two none two to the
 * right. */
CS_INLINE size_t begin_of(unsigned way) {
    return way == CS_DIRECTION_DOWN_LEFT;
}

CS_INLINE size_t end_of(unsigned way, size_t columns) {
    static const size_t short_of[CS_DIRECTIONS] = {
        [CS_DIRECTION_RIGHT] = 1, [CS_DIRECTION_RIGHT_TWO] = 2, [CS_DIRECTION_DOWN_RIGHT] = 1};
    // a run exists only if its direction fits the grid, so this is not negative
    return columns - short_of[way];
}

/* Describes a direction to a kernel. Factors lie by spring, and a run's first spring may begin
 * at the second particle of the row, hence `before`. */
CS_INLINE struct stencil_direction direction_of(struct tile *tile, unsigned way) {
    const struct cs_spring_run *run = tile->fan->directions[way];
    const struct spring_job *job = tile->job;
    const ptrdiff_t before = (ptrdiff_t)(tile->start + run->row) - (ptrdiff_t)run->first_a;
    return (struct stencil_direction){
        .k = active_constants_of(run, job->at.parts).k,
        .length = run->length,
        .offset = run->first_b - run->first_a,
        .factors = job->factors ? job->factors + run->factors + before : NULL,
        .stride = run->factor_stride,
        .out = rows_of(tile, way)};
}

/* Shifts an array, if there is one. */
CS_INLINE const double *from(const double *array, size_t first) {
    return array ? array + first : NULL;
}

/* Input of a kernel for a tile. */
CS_INLINE struct stencil_input in_of(const struct tile *tile) {
    const struct cs_spring_run *run = tile->fan->first;
    const struct cs_eval *at = &tile->job->at;
    const size_t first = run->row + tile->start;
    return (struct stencil_input){.x = from(at->x, first),
                                  .v = from(at->v, first),
                                  .dx = from(at->dx, first),
                                  .dv = from(at->dv, first),
                                  .n = tile->job->n,
                                  .c = active_constants_of(run, at->parts).c,
                                  .axial = run->axial};
}

/* Zeroes the margin entries that sums read: before the row's first particle, and after the
 * tile's last one. Between tiles of a row, carry_over_overlap fills the former. */
CS_INLINE void clear_margins(struct tile *tile) {
    static const unsigned before[] = {CS_DIRECTION_RIGHT, CS_DIRECTION_RIGHT_TWO,
                                      CS_DIRECTION_DOWN_RIGHT};
    for (size_t k = 0; k < tile->parts; k++) {
        for (size_t b = 0; b < 3 && tile->start == 0; b++) {
            double *rows = rows_of(tile, before[b]) + k * PADDED_TILE;
            rows[-1] = rows[-2] = 0;
        }
        rows_of(tile, CS_DIRECTION_DOWN_LEFT)[k * PADDED_TILE + tile->count] = 0;
    }
}

/* Zeroes the results of springs that do not exist, at the ends of the row: at most one or two
 * a tile. Of a tile of one particle, the margin before it holds 0 already. Stores one by one,
 * because a loop over so few entries becomes a call of memset. */
CS_INLINE void drop_none(struct tile *tile, unsigned way) {
    const size_t end = end_of(way, tile->fan->first->columns), stop = tile->start + tile->count;
    const size_t parts = tile->parts, none = stop > end ? stop - end : 0;
    double *rows = rows_of(tile, way), *last = rows + tile->count - 1;
    for (size_t k = 0; k < parts && tile->start < begin_of(way); k++)
        rows[k * PADDED_TILE] = 0;
    for (size_t k = 0; k < parts && none > 0; k++)
        last[k * PADDED_TILE] = 0;
    for (size_t k = 0; k < parts && none > 1; k++)
        *(last + k * PADDED_TILE - 1) = 0;
}

/* Directions that are computed side by side: from one number up to the next. Zeroes go into a
 * group's results before the next group is computed: a vector that is read soon after a number
 * in it was stored waits for that store. */
static const unsigned groups[] = {CS_DIRECTION_RIGHT, CS_DIRECTION_DOWN, CS_DIRECTION_DOWN_TWO,
                                  CS_DIRECTIONS};
enum { GROUPS = sizeof groups / sizeof *groups - 1 };

/* Computes those of the directions [first, last) that exist, side by side if the kernel can. */
CS_INLINE void make_directions(struct tile *tile, const struct stencil_input *in,
                               unsigned first, unsigned last) {
    struct stencil_direction ways[DIRECTIONS_AT_ONCE];
    unsigned n = 0;
    for (unsigned way = first; way < last; way++)
        if (tile->fan->directions[way])
            ways[n++] = direction_of(tile, way);
    if (n > 0 && tile->kernel->passes[n - 1])
        tile->kernel->passes[n - 1](in, ways, 0, tile->count);
    else
        for (unsigned k = 0; k < n; k++)
            tile->kernel->passes[0](in, ways + k, 0, tile->count);
}

/* Computes the existing springs of one direction, and reads nothing else. */
CS_INLINE void make_alone(struct tile *tile, const struct stencil_input *in, unsigned way) {
    const struct stencil_direction alone = direction_of(tile, way);
    const size_t end = end_of(way, tile->fan->first->columns);
    const size_t begin = begin_of(way) > tile->start;
    const size_t stop = end < tile->start ? 0 : end - tile->start;
    tile->kernel->passes[0](in, &alone, begin, stop < tile->count ? stop : tile->count);
    drop_none(tile, way);
}

/* Computes a tile's springs, as far as rows in the block need them. at[k] tells whether the row
 * k rows below is in the block. Its own row needs all directions, the next one those down, the
 * row after only down two. */
CS_INLINE void make_tile(struct tile *tile, const bool at[3]) {
    const struct stencil_input in = in_of(tile);
    const bool alone = tile->fan->first->rows_below < 2;
    clear_margins(tile);
    for (unsigned way = 0; way < CS_DIRECTIONS && alone; way++)
        if (tile->fan->directions[way])
            make_alone(tile, &in, way);
    if (alone)
        return;
    CS_UNROLLED
    for (unsigned g = 0; g < GROUPS; g++) {
        if (at[0] || (g > 0 && at[g]))
            make_directions(tile, &in, groups[g], groups[g + 1]);
        for (unsigned way = groups[g]; way < groups[g + 1]; way++)
            if (tile->fan->directions[way])
                drop_none(tile, way);
    }
}

/* Copies the results of the tile's last two particles to the margin before the next tile, whose
 * first two particles end these springs. Down two has no part in this: it stays in its column.
 */
CS_INLINE void carry_over_overlap(struct tile *tile) {
    for (unsigned way = 0; way < CS_DIRECTION_DOWN_TWO; way++) {
        double *rows = rows_of(tile, way);
        for (size_t k = 0; k < tile->parts && tile->fan->directions[way];
             k++, rows += PADDED_TILE) {
            rows[-2] = rows[TILE - 2];
            rows[-1] = rows[TILE - 1];
        }
    }
}

/* Row k of a direction's results, moved back by some particles. */
CS_INLINE const double *row_of(const struct tile *tile, unsigned way, size_t k, size_t back) {
    return tile->results[way] + k * tile->strides[way] - back;
}

/* Adds to the tile's own particles: the springs that they begin, and those of their row that
 * end there. The order of the terms is the order of the sum; the state hash depends on it. */
CS_INLINE void add_own(struct tile *tile, size_t k, const double sign, double *to) {
    const double *right = row_of(tile, CS_DIRECTION_RIGHT, k, 0);
    const double *two = row_of(tile, CS_DIRECTION_RIGHT_TWO, k, 0);
    const double *down = row_of(tile, CS_DIRECTION_DOWN, k, 0);
    const double *forth = row_of(tile, CS_DIRECTION_DOWN_RIGHT, k, 0);
    const double *back = row_of(tile, CS_DIRECTION_DOWN_LEFT, k, 0);
    const double *after = row_of(tile, CS_DIRECTION_DOWN_TWO, k, 0);
    const size_t count = tile->count;
    CS_INDEPENDENT
    for (size_t i = 0; i < count; i++)
        to[i] += (right[i] + two[i] + (down[i] + forth[i] + back[i]) + after[i]) +
                 sign * ((right - 1)[i] + (two - 2)[i]);
}

/* Adds to the next row. Its particle below the tile's last one also ends a spring down left of
 * the next tile; it is therefore added with the next tile (early), which starts one particle
 * sooner (late). */
CS_INLINE void add_next(struct tile *tile, size_t k, const double sign, double *to) {
    const size_t late = tile->start > 0;
    const size_t early = tile->start + tile->count < tile->fan->first->columns;
    const double *down = row_of(tile, CS_DIRECTION_DOWN, k, late);
    const double *forth = row_of(tile, CS_DIRECTION_DOWN_RIGHT, k, late);
    const double *back = row_of(tile, CS_DIRECTION_DOWN_LEFT, k, late);
    const size_t count = tile->count + late - early;
    double *from_late = to - late;
    CS_INDEPENDENT
    for (size_t i = 0; i < count; i++)
        from_late[i] += sign * (down[i] + (forth - 1)[i] + back[i + 1]);
}

/* Adds to the row after the next. */
CS_INLINE void add_after(struct tile *tile, size_t k, const double sign, double *to) {
    const double *after = row_of(tile, CS_DIRECTION_DOWN_TWO, k, 0);
    const size_t count = tile->count;
    CS_INDEPENDENT
    for (size_t i = 0; i < count; i++)
        to[i] += sign * after[i];
}

/* Adds component k of the results to the three rows, as far as they are in the block and exist.
 */
CS_INLINE void add_part(struct tile *tile, const bool at[3], size_t k, const double sign,
                        double *array) {
    const struct cs_spring_run *first = tile->fan->first;
    double *to = array + first->row + tile->start;
    if (at[0])
        add_own(tile, k, sign, to);
    if (at[1] && first->rows_below > 0)
        add_next(tile, k, sign, to + first->columns);
    if (at[2] && tile->fan->directions[CS_DIRECTION_DOWN_TWO])
        add_after(tile, k, sign, to + 2 * (size_t)first->columns);
}

/* Array of component k: of the force, of df/dx or of df/dv. */
CS_INLINE double *array_of(const struct tile *tile, size_t k) {
    const struct stencil_kernel *kernel = tile->kernel;
    const struct spring_job *job = tile->job;
    if (k < kernel->n_force)
        return job->to + k * job->n;
    k -= kernel->n_force;
    return k < kernel->n_dfdx ? job->at.dfdx_blocks + k * job->n
                              : job->at.dfdv_blocks + (k - kernel->n_dfdx) * job->n;
}

/* Adds all components: forces with the opposite sign at the other ends, blocks with the same
 * sign. */
CS_INLINE void add_tile(struct tile *tile, const bool at[3]) {
    for (size_t k = 0; k < tile->kernel->n_force; k++)
        add_part(tile, at, k, -1, array_of(tile, k));
    for (size_t k = tile->kernel->n_force; k < tile->parts; k++)
        add_part(tile, at, k, 1, array_of(tile, k));
}

/* Finds the rows of each direction, the same for all tiles of a row. */
CS_INLINE void find_rows(struct tile *tile) {
    static const _Alignas(64) double zeros[PADDED_TILE];
    for (unsigned way = 0; way < CS_DIRECTIONS; way++) {
        const bool exists = tile->fan->directions[way];
        tile->results[way] = exists ? rows_of(tile, way) : zeros + BEFORE;
        tile->strides[way] = exists ? PADDED_TILE : 0;
    }
}

/* Tiles go from left to right, as the overlap requires. */
CS_CLONES void cs_grid_stencil_add(const struct spring_job *job, const struct cs_block *block,
                                   const struct row_stencil *stencil,
                                   const struct stencil_kernel *kernel) {
    const struct cs_spring_run *first = stencil->first;
    bool at[3];
    struct tile tile;
    tile.job = job, tile.fan = stencil, tile.kernel = kernel;
    tile.parts = kernel->n_force + kernel->n_dfdx + kernel->n_dfdv;
    find_rows(&tile);
    for (uint32_t down = 0; down < 3; down++)
        at[down] = is_in(block, first->row + down * first->columns);
    for (size_t left = first->columns; left > 0; left -= tile.count) {
        tile.start = first->columns - left;
        tile.count = left < TILE ? left : TILE;
        make_tile(&tile, at);
        add_tile(&tile, at);
        if (left > TILE)
            carry_over_overlap(&tile);
    }
}

/* --- packed rows --- */

/* A tile of packed rows: start and count go on over the ends of rows, which lie one after
 * another. Springs that would cross an end are computed and dropped. A particle reads what the
 * two rows above it began, which is therefore kept before each tile. */

/* Drops the results of one column. */
CS_INLINE void drop_column(struct tile *tile, unsigned way, size_t column) {
    const size_t columns = tile->fan->first->columns;
    double *rows = rows_of(tile, way);
    for (size_t i = column + (column < tile->column ? columns : 0) - tile->column;
         i < tile->count; i += columns)
        for (size_t k = 0; k < tile->parts; k++)
            rows[k * PADDED_TILE + i] = 0;
}

/* Drops what does not exist of a direction: springs over an end of a row, and, from `end` of
 * the tile on, over the last row. */
CS_INLINE void drop_packed(struct tile *tile, unsigned way, size_t end) {
    const size_t columns = tile->fan->first->columns;
    for (size_t column = end_of(way, columns); column < columns; column++)
        drop_column(tile, way, column);
    if (begin_of(way))
        drop_column(tile, way, 0);
    for (size_t k = 0; k < tile->parts; k++)
        for (size_t i = end; i < tile->count; i++)
            rows_of(tile, way)[k * PADDED_TILE + i] = 0;
}

/* Computes a direction, unless `in` is NULL because it was computed, and drops what does not
 * exist of it. The grid has `left` particles from the tile on. */
CS_INLINE void finish_packed(struct tile *tile, unsigned way, const struct stencil_input *in,
                             size_t left) {
    if (!tile->fan->directions[way])
        return;
    const struct stencil_direction alone = direction_of(tile, way);
    const size_t stop = left > alone.offset ? left - alone.offset : 0;
    const size_t end = stop < tile->count ? stop : tile->count;
    if (in)
        tile->kernel->passes[0](in, &alone, 0, end);
    drop_packed(tile, way, end);
}

/* Computes a tile of a grid of `all` particles; near its end direction by direction, so that
 * nothing beyond it is read. */
CS_INLINE void make_packed(struct tile *tile, size_t all) {
    const struct stencil_input in = in_of(tile);
    const size_t left = all - tile->start;
    const bool inside = tile->count + 2 * (size_t)tile->fan->first->columns < left;
    for (unsigned g = 0; g < GROUPS; g++) {
        if (inside)
            make_directions(tile, &in, groups[g], groups[g + 1]);
        for (unsigned way = groups[g]; way < groups[g + 1]; way++)
            finish_packed(tile, way, inside ? NULL : &in, left);
    }
}

/* Adds component k to the tile's particles from `begin` on: first what the rows above began, as
 * add_after and add_next do, then as add_own does. */
CS_INLINE void add_packed(struct tile *tile, size_t k, const double sign, size_t begin,
                          double *to) {
    const size_t count = tile->count, columns = tile->fan->first->columns;
    const double *right = row_of(tile, CS_DIRECTION_RIGHT, k, 0);
    const double *two = row_of(tile, CS_DIRECTION_RIGHT_TWO, k, 0);
    const double *down = row_of(tile, CS_DIRECTION_DOWN, k, 0);
    const double *forth = row_of(tile, CS_DIRECTION_DOWN_RIGHT, k, 0);
    const double *back = row_of(tile, CS_DIRECTION_DOWN_LEFT, k, 0);
    const double *after = row_of(tile, CS_DIRECTION_DOWN_TWO, k, 0);
    CS_INDEPENDENT
    for (size_t i = begin; i < count; i++)
        to[i] =
            to[i] + sign * (after - 2 * columns)[i] +
            sign * ((down - columns)[i] + (forth - columns - 1)[i] + (back - columns + 1)[i]) +
            ((right[i] + two[i] + (down[i] + forth[i] + back[i]) + after[i]) +
             sign * ((right - 1)[i] + (two - 2)[i]));
}

/* Zeroes what is kept before the first tile, or keeps it before the next one. */
CS_INLINE void keep_before(struct tile *tile, bool first) {
    for (unsigned way = 0; way < CS_DIRECTIONS; way++) {
        if (!tile->fan->directions[way])
            continue;
        double *rows = rows_of(tile, way);
        const ptrdiff_t kept = (ptrdiff_t)direction_of(tile, way).offset + 1;
        for (size_t k = 0; k < tile->parts; k++, rows += PADDED_TILE)
            for (ptrdiff_t i = -kept; i < 0; i++)
                rows[i] = first ? 0 : rows[i + PACKED_TILE];
    }
}

CS_CLONES void cs_grid_stencil_add_packed(const struct spring_job *job,
                                          const struct cs_block *block,
                                          const struct row_stencil *stencil,
                                          const struct stencil_kernel *kernel) {
    const struct cs_spring_run *first = stencil->first;
    const size_t all = (size_t)first->columns * (first->rows_below + 1);
    const size_t begin = block->begin > first->row ? block->begin - first->row : 0;
    const size_t left = block->end - first->row, end = left < all ? left : all;
    struct tile tile;
    tile.job = job, tile.fan = stencil, tile.kernel = kernel;
    tile.parts = kernel->n_force + kernel->n_dfdx + kernel->n_dfdv;
    find_rows(&tile);
    for (tile.start = 0; tile.start < end; tile.start += PACKED_TILE) {
        keep_before(&tile, tile.start == 0);
        tile.count = end - tile.start < PACKED_TILE ? end - tile.start : PACKED_TILE;
        tile.column = tile.start % first->columns;
        make_packed(&tile, all);
        const size_t from = begin > tile.start ? begin - tile.start : 0;
        for (size_t k = 0; k < tile.parts; k++)
            add_packed(&tile, k, k < kernel->n_force ? -1 : 1, from,
                       array_of(&tile, k) + first->row + tile.start);
    }
}

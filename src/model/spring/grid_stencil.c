/* The rows of a fan, made tile by tile and added; see grid_stencil.h. */
#include "model/spring/grid_stencil.h"

#include <string.h>

/* one tile of a fan: particles [start, start + count) of the row */
struct tile {
    const struct spring_job *job;
    const struct row_stencil *fan;
    const struct stencil_kernel *kernel;
    size_t start, count;
    _Alignas(64) double rows[CS_DIRECTIONS * NUMBERS_PER_SPRING_MAX * PADDED_TILE];
};

CS_INLINE size_t parts_of(const struct tile *tile) {
    return tile->kernel->n_force + tile->kernel->n_dfdx + tile->kernel->n_dfdv;
}

CS_INLINE double *rows_of(struct tile *tile, unsigned way) {
    return tile->rows + way * parts_of(tile) * PADDED_TILE + MARGIN;
}

/* particles of the row that have a spring of a way: [begin, end) */
CS_INLINE size_t begin_of(unsigned way) {
    return way == CS_DIRECTION_DOWN_LEFT;
}

CS_INLINE size_t end_of(unsigned way, size_t columns) {
    static const size_t short_of[CS_DIRECTIONS] = {
        [CS_DIRECTION_RIGHT] = 1, [CS_DIRECTION_RIGHT_TWO] = 2, [CS_DIRECTION_DOWN_RIGHT] = 1};
    return columns - short_of[way];
}

CS_INLINE struct stencil_direction direction_of(struct tile *tile, unsigned way) {
    const struct cs_spring_run *run = tile->fan->directions[way];
    const struct spring_job *job = tile->job;
    const ptrdiff_t before = (ptrdiff_t)(tile->start + run->row) - (ptrdiff_t)run->first_a;
    return (struct stencil_direction){
        .k = active_constants_of(run, job->at.parts).k,
        .length = run->length,
        .offset = run->first_b - run->first_a,
        .factors = job->factors ? job->factors + 4 * (size_t)run->first + before : NULL,
        .count = run->count,
        .out = rows_of(tile, way)};
}

CS_INLINE const double *from(const double *array, size_t first) {
    return array ? array + first : NULL;
}

/* the arrays that a kernel reads, from the tile on */
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

/* what is read beside a row, before its first particle and behind its last */
CS_INLINE void clear_margins(struct tile *tile) {
    static const unsigned before[] = {CS_DIRECTION_RIGHT, CS_DIRECTION_RIGHT_TWO,
                                      CS_DIRECTION_DOWN_RIGHT};
    for (size_t k = 0; k < parts_of(tile); k++) {
        for (size_t b = 0; b < 3 && tile->start == 0; b++) {
            double *rows = rows_of(tile, before[b]) + k * PADDED_TILE;
            rows[-1] = rows[-2] = 0;
        }
        rows_of(tile, CS_DIRECTION_DOWN_LEFT)[k * PADDED_TILE + tile->count] = 0;
    }
}

/* Springs that are none, before the first and behind the last of a way, add 0. */
CS_INLINE void drop_none(struct tile *tile, unsigned way) {
    const size_t columns = tile->fan->first->columns, stop = tile->start + tile->count;
    const size_t begin = begin_of(way), end = end_of(way, columns);
    double *rows = rows_of(tile, way);
    for (size_t k = 0; k < parts_of(tile); k++, rows += PADDED_TILE) {
        for (size_t i = tile->start; i < begin; i++)
            rows[i - tile->start] = 0;
        for (size_t i = end > tile->start ? end : tile->start; i < stop; i++)
            rows[i - tile->start] = 0;
    }
}

/* Ways [first, last), those that are there, side by side. */
CS_INLINE void make_directions(struct tile *tile, const struct stencil_input *in,
                               unsigned first, unsigned last) {
    struct stencil_direction ways[DIRECTIONS_AT_ONCE];
    unsigned n = 0;
    for (unsigned way = first; way < last; way++)
        if (tile->fan->directions[way])
            ways[n++] = direction_of(tile, way);
    if (n > 0)
        tile->kernel->passes[n - 1](in, ways, 0, tile->count);
    for (unsigned way = first; way < last; way++)
        if (tile->fan->directions[way])
            drop_none(tile, way);
}

/* Those springs of a way that there are. */
CS_INLINE void make_alone(struct tile *tile, const struct stencil_input *in, unsigned way) {
    const struct stencil_direction alone = direction_of(tile, way);
    const size_t end = end_of(way, tile->fan->first->columns);
    const size_t begin = begin_of(way) > tile->start;
    const size_t stop = end < tile->start ? 0 : end - tile->start;
    tile->kernel->passes[0](in, &alone, begin, stop < tile->count ? stop : tile->count);
    drop_none(tile, way);
}

/* Makes the numbers of a tile's springs that rows in the block want. */
CS_INLINE void make_tile(struct tile *tile, const bool at[3]) {
    const struct stencil_input in = in_of(tile);
    const bool alone = tile->fan->first->rows_below < 2;
    clear_margins(tile);
    for (unsigned way = 0; way < CS_DIRECTIONS && alone; way++)
        if (tile->fan->directions[way])
            make_alone(tile, &in, way);
    if (!alone && at[0])
        make_directions(tile, &in, CS_DIRECTION_RIGHT, CS_DIRECTION_DOWN);
    if (!alone && (at[0] || at[1]))
        make_directions(tile, &in, CS_DIRECTION_DOWN, CS_DIRECTION_DOWN_TWO);
    if (!alone && (at[0] || at[2]))
        make_directions(tile, &in, CS_DIRECTION_DOWN_TWO, CS_DIRECTIONS);
}

/* what the next tile wants of this one's last two particles */
CS_INLINE void carry_over_overlap(struct tile *tile) {
    for (unsigned way = 0; way < CS_DIRECTION_DOWN_TWO; way++) {
        double *rows = rows_of(tile, way);
        for (size_t k = 0; k < parts_of(tile) && tile->fan->directions[way];
             k++, rows += PADDED_TILE) {
            rows[-2] = rows[TILE - 2];
            rows[-1] = rows[TILE - 1];
        }
    }
}

/* row k of a way, moved back by some particles; zeros where the way is not there */
CS_INLINE const double *row_of(struct tile *tile, unsigned way, size_t k, size_t back) {
    static const _Alignas(64) double zeros[PADDED_TILE];
    return (tile->fan->directions[way] ? rows_of(tile, way) + k * PADDED_TILE
                                       : zeros + MARGIN) -
           back;
}

/* what particles get from springs in their own row, and from those that they begin */
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

/* What particles get from the row before; the last of a tile waits for what the next tile has
 * for it. */
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

CS_INLINE void add_after(struct tile *tile, size_t k, const double sign, double *to) {
    const double *after = row_of(tile, CS_DIRECTION_DOWN_TWO, k, 0);
    const size_t count = tile->count;
    CS_INDEPENDENT
    for (size_t i = 0; i < count; i++)
        to[i] += sign * after[i];
}

/* Adds part k of what was made of a tile to its row, the next and the one after. */
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

CS_INLINE void add_tile(struct tile *tile, const bool at[3]) {
    const struct stencil_kernel *kernel = tile->kernel;
    const struct spring_job *job = tile->job;
    const size_t blocks = kernel->n_dfdx + kernel->n_dfdv;
    for (size_t k = 0; k < kernel->n_force; k++)
        add_part(tile, at, k, -1, job->to + k * job->n);
    for (size_t k = 0; k < blocks; k++)
        add_part(tile, at, kernel->n_force + k, 1,
                 k < kernel->n_dfdx ? job->at.dfdx_blocks + k * job->n
                                    : job->at.dfdv_blocks + (k - kernel->n_dfdx) * job->n);
}

CS_CLONES void cs_grid_stencil_add(const struct spring_job *job, const struct cs_block *block,
                                   const struct row_stencil *stencil,
                                   const struct stencil_kernel *kernel) {
    const struct cs_spring_run *first = stencil->first;
    bool at[3];
    struct tile tile;
    tile.job = job, tile.fan = stencil, tile.kernel = kernel;
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

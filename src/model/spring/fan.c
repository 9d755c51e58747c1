/* The rows of a fan, made tile by tile and added; see fan.h. */
#include "model/spring/fan.h"

#include <string.h>

/* one tile of a fan: particles [start, start + count) of the row */
struct tile {
    const struct job *job;
    const struct fan *fan;
    const struct fan_kernel *kernel;
    size_t start, count;
    _Alignas(64) double rows[CS_WAYS * PARTS_MOST * WIDE];
};

CS_INLINE size_t parts_of(const struct tile *tile) {
    return tile->kernel->forces + tile->kernel->stiff + tile->kernel->damped;
}

CS_INLINE double *rows_of(struct tile *tile, unsigned way) {
    return tile->rows + way * parts_of(tile) * WIDE + MARGIN;
}

/* particles of the row that have a spring of a way: [begin, end) */
CS_INLINE size_t begin_of(unsigned way) {
    return way == CS_WAY_BACK;
}

CS_INLINE size_t end_of(unsigned way, size_t columns) {
    static const size_t short_of[CS_WAYS] = {
        [CS_WAY_RIGHT] = 1, [CS_WAY_RIGHT_TWO] = 2, [CS_WAY_FORTH] = 1};
    return columns - short_of[way];
}

CS_INLINE struct fan_way way_of(struct tile *tile, unsigned way) {
    const struct cs_spring_run *run = tile->fan->ways[way];
    const struct job *job = tile->job;
    const ptrdiff_t before = (ptrdiff_t)(tile->start + run->row) - (ptrdiff_t)run->a;
    return (struct fan_way){
        .k = asked_of(run, job->at.parts).k,
        .length = run->length,
        .step = run->b - run->a,
        .factors = job->factors ? job->factors + 4 * (size_t)run->first + before : NULL,
        .count = run->count,
        .to = rows_of(tile, way)};
}

CS_INLINE const double *from(const double *array, size_t first) {
    return array ? array + first : NULL;
}

/* the arrays that a kernel reads, from the tile on */
CS_INLINE struct fan_in in_of(const struct tile *tile) {
    const struct cs_spring_run *run = tile->fan->first;
    const struct cs_eval *at = &tile->job->at;
    const size_t first = run->row + tile->start;
    return (struct fan_in){.x = from(at->x, first),
                           .v = from(at->v, first),
                           .dx = from(at->dx, first),
                           .dv = from(at->dv, first),
                           .n = tile->job->n,
                           .c = asked_of(run, at->parts).c,
                           .axial = run->axial};
}

/* what is read beside a row, before its first particle and behind its last */
CS_INLINE void clear_margins(struct tile *tile) {
    static const unsigned before[] = {CS_WAY_RIGHT, CS_WAY_RIGHT_TWO, CS_WAY_FORTH};
    for (size_t k = 0; k < parts_of(tile); k++) {
        for (size_t b = 0; b < 3 && tile->start == 0; b++) {
            double *rows = rows_of(tile, before[b]) + k * WIDE;
            rows[-1] = rows[-2] = 0;
        }
        rows_of(tile, CS_WAY_BACK)[k * WIDE + tile->count] = 0;
    }
}

/* Springs that are none, before the first and behind the last of a way, add 0. */
CS_INLINE void drop_none(struct tile *tile, unsigned way) {
    const size_t columns = tile->fan->first->columns, stop = tile->start + tile->count;
    const size_t begin = begin_of(way), end = end_of(way, columns);
    double *rows = rows_of(tile, way);
    for (size_t k = 0; k < parts_of(tile); k++, rows += WIDE) {
        for (size_t i = tile->start; i < begin; i++)
            rows[i - tile->start] = 0;
        for (size_t i = end > tile->start ? end : tile->start; i < stop; i++)
            rows[i - tile->start] = 0;
    }
}

/* Ways [first, last), those that are there, side by side. */
CS_INLINE void make_together(struct tile *tile, const struct fan_in *in, unsigned first,
                             unsigned last) {
    struct fan_way ways[TOGETHER];
    unsigned n = 0;
    for (unsigned way = first; way < last; way++)
        if (tile->fan->ways[way])
            ways[n++] = way_of(tile, way);
    if (n > 0)
        tile->kernel->passes[n - 1](in, ways, 0, tile->count);
    for (unsigned way = first; way < last; way++)
        if (tile->fan->ways[way])
            drop_none(tile, way);
}

/* Those springs of a way that there are. */
CS_INLINE void make_alone(struct tile *tile, const struct fan_in *in, unsigned way) {
    const struct fan_way alone = way_of(tile, way);
    const size_t end = end_of(way, tile->fan->first->columns);
    const size_t begin = begin_of(way) > tile->start;
    const size_t stop = end < tile->start ? 0 : end - tile->start;
    tile->kernel->passes[0](in, &alone, begin, stop < tile->count ? stop : tile->count);
    drop_none(tile, way);
}

/* Makes the numbers of a tile's springs that rows in the block want. */
CS_INLINE void make_tile(struct tile *tile, const bool at[3]) {
    const struct fan_in in = in_of(tile);
    const bool alone = tile->fan->first->below < 2;
    clear_margins(tile);
    for (unsigned way = 0; way < CS_WAYS && alone; way++)
        if (tile->fan->ways[way])
            make_alone(tile, &in, way);
    if (!alone && at[0])
        make_together(tile, &in, CS_WAY_RIGHT, CS_WAY_DOWN);
    if (!alone && (at[0] || at[1]))
        make_together(tile, &in, CS_WAY_DOWN, CS_WAY_DOWN_TWO);
    if (!alone && (at[0] || at[2]))
        make_together(tile, &in, CS_WAY_DOWN_TWO, CS_WAYS);
}

/* what the next tile wants of this one's last two particles */
CS_INLINE void carry(struct tile *tile) {
    for (unsigned way = 0; way < CS_WAY_DOWN_TWO; way++) {
        double *rows = rows_of(tile, way);
        for (size_t k = 0; k < parts_of(tile) && tile->fan->ways[way]; k++, rows += WIDE) {
            rows[-2] = rows[TILE - 2];
            rows[-1] = rows[TILE - 1];
        }
    }
}

/* row k of a way, moved back by some particles; zeros where the way is not there */
CS_INLINE const double *row_of(struct tile *tile, unsigned way, size_t k, size_t back) {
    static const _Alignas(64) double zeros[WIDE];
    return (tile->fan->ways[way] ? rows_of(tile, way) + k * WIDE : zeros + MARGIN) - back;
}

/* what particles get from springs in their own row, and from those that they begin */
CS_INLINE void add_own(struct tile *tile, size_t k, const double sign, double *to) {
    const double *right = row_of(tile, CS_WAY_RIGHT, k, 0);
    const double *two = row_of(tile, CS_WAY_RIGHT_TWO, k, 0);
    const double *down = row_of(tile, CS_WAY_DOWN, k, 0);
    const double *forth = row_of(tile, CS_WAY_FORTH, k, 0);
    const double *back = row_of(tile, CS_WAY_BACK, k, 0);
    const double *after = row_of(tile, CS_WAY_DOWN_TWO, k, 0);
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
    const double *down = row_of(tile, CS_WAY_DOWN, k, late);
    const double *forth = row_of(tile, CS_WAY_FORTH, k, late);
    const double *back = row_of(tile, CS_WAY_BACK, k, late);
    const size_t count = tile->count + late - early;
    double *from_late = to - late;
    CS_INDEPENDENT
    for (size_t i = 0; i < count; i++)
        from_late[i] += sign * (down[i] + (forth - 1)[i] + back[i + 1]);
}

CS_INLINE void add_after(struct tile *tile, size_t k, const double sign, double *to) {
    const double *after = row_of(tile, CS_WAY_DOWN_TWO, k, 0);
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
    if (at[1] && first->below > 0)
        add_next(tile, k, sign, to + first->columns);
    if (at[2] && tile->fan->ways[CS_WAY_DOWN_TWO])
        add_after(tile, k, sign, to + 2 * (size_t)first->columns);
}

CS_INLINE void add_tile(struct tile *tile, const bool at[3]) {
    const struct fan_kernel *kernel = tile->kernel;
    const struct job *job = tile->job;
    const size_t blocks = kernel->stiff + kernel->damped;
    for (size_t k = 0; k < kernel->forces; k++)
        add_part(tile, at, k, -1, job->to + k * job->n);
    for (size_t k = 0; k < blocks; k++)
        add_part(tile, at, kernel->forces + k, 1,
                 k < kernel->stiff ? job->at.kxx + k * job->n
                                   : job->at.dvv + (k - kernel->stiff) * job->n);
}

CS_CLONES void cs_fan_add(const struct job *job, const struct cs_block *block,
                          const struct fan *fan, const struct fan_kernel *kernel) {
    const struct cs_spring_run *first = fan->first;
    bool at[3];
    struct tile tile;
    tile.job = job, tile.fan = fan, tile.kernel = kernel;
    for (uint32_t down = 0; down < 3; down++)
        at[down] = is_in(block, first->row + down * first->columns);
    for (size_t left = first->columns; left > 0; left -= tile.count) {
        tile.start = first->columns - left;
        tile.count = left < TILE ? left : TILE;
        make_tile(&tile, at);
        add_tile(&tile, at);
        if (left > TILE)
            carry(&tile);
    }
}

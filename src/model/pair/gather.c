/* Points of lots in tables with open addresses, and their rows by particles. */
#include "model/pair/gather.h"

#include <stdlib.h>
#include <string.h>

enum { BITS_LEAST = 9 };

static void finish(void *object) {
    struct cs_gather *gather = object;
    for (uint32_t l = 0; l < gather->n_lots; l++)
        free(gather->lots[l].points), free(gather->lots[l].slots);
    free(gather->rows);
    free(gather->sums);
    free(gather->read);
}

enum cs_status cs_gather_init(struct cs_gather *gather, uint32_t n_lots, uint32_t n_particles,
                              struct cs_arena *arena, struct cs_error *error) {
    *gather = (struct cs_gather){.n_lots = n_lots, .n_particles = n_particles};
    gather->lots = cs_arena_take_n(arena, n_lots, sizeof *gather->lots, error);
    gather->starts =
        cs_arena_take_n(arena, n_particles + (size_t)2, sizeof *gather->starts, error);
    if (!error->status)
        cs_arena_own(arena, finish, gather, error);
    return error->status;
}

/* --- rows of a lot --- */

/* where a point is, or would be */
static uint32_t *slot_of(const struct cs_gather_lot *lot, uint32_t point) {
    const uint32_t mask = (1u << lot->bits) - 1;
    uint32_t at = (point * 2654435769u) >> (32 - lot->bits);
    while (lot->slots[at] && lot->points[lot->slots[at] - 1] != point)
        at = (at + 1) & mask;
    return lot->slots + at;
}

/* a table of that size, with the points that there are; false: no memory */
static bool widen(struct cs_gather_lot *lot, uint32_t bits) {
    uint32_t *slots =
        cs_arena_grow(lot->slots, &lot->slots_room, (size_t)1 << bits, sizeof *slots);
    if (!slots)
        return false;
    lot->slots = slots;
    lot->bits = bits;
    memset(slots, 0, sizeof *slots << bits);
    for (uint32_t row = 0; row < lot->n; row++)
        *slot_of(lot, lot->points[row]) = row + 1;
    return true;
}

void cs_gather_clear(struct cs_gather_lot *lot) {
    lot->n = 0;
    lot->bits = 0;
    lot->failed = false;
}

/* for one more, the table at most half full; false: no memory */
static bool make_room(struct cs_gather_lot *lot) {
    uint32_t *points =
        cs_arena_grow(lot->points, &lot->points_room, (size_t)lot->n + 1, sizeof *points);
    if (!points)
        return false;
    lot->points = points;
    if (!lot->bits)
        return widen(lot, BITS_LEAST);
    return 2 * lot->n < 1u << lot->bits || widen(lot, lot->bits + 1);
}

static uint32_t add_row(struct cs_gather_lot *lot, uint32_t point) {
    if (!make_room(lot)) {
        lot->failed = true;
        return 0;
    }
    *slot_of(lot, point) = lot->n + 1;
    lot->points[lot->n] = point;
    return lot->n++;
}

uint32_t cs_gather_row(struct cs_gather_lot *lot, uint32_t point) {
    const uint32_t slot = lot->n ? *slot_of(lot, point) : 0;
    return slot ? slot - 1 : add_row(lot, point);
}

/* --- by particles --- */

static bool count_rows(struct cs_gather *gather) {
    bool failed = false;
    gather->n_rows = 0;
    for (uint32_t l = 0; l < gather->n_lots; l++) {
        gather->lots[l].first = gather->n_rows;
        gather->n_rows += gather->lots[l].n;
        failed = failed || gather->lots[l].failed;
    }
    return !failed;
}

/* false: no memory */
static bool take_rows(struct cs_gather *gather) {
    uint32_t *rows =
        cs_arena_grow(gather->rows, &gather->rows_room, gather->n_rows, sizeof *rows);
    gather->rows = rows ? rows : gather->rows;
    double *sums = cs_arena_grow(gather->sums, &gather->sums_room, 3 * (size_t)gather->n_rows,
                                 sizeof *sums);
    gather->sums = sums ? sums : gather->sums;
    return rows && sums;
}

static void count_points(const struct cs_gather *gather, uint32_t *starts) {
    for (uint32_t l = 0; l < gather->n_lots; l++)
        for (uint32_t row = 0; row < gather->lots[l].n; row++)
            if (gather->lots[l].points[row] < gather->n_particles)
                starts[gather->lots[l].points[row] + 1]++;
}

static void put_points(const struct cs_gather *gather, uint32_t *starts) {
    for (uint32_t l = 0; l < gather->n_lots; l++)
        for (uint32_t row = 0; row < gather->lots[l].n; row++)
            if (gather->lots[l].points[row] < gather->n_particles)
                gather->rows[starts[gather->lots[l].points[row]]++] =
                    gather->lots[l].first + row;
}

/* Counted two places on, so that filling moves the starts to where they belong. */
bool cs_gather_set(struct cs_gather *gather) {
    uint32_t *starts = gather->starts + 1;
    if (!count_rows(gather) || (gather->n_rows && !take_rows(gather)))
        return false;
    if (!gather->n_rows)
        return true;
    memset(gather->starts, 0, (gather->n_particles + (size_t)2) * sizeof *starts);
    count_points(gather, starts);
    for (uint32_t i = 0; i < gather->n_particles; i++)
        starts[i + 1] += starts[i];
    put_points(gather, starts);
    return true;
}

/* --- what rows read, and have --- */

bool cs_gather_take(struct cs_gather *gather, size_t width) {
    double *read =
        cs_arena_grow(gather->read, &gather->read_room, width * gather->n_rows, sizeof *read);
    gather->read = read ? read : gather->read;
    gather->width = width;
    return read || !gather->n_rows;
}

double *cs_gather_read(const struct cs_gather *gather, uint32_t number, size_t column,
                       const double *x, size_t n) {
    const struct cs_gather_lot *lot = gather->lots + number;
    double *rows = cs_gather_of(lot, gather->read, gather->width);
    for (size_t row = 0; row < lot->n; row++)
        for (size_t c = 0; c < 3; c++)
            rows[row * gather->width + column + c] =
                x && lot->points[row] < n ? x[c * n + lot->points[row]] : 0;
    return rows;
}

void cs_gather_add(const struct cs_gather *gather, const double *rows, size_t width,
                   size_t begin, size_t end, double *out) {
    for (size_t i = begin; i < end && gather->n_rows; i++)
        for (uint32_t e = gather->starts[i]; e < gather->starts[i + 1]; e++)
            for (size_t c = 0; c < width; c++)
                out[c * gather->n_particles + i] += rows[width * gather->rows[e] + c];
}

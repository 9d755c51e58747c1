/* Contacts in lots, gathered by particles. */
#include "model/pair/pair_set.h"

#include "base/pool.h"

#include <stdlib.h>
#include <string.h>

static void finish(void *object) {
    struct cs_pair_set *set = object;
    for (uint32_t l = 0; l < set->n_lots; l++)
        free(set->lots[l].pairs), free(set->lots[l].parts), free(set->lots[l].full);
    free(set->corners);
    free(set->ends);
}

enum cs_status cs_pair_set_init(struct cs_pair_set *set, uint32_t n_particles, uint32_t n_lots,
                                struct cs_arena *arena, struct cs_error *error) {
    *set = (struct cs_pair_set){.n_lots = n_lots, .n_particles = n_particles};
    set->lots = cs_arena_take_n(arena, n_lots, sizeof *set->lots, error);
    set->starts = cs_arena_take_n(arena, n_particles + (size_t)2, sizeof *set->starts, error);
    if (!error->status)
        cs_arena_own(arena, finish, set, error);
    return error->status;
}

void cs_pair_lot_clear(struct cs_pair_lot *lot) {
    lot->n = 0;
    lot->energy = 0;
    lot->failed = false;
}

struct cs_pair *cs_pair_lot_next(struct cs_pair_lot *lot) {
    struct cs_pair *pairs = cs_arena_grow(lot->pairs, &lot->room, lot->n + 1, sizeof *pairs);
    lot->failed = lot->failed || !pairs;
    lot->pairs = pairs ? pairs : lot->pairs;
    return pairs ? pairs + lot->n++ : NULL;
}

struct cs_pair_part *cs_pair_lot_part(struct cs_pair_lot *lot) {
    struct cs_pair_part *parts =
        cs_arena_grow(lot->parts, &lot->parts_room, lot->n, sizeof *parts);
    lot->failed = lot->failed || !parts;
    lot->parts = parts ? parts : lot->parts;
    return parts ? parts + lot->n - 1 : NULL;
}

/* --- by particles --- */

void cs_pair_set_count(struct cs_pair_set *set) {
    set->n = 0;
    for (uint32_t l = 0; l < set->n_lots; l++) {
        set->lots[l].first = set->n;
        set->n += set->lots[l].n;
        set->failed = set->failed || set->lots[l].failed;
    }
    // what was left out is not to be looked for behind the end of a lot
    if (set->failed)
        set->n = 0;
}

/* beside each other, for what is one thread's */
static void copy_corners(void *arg, uint32_t number) {
    const struct cs_pair_set *set = arg;
    const struct cs_pair_lot *lot = set->lots + number;
    uint32_t *corners = set->corners + 4 * lot->first;
    for (size_t p = 0; p < lot->n; p++)
        for (uint32_t k = 0; k < 4; k++)
            corners[4 * p + k] = k < lot->pairs[p].n ? lot->pairs[p].at[k] : UINT32_MAX;
}

static void count_ends(struct cs_pair_set *set) {
    for (size_t e = 0; e < 4 * set->n; e++)
        if (cs_pair_set_has(set, set->corners[e]))
            set->starts[set->corners[e] + 1]++;
}

/* into their places; lots in their order */
static void put_ends(struct cs_pair_set *set) {
    for (uint32_t l = 0; l < set->n_lots; l++) {
        const struct cs_pair_lot *lot = set->lots + l;
        const uint32_t *corners = set->corners + 4 * lot->first;
        for (size_t e = 0; e < 4 * lot->n; e++)
            if (cs_pair_set_has(set, corners[e]))
                set->ends[set->starts[corners[e] + 1]++] =
                    (struct cs_pair_end){lot->pairs + e / 4, (uint32_t)(e % 4), l};
    }
}

/* false: no memory */
static bool take_ends(struct cs_pair_set *set) {
    struct cs_pair_end *ends =
        cs_arena_grow(set->ends, &set->ends_room, 4 * set->n, sizeof *ends);
    set->ends = ends ? ends : set->ends;
    uint32_t *corners =
        cs_arena_grow(set->corners, &set->corners_room, 4 * set->n, sizeof *corners);
    set->corners = corners ? corners : set->corners;
    return ends && corners;
}

/* The corners of each particle one behind the other: counted two places on, so that filling
 * moves the starts to where they belong. */
void cs_pair_set_gather(struct cs_pair_set *set) {
    if (set->n && !take_ends(set)) {
        set->failed = true;
        set->n = 0;
    }
    if (!set->n)
        return;
    cs_pool_run(set->n_lots, copy_corners, set);
    memset(set->starts, 0, (set->n_particles + (size_t)2) * sizeof *set->starts);
    set->starts++;
    count_ends(set);
    for (uint32_t i = 0; i < set->n_particles; i++)
        set->starts[i + 1] += set->starts[i];
    set->starts--;
    put_ends(set);
}

double cs_pair_set_energy(const struct cs_pair_set *set) {
    double sum = 0;
    for (uint32_t l = 0; l < set->n_lots; l++)
        sum += set->lots[l].energy;
    return sum;
}

void cs_pair_set_add(const struct cs_pair_set *set, size_t begin, size_t end, double *f) {
    const size_t n = set->n_particles;
    for (size_t i = begin; i < end && set->n; i++)
        for (uint32_t e = set->starts[i]; e < set->starts[i + 1]; e++)
            for (size_t c = 0; c < 3; c++)
                f[c * n + i] += set->ends[e].pair->to[set->ends[e].corner][c];
}

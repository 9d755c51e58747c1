/* Contacts gathered by particles, and a matrix of them. */
#include "model/pair/pair_set.h"

#include "base/pool.h"
#include "base/vec3.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* points of obstacles feel nothing here, and do not move */
static bool is_particle(const struct cs_pair_set *set, uint32_t point) {
    return point < set->n_particles;
}

static void finish(void *object) {
    struct cs_pair_set *set = object;
    for (uint32_t l = 0; l < set->n_lots; l++)
        free(set->lots[l].pairs), free(set->lots[l].full);
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
        if (is_particle(set, set->corners[e]))
            set->starts[set->corners[e] + 1]++;
}

/* into their places; lots in their order */
static void put_ends(struct cs_pair_set *set) {
    for (uint32_t l = 0; l < set->n_lots; l++) {
        const struct cs_pair_lot *lot = set->lots + l;
        const uint32_t *corners = set->corners + 4 * lot->first;
        for (size_t e = 0; e < 4 * lot->n; e++)
            if (is_particle(set, corners[e]))
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

/* --- blocks of a matrix --- */

/* block += that of corner k of a pair with itself, each part times its factor */
static void add_own(const struct cs_pair *pair, const struct cs_pair_turn *full, uint32_t k,
                    const double factor[2], double block[6]) {
    static const uint32_t row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    const double *g = pair->to[k], w = pair->share[k];
    const double along = factor[0] * pair->along, rub = factor[1] * w * w;
    for (int e = 0; e < 6; e++) {
        block[e] += along * (g[row[e]] * g[column[e]]) + rub * pair->of[e];
        if (full)
            block[e] += full->of[3 * k + row[e]][3 * k + column[e]];
    }
}

/* by how much a block must grow for all together to be above what the pair couples */
static void find_growth(const struct cs_pair *pair, uint32_t k, double factor[2]) {
    double length[4], sum = 0, shares = 0;
    for (uint32_t j = 0; j < pair->n; j++) {
        length[j] = sqrt(cs_vec3_dot(pair->to[j], pair->to[j]));
        sum += length[j];
        shares += fabs(pair->share[j]);
    }
    factor[0] = length[k] > 0 ? sum / length[k] : 1;
    factor[1] = pair->share[k] != 0 ? shares / fabs(pair->share[k]) : 1;
}

static const struct cs_pair_turn *turn_of(const struct cs_pair_set *set,
                                          const struct cs_pair_end *end) {
    const struct cs_pair_lot *lot = set->lots + end->lot;
    return set->exact ? lot->full + (end->pair - lot->pairs) : NULL;
}

void cs_pair_set_add_blocks(const struct cs_pair_set *set, size_t begin, size_t end,
                            double *blocks) {
    const size_t n = set->n_particles;
    for (size_t i = begin; i < end && set->n; i++)
        for (uint32_t e = set->starts[i]; e < set->starts[i + 1]; e++) {
            const struct cs_pair_end *at = set->ends + e;
            double block[6] = {0}, factor[2] = {1, 1};
            if (set->alone)
                find_growth(at->pair, at->corner, factor);
            add_own(at->pair, turn_of(set, at), at->corner, factor, block);
            for (size_t c = 0; c < 6; c++)
                blocks[c * n + i] += block[c];
        }
}

/* --- the matrix times a vector --- */

struct product {
    const struct cs_pair_set *set;
    const double *p;
    double *y;
};

static void turn(const double s[6], const double p[3], double out[3]) {
    out[0] = s[0] * p[0] + s[1] * p[1] + s[2] * p[2];
    out[1] = s[1] * p[0] + s[3] * p[1] + s[4] * p[2];
    out[2] = s[2] * p[0] + s[4] * p[1] + s[5] * p[2];
}

/* by = the pair's share times p, less what the diagonal blocks of the solver have of it */
static void multiply_pair(struct cs_pair *pair, const struct cs_pair_turn *full,
                          double p[4][3]) {
    double along = 0, v[3] = {0};
    for (uint32_t k = 0; k < pair->n; k++) {
        along += cs_vec3_dot(pair->to[k], p[k]);
        for (int c = 0; c < 3; c++)
            v[c] += pair->share[k] * p[k][c];
    }
    double rub[3];
    turn(pair->of, v, rub);
    for (uint32_t k = 0; k < pair->n; k++) {
        double b[6] = {0}, own[3];
        add_own(pair, full, k, (double[2]){1, 1}, b);
        turn(b, p[k], own);
        for (int c = 0; c < 3; c++) {
            double turned = 0;
            for (int j = 0; full && j < 12; j++)
                turned += full->of[3 * k + (uint32_t)c][j] * p[j / 3][j % 3];
            pair->by[k][c] = pair->along * along * pair->to[k][c] + pair->share[k] * rub[c] +
                             turned - own[c];
        }
    }
}

/* the same where it is of*(w w^T) alone: w_k of (sum w_j p_j - w_k p_k) */
static void multiply_point(struct cs_pair *pair, double p[4][3]) {
    double all[3] = {0};
    for (uint32_t k = 0; k < pair->n; k++)
        for (int c = 0; c < 3; c++)
            all[c] += pair->share[k] * p[k][c];
    for (uint32_t k = 0; k < pair->n; k++) {
        double others[3];
        for (int c = 0; c < 3; c++)
            others[c] = pair->share[k] * (all[c] - pair->share[k] * p[k][c]);
        turn(pair->of, others, pair->by[k]);
    }
}

static void multiply_lot(void *arg, uint32_t number) {
    const struct product *product = arg;
    const struct cs_pair_set *set = product->set;
    const struct cs_pair_lot *lot = set->lots + number;
    const size_t n = set->n_particles;
    for (size_t l = 0; l < lot->n; l++) {
        struct cs_pair *pair = lot->pairs + l;
        double p[4][3];
        for (uint32_t k = 0; k < pair->n; k++)
            for (size_t c = 0; c < 3; c++)
                p[k][c] = is_particle(set, pair->at[k]) ? product->p[c * n + pair->at[k]] : 0;
        if (set->points)
            multiply_point(pair, p);
        else
            multiply_pair(pair, set->exact ? lot->full + l : NULL, p);
    }
}

static void add_products(void *arg, size_t begin, size_t end) {
    const struct product *product = arg;
    const struct cs_pair_set *set = product->set;
    const size_t n = set->n_particles;
    for (size_t i = begin; i < end; i++)
        for (uint32_t e = set->starts[i]; e < set->starts[i + 1]; e++)
            for (size_t c = 0; c < 3; c++)
                product->y[c * n + i] += set->ends[e].pair->by[set->ends[e].corner][c];
}

void cs_pair_set_multiply(const struct cs_pair_set *set, const double *p, double *y) {
    struct product product = {set, p, y};
    if (!set->n)
        return;
    cs_pool_run(set->n_lots, multiply_lot, &product);
    cs_vector_share(set->n_particles, add_products, &product);
}

void cs_pair_set_add_bound(const struct cs_pair_set *set, double *stiffness, double *damping) {
    for (uint32_t l = 0; l < set->n_lots; l++)
        for (size_t p = 0; p < set->lots[l].n; p++) {
            const struct cs_pair *pair = set->lots[l].pairs + p;
            for (uint32_t k = 0; k < pair->n; k++) {
                if (!is_particle(set, pair->at[k]))
                    continue;
                stiffness[pair->at[k]] += pair->of[k];
                damping[pair->at[k]] += pair->share[k];
            }
        }
}

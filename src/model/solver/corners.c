/* Corners counted and put by particles, of either kind of matrix. */
#include "model/solver/corners.h"

#include "model/pair/pairs.h"

#include <stdlib.h>
#include <string.h>

static void finish(void *object) {
    struct cs_corners *corners = object;
    free(corners->starts);
    free(corners->of);
}

enum cs_status cs_corners_init(struct cs_corners *corners, struct cs_arena *arena,
                               struct cs_error *error) {
    *corners = (struct cs_corners){0};
    cs_arena_own(arena, finish, corners, error);
    return error->status;
}

size_t cs_corners_pairs(const struct cs_pairs *pairs) {
    return pairs->kept.active ? pairs->kept.active->n : pairs->exact.n;
}

/* --- by particles --- */

static size_t count_in(const struct cs_pairs *pairs, uint32_t lot) {
    return pairs->kept.active ? pairs->kept.active->lots[lot].n : pairs->exact.lots[lot].n;
}

static const uint32_t *points_of(const struct cs_pairs *pairs, uint32_t lot, size_t pair) {
    return pairs->kept.active ? pairs->kept.active->lots[lot].at[pair]
                              : pairs->exact.lots[lot].pairs[pair].at;
}

/* false: no memory */
static bool take_room(struct cs_corners *corners, const struct cs_pairs *pairs) {
    const size_t n = pairs->system->view.n + (size_t)2;
    uint32_t *starts = cs_arena_grow(corners->starts, &corners->starts_room, n, sizeof *starts);
    corners->starts = starts ? starts : corners->starts;
    struct cs_corner *of =
        cs_arena_grow(corners->of, &corners->of_room, 4 * cs_corners_pairs(pairs), sizeof *of);
    corners->of = of ? of : corners->of;
    if (starts)
        memset(starts, 0, n * sizeof *starts);
    return starts && of;
}

/* counts at `to`, or puts where it says */
static void visit(const struct cs_pairs *pairs, uint32_t *to, struct cs_corner *of) {
    for (uint32_t lot = 0; lot < pairs->search.n_lots; lot++)
        for (size_t pair = 0; pair < count_in(pairs, lot); pair++) {
            const uint32_t *at = points_of(pairs, lot, pair);
            for (uint32_t k = 0; k < 4; k++) {
                // obstacles have no place in the matrix
                if (at[k] >= pairs->system->view.n)
                    continue;
                if (of)
                    of[to[at[k]]] = (struct cs_corner){lot, (uint32_t)pair, k};
                to[at[k]]++;
            }
        }
}

/* Counted two places on, so that filling moves the starts to where they belong. */
bool cs_corners_find(struct cs_corners *corners, const struct cs_pairs *pairs) {
    if (!take_room(corners, pairs))
        return false;
    uint32_t *starts = corners->starts;
    visit(pairs, starts + 2, NULL);
    for (uint32_t i = 0; i < pairs->system->view.n; i++)
        starts[i + 2] += starts[i + 1];
    visit(pairs, starts + 1, corners->of);
    return true;
}

/* --- the blocks --- */

/* block = along g g^T + rub, line by line for speed */
static void set_block(const double g[3], double along, double rub, const double of[6],
                      double block[6]) {
    block[0] = along * (g[0] * g[0]) + rub * of[0];
    block[1] = along * (g[0] * g[1]) + rub * of[1];
    block[2] = along * (g[0] * g[2]) + rub * of[2];
    block[3] = along * (g[1] * g[1]) + rub * of[3];
    block[4] = along * (g[1] * g[2]) + rub * of[4];
    block[5] = along * (g[2] * g[2]) + rub * of[5];
}

static void set_blocks(double g[4][3], const struct cs_pair_share *part,
                       struct cs_corner_share *share) {
    const double *weight = part->weight, own = weight[share->corner];
    uint32_t most = 0;
    for (uint32_t k = 1; k < 4; k++)
        most = weight[k] * weight[k] > weight[most] * weight[most] ? k : most;
    memcpy(share->weight, weight, sizeof share->weight);
    set_block(g[share->corner], part->along, own * own, part->of, share->own);
    set_block(g[most], part->along / (weight[most] * weight[most]), 1, part->of, share->whole);
}

/* and how the gradient turns */
static void add_turn(const struct cs_pair_turn *full, struct cs_corner_share *share) {
    static const uint32_t row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    const uint32_t first = 3 * share->corner;
    for (int e = 0; e < 6; e++)
        share->own[e] += full->of[first + row[e]][first + column[e]];
}

static void read_exact(const struct cs_pair_lot *lot, size_t pair,
                       struct cs_corner_share *share) {
    struct cs_pair_share part = {.along = lot->parts[pair].along};
    memcpy(part.weight, lot->parts[pair].share, sizeof part.weight);
    memcpy(part.of, lot->parts[pair].of, sizeof part.of);
    set_blocks(lot->pairs[pair].to, &part, share);
    add_turn(lot->full + pair, share);
}

void cs_corners_read(const struct cs_pairs *pairs, const struct cs_corner *corner,
                     struct cs_corner_share *share) {
    const struct cs_product *kept = &pairs->kept;
    struct cs_pair_share part;
    double g[4][3];
    memcpy(share->at, points_of(pairs, corner->lot, corner->pair), sizeof share->at);
    share->corner = corner->at;
    if (!kept->active) {
        read_exact(pairs->exact.lots + corner->lot, corner->pair, share);
        return;
    }
    cs_pair_factors_read(kept->active->lots[corner->lot].kind,
                         kept->lots[corner->lot].factors + corner->pair / CS_PAIR_LANES,
                         (int)(corner->pair % CS_PAIR_LANES), g, &part);
    set_blocks(g, &part, share);
}

/* Pairs in range: found lot by lot, each with what it does, and gathered by particles. */
#include "model/pair/pairs.h"

#include "base/pool.h"
#include "base/vector.h"
#include "model/contact/near.h"
#include "model/contact/points.h"
#include "model/pair/nearness.h"

#include <string.h>

/* --- one lot --- */

/* what the pairs in range are asked for */
enum ask { ASK_FORCE, ASK_CHANGE, ASK_ENERGY, ASK_MATRIX, ASK_BOUND };

struct job {
    struct cs_pairs *pairs;
    const double *x, *v; /* (3, n_points) at the state; v NULL: at rest */
    struct cs_pair_set *set;
    enum ask ask;
    struct cs_eval at;
    const struct cs_matrix *matrix;
};

/* what an obstacle has no place in is 0 for it */
static void read(const double *from, size_t n, const uint32_t at[4], double to[4][3]) {
    for (size_t k = 0; k < 4; k++)
        for (size_t c = 0; c < 3; c++)
            to[k][c] = from && at[k] < n ? from[c * n + at[k]] : 0;
}

/* what cannot move feels nothing, and holds nothing */
static bool is_fixed(const struct cs_system *system, const uint32_t at[4]) {
    bool fixed = true;
    for (int k = 0; k < 4; k++)
        fixed = fixed && cs_points_inverse_mass(system, at[k]) == 0;
    return fixed;
}

/* beside the share of the pair that was put last */
static void add_turn(const struct job *job, const struct cs_reaction *reaction,
                     struct cs_pair_lot *lot) {
    struct cs_pair_turn *full = cs_arena_grow(lot->full, &lot->full_room, lot->n, sizeof *full);
    lot->failed = lot->failed || !full;
    if (!full)
        return;
    lot->full = full;
    cs_reaction_turn(reaction, job->matrix, full + lot->n - 1);
}

static void answer(const struct job *job, const struct cs_reaction *reaction,
                   struct cs_reaction_move *move, struct cs_pair *pair) {
    const size_t n = job->pairs->system->view.n;
    const struct cs_touch_parts parts = cs_near_parts(job->at.parts);
    if (job->ask == ASK_MATRIX) {
        cs_reaction_matrix(reaction, job->matrix, pair);
    } else if (job->ask == ASK_BOUND) {
        cs_reaction_bound(reaction, pair->of, pair->share);
    } else if (job->ask == ASK_CHANGE) {
        read(job->at.dx, n, pair->at, move->dp);
        read(job->at.dv, n, pair->at, move->dv);
        cs_reaction_jvp(reaction, parts, move, pair->to);
    } else {
        cs_reaction_force(reaction, parts, pair->to);
    }
}

static void meet(const struct job *job, enum cs_stencil_kind kind, const uint32_t pair[2],
                 struct cs_pair_lot *lot) {
    const struct cs_pairs *pairs = job->pairs;
    const uint32_t *body = pairs->search.body;
    const size_t n = pairs->system->surfaces->n_points;
    struct cs_reaction reaction;
    struct cs_reaction_move move;
    uint32_t at[4];
    cs_search_corners(pairs->system->surfaces, kind, pair, at);
    const struct cs_meeting *meeting =
        cs_meeting_of(&pairs->meetings, body[at[0]], body[at[2]]);
    read(job->x, n, at, move.p);
    if (cs_nearness_is_apart(kind, move.p, meeting->range))
        return;
    cs_stencil_set(&reaction.stencil, kind, move.p);
    if (!(reaction.stencil.d < meeting->range) || is_fixed(pairs->system, at))
        return;
    if (job->ask == ASK_ENERGY) {
        lot->energy += cs_law_energy(reaction.stencil.d, meeting->range, meeting->k);
        return;
    }
    struct cs_pair *place = cs_pair_lot_next(lot);
    if (!place)
        return;
    place->n = 4;
    memcpy(place->at, at, sizeof at);
    read(job->v, n, at, move.v);
    cs_reaction_set(&reaction, meeting, &pairs->system->scene->contact, move.v);
    answer(job, &reaction, &move, place);
    if (job->ask == ASK_MATRIX && job->set->exact)
        add_turn(job, &reaction, lot);
}

static void do_lot(void *arg, uint32_t number) {
    const struct job *job = arg;
    const struct cs_search_lot *found = job->pairs->search.lots + number;
    struct cs_pair_lot *lot = job->set->lots + number;
    cs_pair_lot_clear(lot);
    for (size_t k = 0; k < found->n; k++)
        meet(job, found->kind, found->pairs + 2 * k, lot);
}

static void do_lots(struct job *job) {
    struct cs_pairs *pairs = job->pairs;
    job->x = cs_points_places(pairs->system, CS_POINTS_BEGIN, job->at.t, job->at.x);
    job->v = cs_points_velocities(pairs->system, job->at.t, job->at.v);
    cs_meetings_rub(pairs->system, &pairs->meetings);
    if (cs_search_update(&pairs->search, job->x))
        cs_pool_run(job->set->n_lots, do_lot, job);
    else
        job->set->failed = true;
    cs_pair_set_count(job->set);
}

void cs_pairs_set(struct cs_pairs *pairs, const struct cs_eval *at) {
    struct job job = {.pairs = pairs,
                      .set = &pairs->now,
                      .ask = at->dx || at->dv ? ASK_CHANGE : ASK_FORCE,
                      .at = *at};
    do_lots(&job);
    cs_pair_set_gather(&pairs->now);
}

double cs_pairs_energy(struct cs_pairs *pairs, const struct cs_eval *at) {
    struct job job = {.pairs = pairs, .set = &pairs->now, .ask = ASK_ENERGY, .at = *at};
    do_lots(&job);
    return cs_pair_set_energy(&pairs->now);
}

void cs_pairs_set_matrix(struct cs_pairs *pairs, const struct cs_matrix *matrix, bool kept) {
    struct cs_pair_set *set = kept ? &pairs->matrix : &pairs->now;
    struct job job = {
        .pairs = pairs,
        .set = set,
        .ask = ASK_MATRIX,
        .at = {.t = matrix->t, .x = matrix->x, .v = matrix->v, .parts = CS_PART_ALL},
        .matrix = matrix};
    set->exact = !matrix->psd;
    set->alone = !kept && matrix->bound;
    do_lots(&job);
    cs_pair_set_gather(set);
    pairs->blocks = set;
}

void cs_pairs_add_bound(struct cs_pairs *pairs, const struct cs_eval *at, double *stiffness,
                        double *damping) {
    struct job job = {.pairs = pairs, .set = &pairs->now, .ask = ASK_BOUND, .at = *at};
    do_lots(&job);
    cs_pair_set_add_bound(&pairs->now, stiffness, damping);
}

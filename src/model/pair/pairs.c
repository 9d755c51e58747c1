/* Pairs in range: found lot by lot, each with what it does, and gathered by particles. */
#include "model/pair/pairs.h"

#include "base/pool.h"
#include "base/vector.h"
#include "model/pair/nearness.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- one lot --- */

/* what the pairs in range are asked for */
enum ask { ASK_FORCE, ASK_CHANGE, ASK_ENERGY, ASK_MATRIX, ASK_BOUND };

struct job {
    struct cs_pairs *pairs;
    struct cs_pair_set *set;
    enum ask ask;
    struct cs_eval at;
    const struct cs_matrix *matrix;
};

static void read(const double *from, size_t n, const uint32_t at[4], double to[4][3]) {
    for (size_t k = 0; k < 4; k++)
        for (size_t c = 0; c < 3; c++)
            to[k][c] = from ? from[c * n + at[k]] : 0;
}

/* what cannot move feels nothing, and holds nothing */
static bool is_fixed(const struct cs_system *system, const uint32_t at[4]) {
    bool fixed = true;
    for (int k = 0; k < 4; k++)
        fixed = fixed && system->inv_mass[at[k]] == 0;
    return fixed;
}

static struct cs_touch_parts parts_of(uint32_t parts) {
    return (struct cs_touch_parts){.elastic = parts & CS_PART_POTENTIAL ? 1 : 0,
                                   .rubbing = parts & CS_PART_DISSIPATIVE ? 1 : 0};
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
    const struct cs_touch_parts parts = parts_of(job->at.parts);
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

/* the next place of a lot; NULL: no memory */
static struct cs_pair *next_place(struct cs_pair_lot *lot) {
    struct cs_pair *pairs = cs_arena_grow(lot->pairs, &lot->room, lot->n + 1, sizeof *pairs);
    lot->failed = lot->failed || !pairs;
    lot->pairs = pairs ? pairs : lot->pairs;
    return pairs ? pairs + lot->n++ : NULL;
}

static void meet(const struct job *job, enum cs_stencil_kind kind, const uint32_t pair[2],
                 struct cs_pair_lot *lot) {
    const struct cs_pairs *pairs = job->pairs;
    const uint32_t *body = pairs->search.body;
    const size_t n = pairs->system->view.n;
    struct cs_reaction reaction;
    struct cs_reaction_move move;
    uint32_t at[4];
    cs_search_corners(pairs->system->surfaces, kind, pair, at);
    const struct cs_meeting *meeting =
        cs_meeting_of(&pairs->meetings, body[at[0]], body[at[2]]);
    read(job->at.x, n, at, move.p);
    if (cs_nearness_is_apart(kind, move.p, meeting->range))
        return;
    cs_stencil_set(&reaction.stencil, kind, move.p);
    if (!(reaction.stencil.d < meeting->range) || is_fixed(pairs->system, at))
        return;
    if (job->ask == ASK_ENERGY) {
        lot->energy += cs_law_energy(reaction.stencil.d, meeting->range, meeting->k);
        return;
    }
    struct cs_pair *place = next_place(lot);
    if (!place)
        return;
    memcpy(place->at, at, sizeof at);
    read(job->at.v, n, at, move.v);
    cs_reaction_set(&reaction, meeting, &pairs->system->scene->contact, move.v);
    answer(job, &reaction, &move, place);
    if (job->ask == ASK_MATRIX && job->set->exact)
        add_turn(job, &reaction, lot);
}

static void do_lot(void *arg, uint32_t number) {
    const struct job *job = arg;
    const struct cs_search_lot *found = job->pairs->search.lots + number;
    struct cs_pair_lot *lot = job->set->lots + number;
    lot->n = 0;
    lot->energy = 0;
    lot->failed = false;
    for (size_t k = 0; k < found->n; k++)
        meet(job, found->kind, found->pairs + 2 * k, lot);
}

static void do_lots(struct job *job) {
    struct cs_pairs *pairs = job->pairs;
    job->set->n = 0;
    if (!cs_search_update(&pairs->search, job->at.x)) {
        pairs->failed = true;
        return;
    }
    cs_pool_run(pairs->search.n_lots, do_lot, job);
    for (uint32_t l = 0; l < pairs->search.n_lots; l++) {
        job->set->n += job->set->lots[l].n;
        pairs->failed = pairs->failed || job->set->lots[l].failed;
    }
    // what was left out is not to be looked for behind the end of a lot
    if (pairs->failed)
        job->set->n = 0;
}

/* --- by particles --- */

/* counts the corners at each particle, or puts them into their places; lots in their order */
static void visit_ends(const struct cs_pairs *pairs, struct cs_pair_set *set, bool put) {
    for (uint32_t l = 0; l < pairs->search.n_lots; l++)
        for (size_t p = 0; p < set->lots[l].n; p++)
            for (uint32_t k = 0; k < 4; k++) {
                const struct cs_pair *pair = set->lots[l].pairs + p;
                uint32_t *start = set->starts + pair->at[k] + 1;
                if (put)
                    set->ends[*start] = (struct cs_pair_end){pair, k, l};
                ++*start;
            }
}

/* The corners of each particle one behind the other: counted two places on, so that filling
 * moves the starts to where they belong. */
static void gather(struct cs_pairs *pairs, struct cs_pair_set *set) {
    const uint32_t n = pairs->system->view.n;
    struct cs_pair_end *ends =
        cs_arena_grow(set->ends, &set->ends_room, 4 * set->n, sizeof *ends);
    if (!ends && set->n) {
        pairs->failed = true;
        set->n = 0;
    }
    if (!set->n)
        return;
    set->ends = ends;
    memset(set->starts, 0, (n + 2) * sizeof *set->starts);
    set->starts++;
    visit_ends(pairs, set, false);
    for (uint32_t i = 0; i < n; i++)
        set->starts[i + 1] += set->starts[i];
    set->starts--;
    visit_ends(pairs, set, true);
}

void cs_pairs_set(struct cs_pairs *pairs, const struct cs_eval *at) {
    struct job job = {.pairs = pairs,
                      .set = &pairs->now,
                      .ask = at->dx || at->dv ? ASK_CHANGE : ASK_FORCE,
                      .at = *at};
    do_lots(&job);
    gather(pairs, &pairs->now);
}

double cs_pairs_energy(struct cs_pairs *pairs, const struct cs_eval *at) {
    struct job job = {.pairs = pairs, .set = &pairs->now, .ask = ASK_ENERGY, .at = *at};
    double sum = 0;
    do_lots(&job);
    for (uint32_t l = 0; l < pairs->search.n_lots; l++)
        sum += pairs->now.lots[l].energy;
    return sum;
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
    gather(pairs, set);
    pairs->blocks = set;
}

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

/* by how much a block must grow for all four together to be above what the pair couples */
static void find_growth(const struct cs_pair *pair, uint32_t k, double factor[2]) {
    double length[4], sum = 0, shares = 0;
    for (int j = 0; j < 4; j++) {
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

void cs_pairs_add_blocks(const struct cs_pairs *pairs, size_t begin, size_t end,
                         double *blocks) {
    const struct cs_pair_set *set = pairs->blocks;
    const size_t n = pairs->system->view.n;
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

/* --- the kept matrix times a vector --- */

struct product {
    const struct cs_pairs *pairs;
    const double *p;
    double *y;
};

/* by = the pair's share times p, less what the diagonal blocks of the solver have of it */
static void multiply_pair(struct cs_pair *pair, const struct cs_pair_turn *full,
                          double p[4][3]) {
    double along = 0, v[3] = {0};
    for (int k = 0; k < 4; k++) {
        along += cs_vec3_dot(pair->to[k], p[k]);
        for (int c = 0; c < 3; c++)
            v[c] += pair->share[k] * p[k][c];
    }
    const double *s = pair->of;
    const double rub[3] = {s[0] * v[0] + s[1] * v[1] + s[2] * v[2],
                           s[1] * v[0] + s[3] * v[1] + s[4] * v[2],
                           s[2] * v[0] + s[4] * v[1] + s[5] * v[2]};
    for (uint32_t k = 0; k < 4; k++) {
        double b[6] = {0};
        add_own(pair, full, k, (double[2]){1, 1}, b);
        const double own[3] = {b[0] * p[k][0] + b[1] * p[k][1] + b[2] * p[k][2],
                               b[1] * p[k][0] + b[3] * p[k][1] + b[4] * p[k][2],
                               b[2] * p[k][0] + b[4] * p[k][1] + b[5] * p[k][2]};
        for (int c = 0; c < 3; c++) {
            double turned = 0;
            for (int j = 0; full && j < 12; j++)
                turned += full->of[3 * k + (uint32_t)c][j] * p[j / 3][j % 3];
            pair->by[k][c] = pair->along * along * pair->to[k][c] + pair->share[k] * rub[c] +
                             turned - own[c];
        }
    }
}

static void multiply_lot(void *arg, uint32_t number) {
    const struct product *product = arg;
    const struct cs_pair_set *set = &product->pairs->matrix;
    const struct cs_pair_lot *lot = set->lots + number;
    for (size_t l = 0; l < lot->n; l++) {
        double p[4][3];
        read(product->p, product->pairs->system->view.n, lot->pairs[l].at, p);
        multiply_pair(lot->pairs + l, set->exact ? lot->full + l : NULL, p);
    }
}

static void add_products(void *arg, size_t begin, size_t end) {
    const struct product *product = arg;
    const struct cs_pair_set *set = &product->pairs->matrix;
    const size_t n = product->pairs->system->view.n;
    for (size_t i = begin; i < end; i++)
        for (uint32_t e = set->starts[i]; e < set->starts[i + 1]; e++)
            for (size_t c = 0; c < 3; c++)
                product->y[c * n + i] += set->ends[e].pair->by[set->ends[e].corner][c];
}

void cs_pairs_multiply(const struct cs_pairs *pairs, const double *p, double *y) {
    struct product product = {pairs, p, y};
    if (!pairs->matrix.n)
        return;
    cs_pool_run(pairs->search.n_lots, multiply_lot, &product);
    cs_vector_share(pairs->system->view.n, add_products, &product);
}

void cs_pairs_add_bound(struct cs_pairs *pairs, const struct cs_eval *at, double *stiffness,
                        double *damping) {
    struct job job = {.pairs = pairs, .set = &pairs->now, .ask = ASK_BOUND, .at = *at};
    do_lots(&job);
    for (uint32_t l = 0; l < pairs->search.n_lots; l++)
        for (size_t p = 0; p < pairs->now.lots[l].n; p++)
            for (int k = 0; k < 4; k++) {
                const struct cs_pair *pair = pairs->now.lots[l].pairs + p;
                stiffness[pair->at[k]] += pair->of[k];
                damping[pair->at[k]] += pair->share[k];
            }
}

/* --- making --- */

static void finish(void *object) {
    struct cs_pairs *pairs = object;
    struct cs_pair_set *const sets[2] = {&pairs->now, &pairs->matrix};
    for (int k = 0; k < 2; k++) {
        for (uint32_t l = 0; sets[k]->lots && l < pairs->search.n_lots; l++)
            free(sets[k]->lots[l].pairs), free(sets[k]->lots[l].full);
        free(sets[k]->ends);
    }
}

static void take_set(struct cs_pair_set *set, struct cs_system *system, uint32_t n_lots,
                     struct cs_error *error) {
    set->lots = cs_arena_take_n(&system->arena, n_lots, sizeof *set->lots, error);
    set->starts =
        cs_arena_take_n(&system->arena, system->view.n + (size_t)2, sizeof *set->starts, error);
}

/* Two parts of one body within its thickness would push it apart from the first step on: the
 * scene has a thickness that its edges have no room for. */
static enum cs_status check_start(const struct cs_pairs *pairs, struct cs_error *error) {
    const struct cs_search *search = &pairs->search;
    for (uint32_t l = 0; l < search->n_lots; l++)
        for (size_t p = 0; p < search->lots[l].n; p++) {
            uint32_t at[4];
            double places[4][3];
            struct cs_stencil s;
            cs_search_corners(pairs->system->surfaces, search->lots[l].kind,
                              search->lots[l].pairs + 2 * p, at);
            const uint32_t body = search->body[at[0]];
            read(pairs->system->start, pairs->system->view.n, at, places);
            cs_stencil_set(&s, search->lots[l].kind, places);
            const double range = cs_meeting_of(&pairs->meetings, body, body)->range;
            const uint32_t first = pairs->system->bodies[body].first;
            if (body == search->body[at[2]] && s.d < range)
                return cs_fail(error, CS_ERR_SCENE,
                               "bodies[%u].self_contact: parts of it start %.3g m from each "
                               "other (its particles %u and %u), expected at least its "
                               "thickness, %.3g m; give a smaller bodies[%u].thickness",
                               body, s.d, at[0] - first, at[2] - first, range, body);
        }
    return CS_OK;
}

enum cs_status cs_pairs_build(struct cs_system *system, struct cs_error *error) {
    if (cs_surfaces_build(system, error))
        return error->status;
    struct cs_pairs *pairs = cs_arena_take(&system->arena, sizeof *pairs, error);
    if (!pairs || cs_meetings_build(system, &pairs->meetings, error) ||
        cs_search_init(&pairs->search, system, &pairs->meetings, error))
        return error->status;
    pairs->system = system;
    pairs->blocks = &pairs->now;
    take_set(&pairs->now, system, pairs->search.n_lots, error);
    take_set(&pairs->matrix, system, pairs->search.n_lots, error);
    cs_arena_own(&system->arena, finish, pairs, error);
    if (error->status)
        return error->status;
    if (!cs_search_update(&pairs->search, system->start))
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the pairs of contact");
    system->pairs = pairs;
    return check_start(pairs, error);
}

/* The share of a move by the pairs that contact by force has listed for it: a fifth of the time
 * of a tree of boxes. */
#include "model/cross/listed.h"

#include "base/pool.h"
#include "model/cross/gap.h"
#include "model/pair/pairs.h"

#include <math.h>
#include <string.h>

/* but for obstacles with each other */
static bool all_meet(const struct cs_meetings *meetings, uint32_t n_bodies) {
    bool all = true;
    for (uint32_t a = 0; a < n_bodies; a++)
        for (uint32_t b = 0; b < meetings->n_bodies; b++)
            all = all && cs_meeting_of(meetings, a, b)->range > 0;
    return all;
}

bool cs_listed_covers(const struct cs_system *system, bool apart, const double *x0,
                      const double *x1) {
    struct cs_pairs *pairs = system->pairs;
    return pairs && (apart || all_meet(&pairs->meetings, system->scene->bodies.n)) &&
           cs_search_moves(&pairs->search, x0, x1) <= CS_SEARCH_GAPS &&
           cs_search_cover(&pairs->search, x0, x1);
}

/* pairs that are sieved at a time */
enum { SOME = 256 };

struct job {
    struct cs_pairs *pairs;
};

/* a single particle has no surface to go through */
static bool is_alone(const struct cs_surfaces *surfaces, uint32_t body) {
    return surfaces->first_edge[body] == surfaces->first_edge[body + 1];
}

/* The edge first that the parts of crossings.c have first: rounding knows the difference. */
static void order_edges(const struct cs_search *search, uint32_t edges[2]) {
    const struct cs_surfaces *surfaces = search->system->surfaces;
    const size_t first = 2 * (size_t)edges[0], second = 2 * (size_t)edges[1];
    const uint32_t *body = search->body, e = edges[0];
    if (body[surfaces->edges[first]] != body[surfaces->edges[second]] ||
        surfaces->owners[first] <= surfaces->owners[second])
        return;
    edges[0] = edges[1];
    edges[1] = e;
}

static double share_of(const struct job *job, enum cs_stencil_kind stencil,
                       const uint32_t pair[2], double most) {
    const struct cs_search *search = &job->pairs->search;
    const struct cs_surfaces *surfaces = search->system->surfaces;
    const bool edges = stencil == CS_STENCIL_EDGES;
    uint32_t items[2] = {pair[0], pair[1]}, at[4];
    double p[4][3], moves[4][3];
    if (edges)
        order_edges(search, items);
    else if (is_alone(surfaces, search->body[pair[0]]))
        return most;
    cs_search_corners(surfaces, stencil, items, at);
    for (size_t k = 0; k < 4; k++) {
        const double *move = job->pairs->moves[at[k]].of;
        memcpy(p[k], move + CS_POINT_MOVE_FROM, sizeof p[k]);
        memcpy(moves[k], move + CS_POINT_MOVE_BY, sizeof moves[k]);
    }
    return cs_gap_share(edges ? CS_GAP_EDGES : CS_GAP_POINT, (const double(*)[3])p,
                        (const double(*)[3])moves, most);
}

static void share_lot(void *arg, uint32_t number) {
    const struct job *job = arg;
    struct cs_search_lot *lot = job->pairs->search.lots + number;
    struct cs_point_moves_pairs items = {.surfaces = job->pairs->system->surfaces,
                                         .edges = lot->kind == CS_STENCIL_EDGES};
    uint32_t some[SOME][2];
    lot->answer = 1;
    for (size_t p = 0; p < lot->n; p += SOME) {
        items.items = lot->pairs + 2 * p;
        items.n = lot->n - p < SOME ? lot->n - p : SOME;
        const size_t n = cs_point_moves_sieve(job->pairs->moves, &items, CS_GAP_LEAST, some[0]);
        for (size_t k = 0; k < n; k++)
            lot->answer = share_of(job, lot->kind, some[k], lot->answer);
    }
}

double cs_listed_share(const struct cs_system *system, const double *x0, const double *x1) {
    struct cs_search *search = &system->pairs->search;
    struct job job = {system->pairs};
    cs_point_moves_set(system, x0, x1, system->pairs->moves);
    double share = 1;
    cs_pool_run(search->n_lots, share_lot, &job);
    for (uint32_t l = 0; l < search->n_lots; l++)
        share = fmin(share, search->lots[l].answer);
    return share;
}

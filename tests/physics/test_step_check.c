/* What is asked of a step between bodies that meet: whether it sees its contact, by all pairs
 * there are, one after the other, whatever the list is that answers. */
#include "fixture.h"

#include "model/contact/broad_phase/candidate_list.h"
#include "model/contact/broad_phase/primitive_search.h"
#include "model/contact/narrow_phase/contact_pairs.h"
#include "model/contact/step_check.h"

#include <math.h>
#include <string.h>

/* a sheet that meets itself and one above it, within each other's thickness here and there */
static const char sheets[] =
    "{\"bodies\": [{\"cloth\": {\"grid\": [7, 7], \"start\": \"flat\"}, \"thickness\": 0.05, "
    "\"self_contact\": true, \"pins\": [\"top\"], \"mass\": {\"particle\": 0.1}}, {\"cloth\": "
    "{\"grid\": [6, 5], \"start\": \"flat\", \"size\": [0.6, 0.7], \"place\": {\"translate\": "
    "[0.03, 0.05, 0.05], \"rotate\": [0.03, 0.2, 0, 1]}}, \"thickness\": 0.07, \"mass\": "
    "{\"particle\": 0.2}}], \"pairs\": {\"among\": \"all\"}, \"contact\": {\"law\": \"force\", "
    "\"stiffness\": 40}, \"time\": {\"fps\": 10}}";
enum { MOST = 3 * 100 };
#define STEP 0.5

/* all of a pair of parts */
struct pair {
    enum cs_pair_kind kind;
    uint32_t items[2], at[4];
    double from[4][3], by[4][3];
};

/* the largest component of any particle is `far` */
static void shake(const struct fixture *cloth, double far, uint64_t *seed, double *x) {
    for (size_t i = 0; i < 3 * cloth->n; i++) {
        *seed = *seed * 6364136223846793005u + 1442695040888963407u;
        x[i] = cloth->x[i] + far * ((double)(*seed >> 11) / 4503599627370496.0 - 1);
    }
}

/* the next pair without a particle in common, of points and triangles and then of edges; false:
 * there is none. items and kind go on from what they are. */
static bool next_pair(const struct fixture *cloth, const double *x, struct pair *pair) {
    const struct cs_surfaces *s = cloth->system->surfaces;
    bool same = true;
    while (same) {
        const bool edges = pair->kind == CS_PAIR_EDGE_EDGE;
        if (++pair->items[1] >= (edges ? s->n_edges : s->n_triangles)) {
            pair->items[1] = edges ? ++pair->items[0] + 1 : (++pair->items[0], 0);
            if (edges && pair->items[1] >= s->n_edges)
                return false;
            if (!edges && pair->items[0] == cloth->n)
                *pair = (struct pair){.kind = CS_PAIR_EDGE_EDGE, .items = {0, 1}};
        }
        cs_candidate_vertices(s, pair->kind, pair->items, pair->at);
        same = false;
        for (int i = 0; i < (pair->kind ? 2 : 1); i++)
            for (int j = pair->kind ? 2 : 1; j < 4; j++)
                same = same || pair->at[i] == pair->at[j];
    }
    for (size_t k = 0; k < 4; k++)
        for (size_t c = 0; c < 3; c++) {
            pair->from[k][c] = cloth->x[c * cloth->n + pair->at[k]];
            pair->by[k][c] = x[c * cloth->n + pair->at[k]] - pair->from[k][c];
        }
    return true;
}

static const struct pair before_all = {.kind = CS_PAIR_POINT_TRIANGLE,
                                       .items = {0, UINT32_MAX}};

/* the most by which a point of one side goes against one of the other */
static double longest(const struct pair *pair) {
    double most = 0;
    for (int i = 0; i < (pair->kind ? 2 : 1); i++)
        for (int j = pair->kind ? 2 : 1; j < 4; j++) {
            double squared = 0;
            for (int c = 0; c < 3; c++)
                squared +=
                    (pair->by[i][c] - pair->by[j][c]) * (pair->by[i][c] - pair->by[j][c]);
            most = fmax(most, sqrt(squared));
        }
    return most;
}

/* A pair as a whole by force and stiffness at the start. */
struct start {
    double range, k, d, approach, kinetic;
    struct cs_barrier barrier;
};

/* J, what these do not foretell, at the worst of some points */
static double unseen_of(const struct pair *pair, const struct start *at) {
    const int points = 1 + (int)(longest(pair) / (0.5 * at->range));
    double most = 0;
    for (int j = 1; j <= points; j++) {
        double p[4][3];
        struct cs_pair_contact s;
        const double share = j / (double)points, come = share * at->approach;
        for (int l = 0; l < 12; l++)
            p[l / 3][l % 3] = pair->from[l / 3][l % 3] + share * pair->by[l / 3][l % 3];
        const double d = cs_pair_contact_measure_whole(&s, pair->kind, at->range, p);
        most = fmax(most,
                    fabs(cs_barrier_energy(d, at->range, at->k) -
                         cs_barrier_energy(at->d, at->range, at->k) - at->barrier.force * come -
                         0.5 * at->barrier.stiffness * come * come));
    }
    return most;
}

/* Distance, approach, and kinetic energy of the contact points against each other. */
static void begin(const struct fixture *cloth, struct pair *pair, struct start *at) {
    struct cs_pair_contact contact;
    double v[3] = {0, 0, 0}, inverse = 0;
    at->d = cs_pair_contact_measure_whole(&contact, pair->kind, at->range, pair->from);
    at->barrier = cs_barrier_at(at->d, at->range, at->k);
    at->approach = 0;
    for (int k = 0; k < 4; k++) {
        const double w = contact.weight[k];
        inverse += w * w * cloth->system->inv_mass[pair->at[k]];
        for (int c = 0; c < 3; c++) {
            v[c] += w * pair->by[k][c] / STEP;
            at->approach -= contact.g[k][c] * pair->by[k][c];
        }
    }
    at->kinetic = inverse > 0 ? 0.5 * cs_vec3_dot(v, v) / inverse : HUGE_VAL;
}

static const struct cs_body_pair_params *params_of(const struct fixture *cloth, uint32_t a,
                                                   uint32_t b) {
    const struct cs_pairs *pairs = cloth->system->pairs;
    const uint32_t *body = pairs->candidates.body;
    return cs_body_pair_params_of(&pairs->body_pairs, body[a], body[b]);
}

/* J, all features of a point at a fraction of the step; at its start also what they foretell of
 * the whole step, by force and by stiffness */
static double features_of(const struct fixture *cloth, const double *to, uint32_t point,
                          double share, double foretold[2]) {
    const struct cs_surfaces *s = cloth->system->surfaces;
    static double x[MOST];
    double energy = 0;
    for (size_t i = 0; i < 3 * cloth->n; i++)
        x[i] = cloth->x[i] + share * (to[i] - cloth->x[i]);
    for (uint32_t t = 0; t < s->n_triangles; t++) {
        const uint32_t *at = s->triangles + 3 * (size_t)t;
        const struct cs_body_pair_params *params = params_of(cloth, point, at[0]);
        const double range = CS_FEATURE_RANGE_RATIO * params->range;
        struct cs_weighted_feature features[CS_FEATURES_PER_TRIANGLE];
        const struct cs_feature_query query = {.points = {point, at[0], at[1], at[2]},
                                               .triangle = t,
                                               .same_body =
                                                   params == params_of(cloth, point, point),
                                               .range = params->range};
        if (!(range > 0) || point == at[0] || point == at[1] || point == at[2])
            continue;
        const uint32_t n = cs_feature_weights_find(&cloth->system->pairs->feature_weights,
                                                   &query, 1, x, features);
        for (uint32_t u = 0; u < n; u++) {
            struct cs_pair_contact contact;
            double p[4][3], come = 0;
            for (size_t l = 0; l < 12; l++)
                p[l / 3][l % 3] = x[l % 3 * cloth->n + features[u].points[l / 3]];
            cs_pair_contact_measure(&contact, CS_PAIR_POINT_TRIANGLE, features[u].kind, range,
                                    p);
            for (size_t l = 0; l < 12; l++) {
                const size_t i = l % 3 * cloth->n + features[u].points[l / 3];
                come -= contact.g[l / 3][l % 3] * (to[i] - cloth->x[i]);
            }
            const double d = contact.feature.d, k = features[u].weight * params->k;
            energy += cs_barrier_energy(d, range, k);
            foretold[0] += cs_barrier_at(d, range, k).force * come;
            foretold[1] += 0.5 * cs_barrier_at(d, range, k).stiffness * come * come;
        }
    }
    return energy;
}

/* points that are seen by all their features, but not by one of their triangles */
static uint32_t n_points_seen;

/* A point is judged by all its features, as often as the pair is. */
static bool point_is_seen(const struct fixture *cloth, const struct pair *pair,
                          const struct start *at, const double *x) {
    const int points = 1 + (int)(longest(pair) / (0.5 * at->range));
    double foretold[2] = {0, 0}, none[2];
    const double stored = features_of(cloth, x, pair->at[0], 0, foretold);
    const double has =
        at->kinetic + fmax(stored, 0) + cs_barrier_energy(0.5 * at->range, at->range, at->k);
    bool seen = true;
    for (int j = 1; j <= points; j++) {
        const double share = j / (double)points;
        const double missed = features_of(cloth, x, pair->at[0], share, none) - stored -
                              share * foretold[0] - share * share * foretold[1];
        seen = seen && fabs(missed) <= CS_UNRESOLVED_ENERGY_MAX * has;
    }
    return seen;
}

static bool pair_is_seen(const struct fixture *cloth, struct pair *pair, const double *x) {
    const struct cs_body_pair_params *params = params_of(cloth, pair->at[0], pair->at[2]);
    const bool edges = pair->kind == CS_PAIR_EDGE_EDGE;
    // edges take up the same: half the range, four times the stiffness
    struct start at = {.range = params->range * (edges ? 0.5 : CS_FEATURE_RANGE_RATIO),
                       .k = params->k * (edges ? 4 : 1)};
    if (!(at.range > 0))
        return true;
    begin(cloth, pair, &at);
    const double has = at.kinetic + cs_barrier_energy(at.d, at.range, at.k) +
                       cs_barrier_energy(0.5 * at.range, at.range, at.k);
    if (unseen_of(pair, &at) <= CS_UNRESOLVED_ENERGY_MAX * has)
        return true;
    const bool seen = !edges && point_is_seen(cloth, pair, &at, x);
    n_points_seen += seen;
    return seen;
}

static bool all_are_seen(const struct fixture *cloth, const double *x) {
    struct pair pair = before_all;
    bool seen = true;
    while (seen && next_pair(cloth, x, &pair))
        seen = pair_is_seen(cloth, &pair, x);
    return seen;
}

/* A list that was never made, one of another place, one that covers the way, and pairs nearby
 * the start or the end give the same. */
TEST(steps_are_seen_as_by_all_pairs) {
    struct fixture cloth;
    static double x[MOST], away[MOST];
    uint64_t seed = 7;
    uint32_t seen = 0, unseen = 0;
    fixture_open(&cloth, "implicit-linearised:dt=0.02", "%s", sheets);
    ck_assert_uint_le(3 * cloth.n, MOST);
    struct cs_pairs *pairs = cloth.system->pairs;
    for (int k = 0; k < 30; k++) {
        shake(&cloth, 1e-4 * exp(0.18 * k), &seed, x);
        shake(&cloth, 0.1, &seed, away);
        const bool expected = all_are_seen(&cloth, x);
        for (int list = 0; list < 3; list++) {
            if (list == 0)
                pairs->candidates.is_built = false;
            if (list == 1)
                ck_assert(cs_candidates_update(&pairs->candidates, away));
            ck_assert_msg(cs_contact_pairs_resolve_step(pairs, 0, cloth.x, STEP, x) == expected,
                          "move %d, list %d: expected %d", k, list, expected);
        }
        seen += expected;
        unseen += !expected;
    }
    ck_assert_uint_gt(seen, 8);
    ck_assert_uint_gt(unseen, 8);
    fixture_close(&cloth);
}

/* Finds the pairs nearby at a state, as a force after a short step does. Returns whether the
 * step to x is short enough for them. */
static bool find_nearby(const struct fixture *cloth, const double *at, const double *x) {
    struct cs_candidates *candidates = &cloth->system->pairs->candidates;
    static double before[MOST];
    memcpy(before, at, 3 * cloth->n * sizeof *at);
    before[0] += 1e-9;
    candidates->has_nearby = false;
    ck_assert(cs_candidates_find_in_range(candidates, before));
    ck_assert(cs_candidates_find_in_range(candidates, at));
    return candidates->has_nearby &&
           cs_candidates_max_motion(candidates, cloth->x, x) < 0.99 * CS_CANDIDATES_NEARBY;
}

/* Pairs nearby the start, the end or beyond it give the same as all pairs, where sheets are so
 * close that short steps are refused too. */
TEST(pairs_nearby_suffice_for_short_steps) {
    struct fixture cloth;
    static double x[MOST], away[MOST];
    uint64_t seed = 5;
    uint32_t refused = 0, taken = 0;
    fixture_open(&cloth, "implicit-linearised:dt=0.02", "%s", sheets);
    struct cs_pairs *pairs = cloth.system->pairs;
    for (int k = 0; k < 60; k++) {
        for (size_t i = cloth.system->bodies[1].first; i < cloth.n; i++)
            cloth.x[cloth.n + i] -= 0.0015;
        shake(&cloth, 0.0004 * (1 + k % 8), &seed, x);
        for (size_t i = 0; i < 3 * cloth.n; i++)
            away[i] = 1.5 * x[i] - 0.5 * cloth.x[i];
        const bool expected = all_are_seen(&cloth, x);
        const double *const places[] = {cloth.x, x, away};
        for (int place = 0; place < 3; place++) {
            const bool is_short = find_nearby(&cloth, places[place], x);
            ck_assert_msg(cs_contact_pairs_resolve_step(pairs, 0, cloth.x, STEP, x) == expected,
                          "move %d, place %d: expected %d", k, place, expected);
            refused += is_short && !expected;
            taken += is_short && expected;
        }
    }
    ck_assert_uint_gt(refused, 15);
    ck_assert_uint_gt(taken, 15);
    ck_assert_uint_gt(n_points_seen, 15);
    fixture_close(&cloth);
}

/* the sheet above goes down, slowly, from out of range until more is unseen than may be */
TEST(steps_that_come_into_range_are_asked) {
    struct fixture cloth;
    static double x[MOST];
    bool expected = true;
    double least = 0;
    fixture_open(&cloth, "implicit-linearised:dt=0.02", "%s", sheets);
    struct cs_pairs *pairs = cloth.system->pairs;
    const uint32_t first = cloth.system->bodies[1].first;
    for (size_t i = first; i < cloth.n; i++)
        cloth.x[cloth.n + i] += 0.1;
    for (double down = 0.06; expected; down += 0.001) {
        memcpy(x, cloth.x, 3 * cloth.n * sizeof *x);
        for (size_t i = first; i < cloth.n; i++)
            x[cloth.n + i] -= down;
        expected = all_are_seen(&cloth, x);
        pairs->candidates.is_built = false;
        ck_assert_msg(cs_contact_pairs_resolve_step(pairs, 0, cloth.x, STEP, x) == expected,
                      "down %g", down);
        // none is nearby at the start, which must not be taken for none at all
        find_nearby(&cloth, cloth.x, x);
        ck_assert_msg(cs_contact_pairs_resolve_step(pairs, 0, cloth.x, STEP, x) == expected,
                      "down %g, with pairs nearby", down);
        least = down;
    }
    ck_assert_double_gt(least, 0.07);
    fixture_close(&cloth);
}

/* a list that covers a step has room for the next one, where that goes on alike */
TEST(lists_look_ahead) {
    struct fixture cloth;
    static double x[MOST];
    enum { STEPS = 12 };
    fixture_open(&cloth, "implicit-linearised:dt=0.02", "%s", sheets);
    struct cs_candidates *search = &cloth.system->pairs->candidates;
    const size_t first = cloth.system->bodies[1].first;
    const uint64_t before = search->n_builds;
    for (int step = 0; step < STEPS; step++) {
        memcpy(x, cloth.x, 3 * cloth.n * sizeof *x);
        for (size_t i = first; i < cloth.n; i++)
            x[i] += 0.6 * search->body_pairs->range_min;
        ck_assert(cs_candidates_cover_step(search, cloth.x, x));
        memcpy(cloth.x, x, 3 * cloth.n * sizeof *x);
    }
    ck_assert_uint_le(search->n_builds - before, STEPS / 2);
    fixture_close(&cloth);
}

/* one pair through the distance filter */
static bool passes(const struct fixture *cloth, const struct pair *pair, double reach) {
    uint32_t out[2];
    const struct cs_moving_pairs one = {.surfaces = cloth->system->surfaces,
                                        .edges = pair->kind == CS_PAIR_EDGE_EDGE,
                                        .items = pair->items,
                                        .n = 1};
    return cs_point_motion_filter(cloth->system->pairs->point_motion, &one, reach, out) == 1;
}

/* the boxes of a pair's sides as swept boxes know them, to the last bit */
TEST(sieves_hold_what_swaths_do) {
    struct fixture cloth;
    static double x[MOST];
    uint64_t seed = 3;
    uint32_t meet = 0, all = 0;
    fixture_open(&cloth, "implicit-linearised:dt=0.02", "%s", sheets);
    for (int k = 0; k < 3; k++) {
        struct pair pair = before_all;
        const double reach = 0.02 * k;
        shake(&cloth, 0.1, &seed, x);
        cs_point_motion_set(cloth.system, cloth.x, x, cloth.system->pairs->point_motion);
        while (next_pair(&cloth, x, &pair)) {
            struct cs_swept_aabb swept_boxes[2] = {cs_swept_aabb_empty(),
                                                   cs_swept_aabb_empty()};
            for (int l = 0; l < 4; l++)
                cs_swept_aabb_add_point(swept_boxes + (l >= (pair.kind ? 2 : 1)), cloth.n,
                                        pair.at[l], cloth.x, x);
            const bool expected = cs_swept_aabbs_overlap(swept_boxes, swept_boxes + 1, reach);
            ck_assert(passes(&cloth, &pair, reach) == expected);
            meet += expected;
            all++;
        }
    }
    ck_assert_uint_gt(meet, all / 20);
    ck_assert_uint_lt(meet, all / 2);
    fixture_close(&cloth);
}

/* Lists of pairs miss none: they have as many in range as there are, and the same forces but
 * for the order of sums, while surfaces move and lists grow old; and two that come straight at
 * each other are seen whatever the age. The folder faults has lists with one thing wrong. */
#include "model/contact/narrow_phase/contact_pairs.h"
#include "model/contact/narrow_phase/pair_contact.h"
#include "model/force/terms.h"
#include "pair_positions.h"
#include "scene/contact_keys.h"
#include "scene/scene.h"
#include "sheet.h"

/* --- all pairs --- */

/* adds what two edges, or a point and a feature, do to each other; false: out of range */
static bool add_one(const struct sheet *sheet, enum cs_pair_kind kind, const uint32_t at[4],
                    const struct cs_weighted_feature *feature, double *f) {
    const struct cs_system *system = &sheet->system;
    const uint32_t *body = system->pairs->candidates.body;
    struct cs_body_pair_params params =
        *cs_body_pair_params_of(&system->pairs->body_pairs, body[at[0]], body[at[2]]);
    struct cs_pair_contact contact;
    double p[4][3], v[4][3], push[4][3];
    for (size_t k = 0; k < 4; k++)
        for (size_t c = 0; c < 3; c++) {
            p[k][c] = sheet->x[c * sheet->n + at[k]];
            v[k][c] = sheet->v[c * sheet->n + at[k]];
        }
    params.range *= feature ? CS_FEATURE_RANGE_RATIO : CS_EDGE_RANGE_RATIO;
    params.k *= feature ? feature->weight : 4;
    cs_pair_contact_measure(
        &contact, kind, feature ? feature->kind : (struct cs_feature_kind){0}, params.range, p);
    if (kind == CS_PAIR_EDGE_EDGE && !(contact.distance.d < params.range))
        return false;
    cs_pair_contact_set(&contact, &params, system->scene->contact, v);
    cs_pair_contact_force(&contact, (struct cs_contact_force_parts){1, 1}, push);
    for (size_t k = 0; k < 4; k++)
        for (size_t c = 0; c < 3; c++)
            f[c * sheet->n + at[k]] += push[k][c];
    return true;
}

/* what a point feels of one triangle more, behind n uses of others */
static uint32_t feel(const struct sheet *sheet, const uint32_t at[4], uint32_t triangle,
                     struct cs_weighted_feature *felt, uint32_t n) {
    const struct cs_pairs *pairs = sheet->system.pairs;
    const uint32_t *body = pairs->candidates.body;
    const struct cs_feature_query pair = {
        .points = {at[0], at[1], at[2], at[3]},
        .triangle = triangle,
        .same_body = body[at[0]] == body[at[1]],
        .range = cs_body_pair_params_of(&pairs->body_pairs, body[at[0]], body[at[1]])->range};
    const uint32_t more =
        cs_feature_weights_find(&pairs->feature_weights, &pair, 1, sheet->x, felt + n);
    return cs_feature_weights_join(felt, n, more);
}

/* whether a point and a triangle, or two edges, have no particle in common */
static bool are_apart(enum cs_pair_kind kind, const uint32_t at[4]) {
    bool same = false;
    for (int i = 0; i < 2; i++)
        for (int j = i + 1; j < 4; j++)
            same = same || (at[i] == at[j] && (kind ? i / 2 != j / 2 : !i));
    return !same;
}

static size_t add_points(const struct sheet *sheet, double *f) {
    static struct cs_weighted_feature felt[1000];
    const struct cs_surfaces *s = sheet->system.surfaces;
    size_t found = 0;
    for (uint32_t a = 0; a < sheet->n; a++) {
        uint32_t n = 0, at[4];
        for (uint32_t b = 0; b < s->n_triangles; b++) {
            cs_candidate_vertices(s, CS_PAIR_POINT_TRIANGLE, (uint32_t[2]){a, b}, at);
            if (are_apart(CS_PAIR_POINT_TRIANGLE, at))
                n = feel(sheet, at, b, felt, n);
        }
        for (uint32_t k = 0; k < n; k++)
            found += cs_feature_weights_counts(felt + k) &&
                     add_one(sheet, CS_PAIR_POINT_TRIANGLE, felt[k].points, felt + k, f);
    }
    return found;
}

static size_t add_edges(const struct sheet *sheet, double *f) {
    const struct cs_surfaces *s = sheet->system.surfaces;
    size_t found = 0;
    for (uint32_t a = 0; a < s->n_edges; a++)
        for (uint32_t b = a + 1; b < s->n_edges; b++) {
            uint32_t at[4];
            cs_candidate_vertices(s, CS_PAIR_EDGE_EDGE, (uint32_t[2]){a, b}, at);
            found += are_apart(CS_PAIR_EDGE_EDGE, at) &&
                     add_one(sheet, CS_PAIR_EDGE_EDGE, at, NULL, f);
        }
    return found;
}

static size_t add_all(const struct sheet *sheet, double *f) {
    const size_t points = add_points(sheet, f);
    return points + add_edges(sheet, f);
}

enum { MOST = 3 * 160 };

/* returns how many are in range */
static size_t compare(const struct sheet *sheet) {
    double all[MOST] = {0}, found[MOST] = {0};
    struct cs_pairs *pairs = sheet->system.pairs;
    ck_assert_uint_le(3 * sheet->n, MOST);
    const size_t n = add_all(sheet, all);
    const struct cs_block block = {.end = (uint32_t)sheet->n};
    const struct cs_eval at = {
        .x = sheet->x, .v = sheet->v, .parts = CS_PART_ALL, .block = &block};
    cs_term_pairs.prepare(&sheet->system, &at);
    cs_term_pairs.add_force(&sheet->system, &at, found);
    ck_assert_uint_eq(pairs->current_contacts->n, n);
    double most = 0, off = 0;
    for (size_t i = 0; i < 3 * sheet->n; i++) {
        most = fmax(most, fabs(all[i]));
        off = fmax(off, fabs(all[i] - found[i]));
    }
    ck_assert_msg(off <= 1e-13 * most, "%g of %g", off, most);
    return n;
}

/* --- sheets in folds --- */

#define SHEET(columns, rows, side, height, own)                                                \
    "{\"cloth\": {\"grid\": [" #columns ", " #rows "], \"size\": [" #side ", " #side "], "     \
    "\"start\": \"flat\", \"place\": {\"translate\": [0, " #height ", 0]}}, \"mass\": "        \
    "{\"total\": 1}, \"thickness\": 0.1, \"self_contact\": " #own ", \"friction\": 0.3}"

#define LARGE SHEET(13, 6, 3, 0, true) ", " SHEET(9, 7, 3, 1, true)
/* short edges: by a thousandth of them the distance filter is rough */
#define SMALL SHEET(2, 2, 0.05, 0, false) ", " SHEET(2, 2, 0.05, 1, false)

static const char folded[] =
    "{\"bodies\": [" LARGE "], \"pairs\": {\"among\": \"all\", \"friction\": 0.2}, "
    "\"contact\": {\"law\": \"force\", \"stiffness\": 10, \"damping\": 0.01, "
    "\"friction_speed\": 0.1}}";
static const char two[] = "{\"bodies\": [" SMALL "], \"pairs\": \"all\", \"contact\": "
                          "{\"law\": \"force\", \"stiffness\": 10}}";

/* the first about the second, in an S whose layers are about a range apart, all of it crumpled;
 * rows against the order of cells, so that what these find is to be sorted */
static void fold(struct sheet *sheet, uint64_t *state) {
    const size_t n = sheet->n;
    for (size_t i = 0; i < n; i++) {
        const bool first = i < 78;
        const size_t column = first ? i % 13 : (i - 78) % 9,
                     row = first ? i / 13 : (i - 78) / 9;
        const double layer = (double)(column / 5), along = (double)(column % 5);
        const double turned = column / 5 % 2 ? 4 - along : along;
        const double x = first ? 0.2 * turned : 0.1 * (double)column;
        const double y = first ? 0.14 * layer : 0.07;
        sheet->x[i] = x + 0.02 * draw(state);
        sheet->x[n + i] = y + 0.03 * draw(state);
        sheet->x[2 * n + i] = -0.16 * (double)row + 0.02 * draw(state);
    }
}

/* by up to a tenth of the range a component, and speeds to go with it */
static void move(struct sheet *sheet, uint64_t *state) {
    for (size_t i = 0; i < 3 * sheet->n; i++) {
        sheet->v[i] = draw(state);
        sheet->x[i] += 0.01 * sheet->v[i];
    }
}

TEST(lists_miss_no_pair) {
    struct sheet sheet;
    uint64_t state = 1;
    size_t found = 0;
    sheet_open(&sheet, 0, "%s", folded);
    fold(&sheet, &state);
    const struct cs_candidates *search = &sheet.system.pairs->candidates;
    const uint64_t before = search->n_builds;
    for (int k = 0; k < 16; k++) {
        move(&sheet, &state);
        found += compare(&sheet);
    }
    // some lists were old, and some were made
    ck_assert_uint_gt(search->n_builds, before + 2);
    ck_assert_uint_lt(search->n_builds, before + 13);
    ck_assert_uint_gt(found, 16 * 100);
    sheet_close(&sheet);
}

/* the order of sums: by kind, then by the first and then by the second of a pair */
TEST(keys_ascend) {
    struct sheet sheet;
    uint64_t state = 1;
    size_t n = 0;
    sheet_open(&sheet, 0, "%s", folded);
    fold(&sheet, &state);
    compare(&sheet);
    const struct cs_candidates *search = &sheet.system.pairs->candidates;
    uint64_t last = 0;
    for (uint32_t l = 0; l < search->n_chunks; l++) {
        const struct cs_candidate_chunk *chunk = search->chunks + l;
        for (size_t k = 0; k < chunk->n; k++, n++) {
            const uint64_t key = ((uint64_t)(chunk->kind == CS_PAIR_EDGE_EDGE) << 62) +
                                 ((uint64_t)chunk->pairs[2 * k] << 31) +
                                 chunk->pairs[2 * k + 1];
            ck_assert_msg(!n || key > last, "pair %zu", n);
            last = key;
        }
    }
    ck_assert_uint_gt(n, 1000);
    sheet_close(&sheet);
}

/* --- at the end of what a list is good for --- */

/* Puts the second sheet beside the rim of the first, its own rim so far from it and in front of
 * it by a share that features feel soonest (mesh_feature.h: where m - f(m) is greatest). */
static void put_beside(struct sheet *sheet, const double *flat, double distance) {
    const double range = 0.1, side = 0.05, aside = 0.69 * CS_FEATURE_BLEND_RADIUS;
    const size_t n = sheet->n;
    for (size_t i = 4; i < n; i++) {
        sheet->x[i] = side / 2 + distance * aside + 0.8 * (flat[i] + side / 2);
        sheet->x[n + i] = distance * sqrt(1 - aside * aside) + range * (flat[i] / side + 0.5);
        sheet->x[2 * n + i] = 0.8 * flat[2 * n + i];
    }
}

/* A list made where a pair is just about to be in it, or just was not, and used after a move
 * straight to where it is just still good, or just no more. */
TEST(what_comes_straight_is_seen) {
    struct sheet sheet;
    double flat[3 * 8];
    size_t felt = 0;
    sheet_open(&sheet, 0, "%s", two);
    struct cs_candidates *search = &sheet.system.pairs->candidates;
    const double range = sheet.system.pairs->body_pairs.range_min, good = 2 * search->margin;
    memcpy(flat, sheet.x, sizeof flat);
    for (int from = -10; from <= 10; from++)
        for (int to = -10; to <= 10; to++) {
            const double start = range + good * (1 + 0.004 * from);
            put_beside(&sheet, flat, start);
            search->is_built = false;
            ck_assert_uint_eq(compare(&sheet), 0);
            put_beside(&sheet, flat, start - good * (1 + 0.004 * to));
            felt += compare(&sheet) > 0;
        }
    ck_assert_uint_gt(felt, 100);
    sheet_close(&sheet);
}

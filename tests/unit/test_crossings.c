/* Crossings of whole systems: closed cases, and every pair tried one by one. */
#include "base/pool.h"
#include "model/contact/ccd/accd.h"
#include "model/contact/ccd/crossings.h"
#include "model/contact/ccd/edge_triangle.h"
#include "sheet.h"

#define SHEET                                                                                  \
    "{\"cloth\": {\"grid\": [%d, %d], \"size\": [%g, %g], \"place\": {\"translate\": [%g, "    \
    "%g, %g]%s}}, \"mass\": {\"total\": 1}}"
/* about y: a sheet in the plane of x and y becomes one in that of z and y */
#define ACROSS ", \"rotate\": [0, 0.70710678118654752, 0, 0.70710678118654752]"

static void open(struct sheet *sheet, const char *bodies) {
    struct cs_error error = {0};
    sheet_open(sheet, 0, "{\"bodies\": [%s]}", bodies);
    if (!sheet->system.crossings)
        cs_crossings_build(&sheet->system, &error);
    UNIT_ASSERT_OK(&error);
}

static void read_points(const struct sheet *sheet, const double *x, const uint32_t *items,
                        uint32_t n, double p[][3]) {
    for (uint32_t k = 0; k < n; k++)
        for (size_t c = 0; c < 3; c++)
            p[k][c] = x[c * sheet->n + items[k]];
}

static bool share_one(const uint32_t *a, uint32_t n, const uint32_t *b, uint32_t m) {
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < m; j++)
            if (a[i] == b[j])
                return true;
    return false;
}

/* every edge against every triangle */
static struct cs_crossing_count count_all(const struct sheet *sheet) {
    const struct cs_surfaces *s = sheet->system.surfaces;
    struct cs_crossing_count count = {0};
    for (uint32_t e = 0; e < s->n_edges; e++)
        for (uint32_t t = 0; t < s->n_triangles; t++) {
            double edge[2][3], triangle[3][3];
            if (share_one(s->edges + 2 * e, 2, s->triangles + 3 * t, 3))
                continue;
            read_points(sheet, sheet->x, s->edges + 2 * e, 2, edge);
            read_points(sheet, sheet->x, s->triangles + 3 * t, 3, triangle);
            if (!cs_edge_crosses_triangle((const double(*)[3])edge,
                                          (const double(*)[3])triangle))
                continue;
            if (!count.n++)
                count.edge = e, count.triangle = t;
        }
    return count;
}

static double share_of(const struct sheet *sheet, enum cs_pair_kind kind,
                       const uint32_t items[4], const double *to, double most) {
    double p[4][3], moves[4][3];
    read_points(sheet, sheet->x, items, 4, p);
    read_points(sheet, to, items, 4, moves);
    for (int k = 0; k < 4; k++)
        for (int c = 0; c < 3; c++)
            moves[k][c] -= p[k][c];
    return cs_accd_safe_fraction(kind, (const double(*)[3])p, (const double(*)[3])moves, most);
}

/* every point of a body against every triangle, every edge against every other */
static double share_all(const struct sheet *sheet, const double *to) {
    const struct cs_surfaces *s = sheet->system.surfaces;
    double share = 1;
    for (uint32_t i = 0; i < sheet->n; i++)
        for (uint32_t t = 0; t < s->n_triangles; t++) {
            const uint32_t *corners = s->triangles + 3 * t;
            const uint32_t items[4] = {i, corners[0], corners[1], corners[2]};
            if (!share_one(items, 1, corners, 3))
                share = share_of(sheet, CS_PAIR_POINT_TRIANGLE, items, to, share);
        }
    for (uint32_t e = 0; e < s->n_edges; e++)
        for (uint32_t f = e + 1; f < s->n_edges; f++) {
            const uint32_t *a = s->edges + 2 * e, *b = s->edges + 2 * f;
            const uint32_t items[4] = {a[0], a[1], b[0], b[1]};
            if (!share_one(a, 2, b, 2))
                share = share_of(sheet, CS_PAIR_EDGE_EDGE, items, to, share);
        }
    return share;
}

/* A sheet of 9 x 7 is gone through by one of 9 x 12 at x = at, which is higher. A plane that
 * cuts a row of cells between their columns cuts one edge of each row of particles and one
 * diagonal of each row of cells; where it lies in a column, edges of the first only touch it.
 */
static void expect_crossed(double at, double lift, uint64_t first, uint64_t second) {
    struct sheet sheet;
    char bodies[1024];
    const double width = 0.8, height = 0.6;
    snprintf(bodies, sizeof bodies, SHEET ", " SHEET, 9, 7, width, height, 0.0, 0.0, 0.0, "", 9,
             12, width, 1.1, at, 0.031, lift, ACROSS);
    open(&sheet, bodies);
    // the rotation rounds: exactly upright
    for (size_t i = 63; i < sheet.n; i++)
        sheet.x[i] = at;
    uint8_t *marks = calloc(sheet.system.surfaces->n_triangles, 1);
    const struct cs_crossing_count count = cs_crossings_mark(&sheet.system, 0, sheet.x, marks);
    ck_assert_uint_eq(count.n, first + second);
    ck_assert_uint_eq(cs_crossings_count(&sheet.system, 0, sheet.x).n, count.n);
    const struct cs_crossing_count all = count_all(&sheet);
    ck_assert_uint_eq(count.n, all.n);
    ck_assert_uint_eq(count.edge, all.edge);
    ck_assert_uint_eq(count.triangle, all.triangle);
    uint32_t marked = 0;
    for (uint32_t t = 0; t < sheet.system.surfaces->n_triangles; t++)
        marked += marks[t];
    ck_assert(count.n ? marked > 1 && marks[count.triangle] : !marked);
    ck_assert_uint_lt(marked, sheet.system.surfaces->n_triangles);
    free(marks);
    sheet_close(&sheet);
}

TEST(sheets_through_each_other) {
    // rows of the second are 0.1 apart, from -0.519 to 0.581: six lie within the first, whose
    // plane cuts their edges and the diagonals of seven rows of cells, one of them outside
    expect_crossed(0.13, 0.02, 7 + 6, 6 + 6);
}

/* the second stands exactly in a column of the first: no edge of the first goes through it,
 * and what goes through edges of the first counts once */
TEST(sheet_in_a_column_of_another) {
    expect_crossed(0, 0.02, 0, 6 + 6);
}

/* ... and its own column in the plane of the first: all is touch */
TEST(columns_in_each_other) {
    expect_crossed(0, 0, 0, 0);
}

TEST(what_lies_in_a_plane_does_not_cross) {
    struct sheet sheet;
    char bodies[1024];
    snprintf(bodies, sizeof bodies, SHEET ", " SHEET, 6, 5, 1.0, 1.0, 0.0, 0.0, 0.0, "", 4, 7,
             1.0, 1.0, 0.3, 0.2, 0.0, "");
    open(&sheet, bodies);
    ck_assert_uint_eq(cs_crossings_count(&sheet.system, 0, sheet.x).n, 0);
    sheet_close(&sheet);
}

/* crumpled sheets, a mesh, a rope and a single particle, at several stages of disorder */
static void open_disorder(struct sheet *sheet) {
    char bodies[2048];
    snprintf(bodies, sizeof bodies,
             SHEET ", " SHEET ", " SHEET ", " SHEET
                   ", {\"mesh\": {\"shape\": \"sphere\", \"detail\": 3, \"scale\": [0.4, 0.4, "
                   "0.4]}, \"mass\": {\"total\": 1}}",
             9, 8, 1.0, 1.0, 0.0, 0.0, 0.0, "", 12, 1, 1.2, 1.0, 0.0, 0.1, 0.0, ACROSS, 1, 1,
             1.0, 1.0, 0.0, 0.0, 0.0, "", 7, 9, 1.0, 1.0, 0.1, 0.0, 0.2, "");
    open(sheet, bodies);
}

TEST(counts_are_those_of_all_pairs) {
    for (int k = 0; k < 6; k++) {
        struct sheet sheet;
        struct cs_error error = {0};
        open_disorder(&sheet);
        sheet_stir(&sheet, 0.1 * k, 0);
        const struct cs_crossing_count all = count_all(&sheet);
        for (uint32_t threads = 1; threads < 4; threads++) {
            cs_pool_start(threads, &error);
            UNIT_ASSERT_OK(&error);
            const struct cs_crossing_count found =
                cs_crossings_count(&sheet.system, 0, sheet.x);
            ck_assert_uint_eq(found.n, all.n);
            ck_assert_uint_eq(found.edge, all.edge);
            ck_assert_uint_eq(found.triangle, all.triangle);
            cs_pool_stop();
        }
        ck_assert(k == 0 || all.n > 0);
        sheet_close(&sheet);
    }
}

TEST(shares_are_those_of_all_pairs) {
    int cut = 0;
    for (int k = 1; k < 6; k++) {
        struct sheet sheet;
        struct cs_error error = {0};
        open_disorder(&sheet);
        const size_t bytes = 3 * sheet.n * sizeof(double);
        double *to = malloc(bytes);
        sheet_stir(&sheet, 0.01, 0);
        memcpy(to, sheet.x, bytes);
        for (size_t i = 0; i < 3 * sheet.n; i++)
            to[i] += 0.003 * k * sin((double)(i * i));
        const double all = share_all(&sheet, to);
        for (uint32_t threads = 1; threads < 4; threads++) {
            cs_pool_start(threads, &error);
            UNIT_ASSERT_OK(&error);
            ck_assert_double_eq(cs_crossings_safe_fraction(&sheet.system, 0, sheet.x, 1, to),
                                all);
            cs_pool_stop();
        }
        cut += all < 1;
        free(to);
        sheet_close(&sheet);
    }
    ck_assert_int_gt(cut, 2);
}

/* Two sheets of 4 x 4, 0.2 m above each other, with a spike of 0.15 m over the middle of a
 * triangle: its tip is the nearest point, whichever body has it. */
TEST(spikes_of_either_body_are_seen) {
    for (size_t spiked = 0; spiked < 2; spiked++) {
        struct sheet sheet;
        char bodies[1024];
        snprintf(bodies, sizeof bodies, SHEET ", " SHEET, 4, 4, 1.2, 1.2, 0.0, 0.0, 0.0, "", 4,
                 4, 1.2, 1.2, 0.1, 0.16, 0.2, "");
        open(&sheet, bodies);
        const double up = spiked ? -0.15 : 0.15;
        sheet.x[2 * sheet.n + 16 * spiked + 5] += up;
        double *to = malloc(3 * sheet.n * sizeof *to);
        memcpy(to, sheet.x, 3 * sheet.n * sizeof *to);
        for (size_t i = 16; i < 32; i++)
            to[2 * sheet.n + i] -= 0.1;
        const double share = cs_crossings_safe_fraction(&sheet.system, 0, sheet.x, 1, to);
        ck_assert_msg(share < 0.5 && share > 0.44, "%zu: %g", spiked, share);
        free(to);
        sheet_close(&sheet);
    }
}

/* a fall of a metre together, and states that are not finite */
TEST(shared_moves_and_blow_ups) {
    struct sheet sheet;
    open_disorder(&sheet);
    double *to = malloc(3 * sheet.n * sizeof *to);
    sheet_stir(&sheet, 0.01, 0);
    for (size_t i = 0; i < 3 * sheet.n; i++)
        to[i] = sheet.x[i] + 0.5;
    ck_assert_double_eq(cs_crossings_safe_fraction(&sheet.system, 0, sheet.x, 1, to), 1);
    ck_assert_double_eq(cs_crossings_safe_fraction(&sheet.system, 0, sheet.x, 1, sheet.x), 1);
    for (size_t i = 0; i < 3 * sheet.n; i += 5)
        to[i] = i % 2 ? (double)NAN : HUGE_VAL;
    cs_crossings_safe_fraction(&sheet.system, 0, sheet.x, 1, to);
    cs_crossings_count(&sheet.system, 0, to);
    free(to);
    sheet_close(&sheet);
}

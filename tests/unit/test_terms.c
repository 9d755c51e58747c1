/* The outer forces against closed forms, and the parts of the sum. */
#include "base/pool.h"
#include "model/force/terms.h"
#include "sheet.h"

#include <stdatomic.h>

/* hanging in the xy plane: its normals are +z */
#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [4, 3], \"size\": [3, 2]}, \"mass\": "               \
    "{\"areal_density\": 0.5}, \"springs\": {\"damping\": 0.2}, \"pins\": [5]}],"              \
    " \"forces\": {%s}}"

enum { N = 12, VALUES = 3 * N };

static void force(const struct sheet *sheet, uint32_t parts, double f[VALUES]) {
    if (cs_terms_need_normals(&sheet->system, parts))
        cs_normals_update(&sheet->system, sheet->x);
    for (size_t i = 0; i < VALUES; i++)
        f[i] = 1e9; // the sum overwrites
    cs_terms_force(&sheet->system,
                   &(struct cs_eval){.x = sheet->x, .v = sheet->v, .parts = parts}, f);
}

/* share of the area: a cell of 1 m2 inside, halves and quarters at the border */
static double area_of(size_t i) {
    const size_t row = i / 4, column = i % 4;
    return (row == 0 || row == 2 ? 0.5 : 1) * (column == 0 || column == 3 ? 0.5 : 1);
}

TEST(gravity_is_mass_times_g) {
    struct sheet sheet;
    double f[VALUES];
    sheet_open(&sheet, 0, SCENE, "\"gravity\": [1, -2, 3]");
    force(&sheet, CS_PART_GRAVITY, f);
    for (size_t i = 0; i < N; i++) {
        const double m = i == 5 ? 0 : 0.5 * area_of(i); // pinned: 0
        SHEET_ASSERT_AT(&sheet, f, i, m, -2 * m, 3 * m, 1e-14);
    }
    double energy = 0;
    for (size_t i = 0; i < N; i++)
        energy -= 0.5 * area_of(i) * (sheet.x[i] - 2 * sheet.x[N + i] + 3 * sheet.x[2 * N + i]);
    ck_assert_double_eq_tol(
        cs_term_gravity.energy(&sheet.system, &(struct cs_eval){.x = sheet.x}), energy, 1e-14);
    sheet_close(&sheet);
}

TEST(drag_is_against_the_velocity) {
    for (int by_area = 0; by_area < 2; by_area++) {
        struct sheet sheet;
        double f[VALUES];
        sheet_open(&sheet, 0, SCENE,
                   by_area ? "\"drag\": 0.3, \"drag_unit\": \"Pa s/m\"" : "\"drag\": 0.3");
        sheet_stir(&sheet, 0, 2);
        force(&sheet, CS_PART_DRAG, f);
        for (size_t i = 0; i < N; i++) {
            const double c = i == 5 ? 0 : -0.3 * (by_area ? area_of(i) : 1);
            SHEET_ASSERT_AT(&sheet, f, i, c * sheet.v[i], c * sheet.v[N + i],
                            c * sheet.v[2 * N + i], 1e-14);
        }
        sheet_close(&sheet);
    }
}

/* strength times |w.n| along w: the same from in front and behind, nothing edge-on */
TEST(wind_is_by_the_angle_of_the_cloth) {
    static const struct {
        const char *wind;
        double w[3], facing; /* unit direction, |w.n| */
        bool by_area;
    } rows[] = {
        {"[0, 0, 5], \"strength\": 4", {0, 0, 1}, 1, true},
        {"[0, 0, -1], \"strength\": 4", {0, 0, -1}, 1, true},
        {"[1, 0, 0], \"strength\": 4", {1, 0, 0}, 0, true},
        {"[0, 3, 4], \"strength\": 4", {0, 0.6, 0.8}, 0.8, true},
        {"[0, 3, 4], \"strength\": 4, \"strength_unit\": \"N\"", {0, 0.6, 0.8}, 0.8, false},
    };
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        struct sheet sheet;
        double f[VALUES];
        char forces[160];
        snprintf(forces, sizeof forces, "\"wind\": {\"direction\": %s}", rows[k].wind);
        sheet_open(&sheet, 0, SCENE, forces);
        force(&sheet, CS_PART_WIND, f);
        for (size_t i = 0; i < N; i++) {
            const double push =
                i == 5 ? 0 : 4 * rows[k].facing * (rows[k].by_area ? area_of(i) : 1);
            SHEET_ASSERT_AT(&sheet, f, i, push * rows[k].w[0], push * rows[k].w[1],
                            push * rows[k].w[2], 1e-14);
        }
        sheet_close(&sheet);
    }
}

#define EVERYTHING "\"drag\": 0.3, \"wind\": {\"direction\": [1, 0.3, 0.2], \"strength\": 4}"

/* every bit alone adds up to all of them, and none gives nothing */
TEST(parts_add_up) {
    struct sheet sheet;
    double all[VALUES], sum[VALUES] = {0}, f[VALUES];
    sheet_open(&sheet, 0, SCENE, EVERYTHING);
    sheet_stir(&sheet, 0.2, 2);
    force(&sheet, CS_PART_ALL, all);
    for (uint32_t part = 1; part <= CS_PART_WIND; part *= 2) {
        double size = 0;
        force(&sheet, part, f);
        for (size_t i = 0; i < VALUES; i++) {
            sum[i] += f[i];
            size = fmax(size, fabs(f[i]));
        }
        ck_assert_msg(size > 1e-3, "part %u is not there", part);
    }
    for (size_t i = 0; i < VALUES; i++)
        ck_assert_double_eq_tol(sum[i], all[i], 1e-12);
    force(&sheet, 0, f);
    for (size_t i = 0; i < VALUES; i++)
        ck_assert_double_eq(f[i], 0);
    sheet_close(&sheet);
}

TEST(only_wind_needs_normals) {
    struct sheet sheet;
    sheet_open(&sheet, 0, SCENE, EVERYTHING);
    ck_assert(cs_terms_need_normals(&sheet.system, CS_PART_WIND));
    ck_assert(cs_terms_need_normals(&sheet.system, CS_PART_ALL));
    ck_assert(!cs_terms_need_normals(&sheet.system, CS_PART_LINEARISED));
    sheet_close(&sheet);
    sheet_open(&sheet, 0, SCENE, "\"drag\": 0.3");
    ck_assert(!cs_terms_need_normals(&sheet.system, CS_PART_ALL));
    sheet_close(&sheet);
}

/* in the order of the sum, and only those with something to add */
TEST(scene_has_only_its_terms) {
    static const struct {
        const char *forces;
        const struct cs_term *terms[4];
    } rows[] = {
        {"\"gravity\": [0, 0, 0]", {&cs_term_springs}},
        {"", {&cs_term_springs, &cs_term_gravity}},
        {"\"gravity\": [0, 0, 0], \"drag\": 1", {&cs_term_springs, &cs_term_drag}},
        {EVERYTHING, {&cs_term_springs, &cs_term_gravity, &cs_term_drag, &cs_term_wind}},
    };
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        struct sheet sheet;
        sheet_open(&sheet, 0, SCENE, rows[k].forces);
        for (uint32_t t = 0; t < 4; t++)
            ck_assert_ptr_eq(t < sheet.system.n_terms ? sheet.system.terms[t] : NULL,
                             rows[k].terms[t]);
        sheet_close(&sheet);
    }
}

/* which the Jacobian test does not see, as it never moves them */
TEST(derivative_is_zero_on_pins) {
    struct sheet sheet;
    double d[VALUES], df[VALUES];
    sheet_open(&sheet, 0, SCENE, EVERYTHING);
    sheet_stir(&sheet, 0.2, 2);
    for (size_t i = 0; i < VALUES; i++)
        d[i] = 1 + (double)(i % 7);
    cs_normals_update(&sheet.system, sheet.x);
    cs_terms_jvp(
        &sheet.system,
        &(struct cs_eval){.x = sheet.x, .v = sheet.v, .parts = CS_PART_ALL, .dx = d, .dv = d},
        df);
    SHEET_ASSERT_AT(&sheet, df, 5, 0, 0, 0, 0);
    ck_assert_double_ne(df[6], 0);
    sheet_close(&sheet);
}

/* two broad grids about a narrow one, whose rows are packed, and a single row */
#define ROWS                                                                                   \
    "{\"bodies\": [{\"cloth\": {\"grid\": [40, 50]}, \"springs\": {\"damping\": 0.2}, "        \
    "\"mass\":"                                                                                \
    " {\"total\": 1}, \"pins\": [\"top\", 500]}, {\"cloth\": {\"grid\": [7, 90]}, \"mass\":"   \
    " {\"total\": 1}}, {\"cloth\": {\"grid\": [30, 1]}, \"mass\": {\"total\": 1}},"            \
    " {\"cloth\": {\"grid\": [300, 9]}, \"mass\": {\"total\": 1}}], \"forces\": {\"drag\": "   \
    "0.1 %s}}"

/* What a loop after the force has been given. */
struct moved {
    struct sheet sheet;
    double *f, *found; /* (3,n) of the force, and as the loop found it */
    unsigned *visits;  /* (n) */
    atomic_uint ranges;
};

/* Leaves nothing of the state of its particles: a force that reads it later is not finite. */
static void spoil(void *arg, size_t begin, size_t end) {
    struct moved *moved = arg;
    const size_t n = moved->sheet.n;
    atomic_fetch_add(&moved->ranges, 1);
    for (size_t i = begin; i < end; i++) {
        moved->visits[i]++;
        for (size_t k = i; k < 3 * n; k += n) {
            moved->found[k] = moved->f[k];
            moved->sheet.x[k] = moved->sheet.v[k] = (double)NAN;
        }
    }
}

/* The force, and a loop after it that spoils the state, against the force alone. Returns the
 * number of ranges of the loop. */
static unsigned check_loop_after_force(uint32_t threads, const char *forces) {
    struct moved moved = {.ranges = 0};
    struct cs_error error = {0};
    cs_pool_start(threads, &error);
    UNIT_ASSERT_OK(&error);
    sheet_open(&moved.sheet, 0, ROWS, forces);
    sheet_stir(&moved.sheet, 0.01, 1);
    const size_t n = moved.sheet.n, bytes = 3 * n * sizeof(double);
    double *alone = malloc(bytes);
    moved.f = malloc(bytes), moved.found = malloc(bytes);
    moved.visits = calloc(n, sizeof *moved.visits);
    ck_assert(alone && moved.f && moved.found && moved.visits);
    const struct cs_eval at = {.x = moved.sheet.x, .v = moved.sheet.v, .parts = CS_PART_ALL};
    if (cs_terms_need_normals(&moved.sheet.system, at.parts))
        cs_normals_update(&moved.sheet.system, at.x);
    cs_terms_force(&moved.sheet.system, &at, alone);
    memset(moved.f, 1, bytes);
    cs_terms_force_then(&moved.sheet.system, &at, moved.f,
                        &(struct cs_loop){.part = spoil, .arg = &moved});
    ck_assert_mem_eq(moved.found, alone, bytes);
    for (size_t i = 0; i < n; i++)
        ck_assert_uint_eq(moved.visits[i], 1);
    free(alone), free(moved.f), free(moved.found), free(moved.visits);
    sheet_close(&moved.sheet);
    cs_pool_stop();
    return moved.ranges;
}

TEST(rows_move_before_the_next_are_summed) {
    for (uint32_t threads = 1; threads <= 4; threads++)
        ck_assert_uint_gt(check_loop_after_force(threads, ""), 4);
}

/* the wind's power belongs to the whole sum */
TEST(other_forces_are_summed_before_the_loop) {
    const char *wind = ", \"wind\": {\"direction\": [0, 0, 1], \"strength\": 2}";
    check_loop_after_force(3, wind);
    ck_assert_uint_le(check_loop_after_force(1, wind), 2);
}

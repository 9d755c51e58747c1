/* Grids made into particles: places, areas and pins. */
#include "scene/body_keys.h"
#include "scene/body_particles.h"
#include "sheet.h"

#define BODY                                                                                   \
    "{\"bodies\": [{\"cloth\": {\"grid\": [%d, %d], \"size\": [3, 2]%s}, \"mass\": "           \
    "{\"total\": 1}, \"pins\": [%s]}]}"

static void start(struct sheet *sheet, int columns, int rows, const char *more,
                  const char *pins) {
    sheet_open(sheet, 0, BODY, columns, rows, more, pins);
}

/* x = (j / (columns - 1) - 1/2) width, y = (1/2 - i / (rows - 1)) height (cloth thesis,
 * eq. 4.1); flat: what was up lies at -z */
TEST(grid_is_spread_about_its_centre) {
    for (int flat = 0; flat < 2; flat++) {
        struct sheet sheet;
        start(&sheet, 5, 3, flat ? ", \"start\": \"flat\"" : "", "");
        ck_assert_uint_eq(sheet.n, 15);
        for (size_t i = 0; i < 3; i++)
            for (size_t j = 0; j < 5; j++) {
                const double x = -1.5 + 0.75 * (double)j, up = 1 - (double)i;
                SHEET_ASSERT_AT(&sheet, sheet.x, 5 * i + j, x, flat ? 0 : up, flat ? -up : 0,
                                1e-15);
            }
        sheet_close(&sheet);
    }
}

/* one particle of a row or column of one stands in the middle */
TEST(single_rows_lie_in_the_middle) {
    struct sheet sheet;
    start(&sheet, 1, 1, "", "");
    SHEET_ASSERT_AT(&sheet, sheet.x, 0, 0, 0, 0, 0);
    sheet_close(&sheet);
    start(&sheet, 3, 1, "", "");
    SHEET_ASSERT_AT(&sheet, sheet.x, 0, -1.5, 0, 0, 0);
    SHEET_ASSERT_AT(&sheet, sheet.x, 2, 1.5, 0, 0, 0);
    sheet_close(&sheet);
    start(&sheet, 1, 2, "", "");
    SHEET_ASSERT_AT(&sheet, sheet.x, 1, 0, -1, 0, 0);
    sheet_close(&sheet);
}

/* A quarter turn about z takes (x, y, z) to (-y, x, z); the same as quaternions of any length
 * and as a matrix. The shift comes after it. */
TEST(place_is_a_turn_and_a_shift) {
    static const char *const places[] = {"\"rotate\": [0, 0, 1, 1]",
                                         "\"rotate\": [0, 0, -0.2, -0.2]",
                                         "\"matrix\": [0, -1, 0, 1, 0, 0, 0, 0, 1]"};
    for (size_t k = 0; k < 3; k++) {
        struct sheet sheet;
        char more[160];
        snprintf(more, sizeof more, ", \"place\": {\"translate\": [10, 20, 30], %s}",
                 places[k]);
        start(&sheet, 2, 2, more, "");
        SHEET_ASSERT_AT(&sheet, sheet.x, 0, 10 - 1, 20 - 1.5, 30, 1e-14);
        SHEET_ASSERT_AT(&sheet, sheet.x, 1, 10 - 1, 20 + 1.5, 30, 1e-14);
        SHEET_ASSERT_AT(&sheet, sheet.x, 2, 10 + 1, 20 - 1.5, 30, 1e-14);
        sheet_close(&sheet);
    }
}

/* stretch moves the particles and leaves rest lengths and areas; the bump is
 * sin(pi a) sin(pi b) along the normal, to the last bits */
TEST(start_may_be_stretched_and_bumped) {
    const double pi = acos(-1);
    for (int flat = 0; flat < 2; flat++) {
        struct sheet sheet;
        start(&sheet, 5, 3,
              flat ? ", \"start\": \"flat\", \"stretch\": [2, 0.5], \"bump\": 0.3"
                   : ", \"stretch\": [2, 0.5], \"bump\": 0.3",
              "");
        for (size_t i = 0; i < 3; i++)
            for (size_t j = 0; j < 5; j++) {
                const double x = -3 + 1.5 * (double)j, up = 0.5 - 0.5 * (double)i;
                const double out = 0.3 * sin(pi * (double)j / 4) * sin(pi * (double)i / 2);
                SHEET_ASSERT_AT(&sheet, sheet.x, 5 * i + j, x, flat ? out : up,
                                flat ? -up : out, 1e-15);
            }
        ck_assert_double_eq_tol(sheet.system.springs.runs[0].length, 0.75, 1e-15);
        ck_assert_double_eq_tol(cs_body_area(cs_scene_bodies(&sheet.scene), 6), 0.75, 1e-15);
        sheet_close(&sheet);
    }
}

/* a turn of 120 degrees about (1, 1, 1) takes x to y, y to z and z to x */
TEST(quaternion_turns_the_right_way) {
    struct sheet sheet;
    start(&sheet, 2, 2, ", \"place\": {\"rotate\": [1, 1, 1, 1]}", "");
    SHEET_ASSERT_AT(&sheet, sheet.x, 0, 0, -1.5, 1, 1e-15);
    SHEET_ASSERT_AT(&sheet, sheet.x, 3, 0, 1.5, -1, 1e-15);
    sheet_close(&sheet);
}

/* corners a quarter, edges a half, inside a whole cell: their sum is the size */
TEST(area_shares_add_up_to_the_size) {
    static const int grids[][2] = {{1, 1}, {2, 1}, {1, 7}, {2, 2}, {3, 5}, {40, 31}};
    for (size_t k = 0; k < sizeof grids / sizeof *grids; k++) {
        struct sheet sheet;
        start(&sheet, grids[k][0], grids[k][1], "", "");
        double sum = 0;
        for (int i = 0; i < grids[k][1]; i++)
            for (int j = 0; j < grids[k][0]; j++)
                sum += cs_body_area(cs_scene_bodies(&sheet.scene),
                                    (uint32_t)(i * grids[k][0] + j));
        ck_assert_double_eq_tol(sum, 6, 1e-12);
        sheet_close(&sheet);
    }
    struct sheet sheet;
    start(&sheet, 4, 3, "", "");
    const struct cs_body *body = cs_scene_bodies(&sheet.scene);
    ck_assert_double_eq_tol(cs_body_area(body, 0), 0.25, 1e-15);
    ck_assert_double_eq_tol(cs_body_area(body, 9), 0.5, 1e-15);
    ck_assert_double_eq_tol(cs_body_area(body, 7), 0.5, 1e-15);
    ck_assert_double_eq_tol(cs_body_area(body, 6), 1, 1e-15);
    sheet_close(&sheet);
}

/* fails unless exactly the particles marked x in the picture of rows are pinned */
static void check_pins(const char *pins, const char *picture) {
    struct sheet sheet;
    start(&sheet, 4, 3, "", pins);
    for (size_t i = 0; i < 12; i++)
        ck_assert_msg((sheet.system.inv_mass[i] == 0) == (picture[i + i / 4] == 'x'),
                      "pins %s: particle %zu", pins, i);
    sheet_close(&sheet);
}

TEST(every_pin_name_means_its_particles) {
    static const char *const pictures[] = {
        "x... .... ....", "...x .... ....", ".... .... x...",
        ".... .... ...x", "xxxx .... ....", ".... .... xxxx",
        "x... x... x...", "...x ...x ...x", "xxxx x..x xxxx"};
    size_t n = 0;
    for (; cs_pin_names[n]; n++) {
        char pin[40];
        ck_assert_uint_lt(n, sizeof pictures / sizeof *pictures);
        snprintf(pin, sizeof pin, "\"%s\"", cs_pin_names[n]);
        check_pins(pin, pictures[n]);
    }
    ck_assert_uint_eq(n, sizeof pictures / sizeof *pictures);
}

TEST(pins_by_index_and_box) {
    check_pins("", ".... .... ....");
    check_pins("0, 6, 11", "x... ..x. ...x");
    check_pins("{\"index\": 5}, 5", ".... .x.. ....");
    // x from -1.5 to 1.5, y from 1 to -1; the border of the box is inside
    check_pins("{\"box\": {\"min\": [-0.5, 0, 0], \"max\": [0.6, 1, 0]}}", ".xx. .xx. ....");
    check_pins("{\"box\": {\"min\": [-9, -9, 0.1], \"max\": [9, 9, 9]}}", ".... .... ....");
    check_pins("\"left\", {\"box\": {\"min\": [1.4, -9, -9], \"max\": [9, 0, 9]}}, 0",
               "x... x..x x..x");
}

/* the box means where the particles start, not the grid */
TEST(box_is_in_the_scene) {
    struct sheet sheet;
    start(&sheet, 2, 2, ", \"place\": {\"translate\": [0, 100, 0]}",
          "{\"box\": {\"min\": [-9, 100, -9], \"max\": [9, 109, 9]}}");
    ck_assert_uint_eq(sheet.system.n_pinned, 2);
    ck_assert_uint_eq(sheet.system.pinned[0], 0);
    ck_assert_uint_eq(sheet.system.pinned[1], 1);
    sheet_close(&sheet);
}

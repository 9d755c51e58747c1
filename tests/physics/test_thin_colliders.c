/* Contact by projection with colliders that a particle passes in one step: nothing comes to the
 * other side, and nothing gains energy, with any method. With the argument "all" more phases of
 * a step, and all methods everywhere. */
#include "methods.h"

#include <math.h>
#include <stdio.h>

/* 16 x 16 particles, 0.5 m, of default springs; column and row 8 are 1/60 m off the middle */
#define OFF (1 / 60.0)
#define SHEET                                                                                  \
    "\"bodies\": [{\"cloth\": {\"grid\": [16, 16], \"size\": [0.5, 0.5], \"start\": \"flat\"," \
    " \"place\": {\"translate\": [0, %.17g, 0]}, \"velocity\": [0, %.17g, 0]},"                \
    " \"mass\": {\"areal_density\": 0.2}, \"springs\": {\"damping\": 0.02}}]"
#define BOX(centre, size) "{\"box\": {\"centre\": [" centre "], \"size\": [" size "]}}"
#define FALL(collider)    "{" SHEET ", \"contact\": \"project\", \"colliders\": [" collider "]}"

/* lowest height of rows and columns [begin, end) */
static double lowest(const struct fixture *sheet, size_t begin, size_t end) {
    double least = HUGE_VAL;
    for (size_t i = begin; i < end; i++)
        for (size_t j = begin; j < end; j++)
            least = fmin(least, sheet->x[sheet->n + 16 * i + j]);
    return least;
}

/* one of each kind of step loop, for what takes longer */
static struct methods some_methods(void) {
    struct methods methods = methods_find_all(&(struct methods_query){.test = "thin"});
    size_t kept = 0, kinds = 0;
    for (size_t k = 0; k < methods.n; k++)
        if ((suite_all || methods_is(methods.list[k].text, "implicit-linearised") ||
             methods_is(methods.list[k].text, "tr-bdf2") ||
             methods_is(methods.list[k].text, "velocity-verlet") ||
             methods_is(methods.list[k].text, "fast-mass-spring") ||
             methods_is(methods.list[k].text, "xpbd") ||
             methods_is(methods.list[k].text, "cvode-bdf")) &&
            suite_takes(kinds++, 2))
            methods.list[kept++] = methods.list[k];
    methods.n = kept;
    return methods;
}

/* Drops the sheet from `height` on a plate of 2 cm that is larger: it lies there. The run
 * begins when it has fallen to `gap` above the plate. */
static void drop(const char *method, double height, double gap, uint32_t frames) {
    struct fixture sheet;
    struct fixture_log log;
    fixture_open(&sheet, method, FALL(BOX("0, 0, 0", "0.6, 0.02, 0.6")), 0.01 + gap,
                 -sqrt(2 * 9.81 * (height - gap)));
    fixture_start_logged(&sheet, &log);
    fixture_frames(&sheet, frames);
    ck_assert_msg(fabs(lowest(&sheet, 0, 16) - 0.01) <= 1e-6, "%s from %g m: %.6f m", method,
                  height, lowest(&sheet, 0, 16));
    ck_assert_msg(log.largest <= log.first + 1e-3, "%s from %g m: %.4g of %.4g J", method,
                  height, log.largest, log.first);
    fixture_close(&sheet);
}

TEST(plate_holds_a_sheet_that_falls) {
    const struct methods methods = methods_find_all(&(struct methods_query){.test = "thin"});
    for (size_t k = 0; k < methods.n; k++) {
        drop(methods.list[k].text, 0.5, 0.05, 12);
        if (methods_is(methods.list[k].text, "implicit-block"))
            continue; // its drag keeps the sheet in the air
        for (int phase = 0; phase < (suite_all ? 8 : 2); phase++)
            drop(methods.list[k].text, 5 + 0.02 * phase, 0.2 + 0.02 * phase, 11);
    }
}

/* A plate that is smaller than the sheet, which drapes over it: the middle stays above. */
TEST(small_plate_holds_the_middle) {
    const struct methods methods = some_methods();
    for (size_t k = 0; k < methods.n; k++)
        for (int phase = 0; phase < (suite_all ? 8 : 2); phase++) {
            const char *method = methods.list[k].text;
            struct fixture sheet;
            struct fixture_log log;
            fixture_open(&sheet, method, FALL(BOX("0, 0, 0", "0.3, 0.02, 0.3")),
                         0.3 + 0.02 * phase, -10.0);
            fixture_start_logged(&sheet, &log);
            fixture_frames(&sheet, 12);
            ck_assert_msg(lowest(&sheet, 6, 10) >= 0.005, "%s, phase %d: %.4f m", method, phase,
                          lowest(&sheet, 6, 10));
            ck_assert_msg(log.largest <= 1.01 * log.first, "%s, phase %d: %.4g of %.4g J",
                          method, phase, log.largest, log.first);
            fixture_close(&sheet);
        }
}

/* A plate that stands on its edge, 2 cm wide and 60 cm high, under column 8: within 30 ms of
 * the impact, in which free fall goes 30 cm, the column is on the edge or beside it. */
TEST(edge_holds_the_column_above_it) {
    const struct methods methods = some_methods();
    for (size_t k = 0; k < methods.n; k++) {
        const char *method = methods.list[k].text;
        struct fixture sheet;
        struct fixture_log log;
        double least = HUGE_VAL;
        fixture_open(&sheet, method, FALL(BOX("0.016666666666666666, 0, 0", "0.02, 0.6, 0.8")),
                     0.5, -10.0);
        fixture_start_logged(&sheet, &log);
        fixture_frames(&sheet, 3);
        for (size_t i = 0; i < 16; i++)
            least = fmin(least, sheet.x[sheet.n + 16 * i + 8]);
        ck_assert_msg(least >= 0.24, "%s: %.4f m", method, least);
        ck_assert_msg(log.largest <= 1.01 * log.first, "%s: %.4g of %.4g J", method,
                      log.largest, log.first);
        fixture_close(&sheet);
    }
}

/* A plate of 2 cm that comes from below at 10 m/s carries a sheet at rest along: at its end, at
 * 1.51 m, the middle is in front of it. */
TEST(moving_plate_carries_a_sheet) {
    const struct methods methods = some_methods();
    for (size_t k = 0; k < methods.n; k++) {
        const char *method = methods.list[k].text;
        struct fixture sheet;
        fixture_open(
            &sheet, method,
            "{" SHEET ", \"contact\": \"project\", \"colliders\": [" BOX(
                "0, -0.5, 0", "0.3, 0.02, 0.3") "], \"forces\": {\"gravity\": [0, 0, 0]}, "
                                                "\"events\": [{\"from\": 0, "
                                                "\"to\": 0.2, \"move\": {\"collider\": 0, "
                                                "\"path\": [{\"at\": 0.2, "
                                                "\"point\": [0, 2, 0]}]}}]}",
            0.2, 0.0);
        fixture_start(&sheet);
        fixture_frames(&sheet, 12);
        ck_assert_msg(lowest(&sheet, 6, 10) >= 1.505, "%s: %.4f m", method,
                      lowest(&sheet, 6, 10));
        fixture_close(&sheet);
    }
}

/* A blade of 2 cm that turns by 30 rad/s against the sheet above it: all of that stays on the
 * side on which it started, although the blade moves 37 cm a frame there. */
TEST(turning_blade_sweeps_a_sheet) {
    const struct methods methods = some_methods();
    for (size_t k = 0; k < methods.n; k++) {
        const char *method = methods.list[k].text;
        struct fixture sheet;
        fixture_open(&sheet, method,
                     "{" SHEET ", \"contact\": \"project\", \"colliders\": [" BOX(
                         "0.5, 0, 0", "2, 0.02, 0.8") "], \"forces\": {\"gravity\": [0, 0, "
                                                      "0]}, \"events\": [{\"from\": 0, "
                                                      "\"to\": 1, \"move\": {\"collider\": 0, "
                                                      "\"spin\": [0, 0, -30]}}]}",
                     0.1, 0.0);
        fixture_start(&sheet);
        for (uint32_t frame = 1; frame <= 3; frame++) {
            const double a = -30.0 * frame / 60;
            fixture_frames(&sheet, 1);
            for (size_t i = 0; i < sheet.n; i++) {
                const double x = sheet.x[i] - 0.5, y = sheet.x[sheet.n + i];
                // in the frame of the blade, which turns about its middle
                const double along = cos(a) * x + sin(a) * y, above = cos(a) * y - sin(a) * x;
                ck_assert_msg(fabs(along) > 1 || above > 0.005,
                              "%s, frame %u: particle %zu is at %.3f, %.4f m", method, frame, i,
                              along, above);
            }
        }
        fixture_close(&sheet);
    }
}

/* A sheet that may start behind the surface never comes to the side that is farther away. It
 * leaves as far as the limit of energy lets it. */
TEST(sheet_inside_stays_on_the_nearest_side) {
    static const double heights[] = {0.003, -0.003};
    const struct methods methods = some_methods();
    for (size_t k = 0; k < methods.n; k++)
        for (int side = 0; side < 2; side++) {
            struct fixture sheet;
            struct fixture_log log;
            fixture_open(&sheet, methods.list[k].text,
                         "{" SHEET ", \"colliders\": [" BOX(
                             "0, 0, 0", "0.6, 0.02, 0.6") "], \"contact\": {\"law\": "
                                                          "\"project\", \"start\": \"allow\"}}",
                         heights[side], 0.0);
            fixture_start_logged(&sheet, &log);
            fixture_frames(&sheet, 10);
            const double y = lowest(&sheet, 0, 16);
            ck_assert_msg(side ? y < -0.0025 : y > 0.0025, "%s: %.4f m", methods.list[k].text,
                          y);
            ck_assert_double_le(log.largest, log.first + 1e-4);
            fixture_close(&sheet);
        }
}

/* What a diagram of a comparison shows: front, ranges, ticks, which curves, bars and crosses.
 */
#include "study/compare/compare_curves.h"

#include "scene.h"

#include <math.h>
#include <string.h>

enum { SERIES = 20, EACH = 5, CELLS = SERIES * EACH };

static struct cs_cell cells[CELLS];

/* A number in 0..1 that looks like none of its neighbours. */
static double noise(unsigned k) {
    return (double)((k * 2654435761u) >> 8 & 0xffff) / 65536;
}

/* Series of EACH cells over four decades of time; every seventh cell blew up. */
static struct cs_plot_settings make(void) {
    for (unsigned k = 0; k < CELLS; k++) {
        char name[16];
        snprintf(name, sizeof name, "s%u", k / EACH);
        cs_cell_init(cells + k, name);
        snprintf(cells[k].family, sizeof cells[k].family, "%s", cs_family_names[k / EACH % 5]);
        snprintf(cells[k].outcome, sizeof cells[k].outcome, "%s",
                 k % 7 == 6 ? "blew up: not finite" : "finished");
        cells[k].cpu = pow(10, -4 + 4 * noise(k));
        cells[k].error = pow(10, -9 + 6 * noise(k + 1000));
        cells[k].runs = k % 2 ? 5 : 1;
        cells[k].cpu_low = 0.8 * cells[k].cpu;
        cells[k].cpu_high = 1.5 * cells[k].cpu;
    }
    return (struct cs_plot_settings){
        .cells = cells, .n = CELLS, .x = cs_column_find("cpu"), .y = cs_column_find("error")};
}

static bool is_beaten(const struct cs_plot_settings *settings, uint32_t k) {
    for (uint32_t i = 0; i < settings->n; i++)
        if (i != k && cs_cell_is_finished(cells + i) && cells[i].cpu <= cells[k].cpu &&
            cells[i].error <= cells[k].error)
            return true;
    return false;
}

/* against the definition: no other cell is both cheaper and more accurate */
TEST(front_is_what_nothing_beats) {
    const struct cs_plot_settings settings = make();
    struct cs_curves curves;
    bool on[CELLS] = {false};
    double last = 0;
    cs_curves_make(&curves, &settings);
    for (uint32_t k = UINT32_MAX; cs_curves_front(&curves, &k); last = cells[k].cpu) {
        ck_assert_double_gt(cells[k].cpu, last);
        on[k] = true;
    }
    for (uint32_t k = 0; k < CELLS; k++)
        ck_assert_msg(!cs_cell_is_finished(cells + k) || on[k] == !is_beaten(&settings, k),
                      "cell %u: on the front %d", k, on[k]);
}

TEST(no_front_over_what_costs_nothing) {
    struct cs_plot_settings settings = make();
    struct cs_curves curves;
    uint32_t k = UINT32_MAX;
    for (uint32_t c = 0; c < CELLS; c++)
        cells[c].step = cells[c].cpu;
    settings.x = cs_column_find("step");
    cs_curves_make(&curves, &settings);
    ck_assert(!cs_curves_front(&curves, &k));
}

TEST(twelve_curves_with_what_is_on_the_front) {
    const struct cs_plot_settings settings = make();
    struct cs_curves curves;
    uint32_t drawn = 0, least = CELLS, most_left = 0;
    bool styles[CS_CURVES_DRAWN] = {false};
    cs_curves_make(&curves, &settings);
    ck_assert_uint_eq(curves.n, SERIES);
    for (uint32_t c = 0; c < curves.n; c++) {
        const struct cs_curve *curve = curves.list + c;
        if (curve->style < 0) {
            most_left = curve->on_front > most_left ? curve->on_front : most_left;
            continue;
        }
        ck_assert_int_lt(curve->style, CS_CURVES_DRAWN);
        ck_assert(!styles[curve->style]);
        styles[curve->style] = true;
        least = curve->on_front < least ? curve->on_front : least;
        drawn++;
    }
    ck_assert_uint_eq(drawn, CS_CURVES_DRAWN);
    ck_assert_uint_le(most_left, least);
    ck_assert_uint_eq(cs_curves_left_out(&curves), SERIES - CS_CURVES_DRAWN);
}

TEST(a_family_is_drawn_whole_and_alone) {
    struct cs_plot_settings settings = make();
    struct cs_curves curves;
    settings.family = "implicit";
    cs_curves_make(&curves, &settings);
    for (uint32_t c = 0; c < curves.n; c++) {
        const bool mine = !strcmp(cells[curves.list[c].first].family, "implicit");
        ck_assert_int_eq(curves.list[c].style >= 0, mine);
        ck_assert_uint_eq(mine ? 0 : curves.list[c].failed_marks, 0);
    }
    ck_assert_uint_eq(cs_curves_left_out(&curves), 0);
}

static double least_of(double a, double b) {
    return a < b ? a : b;
}

/* Points, quartiles and crosses are within the ranges, and no range is more than a tenth wider
 * than what is in it. */
TEST(axes_are_on_the_data) {
    const struct cs_plot_settings settings = make();
    struct cs_curves curves;
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL}, cross;
    cs_curves_make(&curves, &settings);
    for (uint32_t k = 0; k < CELLS; k++) {
        const struct cs_cell *cell = cells + k;
        const bool bar = cs_curves_quartiles(&settings, cell);
        if (cs_curves_cross(&curves, cell, &cross)) {
            ck_assert(log10(cross) > curves.x[0] && log10(cross) < curves.x[1]);
            continue;
        }
        ck_assert_int_eq(bar, k % 2);
        low[0] = least_of(low[0], log10(bar ? cell->cpu_low : cell->cpu));
        high[0] = -least_of(-high[0], -log10(bar ? cell->cpu_high : cell->cpu));
        low[1] = least_of(low[1], log10(cell->error));
        high[1] = -least_of(-high[1], -log10(cell->error));
    }
    const double *ranges[] = {curves.x, curves.y};
    for (int axis = 0; axis < 2; axis++) {
        ck_assert(ranges[axis][0] < low[axis] && ranges[axis][1] > high[axis]);
        ck_assert_double_lt(ranges[axis][1] - ranges[axis][0], 1.17 * (high[axis] - low[axis]));
    }
    // crosses stand above all points
    ck_assert_double_gt(log10(cs_curves_edge(&curves)), high[1]);
}

/* One cell, or many of one value: an axis has two labels at least, and never more than twenty.
 */
TEST(no_axis_is_without_labels) {
    for (int k = 0; k < 4000; k++) {
        const double start = -12 + 20 * noise((unsigned)k);
        const double span = log10(4) + 25 * noise((unsigned)k + 5000) * noise((unsigned)k);
        const double range[2] = {start, start + span};
        struct cs_tick ticks[CS_TICKS_MAX];
        const uint32_t n = cs_curves_ticks(range, ticks);
        uint32_t labels = 0;
        for (uint32_t i = 0; i < n; i++) {
            ck_assert(ticks[i].position >= range[0] && ticks[i].position <= range[1]);
            ck_assert_double_eq_tol(ticks[i].position, ticks[i].decade + log10(ticks[i].digit),
                                    1e-12);
            labels += ticks[i].label;
        }
        ck_assert_msg(labels >= 2 && labels <= 20, "%u labels from 1e%g over %g decades",
                      labels, start, span);
    }
    struct cs_plot_settings settings = make();
    struct cs_curves curves;
    settings.n = 1;
    cs_curves_make(&curves, &settings);
    ck_assert_double_ge(curves.x[1] - curves.x[0], log10(4) - 1e-12);
}

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
    struct cs_spot spots[CELLS];
    cs_spots_find(&settings, settings.x, spots);
    for (uint32_t k = 0; k < CELLS; k++) {
        const bool front = cs_cell_is_finished(cells + k) && !is_beaten(&settings, k);
        ck_assert_msg(spots[k].on_front == front, "cell %u: on the front %d", k, !front);
    }
}

TEST(no_front_over_what_costs_nothing) {
    const struct cs_plot_settings settings = make();
    struct cs_spot spots[CELLS];
    for (uint32_t k = 0; k < CELLS; k++)
        cells[k].step = cells[k].cpu;
    cs_spots_find(&settings, cs_column_find("step"), spots);
    for (uint32_t k = 0; k < CELLS; k++)
        ck_assert(!spots[k].on_front);
}

static void find(const struct cs_plot_settings *settings, struct cs_curves *curves) {
    struct cs_spot spots[CELLS];
    cs_spots_find(settings, settings->x, spots);
    cs_curves_make(curves, settings, spots);
}

TEST(twelve_curves_with_what_is_on_the_front) {
    const struct cs_plot_settings settings = make();
    struct cs_curves curves;
    uint32_t drawn = 0, least = CELLS, most_left = 0;
    bool styles[CS_CURVES_DRAWN] = {false};
    find(&settings, &curves);
    ck_assert_uint_eq(curves.n, SERIES);
    for (uint32_t c = 0; c < curves.n; c++) {
        const struct cs_curve *curve = curves.list + c;
        if (!curve->is_chosen) {
            most_left = curve->on_front > most_left ? curve->on_front : most_left;
            continue;
        }
        ck_assert_uint_lt(curve->style, CS_CURVES_DRAWN);
        ck_assert(!styles[curve->style]);
        styles[curve->style] = true;
        least = curve->on_front < least ? curve->on_front : least;
        drawn++;
    }
    ck_assert_uint_eq(drawn, CS_CURVES_DRAWN);
    ck_assert_uint_le(most_left, least);
    ck_assert_uint_eq(curves.n_left_out, SERIES - CS_CURVES_DRAWN);
}

TEST(all_series_are_drawn_on_request) {
    struct cs_plot_settings settings = make();
    struct cs_curves curves;
    settings.all = true;
    find(&settings, &curves);
    for (uint32_t c = 0; c < curves.n; c++)
        ck_assert(curves.list[c].is_chosen);
    ck_assert_uint_eq(curves.n_left_out, 0);
}

/* Points, bars and crosses are within the axes; points have their cells' values. Twice, beside
 * each other: of both panels y is the same. */
TEST(points_are_those_of_the_cells) {
    struct cs_plot_settings settings = make();
    struct cs_diagram plot;
    struct cs_error error = {0};
    settings.second = settings.x;
    settings.width = CS_WIDTH_PAGE;
    ck_assert_int_eq(cs_plot_make(&plot, &settings, &error), CS_OK);
    ck_assert_uint_eq(plot.n_panels, 2);
    ck_assert_uint_eq(plot.columns, 2);
    for (const struct cs_panel *panel = plot.panels; panel < plot.panels + 2; panel++) {
        uint32_t full = 0, crosses = 0;
        for (const struct cs_series *s = panel->series; s < panel->series + panel->n_series;
             s++)
            for (const struct cs_point *p = s->points; s->name && p < s->points + s->n; p++) {
                const double at[] = {cs_plot_axis_at(&panel->x, p->x),
                                     cs_plot_axis_at(&panel->y, p->y)};
                ck_assert(at[0] > 0 && at[0] < 1 && at[1] > 0 && at[1] < 1);
                full += p->mark == CS_MARK_FULL;
                crosses += p->mark == CS_MARK_CROSS;
                // above all points
                ck_assert(p->mark != CS_MARK_CROSS || at[1] > 0.96);
            }
        ck_assert_uint_gt(crosses, 0);
        ck_assert_uint_gt(full, 30);
    }
    cs_plot_finish(&plot);
}

/* A run in search of an error is a hollow mark beside its line; over time only where it was
 * timed in rounds, since one time alone is that of the load. */
TEST(probes_are_not_joined) {
    struct cs_plot_settings settings = make();
    struct cs_diagram plot;
    struct cs_error error = {0};
    settings.n = EACH;
    settings.width = CS_WIDTH_COLUMN;
    cells[2].target = 1e-5;
    cells[2].runs = 1;
    ck_assert_int_eq(cs_plot_make(&plot, &settings, &error), CS_OK);
    const struct cs_series *line = plot.panels->series + plot.panels->n_series - 1;
    ck_assert_uint_eq(line->n, EACH - 1);
    cs_plot_finish(&plot);
    cells[2].runs = 2;
    ck_assert_int_eq(cs_plot_make(&plot, &settings, &error), CS_OK);
    line = plot.panels->series + plot.panels->n_series - 1;
    ck_assert_uint_eq(line->n, EACH);
    for (uint32_t k = 0; k < EACH; k++) {
        ck_assert_int_eq(line->points[k].mark, k == 2 ? CS_MARK_HOLLOW : CS_MARK_FULL);
        ck_assert_int_eq(line->points[k].joined, k != 2);
        ck_assert_double_eq(line->points[k].y, cells[k].error);
    }
    cs_plot_finish(&plot);
}

/* Probes whose own error is far from the median, and quartiles, are within the axes; those of a
 * probe that only one panel shows too, because both have one y axis. */
TEST(what_is_drawn_is_within_the_axes) {
    struct cs_plot_settings settings = make();
    struct cs_diagram plot;
    struct cs_error error = {0};
    settings.n = EACH;
    settings.x = cs_column_find("work");
    settings.second = cs_column_find("cpu");
    for (uint32_t k = 0; k < EACH; k++) {
        cells[k].adaptive = true;
        cells[k].value = 1e-6 * pow(1.05, k);
        cells[k].work = 100 * (k + 1);
    }
    cells[2].target = cells[3].target = 1e-5;
    cells[2].runs = 2;
    cells[2].error = 1e-13;
    cells[3].error = 1e-15;
    cells[3].runs = 1;
    cells[1].cpu_low = 1e-9;
    ck_assert_int_eq(cs_plot_make(&plot, &settings, &error), CS_OK);
    for (const struct cs_panel *panel = plot.panels; panel < plot.panels + 2; panel++) {
        const struct cs_series *s = panel->series + panel->n_series - 1;
        ck_assert_uint_eq(s->n, panel == plot.panels ? EACH : EACH - 1);
        for (uint32_t k = 0; k < s->n; k++) {
            const double x =
                s->points[k].low < s->points[k].high ? s->points[k].low : s->points[k].x;
            ck_assert_double_gt(cs_plot_axis_at(&panel->x, x), 0);
            ck_assert_double_gt(cs_plot_axis_at(&panel->y, s->points[k].y), 0);
        }
        ck_assert_double_eq(panel->y.range[0], plot.panels->y.range[0]);
        ck_assert_double_eq(panel->y.range[1], plot.panels->y.range[1]);
    }
    cs_plot_finish(&plot);
}

/* Errors on a line of slope 1 with noise of a factor: the median is on the line where the noise
 * is symmetric, and the band holds all values of the half decades around, brought to the cell.
 */
TEST(typical_errors_are_medians) {
    struct cs_plot_settings settings = make();
    static const double noise_of[EACH] = {1, 10, 1, 0.1, 1};
    double low, high;
    for (uint32_t k = 0; k < EACH; k++) {
        cells[k].adaptive = true;
        cells[k].value = 1e-6 * pow(1.05, (double)k - 2);
        cells[k].error = 3 * cells[k].value * noise_of[k];
    }
    const double typical = cs_cell_typical(cells, CELLS, cells + 2, settings.y, &low, &high);
    ck_assert_double_eq_tol(typical / cells[2].error, 1, 1e-6);
    // least squares may turn the line by the noise: at most by its factor over the range
    ck_assert(low < 0.11 * typical && low > 0.05 * typical);
    ck_assert(high > 9 * typical && high < 20 * typical);
    cells[0].adaptive = false;
    ck_assert_double_eq(cs_cell_typical(cells, CELLS, cells, settings.y, &low, &high),
                        cells[0].error);
}

/* One cell, or many of one value: an axis has two labels at least, and never more than twenty.
 */
TEST(no_axis_is_without_labels) {
    for (int k = 0; k < 4000; k++) {
        const double start = -12 + 20 * noise((unsigned)k);
        const double span = log10(4) + 25 * noise((unsigned)k + 5000) * noise((unsigned)k);
        const struct cs_plot_axis axis = {.logarithmic = true, .range = {start, start + span}};
        const double *range = axis.range;
        struct cs_tick ticks[CS_TICKS_MAX];
        const uint32_t n = cs_plot_axis_ticks(&axis, ticks);
        uint32_t labels = 0;
        for (uint32_t i = 0; i < n; i++) {
            ck_assert(ticks[i].at >= 0 && ticks[i].at <= 1);
            ck_assert_double_eq_tol(range[0] + ticks[i].at * (range[1] - range[0]),
                                    ticks[i].decade + log10(ticks[i].digit), 1e-12);
            labels += ticks[i].label;
        }
        ck_assert_msg(labels >= 2 && labels <= 20, "%u labels from 1e%g over %g decades",
                      labels, start, span);
    }
    // one value
    struct cs_plot_axis axis = {.logarithmic = true, .range = {2, 2}};
    cs_plot_axis_widen(&axis);
    ck_assert_double_ge(axis.range[1] - axis.range[0], log10(4) - 1e-12);
}

/* Linear axes: ticks at whole multiples of 1, 2 or 5 times a power of 10. */
TEST(linear_ticks_are_round) {
    for (int k = 0; k < 4000; k++) {
        const double start = 200 * noise((unsigned)k) - 100;
        const double span = pow(10, 8 * noise((unsigned)k + 5000) - 4);
        const struct cs_plot_axis axis = {.range = {start, start + span}};
        struct cs_tick ticks[CS_TICKS_MAX];
        const uint32_t n = cs_plot_axis_ticks(&axis, ticks);
        ck_assert_msg(n >= 3 && n <= 11, "%u ticks from %g over %g", n, start, span);
        const double step = ticks[1].value - ticks[0].value;
        const double digit = step / pow(10, floor(log10(step) + 1e-6));
        ck_assert(fabs(digit - 1) < 1e-3 || fabs(digit - 2) < 1e-3 || fabs(digit - 5) < 1e-3);
        // a label at every tenth tick has a tenth of the digits
        for (uint32_t i = 0; i < n; i++)
            ck_assert(ticks[i].decade % 10 != 0 ||
                      fabs(remainder(ticks[i].value, 10 * step)) < 1e-3 * step);
    }
}

/* Twelve series differ without their colours. */
TEST(twelve_styles_differ_in_grey) {
    for (uint32_t a = 0; a < CS_STYLES; a++)
        for (uint32_t b = 0; b < a; b++) {
            const struct cs_style one = cs_style_of(a), other = cs_style_of(b);
            ck_assert(one.dash != other.dash || one.marker != other.marker);
            ck_assert_uint_ne(one.colour, other.colour);
        }
}

/* Labels as journals print them: a true minus sign, and powers of 10 instead of an e. */
TEST(labels_are_for_print) {
    static const struct {
        struct cs_tick tick;
        const char *label, *power;
    } known[] = {
        {{.value = 0, .plain = true}, "0", ""},
        {{.value = -0.02, .plain = true}, "\u22120.02", ""},
        {{.value = -2e-7, .plain = true}, "\u22122·10", "\u22127"},
        {{.value = 1e6, .plain = true}, "10", "6"},
        {{.value = 2500000, .plain = true}, "2.5·10", "6"},
        {{.value = 1e-12, .digit = 1, .decade = -12}, "10", "\u221212"},
        {{.value = 5e3, .digit = 5, .decade = 3}, "5·10", "3"},
    };
    for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
        char label[CS_TICK_BYTES], power[CS_TICK_BYTES];
        cs_tick_print(&known[k].tick, label, power);
        ck_assert_str_eq(label, known[k].label);
        ck_assert_str_eq(power, known[k].power);
    }
}

/* Chooses the content of a diagram of a comparison: curves, ranges, ticks, front. */
#include "study/compare/compare_curves.h"

#include <math.h>
#include <string.h>

const char *const cs_curve_colours[CS_CURVE_COLOURS] = {
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#000000", "#e69f00", "#56b4e9"};

/* Room for crosses at the upper edge, as a fraction of the range. */
#define CROSS_ROOM 0.06

/* Only errors of position have an error bar of the reference. */
static bool is_position_error(const struct cs_column *column) {
    return strstr(column->name, "error") && !strcmp(column->unit, "m");
}

bool cs_curves_point(const struct cs_plot_settings *settings, const struct cs_cell *cell,
                     double *x, double *y) {
    *x = cs_cell_number(cell, settings->x);
    *y = cs_cell_number(cell, settings->y);
    const bool known = !is_position_error(settings->y) || !(cell->bar > 0) || *y >= cell->bar;
    const bool asked = !settings->family || !strcmp(settings->family, cell->family);
    return asked && cs_cell_is_finished(cell) && isfinite(*x) && isfinite(*y) && *x > 0 &&
           *y > 0 && known;
}

bool cs_curves_quartiles(const struct cs_plot_settings *settings, const struct cs_cell *cell) {
    return !strcmp(settings->x->name, "cpu") && cell->runs > 1 && cell->cpu_low > 0 &&
           isfinite(cell->cpu_high);
}

bool cs_curves_cross(const struct cs_curves *curves, const struct cs_cell *cell, double *x) {
    const char *family = curves->settings->family;
    const double found = log10(cs_cell_number(cell, curves->settings->x));
    const double margin = 0.01 * (curves->x[1] - curves->x[0]);
    if (cs_cell_is_finished(cell) || !isfinite(found) ||
        (family && strcmp(family, cell->family) != 0))
        return false;
    *x = pow(10, fmin(fmax(found, curves->x[0] + margin), curves->x[1] - margin));
    return true;
}

/* True for a column that smaller values make better: the front needs such an axis. */
static bool is_cost(const struct cs_column *column) {
    static const char *const names[] = {"cpu",    "wall",       "work",   "evals", "jvps",
                                        "solves", "iterations", "setups", "steps", "newton"};
    for (size_t k = 0; k < sizeof names / sizeof *names; k++)
        if (!strcmp(column->name, names[k]))
            return true;
    return false;
}

/* Scans all cells for the cheapest one that is more accurate than the last: O(n) per cell. */
bool cs_curves_front(const struct cs_curves *curves, uint32_t *k) {
    const struct cs_plot_settings *settings = curves->settings;
    double x, y, last = HUGE_VAL, least = HUGE_VAL, best = HUGE_VAL;
    if (*k != UINT32_MAX && cs_curves_point(settings, settings->cells + *k, &x, &y))
        last = y;
    *k = UINT32_MAX;
    // of those more accurate than the last the cheapest
    for (uint32_t i = 0; i < settings->n && is_cost(settings->x); i++)
        if (cs_curves_point(settings, settings->cells + i, &x, &y) && y < last &&
            (x < least || (x <= least && y < best))) {
            least = x;
            best = y;
            *k = i;
        }
    return *k != UINT32_MAX;
}

/* Widens a range by a margin, and to at least a factor of four. */
static void widen(double range[2]) {
    if (!(range[0] <= range[1]))
        range[0] = 0, range[1] = 1;
    // a factor of four has two digits at least, so that no axis is without a label
    const double margin = fmax(0.04 * (range[1] - range[0]), 0.05);
    const double lacking = fmax(0, log10(4) - (range[1] - range[0]) - 2 * margin);
    range[0] -= margin + lacking / 2;
    range[1] += margin + lacking / 2;
}

/* Extends a range by a value above 0. */
static void include(double range[2], double value) {
    range[0] = fmin(range[0], log10(value));
    range[1] = fmax(range[1], log10(value));
}

static void find_ranges(struct cs_curves *curves) {
    const struct cs_plot_settings *settings = curves->settings;
    curves->x[0] = curves->y[0] = HUGE_VAL;
    curves->x[1] = curves->y[1] = -HUGE_VAL;
    for (uint32_t k = 0; k < settings->n; k++) {
        const struct cs_cell *cell = settings->cells + k;
        double x, y;
        if (!cs_curves_point(settings, cell, &x, &y))
            continue;
        include(curves->x, x);
        include(curves->y, y);
        if (cs_curves_quartiles(settings, cell)) {
            include(curves->x, cell->cpu_low);
            include(curves->x, cell->cpu_high);
        }
        if (is_position_error(settings->y))
            curves->error_bar = fmax(curves->error_bar, cell->bar);
    }
    widen(curves->x);
    widen(curves->y);
}

static int family_of(const struct cs_cell *cell) {
    for (int k = 0; cs_family_names[k]; k++)
        if (!strcmp(cell->family, cs_family_names[k]))
            return k;
    return 0;
}

/* Cost over that of the cheapest cell at least as accurate, as a decimal logarithm: 0 on the
 * front. */
static double excess_of(const struct cs_plot_settings *settings, const struct cs_cell *cell) {
    double x, y, other, error, least;
    if (!cs_curves_point(settings, cell, &x, &y))
        return HUGE_VAL;
    least = x;
    for (uint32_t k = 0; k < settings->n; k++)
        if (cs_curves_point(settings, settings->cells + k, &other, &error) && error <= y)
            least = fmin(least, other);
    return log10(x / least);
}

/* Groups adjacent cells to curves and counts their marks. */
static void find_curves(struct cs_curves *curves) {
    const struct cs_plot_settings *settings = curves->settings;
    for (uint32_t k = 0; k < settings->n; k++) {
        const struct cs_cell *cell = settings->cells + k;
        double x, y;
        if (k == 0 || !cs_cell_same_series(cell, cell - 1)) {
            if (curves->n == CS_CURVES_MAX)
                return;
            curves->list[curves->n++] = (struct cs_curve){.first = k,
                                                          .log_cost_excess = HUGE_VAL,
                                                          .family = family_of(cell),
                                                          .style = -1};
        }
        struct cs_curve *curve = curves->list + curves->n - 1;
        const bool drawn = cs_curves_point(settings, cell, &x, &y);
        curve->n++;
        curve->is_drawn += drawn;
        curve->log_cost_excess = fmin(curve->log_cost_excess, excess_of(settings, cell));
        curve->bars += drawn && cs_curves_quartiles(settings, cell);
        curve->crossing_marks += drawn && cs_cell_has_crossings(cell);
        curve->failed_marks += cs_curves_cross(curves, cell, &x);
    }
    for (uint32_t k = UINT32_MAX; cs_curves_front(curves, &k);)
        for (uint32_t c = 0; c < curves->n; c++)
            curves->list[c].on_front +=
                k >= curves->list[c].first && k < curves->list[c].first + curves->list[c].n;
}

/* Priority of curves: cells on the front, then nearness to it. */
static bool is_before(const struct cs_curve *a, const struct cs_curve *b) {
    return a->on_front != b->on_front ? a->on_front > b->on_front
                                      : a->log_cost_excess < b->log_cost_excess;
}

/* Marks the best curve not yet marked. Returns false if there is none. */
static bool choose(struct cs_curves *curves) {
    struct cs_curve *best = NULL;
    for (struct cs_curve *c = curves->list; c < curves->list + curves->n; c++)
        if (c->style < 0 && c->is_drawn > 0 && (!best || is_before(c, best)))
            best = c;
    if (best)
        best->style = 0;
    return best;
}

void cs_curves_make(struct cs_curves *curves, const struct cs_plot_settings *settings) {
    *curves = (struct cs_curves){.settings = settings};
    find_ranges(curves);
    find_curves(curves);
    // whoever asks for one family has all of it
    const uint32_t most = settings->family ? CS_CURVES_MAX : CS_CURVES_DRAWN;
    for (uint32_t k = 0; k < most && choose(curves); k++) {
    }
    int style = 0;
    for (int family = 0; cs_family_names[family]; family++)
        for (uint32_t c = 0; c < curves->n; c++)
            if (curves->list[c].style == 0 && curves->list[c].family == family)
                curves->list[c].style = style++;
    uint32_t crosses = 0;
    for (uint32_t c = 0; c < curves->n; c++)
        crosses += curves->list[c].failed_marks;
    if (crosses > 0)
        curves->y[1] += CROSS_ROOM * (curves->y[1] - curves->y[0]);
}

uint32_t cs_curves_left_out(const struct cs_curves *curves) {
    uint32_t n = 0;
    for (uint32_t c = 0; c < curves->n; c++)
        n += curves->list[c].style < 0 && curves->list[c].is_drawn > 0;
    return n;
}

bool cs_curves_show_bar(const struct cs_curves *curves) {
    return curves->error_bar > 0 && log10(curves->error_bar) > curves->y[0];
}

double cs_curves_edge(const struct cs_curves *curves) {
    return pow(10, curves->y[1] - 0.02 * (curves->y[1] - curves->y[0]));
}

/* Decades between two labels. */
static int stride(double span) {
    return span > 20 ? 3 : span > 10 ? 2 : 1;
}

uint32_t cs_curves_ticks(const double range[2], struct cs_tick ticks[CS_TICKS_MAX]) {
    const double span = range[1] - range[0];
    const int every = stride(span);
    uint32_t n = 0;
    for (int decade = (int)floor(range[0]); decade <= range[1]; decade++)
        for (int digit = 1; digit < 10; digit++) {
            const double at = decade + log10(digit);
            const bool half = digit == 2 || digit == 5;
            const bool label =
                (digit == 1 && decade % every == 0) || (span < 2 && half) || span < 1;
            if (at >= range[0] && at <= range[1] && n < CS_TICKS_MAX)
                ticks[n++] = (struct cs_tick){at, digit, decade, label};
        }
    return n;
}

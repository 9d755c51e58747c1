/* Makes the diagram of a comparison: series, styles, front, ranges. */
#include "study/compare/compare_curves.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define CROSS_ROOM 0.06 /* for crosses at the upper edge */

/* Only errors of position have an error bar of the reference. */
static bool is_position_error(const struct cs_column *column) {
    return strstr(column->name, "error") && !strcmp(column->unit, "m");
}

bool cs_curves_point(const struct cs_plot_settings *settings, const struct cs_cell *cell,
                     double *x, double *y) {
    *x = cs_cell_number(cell, settings->x);
    *y = cs_cell_number(cell, settings->y);
    const bool known = !is_position_error(settings->y) || !(cell->bar > 0) || *y >= cell->bar;
    return cs_cell_is_finished(cell) && isfinite(*x) && isfinite(*y) && *x > 0 && *y > 0 &&
           known;
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

/* O(n) per cell of the front; two numbers rule out most cells at a tenth of the cost. */
bool cs_curves_front(const struct cs_plot_settings *settings, uint32_t *k) {
    double x, y, last = HUGE_VAL, least = HUGE_VAL, best = HUGE_VAL;
    if (*k != UINT32_MAX && cs_curves_point(settings, settings->cells + *k, &x, &y))
        last = y;
    *k = UINT32_MAX;
    const struct cs_cell *cell = settings->cells;
    for (uint32_t i = 0, n = is_cost(settings->x) ? settings->n : 0; i < n; i++, cell++)
        if (cs_cell_number(cell, settings->y) < last &&
            cs_cell_number(cell, settings->x) <= least &&
            cs_curves_point(settings, cell, &x, &y) && (x < least || y < best)) {
            least = x;
            best = y;
            *k = i;
        }
    return *k != UINT32_MAX;
}

/* --- which series --- */

static int family_of(const struct cs_cell *cell) {
    for (int k = 0; cs_family_names[k]; k++)
        if (!strcmp(cell->family, cs_family_names[k]))
            return k;
    return 0;
}

/* Groups adjacent cells to curves and counts their points. */
static void find_curves(struct cs_curves *curves) {
    const struct cs_plot_settings *settings = curves->settings;
    for (uint32_t k = 0; k < settings->n; k++) {
        const struct cs_cell *cell = settings->cells + k;
        double x, y;
        if (k == 0 || !cs_cell_same_series(cell, cell - 1)) {
            if (curves->n == CS_CURVES_MAX)
                return;
            curves->list[curves->n++] =
                (struct cs_curve){.first = k, .least = HUGE_VAL, .style = -1};
        }
        struct cs_curve *curve = curves->list + curves->n - 1;
        curve->n++;
        if (cs_curves_point(settings, cell, &x, &y)) {
            curve->is_drawn++;
            curve->least = fmin(curve->least, x * y);
        }
    }
    for (uint32_t k = UINT32_MAX; cs_curves_front(settings, &k);)
        for (uint32_t c = 0; c < curves->n; c++)
            curves->list[c].on_front +=
                k >= curves->list[c].first && k < curves->list[c].first + curves->list[c].n;
}

/* Priority of curves: cells on the front, then the least product of cost and error. */
static bool is_before(const struct cs_curve *a, const struct cs_curve *b) {
    return a->on_front != b->on_front ? a->on_front > b->on_front : a->least < b->least;
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
    find_curves(curves);
    const uint32_t most = settings->all ? CS_CURVES_MAX : CS_CURVES_DRAWN;
    for (uint32_t k = 0; k < most && choose(curves); k++) {
    }
    int style = 0;
    for (int family = 0; cs_family_names[family]; family++)
        for (uint32_t c = 0; c < curves->n; c++)
            if (curves->list[c].style == 0 &&
                family_of(settings->cells + curves->list[c].first) == family)
                curves->list[c].style = ++style;
    for (uint32_t c = 0; c < curves->n; c++)
        curves->list[c].style -= curves->list[c].style > 0;
}

uint32_t cs_curves_left_out(const struct cs_curves *curves) {
    uint32_t n = 0;
    for (uint32_t c = 0; c < curves->n; c++)
        n += curves->list[c].style < 0 && curves->list[c].is_drawn > 0;
    return n;
}

/* --- the diagram --- */

/* A cell's own value on the y axis, the ends of its scatter, and whether it is on the front. */
struct spread {
    double own, low, high;
    bool front;
};

/* A panel that is being filled. */
struct filling {
    const struct cs_curves *curves;
    struct cs_plot_settings settings; /* with the panel's x; typical values on the y axis */
    struct spread *spread;            /* (settings.n) */
    struct cs_panel *panel;
    struct cs_series *series;
    struct cs_point *points; /* the next ones */
};

/* Replaces the values on the y axis by typical ones. */
static void find_typical(struct filling *at, struct cs_cell *cells) {
    const struct cs_plot_settings *given = at->curves->settings;
    const struct cs_column *y = given->y;
    for (uint32_t k = 0; k < given->n; k++) {
        struct spread *spread = at->spread + k;
        cells[k] = given->cells[k];
        spread->own = spread->low = spread->high = cs_cell_number(cells + k, y);
        if (!strstr(y->name, "error"))
            continue;
        const double typical = cs_cell_typical(given->cells, given->n, given->cells + k, y,
                                               &spread->low, &spread->high);
        memcpy((char *)(cells + k) + y->offset, &typical, sizeof typical);
    }
    at->settings.cells = cells;
}

static bool is_probe(const struct cs_cell *cell) {
    return isfinite(cell->target);
}
/* Ranges of all cells of the drawn series. */
static void find_ranges(struct filling *at) {
    struct cs_panel *panel = at->panel;
    bool crosses = false;
    for (uint32_t c = 0; c < at->curves->n; c++) {
        const struct cs_curve *curve = at->curves->list + c;
        for (uint32_t k = curve->first; curve->style >= 0 && k < curve->first + curve->n; k++) {
            double x, y;
            crosses |= !cs_cell_is_finished(at->settings.cells + k);
            if (!cs_curves_point(&at->settings, at->settings.cells + k, &x, &y))
                continue;
            cs_plot_axis_include(&panel->x, x);
            cs_plot_axis_include(&panel->y, y);
        }
    }
    cs_plot_axis_widen(&panel->x);
    cs_plot_axis_widen(&panel->y);
    if (crosses)
        panel->y.range[1] += CROSS_ROOM * (panel->y.range[1] - panel->y.range[0]);
}

static struct cs_series *add_series(struct filling *at, enum cs_series_kind kind,
                                    struct cs_style style) {
    struct cs_series *series = at->series + at->panel->n_series++;
    *series = (struct cs_series){.kind = kind, .style = style, .points = at->points};
    return series;
}

static void add_point(struct filling *at, struct cs_series *series, struct cs_point point) {
    *at->points++ = point;
    series->n++;
}

static void add_front(struct filling *at) {
    struct cs_series *front = add_series(
        at, CS_SERIES_STAIRS, (struct cs_style){.colour = CS_FRONT_COLOUR, .width = 3.5});
    struct cs_point point = {.joined = true};
    for (uint32_t k = 0; k < at->settings.n; k++)
        at->spread[k].front = false;
    for (uint32_t k = UINT32_MAX; cs_curves_front(&at->settings, &k);) {
        at->spread[k].front = true;
        cs_curves_point(&at->settings, at->settings.cells + k, &point.x, &point.y);
        add_point(at, front, point);
    }
}

/* The scatter of a method with error control. */
static void add_band(struct filling *at, const struct cs_curve *curve) {
    struct cs_series *band =
        add_series(at, CS_SERIES_BAND, cs_style_of((uint32_t)curve->style));
    struct cs_point point = {0};
    for (uint32_t k = curve->first; k < curve->first + curve->n; k++)
        if (!is_probe(at->settings.cells + k) &&
            cs_curves_point(&at->settings, at->settings.cells + k, &point.x, &point.y)) {
            point.low = at->spread[k].low;
            point.high = at->spread[k].high;
            add_point(at, band, point);
        }
}

/* The point of a cell; false: none. A run that did not finish stands at the upper edge. */
static bool make_point(const struct filling *at, uint32_t k, struct cs_point *point) {
    const struct cs_cell *cell = at->settings.cells + k;
    const struct cs_plot_axis *x = &at->panel->x, *y = &at->panel->y;
    const bool timed = !strcmp(at->settings.x->name, "cpu") && cell->runs > 1;
    *point = (struct cs_point){.mark = is_probe(cell) ? CS_MARK_HOLLOW : CS_MARK_FULL,
                               .joined = !is_probe(cell),
                               .ring = cs_cell_has_crossings(cell),
                               .front = at->spread[k].front,
                               .note = cell->options};
    /* a probe that was timed once stands where the load of that moment put it */
    if (is_probe(cell) && cell->runs < 2 && strstr("cpu wall", at->settings.x->name))
        return false;
    if (cs_curves_point(&at->settings, cell, &point->x, &point->y)) {
        point->low = timed ? cell->cpu_low : (double)NAN;
        point->high = timed ? cell->cpu_high : (double)NAN;
        point->y = is_probe(cell) ? at->spread[k].own : point->y;
        return true;
    }
    const double cost = log10(cs_cell_number(cell, at->settings.x));
    if (cs_cell_is_finished(cell) || !isfinite(cost))
        return false;
    const double margin = 0.01 * (x->range[1] - x->range[0]);
    point->x = pow(10, fmin(fmax(cost, x->range[0] + margin), x->range[1] - margin));
    point->y = pow(10, y->range[1] - 0.02 * (y->range[1] - y->range[0]));
    point->mark = CS_MARK_CROSS;
    point->joined = point->ring = point->front = false;
    return true;
}

static void add_curve(struct filling *at, const struct cs_curve *curve) {
    struct cs_series *series =
        add_series(at, CS_SERIES_LINE, cs_style_of((uint32_t)curve->style));
    struct cs_point point;
    series->name = at->settings.cells[curve->first].series;
    for (uint32_t k = curve->first; k < curve->first + curve->n; k++)
        if (make_point(at, k, &point))
            add_point(at, series, point);
}

/* Grey below the reference's own error, where no difference means anything. */
static void add_bar(struct filling *at, struct cs_diagram_rect *bar) {
    const struct cs_plot_settings *settings = &at->settings;
    const struct cs_plot_axis *x = &at->panel->x, *y = &at->panel->y;
    double error = 0;
    for (uint32_t k = 0; k < settings->n && is_position_error(settings->y); k++)
        error = fmax(error, settings->cells[k].bar);
    *bar = (struct cs_diagram_rect){pow(10, x->range[0]), pow(10, x->range[1]),
                                    pow(10, y->range[0]), error,
                                    CS_BAR_COLOUR,        ' '};
    at->panel->boxes = bar;
    at->panel->n_boxes = error > bar->bottom;
}

static void fill_panel(struct filling *at, const struct cs_column *x,
                       struct cs_diagram_rect *bar) {
    const struct cs_column *columns[2] = {x, at->settings.y};
    struct cs_plot_axis *axes[2] = {&at->panel->x, &at->panel->y};
    at->settings.x = x;
    for (int k = 0; k < 2; k++) {
        struct cs_text label = {0};
        *axes[k] = (struct cs_plot_axis){.logarithmic = true, .range = {HUGE_VAL, -HUGE_VAL}};
        cs_column_add_label(columns[k], &label);
        /* in full that of work is wider than the axis */
        snprintf(axes[k]->label, CS_LABEL_BYTES, "%s",
                 strcmp(columns[k]->name, "work") ? cs_text_get(&label)
                                                  : "work in passes over the springs");
        cs_text_finish(&label);
    }
    at->panel->series = at->series;
    find_ranges(at);
    add_bar(at, bar);
    add_front(at);
    /* bands lie below all lines */
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t c = 0; c < at->curves->n; c++) {
            const struct cs_curve *curve = at->curves->list + c;
            if (curve->style >= 0 && pass == 1)
                add_curve(at, curve);
            else if (curve->style >= 0 && at->settings.cells[curve->first].adaptive)
                add_band(at, curve);
        }
    at->series += at->panel->n_series;
}

/* Explains the marks that occur. */
static void add_keys(struct cs_diagram *diagram, const struct cs_curves *curves) {
    enum { FRONT, BAND, PROBE, FAILED, RING, BAR, KEYS };
    static const struct cs_key keys[KEYS] = {
        {CS_KEY_LINE, .style = {CS_FRONT_COLOUR, .width = 3.5}, .letter = 'A',
         .text = "front: nothing is both cheaper and more accurate"},
        {CS_KEY_PATCH, .style.colour = 0xc8d8e4,
         .text = "scatter under error control; its line is the median"},
        {CS_KEY_MARK, CS_MARK_HOLLOW, .style.colour = 0x404040,
         .text = "run in search of equal errors"},
        {CS_KEY_MARK, CS_MARK_CROSS, {.colour = 0x404040}, 'x', "did not finish", NULL},
        {CS_KEY_RING, 0, {.colour = CS_RING_COLOUR}, 'o', "edges through triangles", NULL},
        {CS_KEY_PATCH, .style.colour = CS_BAR_COLOUR,
         .text = "below the reference's own error"},
    };
    const struct cs_panel *panel = diagram->panels;
    bool there[KEYS] = {[BAR] = panel->n_boxes};
    char more[80];
    for (const struct cs_series *s = panel->series; s < panel->series + panel->n_series; s++) {
        there[FRONT] |= s->kind == CS_SERIES_STAIRS && s->n;
        there[BAND] |= s->kind == CS_SERIES_BAND && s->n;
        for (uint32_t i = 0; i < s->n; i++) {
            there[PROBE] |= s->points[i].mark == CS_MARK_HOLLOW;
            there[FAILED] |= s->points[i].mark == CS_MARK_CROSS;
            there[RING] |= s->points[i].ring;
        }
    }
    for (int k = 0; k < KEYS; k++)
        if (there[k])
            diagram->keys[diagram->n_keys++] = keys[k];
    snprintf(more, sizeof more, "%u more series: clothsim plot --family",
             cs_curves_left_out(curves));
    if (cs_curves_left_out(curves) || panel->n_series < 2)
        cs_diagram_add_key(diagram, CS_KEY_TEXT, 0, ' ',
                           panel->n_series > 1 ? more : "no cell has both values");
}

enum cs_status cs_plot_make(struct cs_plot *plot, const struct cs_plot_settings *settings,
                            struct cs_error *error) {
    const struct cs_column *columns[] = {settings->x, settings->second};
    const uint32_t panels = settings->second ? 2 : 1;
    struct cs_arena *arena = &plot->arena;
    *plot = (struct cs_plot){0};
    struct cs_curves *curves = cs_arena_alloc(arena, sizeof *curves, error);
    struct cs_cell *cells =
        cs_arena_alloc_array(arena, settings->n + 1ul, sizeof *cells, error);
    /* for each panel a front, and a line and a band for each curve */
    struct filling at = {
        .curves = curves,
        .settings = *settings,
        .spread = cs_arena_alloc_array(arena, settings->n + 1ul, sizeof *at.spread, error),
        .series = cs_arena_alloc_array(arena, panels * (2 * CS_CURVES_MAX + 1),
                                       sizeof *at.series, error),
        .points = cs_arena_alloc_array(arena, panels * 3ul * settings->n + 1, sizeof *at.points,
                                       error)};
    if (!error->status) {
        const bool page = settings->width >= CS_WIDTH_PAGE && panels > 1;
        curves->settings = settings;
        find_typical(&at, cells);
        const struct cs_plot_settings typical = at.settings;
        cs_curves_make(curves, &typical);
        plot->diagram = (struct cs_diagram){.title = settings->title,
                                            .width = settings->width,
                                            .columns = page ? 2 : 1,
                                            .n_panels = panels,
                                            .panels = plot->panels};
        for (uint32_t k = 0; k < panels; k++) {
            at.panel = plot->panels + k;
            at.panel->aspect = page ? 1.1 : panels > 1 ? 1.3 : 0.8;
            fill_panel(&at, columns[k], plot->bars + k);
        }
        add_keys(&plot->diagram, curves);
    }
    return error->status;
}

void cs_plot_finish(struct cs_plot *plot) {
    cs_arena_finish(&plot->arena);
    *plot = (struct cs_plot){0};
}

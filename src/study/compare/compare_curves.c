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

/* True for a column that smaller values make better: the front needs such an axis. */
static bool is_cost(const struct cs_column *column) {
    static const char *const names[] = {"cpu",    "wall",       "work",   "evals", "jvps",
                                        "solves", "iterations", "setups", "steps", "newton"};
    for (size_t k = 0; k < sizeof names / sizeof *names; k++)
        if (!strcmp(column->name, names[k]))
            return true;
    return false;
}

static bool is_probe(const struct cs_cell *cell) {
    return isfinite(cell->target);
}

/* The cheapest spot with a smaller error than y, and of those the most accurate; NULL: none. */
static struct cs_spot *next_of_front(struct cs_spot *spots, uint32_t n, double y) {
    struct cs_spot *next = NULL;
    for (struct cs_spot *s = spots; s < spots + n; s++)
        if (s->is_drawn && s->y < y &&
            (!next || s->x < next->x || (s->x <= next->x && s->y < next->y)))
            next = s;
    return next;
}

void cs_spots_find(const struct cs_plot_settings *settings, const struct cs_column *x,
                   struct cs_spot *spots) {
    const uint32_t n = settings->n;
    const struct cs_column *y = settings->y;
    for (uint32_t k = 0; k < n; k++) {
        const struct cs_cell *cell = settings->cells + k;
        struct cs_spot *s = spots + k;
        const double own = cs_cell_number(cell, y);
        *s = (struct cs_spot){.y = own, .own = own, .low = own, .high = own};
        // a probe that was timed once stands where the load of that moment put it: not drawn
        const bool untimed = is_probe(cell) && cell->runs < 2 && strstr("cpu wall", x->name);
        s->x = untimed ? (double)NAN : cs_cell_number(cell, x);
        if (strstr(y->name, "error"))
            s->y = cs_cell_typical(settings->cells, n, cell, y, &s->low, &s->high);
        s->is_drawn = cs_cell_is_finished(cell) && isfinite(s->x) && isfinite(s->y) &&
                      s->x > 0 && s->y > 0 &&
                      (!is_position_error(y) || !(cell->bar > 0) ||
                       (is_probe(cell) ? own : s->y) >= cell->bar);
    }
    /* from the cheapest on, each more accurate than all before */
    struct cs_spot *s = NULL;
    while (is_cost(x) && (s = next_of_front(spots, n, s ? s->y : HUGE_VAL)))
        s->on_front = true;
}

/* --- which series --- */

static int family_of(const struct cs_cell *cell) {
    for (int k = 0; cs_family_names[k]; k++)
        if (!strcmp(cell->family, cs_family_names[k]))
            return k;
    return 0;
}

/* The best curve that is not chosen yet: with the most cells on the front, then with the least
 * product of cost and error. NULL: none has points. */
static struct cs_curve *best_curve(struct cs_curves *curves) {
    struct cs_curve *best = NULL;
    for (struct cs_curve *c = curves->list; c < curves->list + curves->n; c++)
        if (!c->is_chosen && isfinite(c->least) &&
            (!best || (c->on_front != best->on_front ? c->on_front > best->on_front
                                                     : c->least < best->least)))
            best = c;
    return best;
}

void cs_curves_make(struct cs_curves *curves, const struct cs_plot_settings *settings,
                    const struct cs_spot *spots) {
    const uint32_t most = settings->all ? CS_CURVES_MAX : CS_CURVES_DRAWN;
    struct cs_curve *curve = NULL;
    *curves = (struct cs_curves){0};
    for (uint32_t k = 0; k < settings->n; k++) {
        const struct cs_cell *cell = settings->cells + k;
        if (k == 0 || !cs_cell_same_series(cell, cell - 1)) {
            if (curves->n == CS_CURVES_MAX)
                break;
            curve = curves->list + curves->n++;
            *curve = (struct cs_curve){.first = k, .least = HUGE_VAL};
        }
        curve->n++;
        curve->on_front += spots[k].on_front;
        if (spots[k].is_drawn)
            curve->least = fmin(curve->least, spots[k].x * spots[k].y);
    }
    /* of the best, styles go by family */
    for (uint32_t k = 0; k < most && (curve = best_curve(curves)); k++)
        curve->is_chosen = true;
    uint32_t style = 0;
    for (int family = 0; cs_family_names[family]; family++)
        for (curve = curves->list; curve < curves->list + curves->n; curve++)
            if (curve->is_chosen && family_of(settings->cells + curve->first) == family)
                curve->style = style++;
    for (curve = curves->list; curve < curves->list + curves->n; curve++)
        curves->n_left_out += !curve->is_chosen && isfinite(curve->least);
}

/* --- the diagram --- */

/* Explanations of what occurs in a diagram. */
enum key { FRONT, BAND, PROBE, FAILED, RING, BAR, KEYS };

/* A panel that is being filled. */
struct filling {
    const struct cs_plot_settings *settings;
    const struct cs_curves *curves;
    const struct cs_column *x;
    struct cs_spot *spots; /* (settings->n) over x */
    struct cs_diagram *plot;
    struct cs_panel *panel;
    bool there[KEYS];
};

static void add_front(struct filling *at, struct cs_error *error) {
    const uint32_t n = at->settings->n;
    const struct cs_spot *s;
    double y = HUGE_VAL;
    struct cs_series *front = cs_plot_add_series(
        at->plot, at->panel, (struct cs_series){.style = {CS_FRONT_COLOUR, .width = 3.5}},
        2 * n, error);
    for (; front && is_cost(at->x) && (s = next_of_front(at->spots, n, y)); y = s->y) {
        if (front->n) /* the corner of a step */
            front->points[front->n++] = (struct cs_point){.x = s->x, .y = y, .joined = true};
        front->points[front->n++] = (struct cs_point){.x = s->x, .y = s->y, .joined = true};
        at->there[FRONT] = true;
    }
}

/* The point of a cell; false: none. That of a run that did not finish is placed later. */
static bool make_point(struct filling *at, uint32_t k, struct cs_point *point) {
    const struct cs_cell *cell = at->settings->cells + k;
    const struct cs_spot *s = at->spots + k;
    const bool swept = s->is_drawn && !is_probe(cell),
               timed = s->is_drawn && !strcmp(at->x->name, "cpu") && cell->runs > 1;
    if (!s->is_drawn && (cs_cell_is_finished(cell) || !isfinite(log10(s->x))))
        return false;
    *point = (struct cs_point){.x = s->x,
                               .y = swept ? s->y : s->own,
                               .low = timed ? cell->cpu_low : (double)NAN,
                               .high = timed ? cell->cpu_high : (double)NAN,
                               .band = {swept ? s->low : (double)NAN, s->high},
                               .mark = swept         ? CS_MARK_FULL
                                       : s->is_drawn ? CS_MARK_HOLLOW
                                                     : CS_MARK_CROSS,
                               .joined = swept,
                               .ring = s->is_drawn && cs_cell_has_crossings(cell),
                               .front = s->on_front,
                               .note = cell->options};
    at->there[BAND] |= point->band[0] < point->band[1];
    at->there[PROBE] |= point->mark == CS_MARK_HOLLOW;
    at->there[FAILED] |= point->mark == CS_MARK_CROSS;
    at->there[RING] |= point->ring;
    return true;
}

static void add_curve(struct filling *at, const struct cs_curve *curve,
                      struct cs_error *error) {
    const struct cs_cell *first = at->settings->cells + curve->first;
    struct cs_series *series =
        cs_plot_add_series(at->plot, at->panel,
                           (struct cs_series){.name = first->series,
                                              .style = cs_style_of(curve->style),
                                              .has_band = first->adaptive},
                           curve->n, error);
    for (uint32_t k = curve->first; series && k < curve->first + curve->n; k++)
        series->n += make_point(at, k, series->points + series->n);
}

/* Grey below the reference's own error, where no difference means anything. */
static void add_bar(struct filling *at, struct cs_error *error) {
    const struct cs_plot_settings *settings = at->settings;
    struct cs_panel *panel = at->panel;
    const double *x = panel->x.range, *y = panel->y.range;
    double bar = 0;
    for (uint32_t k = 0; k < settings->n && is_position_error(settings->y); k++)
        bar = fmax(bar, settings->cells[k].bar);
    if (bar > pow(10, y[0]) && CS_ARENA_ARRAY(&at->plot->arena, panel->boxes, 1, error))
        panel->boxes[panel->n_boxes++] = (struct cs_diagram_rect){
            pow(10, x[0]), pow(10, x[1]), pow(10, y[0]), bar, CS_BAR_COLOUR, ' '};
    at->there[BAR] |= panel->n_boxes;
}

/* Places the runs that did not finish at the upper edge. */
static void place_crosses(struct cs_panel *panel) {
    const double *x = panel->x.range, *y = panel->y.range, margin = 0.01 * (x[1] - x[0]);
    for (uint32_t k = 0; k < panel->n_series; k++)
        for (uint32_t i = 0; i < panel->series[k].n; i++) {
            struct cs_point *p = panel->series[k].points + i;
            if (p->mark != CS_MARK_CROSS)
                continue;
            p->x = pow(10, fmin(fmax(log10(p->x), x[0] + margin), x[1] - margin));
            p->y = pow(10, y[1] - 0.02 * (y[1] - y[0]));
        }
}

/* Adds the series. y: range of all panels, which share the axis. */
static void fill_panel(struct filling *at, double y[2], struct cs_error *error) {
    const struct cs_column *columns[] = {at->x, at->settings->y};
    struct cs_plot_axis *axes[] = {&at->panel->x, &at->panel->y};
    for (int k = 0; k < 2; k++) {
        axes[k]->logarithmic = true;
        cs_column_print_label(columns[k], axes[k]->label, CS_LABEL_BYTES);
        /* in full that of work is wider than the axis */
        if (!strcmp(columns[k]->name, "work"))
            snprintf(axes[k]->label, CS_LABEL_BYTES, "work in passes over the springs");
    }
    add_front(at, error);
    /* later ones lie over earlier ones */
    for (uint32_t c = 0; c < at->curves->n; c++)
        if (at->curves->list[c].is_chosen)
            add_curve(at, at->curves->list + c, error);
    cs_panel_fit(at->panel);
    y[0] = fmin(y[0], axes[1]->range[0]);
    y[1] = fmax(y[1], axes[1]->range[1]);
}

/* Sets the ranges, and adds what depends on them. */
static void finish_panel(struct filling *at, const double y[2], struct cs_error *error) {
    struct cs_plot_axis *axis = &at->panel->y;
    memcpy(axis->range, y, sizeof axis->range);
    cs_plot_axis_widen(&at->panel->x);
    cs_plot_axis_widen(axis);
    if (at->there[FAILED])
        axis->range[1] += CROSS_ROOM * (axis->range[1] - axis->range[0]);
    place_crosses(at->panel);
    add_bar(at, error);
}

/* Explains the marks that occur. */
static void add_keys(const struct filling *at) {
    static const struct cs_key keys[KEYS] = {
        [FRONT] = {CS_KEY_SAMPLE, .style = {CS_FRONT_COLOUR, .width = 3.5}, .letter = 'A',
                   .text = "front: nothing is both cheaper and more accurate"},
        [BAND] = {CS_KEY_PATCH, .style.colour = 0xc8d8e4,
                  .text = "scatter under error control; its line is the median"},
        [PROBE] = {CS_KEY_SAMPLE, CS_MARK_HOLLOW, .style.colour = 0x404040,
                   .text = "run in search of equal errors"},
        [FAILED] = {CS_KEY_SAMPLE, CS_MARK_CROSS, .style.colour = 0x404040, .letter = 'x',
                    .text = "did not finish"},
        [RING] = {CS_KEY_SAMPLE, CS_MARK_RING, .style.colour = CS_RING_COLOUR, .letter = 'o',
                  .text = "edges through triangles"},
        [BAR] = {CS_KEY_PATCH, .style.colour = CS_BAR_COLOUR,
                 .text = "below the reference's own error"},
    };
    struct cs_diagram *diagram = at->plot;
    const bool empty = at->panel->n_series < 2;
    char more[80];
    for (int k = 0; k < KEYS; k++)
        if (at->there[k])
            diagram->keys[diagram->n_keys++] = keys[k];
    snprintf(more, sizeof more, "%u more series: clothsim plot --family",
             at->curves->n_left_out);
    if (at->curves->n_left_out || empty)
        cs_diagram_add_key(diagram, CS_KEY_TEXT, 0, ' ',
                           empty ? "no cell has both values" : more);
}

enum cs_status cs_plot_make(struct cs_diagram *plot, const struct cs_plot_settings *settings,
                            struct cs_error *error) {
    const struct cs_column *columns[] = {settings->x, settings->second};
    const bool pair = settings->second, page = pair && settings->width >= CS_WIDTH_PAGE;
    struct cs_curves *curves;
    struct filling at = {.settings = settings, .plot = plot};
    double y[2] = {HUGE_VAL, -HUGE_VAL};
    cs_plot_begin(plot, settings->title, settings->width);
    plot->columns = page ? 2 : 1;
    CS_ARENA_ARRAY(&plot->arena, at.spots, settings->n + 1ul, error);
    at.curves = CS_ARENA_ARRAY(&plot->arena, curves, 1, error);
    for (int k = 0; k <= pair && !error->status; k++) {
        at.x = columns[k];
        cs_spots_find(settings, at.x, at.spots);
        /* both panels have the series of the first */
        if (k == 0)
            cs_curves_make(curves, settings, at.spots);
        at.panel = cs_plot_add_panel(plot, page ? 1.1 : pair ? 1.3 : 0.8, curves->n + 1, error);
        if (at.panel)
            fill_panel(&at, y, error);
    }
    for (uint32_t k = 0; k < plot->n_panels && !error->status; k++) {
        at.panel = plot->panels + k;
        finish_panel(&at, y, error);
    }
    if (!error->status)
        add_keys(&at);
    return error->status;
}

/* Axes, ticks, styles and keys of diagrams: the part that all their drawers share. */
#include "diagram/diagram.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const cs_format_names[] = {"png", "svg", "pdf", NULL};

struct cs_style cs_style_of(uint32_t n) {
    static const uint32_t colours[] = {
        0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7, 0x000000, 0xe69f00, 0x56b4e9,
        /* and the same, darker; grey for black */
        0x00436a, 0x80380a, 0x00664b, 0x7d3f63, 0x8a8a8a, 0x8a5f00, 0x2b7099};
    /* twelve pairs of marker and dash: with each three series the dash changes */
    return (struct cs_style){.colour = colours[n % 14],
                             .dash = (uint8_t)(n / 3 % 4),
                             .marker = (uint8_t)(n % 6),
                             .width = 1};
}

static double to_range(const struct cs_plot_axis *axis, double value) {
    return axis->logarithmic ? log10(value) : value;
}

double cs_plot_axis_at(const struct cs_plot_axis *axis, double value) {
    return (to_range(axis, value) - axis->range[0]) / (axis->range[1] - axis->range[0]);
}

void cs_plot_axis_include(struct cs_plot_axis *axis, double value) {
    const double at = to_range(axis, value);
    if (!isfinite(at))
        return;
    axis->range[0] = fmin(axis->range[0], at);
    axis->range[1] = fmax(axis->range[1], at);
}

void cs_plot_axis_widen(struct cs_plot_axis *axis) {
    double *range = axis->range;
    if (!(range[0] <= range[1]))
        range[0] = 0, range[1] = 1;
    const double least =
        axis->logarithmic ? log10(4) : fmax(0.1 * fmax(fabs(range[0]), fabs(range[1])), 1e-300);
    const double more = fmax(0.04 * (range[1] - range[0]), (least - (range[1] - range[0])) / 2);
    range[0] -= more;
    range[1] += more;
}

static uint32_t add_decades(const double range[2], struct cs_tick *ticks) {
    const double span = range[1] - range[0];
    /* few decades around 1 read best as plain numbers */
    const bool plain = range[0] > -3 && range[1] < 4 && span < 4;
    const int every = span > 20 ? 3 : span > 10 ? 2 : 1; /* decades between two labels */
    uint32_t n = 0;
    for (int decade = (int)floor(range[0]); decade <= range[1]; decade++)
        for (int digit = 1; digit < 10; digit++) {
            const double at = (decade + log10(digit) - range[0]) / span;
            const bool label = (digit == 1 && decade % every == 0) ||
                               (span < 2 && (digit == 2 || digit == 5)) ||
                               (span < 1 && digit == 3);
            if (at >= 0 && at <= 1 && n < CS_TICKS_MAX)
                ticks[n++] =
                    (struct cs_tick){at, digit * pow(10, decade), digit, decade, label, plain};
        }
    return n;
}

uint32_t cs_plot_axis_ticks(const struct cs_plot_axis *axis,
                            struct cs_tick ticks[CS_TICKS_MAX]) {
    if (axis->logarithmic)
        return add_decades(axis->range, ticks);
    /* 1, 2 or 5 times a power of 10: four to nine ticks */
    const double *range = axis->range, span = range[1] - range[0],
                 power = pow(10, floor(log10(span / 4)));
    const double step = span / power >= 20 ? 5 * power : span / power >= 8 ? 2 * power : power;
    uint32_t n = 0;
    for (double k = ceil(range[0] / step); k * step <= range[1] && n < 16; k++)
        ticks[n++] = (struct cs_tick){.at = (k * step - range[0]) / span,
                                      .value = k * step + 0.0,
                                      .decade = (int)fmod(k, 10),
                                      .label = true,
                                      .plain = true};
    return n;
}

/* Adds a number with the minus sign of print. */
static void add_number(char out[CS_TICK_BYTES], const char *number) {
    const bool minus = *number == '-';
    const size_t length = strlen(out);
    snprintf(out + length, CS_TICK_BYTES - length, "%s%s", minus ? "\u2212" : "",
             number + minus);
}

void cs_tick_print(const struct cs_tick *tick, char label[CS_TICK_BYTES],
                   char power[CS_TICK_BYTES]) {
    char number[CS_TICK_BYTES], decade[CS_TICK_BYTES];
    snprintf(number, sizeof number, tick->plain ? "%.6g" : "%.0e", tick->value);
    char *exponent = strchr(number, 'e');
    *label = *power = 0;
    if (exponent) {
        *exponent = 0;
        snprintf(decade, sizeof decade, "%d", atoi(exponent + 1));
        add_number(power, decade);
    }
    if (!exponent || strcmp(number, "1") != 0)
        add_number(label, number);
    if (exponent)
        add_number(label, *label ? "·10" : "10");
}

struct cs_key *cs_diagram_add_key(struct cs_diagram *diagram, enum cs_key_kind kind,
                                  uint32_t colour, char letter, const char *text) {
    struct cs_key *key = diagram->keys + diagram->n_keys;
    diagram->n_keys += diagram->n_keys + 1 < CS_KEYS_MAX;
    *key = (struct cs_key){
        .kind = kind, .style = {.colour = colour, .width = 1}, .letter = letter};
    snprintf(key->text, sizeof key->text, "%s", text);
    return key;
}

void cs_plot_begin(struct cs_diagram *plot, const char *title, double width) {
    *plot = (struct cs_diagram){.width = width, .columns = 1};
    snprintf(plot->title, sizeof plot->title, "%s", title ? title : "");
}

void cs_plot_finish(struct cs_diagram *plot) {
    cs_arena_finish(&plot->arena);
    *plot = (struct cs_diagram){0};
}

struct cs_panel *cs_plot_add_panel(struct cs_diagram *plot, double aspect, uint32_t n_series,
                                   struct cs_error *error) {
    const struct cs_plot_axis empty = {.range = {HUGE_VAL, -HUGE_VAL}};
    struct cs_panel *panel = plot->panels + plot->n_panels;
    if (panel == plot->panels + CS_PANELS_MAX)
        return NULL;
    *panel = (struct cs_panel){.x = empty, .y = empty, .aspect = aspect};
    plot->n_panels++;
    return CS_ARENA_ARRAY(&plot->arena, panel->series, n_series, error) ? panel : NULL;
}

struct cs_series *cs_plot_add_series(struct cs_diagram *plot, struct cs_panel *panel,
                                     struct cs_series series, uint32_t n_points,
                                     struct cs_error *error) {
    if (!CS_ARENA_ARRAY(&plot->arena, series.points, n_points, error))
        return NULL;
    panel->series[panel->n_series] = series;
    return panel->series + panel->n_series++;
}

void cs_panel_fit(struct cs_panel *panel) {
    for (uint32_t k = 0; k < panel->n_series; k++) {
        const struct cs_series *s = panel->series + k;
        for (uint32_t i = 0; i < s->n && s->name; i++) {
            const struct cs_point *p = s->points + i;
            if (p->mark == CS_MARK_CROSS)
                continue;
            for (int end = 0; end < 2 && p->low < p->high; end++)
                cs_plot_axis_include(&panel->x, end ? p->high : p->low);
            cs_plot_axis_include(&panel->x, p->x);
            cs_plot_axis_include(&panel->y, p->y);
        }
    }
}

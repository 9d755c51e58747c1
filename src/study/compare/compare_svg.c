/* Draws cells as a log-log diagram in SVG: axes on the data, front, curves, quartile bars. */
#include "study/compare/compare_svg.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { WIDTH = 920, HEIGHT = 520, LEFT = 78, RIGHT = 640, TOP = 16, BOTTOM = 460 };
enum { COLOURS = 7, SERIES_MOST = 256 };

static const char *const colours[COLOURS] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                             "#000000", "#e69f00", "#56b4e9"};

/* A diagram on its way: the ranges are decimal logarithms. */
struct diagram {
    const struct cs_plot_settings *settings;
    const bool *front;
    double x[2], y[2];
    struct curve {
        uint32_t first, n, on_front, drawn;
    } curves[SERIES_MOST];
    uint32_t n_curves;
    bool shown[SERIES_MOST];
};

void cs_svg_add_text(struct cs_text *out, const char *text) {
    for (; *text; text++)
        switch (*text) {
        case '&':
            cs_text_add(out, "&amp;");
            break;
        case '<':
            cs_text_add(out, "&lt;");
            break;
        case '>':
            cs_text_add(out, "&gt;");
            break;
        case '"':
            cs_text_add(out, "&quot;");
            break;
        default:
            cs_text_add(out, "%c", *text);
        }
}

static bool place(const struct diagram *diagram, uint32_t k, double *x, double *y) {
    const struct cs_plot_settings *settings = diagram->settings;
    const struct cs_cell *cell = settings->cells + k;
    if (!cs_plot_point(settings, cell, x, y))
        return false;
    *x = log10(*x);
    *y = log10(*y);
    return true;
}

static double to_x(const struct diagram *diagram, double x) {
    return LEFT + (x - diagram->x[0]) / (diagram->x[1] - diagram->x[0]) * (RIGHT - LEFT);
}

static double to_y(const struct diagram *diagram, double y) {
    return BOTTOM - (y - diagram->y[0]) / (diagram->y[1] - diagram->y[0]) * (BOTTOM - TOP);
}

static void widen(double range[2]) {
    if (!(range[0] <= range[1]))
        range[0] = 0, range[1] = 1;
    const double margin = fmax(0.04 * (range[1] - range[0]), 0.05);
    range[0] -= margin;
    range[1] += margin;
}

static void find_ranges(struct diagram *diagram) {
    diagram->x[0] = diagram->y[0] = HUGE_VAL;
    diagram->x[1] = diagram->y[1] = -HUGE_VAL;
    for (uint32_t k = 0; k < diagram->settings->n; k++) {
        double x, y;
        if (!place(diagram, k, &x, &y))
            continue;
        diagram->x[0] = fmin(diagram->x[0], x);
        diagram->x[1] = fmax(diagram->x[1], x);
        diagram->y[0] = fmin(diagram->y[0], y);
        diagram->y[1] = fmax(diagram->y[1], y);
    }
    widen(diagram->x);
    widen(diagram->y);
}

static void find_curves(struct diagram *diagram) {
    const struct cs_plot_settings *settings = diagram->settings;
    for (uint32_t k = 0; k < settings->n; k++) {
        double x, y;
        if (k == 0 || !cs_cell_same_series(settings->cells + k, settings->cells + k - 1)) {
            if (diagram->n_curves == SERIES_MOST)
                return;
            diagram->curves[diagram->n_curves++] = (struct curve){.first = k};
        }
        struct curve *curve = diagram->curves + diagram->n_curves - 1;
        curve->n++;
        curve->drawn += place(diagram, k, &x, &y);
        curve->on_front += diagram->front && diagram->front[k];
    }
}

/* Those with the most cells on the front, then the first. */
static void choose_curves(struct diagram *diagram) {
    for (int n = 0; n < CS_SVG_CURVES; n++) {
        uint32_t best = SERIES_MOST;
        for (uint32_t c = 0; c < diagram->n_curves; c++)
            if (!diagram->shown[c] && diagram->curves[c].drawn > 0 &&
                (best == SERIES_MOST ||
                 diagram->curves[c].on_front > diagram->curves[best].on_front))
                best = c;
        if (best < SERIES_MOST)
            diagram->shown[best] = true;
    }
}

/* One tick of an axis, with its grid line; `mark` may be "". */
static void add_tick(const struct diagram *diagram, bool vertical, double at, const char *mark,
                     const char *power, struct cs_text *out) {
    const double p = vertical ? to_y(diagram, at) : to_x(diagram, at);
    if (vertical)
        cs_text_add(out, "<path d=\"M%d %.1fH%d\" class=\"%s\"/>", LEFT, p, RIGHT,
                    *mark ? "g" : "h");
    else
        cs_text_add(out, "<path d=\"M%.1f %dV%d\" class=\"%s\"/>", p, TOP, BOTTOM,
                    *mark ? "g" : "h");
    if (*mark)
        cs_text_add(out,
                    "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">%s<tspan dy=\"-5\" "
                    "font-size=\"10\">%s</tspan></text>\n",
                    vertical ? LEFT - 6 : p, vertical ? p + 4 : BOTTOM + 18,
                    vertical ? "end" : "middle", mark, power);
}

/* Decades; below two of them 2 and 5 are labelled as well, so that an axis is never bare. */
static void add_axis(const struct diagram *diagram, bool vertical, struct cs_text *out) {
    const double *range = vertical ? diagram->y : diagram->x;
    const bool narrow = range[1] - range[0] < 2;
    for (int decade = (int)floor(range[0]); decade <= range[1]; decade++)
        for (int digit = 1; digit < 10; digit++) {
            const double at = decade + log10(digit);
            char mark[32] = "", power[16] = "";
            if (at < range[0] || at > range[1])
                continue;
            if (digit == 1 || (narrow && (digit == 2 || digit == 5))) {
                snprintf(mark, sizeof mark, digit == 1 ? "10" : "%d·10", digit);
                snprintf(power, sizeof power, "%d", decade);
            }
            add_tick(diagram, vertical, at, mark, power, out);
        }
}

/* What the reference's own error hides. */
static void add_bar(const struct diagram *diagram, struct cs_text *out) {
    const double bar = cs_plot_bar(diagram->settings);
    const double y = bar > 0 ? to_y(diagram, log10(bar)) : BOTTOM;
    if (y < BOTTOM)
        cs_text_add(out,
                    "<rect x=\"%d\" y=\"%.1f\" width=\"%d\" height=\"%.1f\" "
                    "fill=\"#ddd\"/>\n",
                    LEFT, fmax(y, TOP), RIGHT - LEFT, BOTTOM - fmax(y, TOP));
}

/* A staircase from the cheapest cell of the front to the most accurate. */
static void add_front(const struct diagram *diagram, struct cs_text *out) {
    double last = -HUGE_VAL;
    bool any = false;
    for (;;) {
        double x = 0, y = 0, least = HUGE_VAL, at = 0;
        for (uint32_t k = 0; diagram->front && k < diagram->settings->n; k++)
            if (diagram->front[k] && place(diagram, k, &x, &y) && x > last && x < least) {
                least = x;
                at = y;
            }
        if (least == HUGE_VAL)
            break;
        if (any)
            cs_text_add(out, "H%.1fV%.1f", to_x(diagram, least), to_y(diagram, at));
        else
            cs_text_add(out, "<path class=\"f\" d=\"M%.1f %.1f", to_x(diagram, least),
                        to_y(diagram, at));
        any = true;
        last = least;
    }
    if (any)
        cs_text_add(out, "\"/>\n");
}

static void add_marker(int shape, double x, double y, const char *colour, struct cs_text *out) {
    static const char *const paths[] = {"m-4 0a4 4 0 1 0 8 0a4 4 0 1 0 -8 0", "m-4 -4h8v8h-8z",
                                        "m0 -5l5 9h-10z", "m0 -5.5l5 5.5l-5 5.5l-5 -5.5z"};
    cs_text_add(out, "<path d=\"M%.1f %.1f%s\" fill=\"%s\"/>", x, y, paths[shape % 4], colour);
}

static void add_quartiles(const struct diagram *diagram, uint32_t k, double y,
                          const char *colour, struct cs_text *out) {
    const struct cs_cell *cell = diagram->settings->cells + k;
    if (strcmp(diagram->settings->x->name, "cpu") != 0 || !(cell->runs > 1) ||
        !(cell->cpu_low > 0))
        return;
    cs_text_add(out, "<path d=\"M%.1f %.1fH%.1fm0 -3v6\" stroke=\"%s\"/>",
                to_x(diagram, log10(cell->cpu_low)), y, to_x(diagram, log10(cell->cpu_high)),
                colour);
}

static void add_curve(const struct diagram *diagram, const struct curve *curve, int style,
                      struct cs_text *out) {
    const char *colour = colours[style % COLOURS];
    bool begun = false;
    double x, y;
    cs_text_add(out, "<path fill=\"none\" stroke=\"%s\" stroke-width=\"1.6\"%s d=\"", colour,
                style < COLOURS ? "" : " stroke-dasharray=\"6 4\"");
    for (uint32_t k = curve->first; k < curve->first + curve->n; k++)
        if (place(diagram, k, &x, &y)) {
            cs_text_add(out, "%c%.1f %.1f", begun ? 'L' : 'M', to_x(diagram, x),
                        to_y(diagram, y));
            begun = true;
        }
    cs_text_add(out, "\"/>\n");
    for (uint32_t k = curve->first; k < curve->first + curve->n; k++)
        if (place(diagram, k, &x, &y)) {
            add_quartiles(diagram, k, to_y(diagram, y), colour, out);
            add_marker(style, to_x(diagram, x), to_y(diagram, y), colour, out);
        }
}

static void add_key(const struct diagram *diagram, const struct curve *curve, int style,
                    struct cs_text *out) {
    const double y = TOP + 10 + 20.0 * style;
    const char *colour = colours[style % COLOURS];
    cs_text_add(out, "<path d=\"M%d %.1fh28\" stroke=\"%s\" stroke-width=\"1.6\"%s/>",
                RIGHT + 14, y, colour, style < COLOURS ? "" : " stroke-dasharray=\"6 4\"");
    add_marker(style, RIGHT + 28, y, colour, out);
    cs_text_add(out, "<text x=\"%d\" y=\"%.1f\">", RIGHT + 48, y + 4);
    cs_svg_add_text(out, diagram->settings->cells[curve->first].series);
    cs_text_add(out, "</text>\n");
}

/* The series that there was no room for, by name. */
static void add_rest(const struct diagram *diagram, struct cs_text *out) {
    bool any = false;
    for (uint32_t c = 0; c < diagram->n_curves; c++)
        if (!diagram->shown[c] && diagram->curves[c].drawn > 0) {
            cs_text_add(out, "%s", any ? ", " : "<p>Not drawn, but in the table: ");
            cs_svg_add_text(out, diagram->settings->cells[diagram->curves[c].first].series);
            any = true;
        }
    cs_text_add(out, "%s", any ? ".</p>\n" : "");
}

static void add_frame(const struct diagram *diagram, struct cs_text *out) {
    cs_text_add(out,
                "<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" fill=\"none\" "
                "stroke=\"#444\"/>\n",
                LEFT, TOP, RIGHT - LEFT, BOTTOM - TOP);
    cs_text_add(out, "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">", (LEFT + RIGHT) / 2,
                BOTTOM + 42);
    cs_svg_add_text(out, diagram->settings->x->label);
    cs_text_add(out,
                "</text>\n<text transform=\"translate(20 %d) rotate(-90)\" "
                "text-anchor=\"middle\">",
                (TOP + BOTTOM) / 2);
    cs_svg_add_text(out, diagram->settings->y->label);
    cs_text_add(out, "</text>\n");
}

void cs_svg_print(const struct cs_plot_settings *settings, const bool *front,
                  struct cs_text *out) {
    struct diagram diagram = {.settings = settings, .front = front};
    int style = 0;
    find_ranges(&diagram);
    find_curves(&diagram);
    choose_curves(&diagram);
    cs_text_add(out,
                "<svg viewBox=\"0 0 %d %d\" "
                "font-family=\"sans-serif\" font-size=\"13\">\n"
                "<style>.g{stroke:#ccc}.h{stroke:#eee}.f{stroke:#f0e442;stroke-width:7;"
                "fill:none}</style>\n",
                WIDTH, HEIGHT);
    add_bar(&diagram, out);
    add_axis(&diagram, false, out);
    add_axis(&diagram, true, out);
    add_front(&diagram, out);
    for (uint32_t c = 0; c < diagram.n_curves; c++)
        if (diagram.shown[c]) {
            add_curve(&diagram, diagram.curves + c, style, out);
            add_key(&diagram, diagram.curves + c, style++, out);
        }
    add_frame(&diagram, out);
    cs_text_add(out, "</svg>\n");
    add_rest(&diagram, out);
}

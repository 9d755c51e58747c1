/* Draws cells as a log-log diagram in SVG: axes on the data, front, curves, quartile bars. */
#include "study/compare/compare_curves.h"

#include <math.h>
#include <stdio.h>

/* Pixels of the picture and of the axes' box; y points down. */
enum { WIDTH = 920, HEIGHT = 520, LEFT = 78, RIGHT = 640, TOP = 16, BOTTOM = 460 };
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

/* Pixel of a decimal logarithm on the x axis. */
static double to_x(const struct cs_curves *curves, double x) {
    return LEFT + (x - curves->x[0]) / (curves->x[1] - curves->x[0]) * (RIGHT - LEFT);
}

/* Pixel of a decimal logarithm on the y axis. */
static double to_y(const struct cs_curves *curves, double y) {
    return BOTTOM - (y - curves->y[0]) / (curves->y[1] - curves->y[0]) * (BOTTOM - TOP);
}

/* Position of a cell in pixels; false: it is not drawn. */
static bool place(const struct cs_curves *curves, const struct cs_cell *cell, double *x,
                  double *y) {
    if (!cs_curves_point(curves->settings, cell, x, y))
        return false;
    *x = to_x(curves, log10(*x));
    *y = to_y(curves, log10(*y));
    return true;
}

/* One tick of an axis, with its grid line. */
static void add_tick(const struct cs_curves *curves, bool vertical, const struct cs_tick *tick,
                     struct cs_text *out) {
    const double p = vertical ? to_y(curves, tick->position) : to_x(curves, tick->position);
    char mark[32] = "10";
    if (vertical)
        cs_text_add(out, "<path d=\"M%d %.1fH%d\" class=\"%s\"/>", LEFT, p, RIGHT,
                    tick->label ? "g" : "h");
    else
        cs_text_add(out, "<path d=\"M%.1f %dV%d\" class=\"%s\"/>", p, TOP, BOTTOM,
                    tick->label ? "g" : "h");
    if (tick->digit > 1)
        snprintf(mark, sizeof mark, "%d·10", tick->digit);
    if (tick->label)
        cs_text_add(out,
                    "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">%s<tspan dy=\"-5\" "
                    "font-size=\"10\">%d</tspan></text>\n",
                    vertical ? LEFT - 6 : p, vertical ? p + 4 : BOTTOM + 18,
                    vertical ? "end" : "middle", mark, tick->decade);
}

static void add_axis(const struct cs_curves *curves, bool vertical, struct cs_text *out) {
    struct cs_tick ticks[CS_TICKS_MAX];
    const uint32_t n = cs_curves_ticks(vertical ? curves->y : curves->x, ticks);
    for (uint32_t k = 0; k < n; k++)
        add_tick(curves, vertical, ticks + k, out);
}

/* Grey area below the reference's own error. */
static void add_bar(const struct cs_curves *curves, struct cs_text *out) {
    if (!cs_curves_show_bar(curves))
        return;
    const double y = fmax(to_y(curves, log10(curves->error_bar)), TOP);
    cs_text_add(out,
                "<rect x=\"%d\" y=\"%.1f\" width=\"%d\" height=\"%.1f\" "
                "fill=\"#ddd\"/>\n",
                LEFT, y, RIGHT - LEFT, BOTTOM - y);
}

/* A staircase from the cheapest cell of the front to the most accurate. */
static void add_front(const struct cs_curves *curves, struct cs_text *out) {
    double x, y;
    bool any = false;
    for (uint32_t k = UINT32_MAX; cs_curves_front(curves, &k); any = true)
        if (place(curves, curves->settings->cells + k, &x, &y) && any)
            cs_text_add(out, "H%.1fV%.1f", x, y);
        else
            cs_text_add(out, "<path class=\"f\" d=\"M%.1f %.1f", x, y);
    if (any)
        cs_text_add(out, "\"/>\n");
}

/* A filled marker; shape and colour repeat with the number of the style. */
static void add_marker(int style, double x, double y, struct cs_text *out) {
    static const char *const paths[CS_CURVE_SHAPES] = {
        "m-4 0a4 4 0 1 0 8 0a4 4 0 1 0 -8 0", "m-4 -4h8v8h-8z", "m0 -5l5 9h-10z",
        "m0 -5.5l5 5.5l-5 5.5l-5 -5.5z", "m0 5l5 -9h-10z"};
    cs_text_add(out, "<path d=\"M%.1f %.1f%s\" fill=\"%s\"/>", x, y,
                paths[style % CS_CURVE_SHAPES], cs_curve_colours[style % CS_CURVE_COLOURS]);
}

/* Horizontal bar between the quartiles of the processor time. */
static void add_quartiles(const struct cs_curves *curves, const struct cs_cell *cell, double y,
                          const char *colour, struct cs_text *out) {
    if (cs_curves_quartiles(curves->settings, cell))
        cs_text_add(out, "<path d=\"M%.1f %.1fm0 -3v6m0 -3H%.1fm0 -3v6\" stroke=\"%s\"/>",
                    to_x(curves, log10(cell->cpu_low)), y, to_x(curves, log10(cell->cpu_high)),
                    colour);
}

/* Cross at the upper edge for a run that did not finish. */
static void add_cross(const struct cs_curves *curves, const struct cs_cell *cell,
                      const char *colour, struct cs_text *out) {
    double x;
    if (cs_curves_cross(curves, cell, &x))
        cs_text_add(out, "<path d=\"M%.1f %.1fm-4 -4l8 8m0 -8l-8 8\" stroke=\"%s\"/>",
                    to_x(curves, log10(x)), to_y(curves, log10(cs_curves_edge(curves))),
                    colour);
}

/* A ring marks a cell in which edges went through triangles. */
static void add_ring(double x, double y, struct cs_text *out) {
    cs_text_add(out, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"8\" class=\"r\"/>", x, y);
}

/* Line, bars, markers and rings of one series. Dashed lines distinguish repeated colours. */
static void add_curve(const struct cs_curves *curves, const struct cs_curve *curve,
                      struct cs_text *out) {
    const char *colour = cs_curve_colours[curve->style % CS_CURVE_COLOURS];
    const struct cs_cell *first = curves->settings->cells + curve->first;
    bool begun = false;
    double x, y;
    cs_text_add(out, "<path fill=\"none\" stroke=\"%s\" stroke-width=\"1.6\"%s d=\"", colour,
                curve->style < CS_CURVE_COLOURS ? "" : " stroke-dasharray=\"6 4\"");
    for (const struct cs_cell *cell = first; cell < first + curve->n; cell++)
        if (place(curves, cell, &x, &y)) {
            cs_text_add(out, "%c%.1f %.1f", begun ? 'L' : 'M', x, y);
            begun = true;
        }
    cs_text_add(out, "\"/>\n");
    for (const struct cs_cell *cell = first; cell < first + curve->n; cell++)
        if (place(curves, cell, &x, &y)) {
            add_quartiles(curves, cell, y, colour, out);
            add_marker(curve->style, x, y, out);
            if (cs_cell_has_crossings(cell))
                add_ring(x, y, out);
        } else
            add_cross(curves, cell, colour, out);
}

/* Entry of the legend. */
static void add_key(const struct cs_curves *curves, const struct cs_curve *curve,
                    struct cs_text *out) {
    const double y = TOP + 10 + 20.0 * curve->style;
    cs_text_add(out, "<path d=\"M%d %.1fh28\" stroke=\"%s\" stroke-width=\"1.6\"%s/>",
                RIGHT + 14, y, cs_curve_colours[curve->style % CS_CURVE_COLOURS],
                curve->style < CS_CURVE_COLOURS ? "" : " stroke-dasharray=\"6 4\"");
    add_marker(curve->style, RIGHT + 28, y, out);
    cs_text_add(out, "<text x=\"%d\" y=\"%.1f\">", RIGHT + 48, y + 4);
    cs_svg_add_text(out, curves->settings->cells[curve->first].series);
    cs_text_add(out, "</text>\n");
}

/* Explains the ring below the series. */
static void add_ring_key(const struct cs_curves *curves, struct cs_text *out) {
    double y = TOP + 10;
    uint32_t rings = 0;
    for (uint32_t c = 0; c < curves->n; c++)
        if (curves->list[c].style >= 0) {
            y += 20;
            rings += curves->list[c].crossing_marks;
        }
    if (rings == 0)
        return;
    add_ring(RIGHT + 28, y, out);
    cs_text_add(out, "<text x=\"%d\" y=\"%.1f\">edges through triangles</text>\n", RIGHT + 48,
                y + 4);
}

/* Names the series that had no room. */
static void add_omitted_series(const struct cs_curves *curves, struct cs_text *out) {
    bool any = false;
    for (uint32_t c = 0; c < curves->n; c++)
        if (curves->list[c].style < 0 && curves->list[c].is_drawn > 0) {
            cs_text_add(out, "%s", any ? ", " : "<p>Not drawn, but in the table: ");
            cs_svg_add_text(out, curves->settings->cells[curves->list[c].first].series);
            any = true;
        }
    cs_text_add(out, "%s",
                any ? ". <code>clothsim plot --family</code> draws them.</p>\n" : "");
}

static void add_label(const struct cs_column *column, struct cs_text *out) {
    struct cs_text label = {0};
    cs_column_add_label(column, &label);
    cs_svg_add_text(out, cs_text_get(&label));
    out->failed |= label.failed;
    cs_text_finish(&label);
}

/* Box and labels of the axes. */
static void add_frame(const struct cs_curves *curves, struct cs_text *out) {
    cs_text_add(out,
                "<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" fill=\"none\" "
                "stroke=\"#444\"/>\n",
                LEFT, TOP, RIGHT - LEFT, BOTTOM - TOP);
    cs_text_add(out, "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">", (LEFT + RIGHT) / 2,
                BOTTOM + 42);
    add_label(curves->settings->x, out);
    cs_text_add(out,
                "</text>\n<text transform=\"translate(20 %d) rotate(-90)\" "
                "text-anchor=\"middle\">",
                (TOP + BOTTOM) / 2);
    add_label(curves->settings->y, out);
    cs_text_add(out, "</text>\n");
}

void cs_svg_print(const struct cs_plot_settings *settings, struct cs_text *out) {
    struct cs_curves curves;
    cs_curves_make(&curves, settings);
    cs_text_add(out,
                "<svg viewBox=\"0 0 %d %d\" "
                "font-family=\"sans-serif\" font-size=\"13\">\n"
                "<style>.g{stroke:#ccc}.h{stroke:#eee}.f{stroke:%s;stroke-width:7;"
                "fill:none}.r{stroke:%s;stroke-width:1.6;fill:none}</style>\n",
                WIDTH, HEIGHT, CS_FRONT_COLOUR, CS_RING_COLOUR);
    add_bar(&curves, out);
    add_axis(&curves, false, out);
    add_axis(&curves, true, out);
    add_front(&curves, out);
    for (uint32_t c = 0; c < curves.n; c++)
        if (curves.list[c].style >= 0) {
            add_curve(&curves, curves.list + c, out);
            add_key(&curves, curves.list + c, out);
        }
    add_ring_key(&curves, out);
    add_frame(&curves, out);
    cs_text_add(out, "</svg>\n");
    add_omitted_series(&curves, out);
}

/* The module diagram-cairo.so: lays a diagram out and draws it as PNG, SVG or PDF.
 *
 *   surface -> title -> panels, row by row: boxes, grid, series, names at the right -> keys
 * All lengths are in points at print size. A first pass on an empty surface finds the height.
 */
#include "draw/cairo/cairo_marks.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PT_PER_MM  (72 / 25.4)
#define PNG_SCALE  (300 / 72.0)
#define GREY       0x404040u
#define GRID       0xdddddd
#define GRID_MINOR 0xf2f2f2
enum { GAP = 12, TICK = 3, LEADER = 6, APART = 9, NAMES_MAX = 64 };

/* The box of the axes of a panel. */
struct box {
    double left, top, width, height;
};

/* A name and where its line ends. */
struct name {
    const struct cs_series *series;
    double end[2], y; /* pt: the line's end; the name's height */
};

static double to_x(const struct box *box, const struct cs_panel *panel, double x) {
    return box->left + cs_plot_axis_at(&panel->x, x) * box->width;
}

static double to_y(const struct box *box, const struct cs_panel *panel, double y) {
    return box->top + (1 - cs_plot_axis_at(&panel->y, y)) * box->height;
}

/* Position of a point; false if an axis does not have it. */
static bool place(const struct box *box, const struct cs_panel *panel,
                  const struct cs_point *point, double *x, double *y) {
    *x = to_x(box, panel, point->x);
    *y = to_y(box, panel, point->y);
    return isfinite(*x) && isfinite(*y);
}

static void clip(cairo_t *cairo, const struct box *box) {
    cairo_save(cairo);
    cairo_rectangle(cairo, box->left, box->top, box->width, box->height);
    cairo_clip(cairo);
}

static void draw_boxes(cairo_t *cairo, const struct box *box, const struct cs_panel *panel) {
    /* between many cells white lines would be most of the picture */
    const bool apart = panel->n_boxes < 1000;
    clip(cairo, box);
    for (const struct cs_diagram_rect *cell = panel->boxes;
         cell < panel->boxes + panel->n_boxes; cell++) {
        const double x = to_x(box, panel, cell->left), y = to_y(box, panel, cell->top);
        cairo_rectangle(cairo, x, y, to_x(box, panel, cell->right) - x,
                        to_y(box, panel, cell->bottom) - y);
        cs_cairo_ink(cairo, cell->colour, 1);
        cairo_fill_preserve(cairo);
        cs_cairo_ink(cairo, apart ? 0xffffff : cell->colour, 1);
        cairo_set_line_width(cairo, 0.3);
        cairo_stroke(cairo);
    }
    cairo_restore(cairo);
}

/* Grid lines and tick marks; labels where there is room. labelled: this axis has them. */
static void draw_axis(cairo_t *cairo, const struct box *box, const struct cs_plot_axis *axis,
                      bool vertical, bool grid, bool labelled) {
    /* decades from a digit to the nearest one with a more important label, which needs room */
    static const double nearest[10] = {99, 99, 0.3, 0.17, 0, 0.3};
    struct cs_tick ticks[CS_TICKS_MAX];
    const uint32_t n = cs_plot_axis_ticks(axis, ticks);
    const double length = vertical ? box->height : box->width, bottom = box->top + box->height;
    const double room = length / (axis->range[1] - axis->range[0]), wide = vertical ? 9 : 30;
    for (uint32_t k = 0; k < n; k++) {
        const double at = length * cs_tick_at(axis, ticks + k);
        const double x = vertical ? box->left : box->left + at;
        const double y = vertical ? bottom - at : bottom,
                     tick = ticks[k].label ? TICK : TICK / 2;
        cairo_set_line_width(cairo, 0.4);
        cs_cairo_ink(cairo, ticks[k].label ? GRID : GRID_MINOR, 1);
        if (grid)
            cs_cairo_line(cairo, x, y, vertical ? x + box->width : x, vertical ? y : box->top);
        cs_cairo_ink(cairo, GREY, 1);
        cs_cairo_line(cairo, x, y, vertical ? x - tick : x, vertical ? y : y + tick);
        if (labelled && ticks[k].label && nearest[ticks[k].digit] * room > wide)
            cs_cairo_tick(cairo, ticks + k, vertical ? x - TICK - 2 : x,
                          vertical ? y + 0.36 * CS_FONT_SIZE : y + TICK + CS_FONT_SIZE + 1,
                          vertical ? 1 : 0.5);
    }
}

static void draw_band(cairo_t *cairo, const struct box *box, const struct cs_panel *panel,
                      const struct cs_series *series) {
    for (uint32_t k = 0; k < 2 * series->n; k++) {
        const bool back = k >= series->n;
        struct cs_point point = series->points[back ? 2 * series->n - 1 - k : k];
        double x, y;
        point.y = back ? point.low : point.high;
        if (place(box, panel, &point, &x, &y))
            cairo_line_to(cairo, x, y);
    }
    cs_cairo_ink(cairo, series->style.colour, 0.22);
    cairo_fill(cairo);
}

/* The line through the joined points; a gap where an axis has no such value. */
static void draw_line(cairo_t *cairo, const struct box *box, const struct cs_panel *panel,
                      const struct cs_series *series) {
    bool begun = false;
    double x, y, last = 0;
    for (const struct cs_point *p = series->points; p < series->points + series->n; p++) {
        if (!p->joined)
            continue;
        const bool there = place(box, panel, p, &x, &y);
        if (there && begun && series->kind == CS_SERIES_STAIRS)
            cairo_line_to(cairo, x, last);
        if (there && begun)
            cairo_line_to(cairo, x, y);
        else if (there)
            cairo_move_to(cairo, x, y);
        begun = there;
        last = y;
    }
    if (series->style.width > 0)
        cs_cairo_dash(cairo, &series->style);
    cairo_new_path(cairo);
}

/* Draws full marks only where they leave their line in sight, and the last of them. */
static void draw_marks(cairo_t *cairo, const struct box *box, const struct cs_panel *panel,
                       const struct cs_series *series, enum cs_mark mark) {
    double x, y, last[2] = {HUGE_VAL, HUGE_VAL};
    for (const struct cs_point *p = series->points; p < series->points + series->n; p++) {
        if (p->mark != mark || !place(box, panel, p, &x, &y))
            continue;
        cs_cairo_ink(cairo, series->style.colour, 1);
        cairo_set_line_width(cairo, 0.6);
        if (p->low < p->high)
            cs_cairo_line(cairo, to_x(box, panel, p->low), y, to_x(box, panel, p->high), y);
        if (mark != CS_MARK_FULL || hypot(x - last[0], y - last[1]) > APART ||
            p + 1 == series->points + series->n) {
            cs_cairo_mark(cairo, mark, &series->style, x, y);
            last[0] = x, last[1] = y;
        }
        if (p->ring)
            cs_cairo_ring(cairo, x, y);
        cs_cairo_title(cairo, panel, series, p, x, y);
    }
}

static void draw_series(cairo_t *cairo, const struct box *box, const struct cs_panel *panel) {
    const struct cs_series *end = panel->series + panel->n_series;
    clip(cairo, box);
    for (const struct cs_series *s = panel->series; s < end; s++)
        if (s->kind == CS_SERIES_BAND)
            draw_band(cairo, box, panel, s);
        else
            draw_line(cairo, box, panel, s);
    cairo_restore(cairo);
    /* full marks last: the sweep is what the eye must follow */
    for (enum cs_mark mark = CS_MARK_CROSS; mark > CS_MARK_NONE; mark--)
        for (const struct cs_series *s = panel->series; s < end; s++)
            if (s->kind == CS_SERIES_LINE)
                draw_marks(cairo, box, panel, s, mark);
}

/* --- names --- */

static int compare_names(const void *a, const void *b) {
    const struct name *one = a, *other = b;
    return one->y != other->y ? (one->y > other->y) - (one->y < other->y)
                              : (one->series > other->series) - (one->series < other->series);
}

/* Names of a panel from above, as near to the ends of their lines as their height lets them. */
static uint32_t find_names(const struct box *box, const struct cs_panel *panel,
                           struct name names[NAMES_MAX]) {
    uint32_t n = 0;
    for (const struct cs_series *s = panel->series; s < panel->series + panel->n_series; s++) {
        double x, y;
        struct name name = {.series = NULL};
        for (const struct cs_point *p = s->points; p < s->points + s->n; p++)
            if (p->joined && place(box, panel, p, &x, &y))
                name = (struct name){s, {x, y}, y};
        if (s->name && name.series && n < NAMES_MAX)
            names[n++] = name;
    }
    qsort(names, n, sizeof *names, compare_names);
    /* from above, then from below: none on another, none outside */
    const double bottom = box->top + box->height;
    const double apart = fmin(CS_LINE_HEIGHT, n ? box->height / n : 0);
    for (uint32_t k = 0; k < n; k++)
        names[k].y = fmax(names[k].y, k ? names[k - 1].y + apart : box->top + apart / 2);
    for (uint32_t k = n; k-- > 0;)
        names[k].y = fmin(names[k].y, k + 1 < n ? names[k + 1].y - apart : bottom - apart / 2);
    return n;
}

/* room: in pt, at the right of the box */
static void draw_names(cairo_t *cairo, const struct box *box, const struct cs_panel *panel,
                       double room) {
    struct name names[NAMES_MAX];
    const uint32_t n = find_names(box, panel, names);
    const double right = box->left + box->width;
    for (uint32_t k = 0; k < n; k++) {
        const struct cs_series *s = names[k].series;
        enum cs_mark mark = CS_MARK_NONE;
        for (uint32_t p = 0; p < s->n && mark != CS_MARK_FULL; p++)
            mark = s->points[p].joined ? s->points[p].mark : mark;
        cs_cairo_ink(cairo, s->style.colour, 0.6);
        cairo_set_line_width(cairo, 0.4);
        cs_cairo_line(cairo, names[k].end[0], names[k].end[1], right + LEADER, names[k].y);
        cs_cairo_sample(cairo, &s->style, mark, right + LEADER, names[k].y);
        cs_cairo_ink(cairo, 0, 1);
        cs_cairo_fitted(cairo, s->name, right + LEADER + CS_SAMPLE + 2,
                        names[k].y + 0.35 * CS_FONT_SIZE, 0, room - LEADER - CS_SAMPLE - 2);
    }
}

/* Width of the names at the right of all panels. */
static double names_width(cairo_t *cairo, const struct cs_diagram *diagram) {
    double width = 0;
    for (const struct cs_panel *p = diagram->panels; p < diagram->panels + diagram->n_panels;
         p++)
        for (uint32_t k = 0; k < p->n_series; k++)
            if (p->series[k].name)
                width = fmax(width, LEADER + CS_SAMPLE + 2 +
                                        cs_cairo_width(cairo, p->series[k].name, CS_FONT_SIZE));
    return width;
}

/* Width of the label of the y axis and of its ticks. */
static double ticks_width(cairo_t *cairo, const struct cs_diagram *diagram) {
    struct cs_tick ticks[CS_TICKS_MAX];
    double width = 0;
    for (uint32_t p = 0; p < diagram->n_panels; p++)
        for (uint32_t k = cs_plot_axis_ticks(&diagram->panels[p].y, ticks); k-- > 0;)
            if (ticks[k].label)
                width = fmax(width, cs_cairo_tick_width(cairo, ticks + k));
    return width + CS_FONT_SIZE + TICK + 6;
}

/* --- the page --- */

/* first: of its row, which has the labels of the y axis; names: room for them in pt, 0: none */
static void draw_panel(cairo_t *cairo, const struct box *box, const struct cs_panel *panel,
                       bool first, double names) {
    const double bottom = box->top + box->height, middle = box->top + box->height / 2;
    draw_boxes(cairo, box, panel);
    draw_axis(cairo, box, &panel->x, false, !panel->n_boxes || panel->n_boxes < 4, true);
    draw_axis(cairo, box, &panel->y, true, !panel->n_boxes || panel->n_boxes < 4, first);
    draw_series(cairo, box, panel);
    cs_cairo_ink(cairo, GREY, 1);
    cairo_set_line_width(cairo, 0.6);
    cairo_rectangle(cairo, box->left, box->top, box->width, box->height);
    cairo_stroke(cairo);
    cs_cairo_ink(cairo, 0, 1);
    cs_cairo_fitted(cairo, panel->x.label, box->left + box->width / 2,
                    bottom + TICK + 2 * CS_LINE_HEIGHT, 0.5, box->width + GAP);
    if (first) {
        cairo_save(cairo);
        cairo_translate(cairo, CS_MARGIN + CS_FONT_SIZE, middle);
        cairo_rotate(cairo, -M_PI / 2);
        cs_cairo_fitted(cairo, panel->y.label, 0, 0, 0.5, box->height + CS_LINE_HEIGHT);
        cairo_restore(cairo);
    }
    if (names > 0)
        draw_names(cairo, box, panel, names);
}

/* Draws everything; returns the height in pt. */
static double draw_page(cairo_t *cairo, const struct cs_diagram *diagram) {
    const double width = diagram->width * PT_PER_MM,
                 left = CS_MARGIN + ticks_width(cairo, diagram);
    const double names = fmin(names_width(cairo, diagram), 0.4 * width);
    const uint32_t columns = diagram->columns;
    const double wide =
        (width - left - names - CS_MARGIN - (columns - 1) * GAP) / (double)columns;
    double y = CS_MARGIN + (diagram->title ? CS_LINE_HEIGHT + 6 : 4), below = 0;
    cs_cairo_ink(cairo, 0, 1);
    if (diagram->title)
        cs_cairo_fitted(cairo, diagram->title, width / 2, CS_MARGIN + CS_FONT_SIZE, 0.5,
                        width - 2 * CS_MARGIN);
    /* rows of panels, each as high as its highest */
    for (uint32_t k = 0; k < diagram->n_panels; k++) {
        const struct cs_panel *panel = diagram->panels + k;
        const uint32_t column = k % columns;
        const struct box box = {left + column * (wide + GAP), y, wide, panel->aspect * wide};
        const bool last = column + 1 == columns || k + 1 == diagram->n_panels;
        draw_panel(cairo, &box, panel, column == 0, last ? names : 0);
        below = fmax(below, box.height + TICK + 2 * CS_LINE_HEIGHT + 9);
        if (last) {
            y += below;
            below = 0;
        }
    }
    y += CS_LINE_HEIGHT;
    cs_cairo_keys(cairo, diagram, width - CS_MARGIN, &y);
    return y - (diagram->n_keys ? CS_LINE_HEIGHT - CS_MARGIN : CS_LINE_HEIGHT);
}

/* --- surfaces --- */

/* Bytes as they come from cairo. */
static cairo_status_t store(void *closure, const unsigned char *bytes, unsigned n) {
    cs_text_add_bytes(closure, bytes, n);
    if (((struct cs_text *)closure)->failed)
        return CAIRO_STATUS_NO_MEMORY;
    return CAIRO_STATUS_SUCCESS;
}

static cairo_surface_t *make_surface(enum cs_format format, double width, double height,
                                     struct cs_text *out) {
    if (format == CS_FORMAT_SVG)
        return cairo_svg_surface_create_for_stream(store, out, width, height);
    if (format == CS_FORMAT_PNG)
        return cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)ceil(width * PNG_SCALE),
                                          (int)ceil(height * PNG_SCALE));
    cairo_surface_t *pdf = cairo_pdf_surface_create_for_stream(store, out, width, height);
    /* equal diagrams give equal files, whenever they were drawn */
    cairo_pdf_surface_set_metadata(pdf, CAIRO_PDF_METADATA_CREATE_DATE, "");
    return pdf;
}

/* Draws on a surface, and gathers titles unless they are NULL; returns the height. */
static double draw_on(cairo_surface_t *surface, double scale, const struct cs_diagram *diagram,
                      struct cs_text *titles) {
    cairo_font_options_t *options = cairo_font_options_create();
    cairo_t *cairo = cairo_create(surface);
    cs_cairo_gather_titles(cairo, titles);
    /* letters have the same shape and width in pixels as in the files without */
    cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
    cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
    cairo_set_font_options(cairo, options);
    cairo_font_options_destroy(options);
    cairo_select_font_face(cairo, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                           CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
    cairo_scale(cairo, scale, scale);
    cs_cairo_ink(cairo, 0xffffff, 1);
    cairo_paint(cairo);
    const double height = draw_page(cairo, diagram);
    cairo_destroy(cairo);
    return height;
}

static enum cs_status draw(const struct cs_diagram *diagram, enum cs_format format,
                           char **bytes, size_t *length, struct cs_error *error) {
    const double width = diagram->width * PT_PER_MM;
    const bool pixels = format == CS_FORMAT_PNG;
    const bool is_svg = format == CS_FORMAT_SVG;
    struct cs_text out = {0}, titles = {0};
    /* a first pass finds the height */
    cairo_surface_t *empty = cairo_image_surface_create(CAIRO_FORMAT_RGB24, 1, 1);
    cairo_surface_t *surface =
        make_surface(format, width, draw_on(empty, 1, diagram, NULL), &out);
    draw_on(surface, pixels ? PNG_SCALE : 1, diagram, is_svg ? &titles : NULL);
    cairo_status_t status = cairo_surface_status(surface);
    if (pixels && !status)
        status = cairo_surface_write_to_png_stream(surface, store, &out);
    cairo_surface_finish(surface);
    status = status ? status : cairo_surface_status(surface);
    cairo_surface_destroy(surface);
    cairo_surface_destroy(empty);
    if (is_svg)
        cs_cairo_finish_svg(&out, &titles);
    if (out.failed)
        status = CAIRO_STATUS_NO_MEMORY;
    *bytes = out.bytes;
    *length = out.length;
    if (!status)
        return CS_OK;
    free(out.bytes);
    *bytes = NULL;
    return cs_fail(error, status == CAIRO_STATUS_NO_MEMORY ? CS_ERR_MEMORY : CS_ERR_MODULE,
                   "cairo cannot draw a diagram: %s", cairo_status_to_string(status));
}

extern const struct cs_diagram_module clothsim_diagram;
const struct cs_diagram_module clothsim_diagram
    __attribute__((visibility("default"))) = {CS_DIAGRAM_ABI, draw};

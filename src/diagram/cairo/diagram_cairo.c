/* The module diagram-cairo.so: lays a diagram out and draws it as PNG, SVG or PDF.
 *
 *   surface -> title -> panels, row by row: boxes, grid, series, names at the right -> keys
 * Lengths are in points at print size. A first pass on an empty surface finds the height. */
#include "diagram/cairo/cairo_marks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PT_PER_MM  (72 / 25.4)
#define GREY       0x404040u
#define GRID       0xdddddd
#define GRID_MINOR 0xf2f2f2
enum { GAP = 12, TICK = 3, LEADER = 6, APART = 9, NAMES_MAX = 64 };
/* pt from the box of the axes to a name, beyond a line to its end and a sample. */
enum { NAME_LEFT = LEADER + CS_SAMPLE + 2 };

/* A panel, and the box of its axes in pt. */
struct view {
    cairo_t *cairo;
    struct cs_text *titles; /* of the marks of an SVG; NULL: not wanted */
    const struct cs_panel *panel;
    double left, top, width, height;
};

/* A name and where its line ends. */
struct name {
    const struct cs_series *series;
    double end[2], y; /* pt: the line's end; the name's height */
};

static double to_x(const struct view *view, double x) {
    return view->left + cs_plot_axis_at(&view->panel->x, x) * view->width;
}

static double to_y(const struct view *view, double y) {
    return view->top + (1 - cs_plot_axis_at(&view->panel->y, y)) * view->height;
}

/* Position of a point; false if an axis does not have it. */
static bool place(const struct view *view, double x, double y, double at[2]) {
    at[0] = to_x(view, x);
    at[1] = to_y(view, y);
    return isfinite(at[0]) && isfinite(at[1]);
}

static void clip(const struct view *view) {
    cairo_save(view->cairo);
    cairo_rectangle(view->cairo, view->left, view->top, view->width, view->height);
    cairo_clip(view->cairo);
}

static void draw_boxes(const struct view *view) {
    const struct cs_panel *panel = view->panel;
    /* between many cells white lines would be most of the picture */
    const bool apart = panel->n_boxes < 1000;
    clip(view);
    cairo_set_line_width(view->cairo, 0.3);
    for (uint32_t k = 0; k < panel->n_boxes; k++) {
        const struct cs_diagram_rect *cell = panel->boxes + k;
        const double x = to_x(view, cell->left), y = to_y(view, cell->top);
        cairo_rectangle(view->cairo, x, y, to_x(view, cell->right) - x,
                        to_y(view, cell->bottom) - y);
        cs_cairo_ink(view->cairo, cell->colour, 1);
        cairo_fill_preserve(view->cairo);
        cs_cairo_ink(view->cairo, apart ? 0xffffff : cell->colour, 1);
        cairo_stroke(view->cairo);
    }
    cairo_restore(view->cairo);
}

/* Every how many-th of the labels that are `space` apart has room, if the widest has `wide`. */
static int stride(double space, double wide) {
    return space >= wide ? 1 : 2 * space >= wide ? 2 : 5 * space >= wide ? 5 : 10;
}

/* Grid lines and tick marks; labels where there is room. labelled: this axis has them. */
static void draw_axis(const struct view *view, bool vertical, bool grid, bool labelled) {
    /* decades from a digit to the nearest one with a more important label */
    static const double nearest[10] = {0, 0, 0.3, 0.17, 0, 0.3};
    const struct cs_plot_axis *axis = vertical ? &view->panel->y : &view->panel->x;
    struct cs_tick ticks[CS_TICKS_MAX];
    const uint32_t n = cs_plot_axis_ticks(axis, ticks);
    const double length = vertical ? view->height : view->width;
    const double decade = length / (axis->range[1] - axis->range[0]);
    double wide = vertical ? CS_FONT_SIZE + 1 : 30;
    for (uint32_t k = 0; k < n && !vertical; k++)
        if (ticks[k].label)
            wide = fmax(wide, cs_cairo_tick(view->cairo, ticks + k, 0, CS_NO_Y, 0) + 4);
    const int every = stride(
        axis->logarithmic || n < 2 ? decade : (ticks[1].at - ticks[0].at) * length, wide);
    for (uint32_t k = 0; k < n; k++) {
        const struct cs_tick *tick = ticks + k;
        const double x = view->left + (vertical ? 0 : length * tick->at);
        const double y = view->top + view->height - (vertical ? length * tick->at : 0);
        const double mark = tick->label ? TICK : TICK / 2;
        cairo_set_line_width(view->cairo, 0.4);
        cs_cairo_ink(view->cairo, tick->label ? GRID : GRID_MINOR, 1);
        if (grid)
            cs_cairo_line(view->cairo, x, y, vertical ? x + view->width : x,
                          vertical ? y : view->top);
        cs_cairo_ink(view->cairo, GREY, 1);
        cs_cairo_line(view->cairo, x, y, vertical ? x - mark : x, vertical ? y : y + mark);
        const bool room =
            tick->digit > 1 ? nearest[tick->digit] * decade > wide : tick->decade % every == 0;
        if (labelled && tick->label && room)
            cs_cairo_tick(view->cairo, tick, vertical ? x - TICK - 2 : x,
                          vertical ? y + 0.36 * CS_FONT_SIZE : y + TICK + CS_FONT_SIZE + 1,
                          vertical ? 1 : 0.5);
    }
}

static void draw_band(const struct view *view, const struct cs_series *series) {
    double at[2];
    for (uint32_t k = 0; k < 2 * series->n; k++) {
        const bool back = k >= series->n;
        const struct cs_point *p = series->points + (back ? 2 * series->n - 1 - k : k);
        if (place(view, p->x, p->band[!back], at) && p->band[0] <= p->band[1])
            cairo_line_to(view->cairo, at[0], at[1]);
    }
    cs_cairo_ink(view->cairo, series->style.colour, 0.22);
    cairo_fill(view->cairo);
}

/* The line through the joined points; a gap where an axis has no such value. */
static void draw_line(const struct view *view, const struct cs_series *series) {
    bool begun = false;
    double at[2];
    for (const struct cs_point *p = series->points; p < series->points + series->n; p++) {
        if (!p->joined)
            continue;
        const bool there = place(view, p->x, p->y, at);
        if (there && begun)
            cairo_line_to(view->cairo, at[0], at[1]);
        else if (there)
            cairo_move_to(view->cairo, at[0], at[1]);
        begun = there;
    }
    cs_cairo_dash(view->cairo, &series->style);
}

/* Draws full marks only where they leave their line in sight, and the last of them. */
static void draw_marks(const struct view *view, const struct cs_series *series,
                       enum cs_mark mark) {
    double at[2], last[2] = {HUGE_VAL, HUGE_VAL};
    for (const struct cs_point *p = series->points; p < series->points + series->n; p++) {
        if (p->mark != mark || !place(view, p->x, p->y, at))
            continue;
        cs_cairo_ink(view->cairo, series->style.colour, 1);
        cairo_set_line_width(view->cairo, 0.6);
        if (p->low < p->high)
            cs_cairo_line(view->cairo, to_x(view, p->low), at[1], to_x(view, p->high), at[1]);
        if (mark != CS_MARK_FULL || hypot(at[0] - last[0], at[1] - last[1]) > APART ||
            p + 1 == series->points + series->n) {
            cs_cairo_mark(view->cairo, mark, &series->style, at[0], at[1]);
            memcpy(last, at, sizeof last);
        }
        if (p->ring)
            cs_cairo_mark(view->cairo, CS_MARK_RING, &series->style, at[0], at[1]);
        cs_cairo_title(view->titles, view->panel, series, p, at);
    }
}

static void draw_series(const struct view *view) {
    const struct cs_series *begin = view->panel->series, *end = begin + view->panel->n_series;
    clip(view);
    /* lines over bands and borders */
    for (const struct cs_series *s = begin; s < end; s++)
        if (!s->name)
            draw_line(view, s);
        else if (s->has_band)
            draw_band(view, s);
    for (const struct cs_series *s = begin; s < end; s++)
        if (s->name)
            draw_line(view, s);
    cairo_restore(view->cairo);
    /* full marks last: the sweep is what the eye must follow */
    for (enum cs_mark mark = CS_MARK_CROSS; mark > CS_MARK_NONE; mark--)
        for (const struct cs_series *s = begin; s < end; s++)
            draw_marks(view, s, mark);
}

/* --- names --- */

/* Names of a panel from above, as near to the ends of their lines as their height lets them. */
static uint32_t find_names(const struct view *view, struct name names[NAMES_MAX]) {
    const struct cs_panel *panel = view->panel;
    uint32_t n = 0;
    const struct cs_series *end = panel->series + (panel->is_single ? 0 : panel->n_series);
    for (const struct cs_series *s = panel->series; s < end; s++) {
        double at[2];
        struct name name = {.series = NULL};
        for (const struct cs_point *p = s->points; p < s->points + s->n; p++)
            if (p->joined && place(view, p->x, p->y, at))
                name = (struct name){s, {at[0], at[1]}, at[1]};
        if (!s->name || !name.series || n == NAMES_MAX)
            continue;
        uint32_t k = n++;
        for (; k > 0 && names[k - 1].y > name.y; k--)
            names[k] = names[k - 1];
        names[k] = name;
    }
    /* from above, then from below: none on another, none outside */
    const double bottom = view->top + view->height,
                 apart = fmin(CS_LINE_HEIGHT, n ? view->height / n : 0);
    for (uint32_t k = 0; k < n; k++)
        names[k].y = fmax(names[k].y, k ? names[k - 1].y + apart : view->top + apart / 2);
    for (uint32_t k = n; k-- > 0;)
        names[k].y = fmin(names[k].y, k + 1 < n ? names[k + 1].y - apart : bottom - apart / 2);
    return n;
}

static void draw_names(const struct view *view, double size) {
    cairo_t *cairo = view->cairo;
    struct name names[NAMES_MAX];
    const uint32_t n = find_names(view, names);
    const double x = view->left + view->width + LEADER;
    for (uint32_t k = 0; k < n; k++) {
        const struct cs_series *s = names[k].series;
        /* the sample has the mark of the line */
        enum cs_mark mark = CS_MARK_NONE;
        for (uint32_t p = 0; p < s->n && mark != CS_MARK_FULL; p++)
            mark = s->points[p].joined ? s->points[p].mark : mark;
        cs_cairo_ink(cairo, s->style.colour, 0.6);
        cairo_set_line_width(cairo, 0.4);
        cs_cairo_line(cairo, names[k].end[0], names[k].end[1], x, names[k].y);
        cs_cairo_sample(cairo, &s->style, mark, x, names[k].y);
        cs_cairo_ink(cairo, 0, 1);
        cs_cairo_text(cairo, s->name, x + CS_SAMPLE + 2, names[k].y + 0.35 * size, 0, size);
    }
}

/* Rooms of all panels in pt: widths of the y axes' labels at the left and of the names at the
 * right; heights of their labels, which are turned, and of the names. */
struct rooms {
    double left, right, label, names;
};

static struct rooms find_rooms(cairo_t *cairo, const struct cs_diagram *diagram) {
    struct rooms rooms = {0};
    struct cs_tick ticks[CS_TICKS_MAX];
    for (const struct cs_panel *p = diagram->panels; p < diagram->panels + diagram->n_panels;
         p++) {
        double names = 0;
        for (uint32_t k = 0; k < p->n_series && !p->is_single; k++)
            if (p->series[k].name) {
                rooms.right =
                    fmax(rooms.right, cs_cairo_width(cairo, p->series[k].name, CS_FONT_SIZE));
                names += CS_LINE_HEIGHT;
            }
        for (uint32_t k = cs_plot_axis_ticks(&p->y, ticks); k-- > 0;)
            if (ticks[k].label)
                rooms.left = fmax(rooms.left, cs_cairo_tick(cairo, ticks + k, 0, CS_NO_Y, 0));
        rooms.label = fmax(rooms.label, cs_cairo_width(cairo, p->y.label, CS_FONT_SIZE));
        rooms.names = fmax(rooms.names, names);
    }
    rooms.left += CS_MARGIN + CS_FONT_SIZE + TICK + 6;
    return rooms;
}

/* --- the page --- */

/* first: of its row, which has the labels of the y axis; lowest: of those that have its x axis;
 * names: size of their letters, 0: none */
static void draw_panel(const struct view *view, bool first, bool lowest, double names) {
    const struct cs_panel *panel = view->panel;
    const bool grid = panel->n_boxes < 4;
    cairo_t *cairo = view->cairo;
    draw_boxes(view);
    draw_axis(view, false, grid, lowest);
    draw_axis(view, true, grid, first);
    draw_series(view);
    cs_cairo_ink(cairo, GREY, 1);
    cairo_set_line_width(cairo, 0.6);
    cairo_rectangle(cairo, view->left, view->top, view->width, view->height);
    cairo_stroke(cairo);
    cs_cairo_ink(cairo, 0, 1);
    if (lowest)
        cs_cairo_fitted(cairo, panel->x.label, view->left + view->width / 2,
                        view->top + view->height + TICK + 2 * CS_LINE_HEIGHT, 0.5,
                        view->width + GAP);
    if (first) {
        cairo_save(cairo);
        cairo_translate(cairo, CS_MARGIN + CS_FONT_SIZE, view->top + view->height / 2);
        cairo_rotate(cairo, -M_PI / 2);
        cs_cairo_fitted(cairo, panel->y.label, 0, 0, 0.5, view->height + CS_LINE_HEIGHT);
        cairo_restore(cairo);
    }
    if (names > 0)
        draw_names(view, names);
}

/* True if the panel below has the same x axis. */
static bool shares_axis(const struct cs_diagram *diagram, uint32_t k) {
    const struct cs_plot_axis *a = &diagram->panels[k].x, *b = a;
    if (k + diagram->columns < diagram->n_panels)
        b = &diagram->panels[k + diagram->columns].x;
    return a != b && !strcmp(a->label, b->label) &&
           !memcmp(a->range, b->range, sizeof a->range);
}

/* Draws everything; returns the height in pt. titles: as in struct view. */
static double draw_page(cairo_t *cairo, const struct cs_diagram *diagram,
                        struct cs_text *titles) {
    const struct rooms rooms = find_rooms(cairo, diagram);
    const double width = diagram->width * PT_PER_MM;
    const uint32_t columns = diagram->columns;
    /* names have one size: smaller ones where the longest would take half of the width */
    const double room = fmin(rooms.right, 0.45 * width - NAME_LEFT),
                 size = rooms.right > 0 ? CS_FONT_SIZE * room / rooms.right : 0,
                 right =
                     size > 0 ? room + NAME_LEFT : CS_FONT_SIZE; /* half of a tick's label */
    const double wide =
        (width - rooms.left - right - CS_MARGIN - (columns - 1) * GAP) / (double)columns;
    double y = CS_MARGIN + (*diagram->title ? CS_LINE_HEIGHT + 6 : 4);
    cs_cairo_ink(cairo, 0, 1);
    if (*diagram->title)
        cs_cairo_fitted(cairo, diagram->title, width / 2, CS_MARGIN + CS_FONT_SIZE, 0.5,
                        width - 2 * CS_MARGIN);
    /* rows of panels, in each of which names and labels have room */
    for (uint32_t k = 0; k < diagram->n_panels; k++) {
        const struct cs_panel *panel = diagram->panels + k;
        const uint32_t column = k % columns;
        const double height =
            fmax(panel->aspect * wide, fmax(rooms.names, fmin(rooms.label, 0.8 * wide)));
        const struct view view = {cairo, titles, panel, rooms.left + column * (wide + GAP),
                                  y,     wide,   height};
        const bool last = column + 1 == columns || k + 1 == diagram->n_panels;
        const bool lowest = !shares_axis(diagram, k);
        draw_panel(&view, column == 0, lowest, last ? size : 0);
        if (last)
            y += height + (lowest ? TICK + 2 * CS_LINE_HEIGHT + 9 : GAP);
    }
    y += CS_LINE_HEIGHT;
    cs_cairo_keys(cairo, diagram, width - CS_MARGIN, &y);
    return y - (diagram->n_keys ? CS_LINE_HEIGHT - CS_MARGIN : CS_LINE_HEIGHT);
}

/* --- surfaces --- */

/* Draws on a surface, and gathers titles unless they are NULL; returns the height. */
static double draw_on(cairo_surface_t *surface, double scale, const struct cs_diagram *diagram,
                      struct cs_text *titles) {
    cairo_font_options_t *options = cairo_font_options_create();
    cairo_t *cairo = cairo_create(surface);
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
    const double height = draw_page(cairo, diagram, titles);
    cairo_destroy(cairo);
    return height;
}

static enum cs_status draw(const struct cs_diagram *diagram, enum cs_format format,
                           char **bytes, size_t *length, struct cs_error *error) {
    const double width = diagram->width * PT_PER_MM;
    const bool pixels = format == CS_FORMAT_PNG, is_svg = format == CS_FORMAT_SVG;
    struct cs_text out = {0}, titles = {0};
    /* a first pass finds the height */
    cairo_surface_t *empty = cairo_image_surface_create(CAIRO_FORMAT_RGB24, 1, 1);
    cairo_surface_t *surface =
        cs_cairo_make_surface(format, width, draw_on(empty, 1, diagram, NULL), &out);
    draw_on(surface, pixels ? CS_PNG_SCALE : 1, diagram, is_svg ? &titles : NULL);
    cairo_status_t status = cairo_surface_status(surface);
    if (pixels && !status)
        status = cs_cairo_png(surface, &out);
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

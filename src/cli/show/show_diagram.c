/* Draws a work-precision diagram in characters. */
#include "cli/show/screen.h"

#include "cli/line/print.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LEFT = 7, ROWS_MIN = 12, ROWS_MAX = 32 };

/* Letters of series; x is a run that did not finish, o one with crossings. */
static const char letters[] = "abcdefghijklmnpqrstuvwyz";

/* The box of the axes, rows from the top. */
struct box {
    const struct cs_screen *screen;
    const struct cs_curves *curves;
    uint32_t columns, rows; /* of the box, without axes */
    struct cs_screen_cell cells[ROWS_MAX][CS_SCREEN_COLUMNS_MAX];
};

static uint32_t colour_of(const char *hex) {
    return (uint32_t)strtoul(hex + 1, NULL, 16);
}

/* Black would be lost on a dark terminal. */
static uint32_t ink_of(const struct cs_curve *curve) {
    const uint32_t colour = colour_of(cs_curve_colours[curve->style % CS_CURVE_COLOURS]);
    return colour ? colour : CS_SCREEN_DEFAULT;
}

static char letter_of(const struct cs_curve *curve) {
    return letters[(size_t)curve->style % (sizeof letters - 1)];
}

/* The curve that a cell is on, or NULL: there are more than curves can be. */
static const struct cs_curve *curve_of(const struct cs_curves *curves, uint32_t cell) {
    for (const struct cs_curve *c = curves->list; c < curves->list + curves->n; c++)
        if (cell < c->first + c->n)
            return c;
    return NULL;
}

static uint32_t position(double at, const double range[2], uint32_t n) {
    const double part = (at - range[0]) / (range[1] - range[0]) * n;
    return (uint32_t)fmin(fmax(part, 0), n - 1);
}

/* Row and column of a point in data coordinates. */
struct place {
    uint32_t row, column;
};

static struct place place_of(const struct box *box, double x, double y) {
    return (struct place){box->rows - 1 - position(log10(y), box->curves->y, box->rows),
                          position(log10(x), box->curves->x, box->columns)};
}

static void put(struct box *box, double x, double y, struct cs_screen_cell cell) {
    const struct place at = place_of(box, x, y);
    box->cells[at.row][at.column] = cell;
}

static void clear(struct box *box) {
    for (uint32_t r = 0; r < box->rows; r++)
        for (uint32_t c = 0; c < box->columns; c++)
            box->cells[r][c] =
                (struct cs_screen_cell){.ink = CS_SCREEN_DEFAULT, .paper = CS_SCREEN_DEFAULT};
}

/* Marks from one cell of the front to the next: along the row of the first, then down. */
static void draw_step(struct box *box, double x0, double y0, double x1, double y1) {
    const struct cs_screen_cell front = {
        .plain = '.', .ink = 0, .paper = colour_of(CS_FRONT_COLOUR)};
    const struct place from = place_of(box, x0, y0), to = place_of(box, x1, y1);
    for (uint32_t c = from.column; c <= to.column; c++)
        box->cells[from.row][c] = front;
    for (uint32_t r = from.row; r <= to.row; r++)
        box->cells[r][to.column] = front;
}

static void draw_front(struct box *box) {
    const struct cs_plot_settings *settings = box->curves->settings;
    double last[2] = {0, 0}, x, y;
    for (uint32_t k = UINT32_MAX; cs_curves_front(box->curves, &k);) {
        cs_curves_point(settings, settings->cells + k, &x, &y);
        if (last[0] > 0)
            draw_step(box, last[0], last[1], x, y);
        last[0] = x;
        last[1] = y;
    }
}

static void draw_cells(struct box *box, const struct cs_curve *curve) {
    const struct cs_plot_settings *settings = box->curves->settings;
    for (uint32_t k = curve->first; k < curve->first + curve->n; k++) {
        const struct cs_cell *cell = settings->cells + k;
        struct cs_screen_cell mark = {
            .plain = letter_of(curve), .ink = ink_of(curve), .paper = CS_SCREEN_DEFAULT};
        double x, y;
        if (cs_curves_point(settings, cell, &x, &y)) {
            if (cs_cell_has_crossings(cell))
                mark = (struct cs_screen_cell){
                    .plain = 'o', .ink = colour_of(CS_RING_COLOUR), .paper = CS_SCREEN_DEFAULT};
            put(box, x, y, mark);
        } else if (cs_curves_cross(box->curves, cell, &x)) {
            mark.plain = 'x';
            put(box, x, cs_curves_edge(box->curves), mark);
        }
    }
}

/* Cells of the front come last, in capitals, since others may lie on them. */
static void draw_front_cells(struct box *box) {
    const struct cs_plot_settings *settings = box->curves->settings;
    double x, y;
    for (uint32_t k = UINT32_MAX; cs_curves_front(box->curves, &k);) {
        const struct cs_curve *curve = curve_of(box->curves, k);
        const bool crossed = cs_cell_has_crossings(settings->cells + k);
        cs_curves_point(settings, settings->cells + k, &x, &y);
        if (curve && curve->style >= 0)
            put(box, x, y,
                (struct cs_screen_cell){.plain =
                                            crossed ? 'O' : (char)toupper(letter_of(curve)),
                                        .ink = 0,
                                        .paper = colour_of(CS_FRONT_COLOUR)});
    }
}

/* The rows with the labels of the y axis. */
static void add_rows(const struct box *box, struct cs_text *out) {
    char labels[ROWS_MAX][24] = {""};
    struct cs_tick ticks[CS_TICKS_MAX];
    const uint32_t n = cs_curves_ticks(box->curves->y, ticks);
    for (uint32_t k = 0; k < n; k++) {
        char *label =
            labels[box->rows - 1 - position(ticks[k].position, box->curves->y, box->rows)];
        if (ticks[k].label && !*label)
            snprintf(label, sizeof *labels, "%de%d", ticks[k].digit, ticks[k].decade);
    }
    for (uint32_t r = 0; r < box->rows; r++) {
        cs_text_add(out, "%*s%c", LEFT - 1, labels[r], *labels[r] ? '+' : '|');
        cs_screen_add_row(box->screen, box->cells[r], box->columns, out);
    }
}

/* The x axis and its labels, each below the middle of its tick where there is room. */
static void add_x_axis(const struct box *box, struct cs_text *out) {
    char axis[CS_SCREEN_COLUMNS_MAX + 1], labels[CS_SCREEN_COLUMNS_MAX + 1] = "";
    struct cs_tick ticks[CS_TICKS_MAX];
    const uint32_t n = cs_curves_ticks(box->curves->x, ticks), end = LEFT + box->columns;
    size_t length = 0;
    memset(axis, '-', box->columns);
    axis[box->columns] = 0;
    for (uint32_t k = 0; k < n; k++) {
        char label[24];
        const uint32_t at = position(ticks[k].position, box->curves->x, box->columns);
        const size_t width =
            (size_t)snprintf(label, sizeof label, "%de%d", ticks[k].digit, ticks[k].decade);
        const size_t start = LEFT + at - width / 2;
        /* labels that would touch the one before or end outside are left out */
        if (!ticks[k].label || start < length + (length > 0) || start + width > end)
            continue;
        axis[at] = '+';
        length += (size_t)snprintf(labels + length, sizeof labels - length, "%*s%s",
                                   (int)(start - length), "", label);
    }
    cs_text_add(out, "%*s+%s\n%s\n", LEFT - 1, "", axis, labels);
}

/* The name of an axis, wrapped. */
static void add_label(const struct box *box, const char *way, const struct cs_column *column,
                      struct cs_text *out) {
    struct cs_text label = {0};
    cs_column_add_label(column, &label);
    cs_print_wrapped(way, cs_text_get(&label), strlen(way) + 1, box->screen->columns, out);
    out->failed |= label.failed;
    cs_text_finish(&label);
}

/* The letter of each series, in their order. */
static void add_letters(const struct box *box, struct cs_text *out) {
    const struct cs_curves *curves = box->curves;
    for (int style = 0; style < (int)curves->n; style++)
        for (const struct cs_curve *c = curves->list; c < curves->list + curves->n; c++)
            if (c->style == style) {
                const struct cs_screen_cell letter = {
                    .plain = letter_of(c), .ink = ink_of(c), .paper = CS_SCREEN_DEFAULT};
                cs_screen_add_key(box->screen, &letter,
                                  curves->settings->cells[c->first].series, out);
            }
}

/* Explains letters and marks, wrapped. */
static void add_key(const struct box *box, struct cs_text *out) {
    const struct cs_curves *curves = box->curves;
    const uint32_t width = box->screen->columns, left_out = cs_curves_left_out(curves);
    uint32_t crosses = 0, crossings = 0;
    char more[80];
    add_letters(box, out);
    for (const struct cs_curve *c = curves->list; c < curves->list + curves->n; c++) {
        crosses += c->style >= 0 ? c->failed_marks : 0;
        crossings += c->style >= 0 ? c->crossing_marks : 0;
    }
    if (curves->n)
        cs_print_wrapped("A.B", "the front: nothing is both cheaper and more accurate", 4,
                         width, out);
    else
        cs_print_wrapped("", "no cell has both values", 0, width, out);
    /* marks are explained only if they occur */
    if (crosses)
        cs_print_wrapped("x", "did not finish", 2, width, out);
    if (crossings)
        cs_print_wrapped("o", "edges through triangles", 2, width, out);
    snprintf(more, sizeof more, "%u more series: clothsim plot --family draws them", left_out);
    if (left_out)
        cs_print_wrapped("", more, 0, width, out);
}

void cs_screen_print_diagram(const struct cs_screen *screen,
                             const struct cs_plot_settings *settings, struct cs_text *out) {
    struct cs_curves curves;
    struct box box = {.screen = screen, .curves = &curves};
    cs_curves_make(&curves, settings);
    box.columns = screen->columns - LEFT - 1;
    box.rows = box.columns * 3 / 10;
    box.rows = box.rows < ROWS_MIN ? ROWS_MIN : box.rows > ROWS_MAX ? ROWS_MAX : box.rows;
    clear(&box);
    /* the front lies below the cells, its own cells on top */
    draw_front(&box);
    for (uint32_t c = 0; c < curves.n; c++)
        if (curves.list[c].style >= 0)
            draw_cells(&box, curves.list + c);
    draw_front_cells(&box);
    cs_print_wrapped("", settings->title, 0, screen->columns, out);
    add_label(&box, "up:", settings->y, out);
    add_label(&box, "right:", settings->x, out);
    add_rows(&box, out);
    add_x_axis(&box, out);
    add_key(&box, out);
}

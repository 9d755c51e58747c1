/* Draws diagrams and pictures in characters. */
#include "cli/show/screen.h"

#include "cli/line/print.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { LEFT = 8, ROWS_MIN = 6, ROWS_MAX = 40 };

/* Letters of series; x is a run that did not finish, o one with crossings. */
static const char letters[] = "abcdefghijklmnpqrstuvwyz";

/* The box of the axes, rows from the top. */
struct box {
    const struct cs_screen *screen;
    const struct cs_panel *panel;
    uint32_t columns, rows; /* of the box, without axes */
    struct cs_screen_cell cells[ROWS_MAX][CS_SCREEN_COLUMNS_MAX];
};

/* Row and column of a point in data coordinates. */
struct place {
    uint32_t row, column;
};

/* Black would be lost on a dark terminal. */
static uint32_t ink_of(const struct cs_style *style) {
    return style->colour ? style->colour : CS_SCREEN_DEFAULT;
}

/* Letter of a series, by its place among those with a name. */
static char letter_of(const struct cs_panel *panel, const struct cs_series *series) {
    size_t n = 0;
    for (const struct cs_series *s = panel->series; s < series; s++)
        n += s->name != NULL;
    return letters[n % (sizeof letters - 1)];
}

static uint32_t position(double part, uint32_t n) {
    return (uint32_t)fmin(fmax(part * n, 0), n - 1);
}

static struct place place_of(const struct box *box, double x, double y) {
    return (struct place){box->rows - 1 -
                              position(cs_plot_axis_at(&box->panel->y, y), box->rows),
                          position(cs_plot_axis_at(&box->panel->x, x), box->columns)};
}

static void put(struct box *box, double x, double y, char letter, uint32_t ink,
                uint32_t paper) {
    const struct place at = place_of(box, x, y);
    if (!isfinite(cs_plot_axis_at(&box->panel->x, x)) ||
        !isfinite(cs_plot_axis_at(&box->panel->y, y)))
        return;
    box->cells[at.row][at.column] =
        (struct cs_screen_cell){.plain = letter, .ink = ink, .paper = paper};
}

/* Middle of two values on an axis. */
static double middle(const struct cs_plot_axis *axis, double a, double b) {
    return axis->logarithmic ? sqrt(a * b) : (a + b) / 2;
}

/* Fills the rectangle between two places. */
static void fill(struct box *box, struct place from, struct place to,
                 struct cs_screen_cell cell) {
    for (uint32_t r = from.row; r <= to.row; r++)
        for (uint32_t c = from.column; c <= to.column; c++)
            box->cells[r][c] = cell;
}

static void draw_boxes(struct box *box) {
    const struct cs_panel *panel = box->panel;
    for (uint32_t k = 0; k < panel->n_boxes; k++) {
        const struct cs_diagram_rect *b = panel->boxes + k;
        /* the far edges are those of the next box */
        fill(box, place_of(box, b->left, b->top), place_of(box, b->right, b->bottom),
             (struct cs_screen_cell){.plain = ' ', .paper = b->colour});
    }
    for (uint32_t k = 0; k < panel->n_boxes; k++) {
        const struct cs_diagram_rect *b = panel->boxes + k;
        put(box, middle(&panel->x, b->left, b->right), middle(&panel->y, b->bottom, b->top),
            b->letter, 0, b->colour);
    }
}

/* Fills a border from one point to the next, which stand in one row or column. */
static void draw_border(struct box *box, const struct cs_series *series) {
    const struct cs_screen_cell step = {.plain = '.', .paper = series->style.colour};
    for (uint32_t k = 1; k < series->n; k++) {
        const struct cs_point *p = series->points + k;
        fill(box, place_of(box, p[-1].x, p[-1].y), place_of(box, p->x, p->y), step);
    }
}

/* front: those of the front alone, which come last and in capitals, or all others. */
static void draw_points(struct box *box, const struct cs_series *series, bool front) {
    const char letter = letter_of(box->panel, series);
    for (const struct cs_point *p = series->points; p < series->points + series->n; p++) {
        const char mark = p->mark == CS_MARK_CROSS ? 'x' : p->ring ? 'o' : letter;
        if (p->front == front)
            put(box, p->x, p->y, (char)(front ? toupper(mark) : mark),
                front     ? 0
                : p->ring ? CS_RING_COLOUR
                          : ink_of(&series->style),
                front ? CS_FRONT_COLOUR : CS_SCREEN_DEFAULT);
    }
}

/* Number of the series that are drawn: none over boxes with letters, which they would hide. */
static uint32_t drawn_series(const struct cs_panel *panel) {
    return panel->n_boxes && panel->boxes->letter != ' ' ? 0 : panel->n_series;
}

/* Later ones lie on earlier ones. */
static void draw(struct box *box) {
    const struct cs_panel *panel = box->panel;
    const struct cs_series *end = panel->series + drawn_series(panel);
    fill(box, (struct place){0, 0}, (struct place){box->rows - 1, box->columns - 1},
         (struct cs_screen_cell){.ink = CS_SCREEN_DEFAULT, .paper = CS_SCREEN_DEFAULT});
    draw_boxes(box);
    for (const struct cs_series *s = panel->series; s < end; s++)
        if (!s->name)
            draw_border(box, s);
    for (int front = 0; front < 2; front++)
        for (const struct cs_series *s = panel->series; s < end; s++)
            if (s->name)
                draw_points(box, s, front);
}

static void print_label(const struct cs_tick *tick, char label[32]) {
    if (tick->plain)
        snprintf(label, 32, "%.6g", tick->value);
    else
        snprintf(label, 32, "%de%d", tick->digit, tick->decade);
}

/* The rows with the labels of the y axis. */
static void add_rows(const struct box *box, struct cs_text *out) {
    char labels[ROWS_MAX][32] = {""};
    struct cs_tick ticks[CS_TICKS_MAX];
    const uint32_t n = cs_plot_axis_ticks(&box->panel->y, ticks);
    for (uint32_t k = 0; k < n; k++) {
        char *label = labels[box->rows - 1 - position(ticks[k].at, box->rows)];
        if (ticks[k].label && !*label)
            print_label(ticks + k, label);
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
    const uint32_t n = cs_plot_axis_ticks(&box->panel->x, ticks), end = LEFT + box->columns;
    size_t length = 0;
    memset(axis, '-', box->columns);
    axis[box->columns] = 0;
    for (uint32_t k = 0; k < n; k++) {
        char label[32];
        const uint32_t at = position(ticks[k].at, box->columns);
        print_label(ticks + k, label);
        const size_t width = strlen(label), start = LEFT + at - width / 2;
        /* labels that would touch the one before or end outside are left out */
        if (!ticks[k].label || start < length + (length > 0) || start + width > end)
            continue;
        axis[at] = '+';
        length += (size_t)snprintf(labels + length, sizeof labels - length, "%*s%s",
                                   (int)(start - length), "", label);
    }
    cs_text_add(out, "%*s+%s\n%s\n", LEFT - 1, "", axis, labels);
}

/* The letter of each series of the panels, in their order; then the keys. */
static void add_keys(const struct cs_screen *screen, const struct cs_diagram *diagram,
                     struct cs_text *out) {
    uint32_t column = 0;
    for (uint32_t p = 0; p < diagram->n_panels; p++)
        for (uint32_t k = 0; k < drawn_series(diagram->panels + p); k++) {
            const struct cs_series *s = diagram->panels[p].series + k;
            const struct cs_screen_cell letter = {.plain = letter_of(diagram->panels + p, s),
                                                  .ink = ink_of(&s->style),
                                                  .paper = CS_SCREEN_DEFAULT};
            if (s->name && s->n)
                cs_screen_add_key(screen, &letter, s->name, &column, out);
        }
    /* a patch is the paper of its letter, a line or mark its ink */
    for (const struct cs_key *key = diagram->keys; key < diagram->keys + diagram->n_keys;
         key++) {
        const bool paper = key->kind == CS_KEY_PATCH || key->letter == 'A';
        const struct cs_screen_cell letter = {.plain = key->letter,
                                              .ink = paper ? 0 : CS_SCREEN_DEFAULT,
                                              .paper = paper ? key->style.colour
                                                             : CS_SCREEN_DEFAULT};
        char text[2 * CS_LABEL_BYTES];
        snprintf(text, sizeof text, "%s%s%s", key->text, key->help ? ": " : "",
                 key->help ? key->help : "");
        if (key->letter)
            cs_screen_add_key(screen, &letter, text, &column, out);
    }
    cs_text_add(out, "%s", column ? "\n" : "");
}

static void add_panel(struct box *box, struct cs_text *out) {
    cs_print_wrapped("up:", box->panel->y.label, 4, box->screen->columns, out);
    cs_print_wrapped("right:", box->panel->x.label, 7, box->screen->columns, out);
    draw(box);
    add_rows(box, out);
    add_x_axis(box, out);
}

void cs_screen_print_diagram(const struct cs_screen *screen, const struct cs_diagram *diagram,
                             struct cs_text *out) {
    struct cs_text keys = {0}, title = {0};
    struct box box = {.screen = screen, .columns = screen->columns - LEFT - 1};
    add_keys(screen, diagram, &keys);
    cs_text_add_plain(&title, diagram->title);
    cs_print_wrapped("", cs_text_get(&title), 0, screen->columns, out);
    /* of the window's height what text and axes leave, with a line for the next command */
    uint32_t others = 2 + 4 * diagram->n_panels;
    for (const char *c = cs_text_get(&keys); *c; c++)
        others += *c == '\n';
    const uint32_t rows =
        screen->rows > others ? (screen->rows - others) / diagram->n_panels : 0;
    box.rows = rows < ROWS_MIN ? ROWS_MIN : rows > ROWS_MAX ? ROWS_MAX : rows;
    for (uint32_t k = 0; k < diagram->n_panels; k++) {
        box.panel = diagram->panels + k;
        add_panel(&box, out);
    }
    cs_text_add(out, "%s", cs_text_get(&keys));
    out->failed |= keys.failed || title.failed;
    cs_text_finish(&keys);
    cs_text_finish(&title);
}

/* Shows images: as such where the terminal can, else as half blocks, two pixels per character.
 */

/* Rows of the window that stay free: the caption, and the line of the cursor. */
enum { FREE_ROWS = 2 };

/* The largest size in characters with the proportions of the image. */
static void find_size(const struct cs_screen *screen, const struct cs_image *image,
                      uint32_t size[2]) {
    /* half blocks make square pixels where a character is twice as high as wide */
    const bool blocks = screen->graphics == CS_SCREEN_CHARACTERS;
    const double shape = blocks ? 2 : screen->cell[1] / screen->cell[0];
    const double rows_max = screen->rows > FREE_ROWS ? screen->rows - FREE_ROWS : 1;
    const double wide = shape * rows_max * image->width / image->height;
    size[0] = (uint32_t)fmax(1, fmin(screen->columns, floor(wide)));
    size[1] = (uint32_t)fmax(
        1, fmin(rows_max, floor(size[0] * (double)image->height / image->width / shape + 0.5)));
}

/* Packs a pixel as 0xRRGGBB. */
static uint32_t colour_of(const struct cs_image *image, uint32_t x, uint32_t y) {
    const uint8_t *rgb = image->rgb + 3 * ((size_t)y * image->width + x);
    return (uint32_t)rgb[0] << 16 | (uint32_t)rgb[1] << 8 | rgb[2];
}

/* A character with as much ink as the two pixels have light. */
static char shade_of(const struct cs_screen *screen, uint32_t above, uint32_t below) {
    static const char shades[] = " .:-=+*#%@";
    static const double weights[3] = {0.0722, 0.7152, 0.2126}; /* of blue, green, red: BT.709 */
    double light = 0;
    for (int k = 0; k < 3; k++)
        light += weights[k] / 2 *
                 (double)(screen->srgb.linear[above >> 8 * k & 255] +
                          screen->srgb.linear[below >> 8 * k & 255]);
    const uint32_t byte = cs_srgb_encode(&screen->srgb, (float)fmin(light, 1));
    return shades[byte * (sizeof shades - 1) / 256];
}

/* image: of a pixel per column and two per row. */
static void add_blocks(const struct cs_screen *screen, const struct cs_image *image,
                       struct cs_text *out) {
    struct cs_screen_cell row[CS_SCREEN_COLUMNS_MAX];
    for (uint32_t y = 0; y < image->height; y += 2) {
        for (uint32_t x = 0; x < image->width; x++) {
            const uint32_t above = colour_of(image, x, y), below = colour_of(image, x, y + 1);
            row[x] =
                (struct cs_screen_cell){"\u2580", shade_of(screen, above, below), above, below};
        }
        cs_screen_add_row(screen, row, image->width, out);
    }
}

/* In pieces of at most 4096 bytes. The number of the image replaces the last one. */
static void add_kitty(const struct cs_image *image, const uint32_t size[2],
                      struct cs_text *out) {
    enum { PIXELS = 1024 };
    const size_t n = (size_t)image->width * image->height;
    cs_text_add(out, "\033_Ga=T,f=24,s=%u,v=%u,c=%u,r=%u,i=%ld,p=1,q=2,C=1,", image->width,
                image->height, size[0], size[1], (long)getpid());
    for (size_t k = 0; k < n; k += PIXELS) {
        const size_t some = n - k < PIXELS ? n - k : PIXELS;
        cs_text_add(out, "%sm=%d;", k ? "\033_G" : "", k + some < n);
        cs_text_add_base64(out, image->rgb + 3 * k, 3 * some);
        cs_text_add(out, "\033\\");
    }
}

/* Makes room, draws without regard to where that leaves the cursor, and goes below. */
static bool add_graphics(const struct cs_screen *screen, const struct cs_image *image,
                         const uint32_t size[2], struct cs_text *out) {
    bool drawn = true;
    for (uint32_t k = 0; k < size[1]; k++)
        cs_text_add(out, "\n");
    cs_text_add(out, "\033[%uA\0337", size[1]);
    if (screen->graphics == CS_SCREEN_KITTY)
        add_kitty(image, size, out);
    else
        drawn = cs_sixel_add(image, out);
    cs_text_add(out, "\0338\033[%uB", size[1]);
    return drawn;
}

/* Pixels of the image on the screen. Images are not enlarged here: kitty does that itself. */
static void find_pixels(const struct cs_screen *screen, const struct cs_image *image,
                        const uint32_t size[2], uint32_t pixels[2]) {
    const bool blocks = screen->graphics == CS_SCREEN_CHARACTERS;
    const uint32_t whole[2] = {image->width, image->height};
    for (int k = 0; k < 2; k++) {
        const uint32_t shown = (uint32_t)fmax(1, floor(size[k] * screen->cell[k]));
        pixels[k] = blocks ? size[k] << k : shown < whole[k] ? shown : whole[k];
    }
}

enum cs_status cs_screen_show_image(struct cs_screen *screen, const struct cs_image *image,
                                    const char *caption, struct cs_error *error) {
    uint32_t size[2], pixels[2];
    struct cs_text out = {0};
    find_size(screen, image, size);
    find_pixels(screen, image, size, pixels);
    struct cs_image shown = {pixels[0], pixels[1], malloc(3 * (size_t)pixels[0] * pixels[1]),
                             NULL};
    if (!shown.rgb)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for --show");
    cs_srgb_shrink(&screen->srgb, image, pixels, 0, &shown);
    /* back to the upper left corner of the last image */
    if (screen->image_rows)
        cs_text_add(&out, "\033[%uA\r", screen->image_rows);
    screen->image_rows = size[1] + 1;
    if (screen->graphics == CS_SCREEN_CHARACTERS)
        add_blocks(screen, &shown, &out);
    else if (!add_graphics(screen, &shown, size, &out))
        cs_fail(error, CS_ERR_FILE, "--show: libsixel failed");
    free(shown.rgb);
    cs_text_add(&out, "%s\033[K\n", caption);
    if (!error->status)
        return cs_print_raw(stdout, &out, error);
    cs_text_finish(&out);
    return error->status;
}

/* Lays pictures out on a sheet: white paper, dark ink. */
#include "film/film_sheet.h"
#include "film/image_lines.h"

#include "base/file.h"
#include "base/image.h"
#include "base/serialise.h"
#include "draw/glyph.h"
#include "draw/srgb.h"
#include "export/npy.h"
#include "session/frame_picture.h"
#include "session/scene_view.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    PATH_BYTES = 4096,
    GAP = 8,
    CAPTION = 16,
    LETTER = 8, /* height of a figure */
    BAR_WIDTH = 92,
    BAR_HEIGHT = 480,
    MOST = 16384
};

/* A sheet under way. */
struct layout {
    struct cs_contact_sheet *sheet;
    const struct cs_film_report *report;
    struct cs_image *image;
    uint32_t size[2];       /* of a picture */
    uint32_t width, height; /* of a shrunk one */
    struct cs_srgb srgb;
    struct cs_image_lines lines;
};

/* Chooses a full rectangle of at most as many tiles as there are pictures; of equal ones that
 * with the proportions nearest to the request. */
static void choose_grid(struct cs_contact_sheet *sheet, uint32_t n) {
    const long columns = sheet->columns, rows = sheet->rows, most = (long)n;
    long best = 0, unlike = 0;
    for (long c = columns; c > 0; c--) {
        const long r = most / c < rows ? most / c : rows, off = labs(c * rows - r * columns);
        if (c * r < best || (c * r == best && off >= unlike))
            continue;
        best = c * r;
        unlike = off;
        sheet->columns = (uint32_t)c;
        sheet->rows = (uint32_t)r;
    }
}

/* the picture of a tile, the last of one tile alone */
static const struct cs_film_picture *picture_of(const struct layout *layout, uint32_t tile) {
    const uint32_t tiles = layout->sheet->columns * layout->sheet->rows;
    const uint64_t last = layout->report->n - 1, steps = tiles - 1;
    return layout->report->pictures + (steps ? (2 * last * tile + steps) / (2 * steps) : last);
}

/* True if all pictures have one range of colours: only then a colour bar is valid for the
 * sheet. */
static bool has_one_range(const struct cs_film_report *report) {
    const double *range = report->pictures->range;
    if (!(range[0] < range[1]))
        return false;
    for (uint32_t k = 1; k < report->n; k++)
        if (memcmp(report->pictures[k].range, range, sizeof report->pictures->range) != 0)
            return false;
    return true;
}

static enum cs_status read_picture(const char *folder, uint32_t number, struct cs_image *image,
                                   struct cs_error *error) {
    char path[PATH_BYTES];
    snprintf(path, sizeof path, "%.4000s/frame_%05u.png", folder, number);
    return cs_png_read_on_white(path, image, error);
}

/* Takes the paper, for pictures of the first one's size. */
static enum cs_status init_sheet_image(struct layout *layout, const struct cs_image *first,
                                       struct cs_error *error) {
    struct cs_contact_sheet *sheet = layout->sheet;
    const double scale = fmin((double)sheet->tile / first->width, 1);
    layout->size[0] = first->width;
    layout->size[1] = first->height;
    layout->width = (uint32_t)fmax(floor(scale * first->width + 0.5), 1);
    layout->height = (uint32_t)fmax(floor(scale * first->height + 0.5), 1);
    const uint64_t width = GAP + (uint64_t)sheet->columns * (layout->width + GAP) +
                           (sheet->colour_bar ? BAR_WIDTH : 0);
    const uint64_t height =
        GAP + (uint64_t)sheet->rows * (layout->height + sheet->captions * CAPTION + GAP);
    if (width > MOST || height > MOST)
        return cs_fail(error, CS_ERR_FILE,
                       "a sheet of %llu x %llu pixels is too large, expected at most %d x %d",
                       (unsigned long long)width, (unsigned long long)height, MOST, MOST);
    *layout->image = (struct cs_image){(uint32_t)width, (uint32_t)height,
                                       malloc(3 * (size_t)width * (size_t)height), NULL};
    if (!layout->image->rgb)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for a sheet");
    memset(layout->image->rgb, 255, 3 * (size_t)width * (size_t)height);
    return CS_OK;
}

/* right: pixels of the right end; top: of the caption's box */
static void write_text(struct layout *layout, const char *text, double right, double top) {
    struct cs_line_style style = {.alpha = 0.85, .half_width = 0.6, .flat = true};
    const double white[3] = {1, 1, 1};
    cs_colour_ink(white, style.colour);
    layout->lines.left = layout->lines.top = 0;
    cs_glyph_add(&layout->lines.lines, text, right, top + CAPTION - 4.0, LETTER);
    cs_lines_draw(&layout->lines.lines, &style);
}

static void write_time(struct layout *layout, uint32_t tile, uint32_t left, uint32_t top) {
    char text[40];
    snprintf(text, sizeof text, "%.3g s",
             picture_of(layout, tile)->frame / layout->report->fps);
    write_text(layout, text, left + layout->width - 2.0, top);
}

/* Shrinks a picture into its place. */
static enum cs_status put_picture(struct layout *layout, const char *folder, uint32_t number,
                                  uint32_t left, uint32_t top, struct cs_error *error) {
    struct cs_image image;
    if (read_picture(folder, number, &image, error))
        return error->status;
    if (image.width == layout->size[0] && image.height == layout->size[1])
        cs_srgb_shrink(&layout->srgb, &image, (const uint32_t[]){layout->width, layout->height},
                       (size_t)top * layout->image->width + left, layout->image);
    else
        cs_fail(error, CS_ERR_FILE,
                "%s/frame_%05u.png: found %u x %u pixels, expected %u x %u as in the first",
                folder, number, image.width, image.height, layout->size[0], layout->size[1]);
    free(image.rgb);
    return error->status;
}

static enum cs_status put_tile(struct layout *layout, const char *folder, uint32_t tile,
                               struct cs_error *error) {
    const uint32_t columns = layout->sheet->columns;
    const uint32_t left = GAP + tile % columns * (layout->width + GAP),
                   top = GAP + tile / columns * (layout->height + CAPTION + GAP);
    if (!put_picture(layout, folder, picture_of(layout, tile)->number, left, top, error))
        write_time(layout, tile, left, top + layout->height);
    return error->status;
}

/* As in a picture, in a column of its own at the right, in the middle of the height. */
static void put_bar(struct layout *layout) {
    const double height = fmin(layout->image->height - 2.0 * GAP, BAR_HEIGHT);
    const int32_t look = layout->report->look;
    const double *range = layout->report->pictures->range;
    const struct cs_render paper = {.size = {BAR_WIDTH, (int64_t)height},
                                    .background = {.colour = {1, 1, 1}}};
    const struct cs_frame frame = {.range = {range[0], range[1]},
                                   .title = cs_look_of(look)->title,
                                   .factor = cs_look_of(look)->factor};
    struct cs_colour_bar bar;
    cs_colour_bar_init(&bar, &paper);
    layout->lines.look = look;
    layout->lines.left = layout->image->width - (double)BAR_WIDTH;
    /* the bar stands at the foot of its picture */
    const double length = 0.39 * height + 18 * fmax(height / 480, 0.75);
    layout->lines.top = floor((layout->image->height + length) / 2 - height);
    cs_colour_bar_draw(&bar, &layout->lines.lines, &frame);
}

/* Positions (n,3) of a frame, as run --states writes them; NULL: there are none. The caller
 * frees them. */
static double *read_state(const char *folder, double frame, size_t *n) {
    char path[PATH_BYTES], *bytes = NULL;
    size_t length = 0;
    struct cs_error absent = {0};
    snprintf(path, sizeof path, "%.4000s/x_%05.0f.npy", folder, frame);
    if (access(path, R_OK) || cs_file_read(path, (size_t)CS_PARTICLES_MAX * 24 + CS_NPY_HEAD,
                                           &bytes, &length, &absent))
        return NULL;
    *n = length > CS_NPY_HEAD ? (length - CS_NPY_HEAD) / sizeof(double) : 0;
    double *x = malloc(*n * sizeof *x + 1);
    for (size_t i = 0; x && i < *n; i++) {
        uint64_t word;
        memcpy(&word, bytes + CS_NPY_HEAD + i * sizeof word, sizeof word);
        x[i] = cs_double_from_le64(word);
    }
    free(bytes);
    return x;
}

/* m, root mean square distance of the particles of two runs at a frame; NAN: unknown. */
static double distance_of_runs(const char *a, const char *b, double frame) {
    size_t n = 0, m = 0;
    double *x = read_state(a, frame, &n), *y = read_state(b, frame, &m), squared = 0;
    for (size_t i = 0; x && y && i < n && n == m; i++)
        squared += (x[i] - y[i]) * (x[i] - y[i]);
    const bool known = x && y && n == m && n > 0;
    free(x);
    free(y);
    return known ? sqrt(3 * squared / (double)n) : (double)NAN;
}

/* Method; then cost and error, or what the others are compared with. */
static void write_title(struct layout *layout, const struct cs_film_tiles *tiles, uint32_t run,
                        double frame, double left) {
    const struct cs_film_report *report = tiles->reports + run;
    char text[120];
    const double error =
        run ? distance_of_runs(tiles->folders[0], tiles->folders[run], frame) : (double)NAN;
    write_text(layout, report->method, left + cs_glyph_width(report->method, LETTER), GAP);
    int n = snprintf(text, sizeof text, "%.3g s", report->seconds);
    if (!isnan(error))
        snprintf(text + n, sizeof text - (size_t)n, ", error %.1e m", error);
    write_text(layout, text, left + cs_glyph_width(text, LETTER), GAP + CAPTION);
}

static enum cs_status put_run(struct layout *layout, const struct cs_film_tiles *tiles,
                              uint32_t run, uint32_t k, struct cs_error *error) {
    const struct cs_film_report *report = tiles->reports + run;
    const struct cs_film_picture *at = report->pictures + (k < report->n ? k : report->n - 1);
    const uint32_t left = GAP + run * (layout->width + GAP),
                   top = GAP + (tiles->titles ? 2 * CAPTION : 0);
    if (!put_picture(layout, tiles->folders[run], at->number, left, top, error) &&
        tiles->titles)
        write_title(layout, tiles, run, at->frame, left);
    return error->status;
}

/* Makes the image from pictures of one run, or from picture k of several. */
static enum cs_status make(struct layout *layout, const char *folder,
                           const struct cs_film_tiles *tiles, uint32_t k,
                           struct cs_error *error) {
    struct cs_arena arena = {0};
    struct cs_image first = {0};
    const uint32_t n = layout->sheet->columns * layout->sheet->rows;
    *layout->image = (struct cs_image){0};
    cs_srgb_make(&layout->srgb);
    if (!read_picture(folder, picture_of(layout, 0)->number, &first, error) &&
        !init_sheet_image(layout, &first, error))
        cs_image_lines_init(&layout->lines, CS_COLOUR_BAR_LINES, layout->image, &layout->srgb,
                            &arena, error);
    free(first.rgb);
    for (uint32_t tile = 0; tile < n && !error->status; tile++)
        tiles ? put_run(layout, tiles, tile, k, error) : put_tile(layout, folder, tile, error);
    if (!error->status && layout->sheet->colour_bar)
        put_bar(layout);
    cs_arena_finish(&arena);
    if (error->status) {
        free(layout->image->rgb);
        *layout->image = (struct cs_image){0};
    }
    return error->status;
}

enum cs_status cs_contact_sheet_make(struct cs_contact_sheet *sheet, const char *folder,
                                     const struct cs_film_report *report,
                                     struct cs_image *image, struct cs_error *error) {
    struct layout layout = {.sheet = sheet, .report = report, .image = image};
    sheet->captions = 1;
    choose_grid(sheet, report->n);
    sheet->colour_bar = has_one_range(report);
    return make(&layout, folder, NULL, 0, error);
}

enum cs_status cs_film_tiles_make(const struct cs_film_tiles *tiles, uint32_t k,
                                  struct cs_image *image, struct cs_error *error) {
    struct cs_contact_sheet sheet = {
        .columns = tiles->n, .rows = 1, .tile = tiles->tile, .captions = tiles->titles ? 2 : 0};
    struct layout layout = {.sheet = &sheet, .report = tiles->reports, .image = image};
    return make(&layout, tiles->folders[0], tiles, k, error);
}

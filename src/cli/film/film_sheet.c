/* Lays pictures out on a sheet: white paper, dark ink. */
#include "cli/film/film_sheet.h"

#include "cli/film/film_lines.h"
#include "draw/colour.h"
#include "draw/colour_bar.h"
#include "draw/glyph.h"
#include "io/png.h"
#include "study/frame_picture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    PATH_BYTES = 4096,
    GAP = 8,
    CAPTION = 16,
    BAR_WIDTH = 92,
    BAR_HEIGHT = 480,
    MOST = 16384
};

/* A sheet under way. */
struct layout {
    struct cs_contact_sheet *sheet;
    const struct cs_film_report *report;
    struct cs_image *image;
    uint32_t width, height; /* of a shrunk picture */
    struct cs_srgb tone;
    struct cs_image_lines pen;
};

/* As many tiles as there are pictures for, in a whole rectangle; of equal ones the one whose
 * sides are most like those that were asked for. */
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

static bool has_one_range(const struct cs_film_report *report) {
    const double *range = report->pictures->range;
    if (!(range[0] < range[1]))
        return false;
    for (uint32_t k = 1; k < report->n; k++)
        if (memcmp(report->pictures[k].range, range, sizeof report->pictures->range) != 0)
            return false;
    return true;
}

static enum cs_status read_picture(const struct layout *layout, const char *folder,
                                   uint32_t tile, struct cs_image *picture,
                                   struct cs_error *error) {
    char path[PATH_BYTES];
    snprintf(path, sizeof path, "%.4000s/frame_%05u.png", folder,
             picture_of(layout, tile)->number);
    return cs_png_read_on_white(path, picture, error);
}

/* Takes the paper, for pictures of the first one's size. */
static enum cs_status init_sheet_image(struct layout *layout, const struct cs_image *first,
                                       struct cs_error *error) {
    struct cs_contact_sheet *sheet = layout->sheet;
    const double scale = fmin((double)sheet->tile / first->width, 1);
    layout->width = (uint32_t)fmax(floor(scale * first->width + 0.5), 1);
    layout->height = (uint32_t)fmax(floor(scale * first->height + 0.5), 1);
    const uint64_t width = GAP + (uint64_t)sheet->columns * (layout->width + GAP) +
                           (sheet->colour_bar ? BAR_WIDTH : 0);
    const uint64_t height = GAP + (uint64_t)sheet->rows * (layout->height + CAPTION + GAP);
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

/* The mean light of the box that a pixel of the sheet covers; parts of pixels count as such. */
static void shrink_pixel(const struct layout *layout, const struct cs_image *picture,
                         const double box[4], uint8_t out[3]) {
    double light[3] = {0}, area = 0;
    for (uint32_t y = (uint32_t)box[1]; y < picture->height && y < box[3]; y++)
        for (uint32_t x = (uint32_t)box[0]; x < picture->width && x < box[2]; x++) {
            const double share = (fmin(x + 1, box[2]) - fmax(x, box[0])) *
                                 (fmin(y + 1, box[3]) - fmax(y, box[1]));
            const uint8_t *rgb = picture->rgb + 3 * ((size_t)y * picture->width + x);
            for (int k = 0; k < 3; k++)
                light[k] += share * (double)layout->tone.linear[rgb[k]];
            area += share;
        }
    for (int k = 0; k < 3; k++)
        out[k] = (uint8_t)cs_srgb_encode(&layout->tone, (float)fmin(light[k] / area, 1));
}

static void shrink(const struct layout *layout, const struct cs_image *picture, uint32_t left,
                   uint32_t top) {
    const double sx = (double)picture->width / layout->width,
                 sy = (double)picture->height / layout->height;
    for (uint32_t y = 0; y < layout->height; y++)
        for (uint32_t x = 0; x < layout->width; x++) {
            const double box[4] = {x * sx, y * sy, (x + 1) * sx, (y + 1) * sy};
            const size_t at = (size_t)(top + y) * layout->image->width + left + x;
            shrink_pixel(layout, picture, box, layout->image->rgb + 3 * at);
        }
}

static void write_time(struct layout *layout, uint32_t tile, uint32_t left, uint32_t top) {
    char text[40];
    struct cs_line_style style = {.alpha = 0.85, .half_width = 0.6, .flat = true};
    const double white[3] = {1, 1, 1};
    snprintf(text, sizeof text, "%.3g s",
             picture_of(layout, tile)->frame / layout->report->fps);
    cs_colour_ink(white, style.colour);
    layout->pen.left = layout->pen.top = 0;
    cs_glyph_add(&layout->pen.lines, text, left + layout->width - 2.0, top + CAPTION - 4.0, 8);
    cs_lines_draw(&layout->pen.lines, &style);
}

static enum cs_status put_tile(struct layout *layout, const char *folder, uint32_t tile,
                               const struct cs_image *first, struct cs_error *error) {
    const uint32_t columns = layout->sheet->columns;
    const uint32_t left = GAP + tile % columns * (layout->width + GAP),
                   top = GAP + tile / columns * (layout->height + CAPTION + GAP);
    struct cs_image picture;
    if (read_picture(layout, folder, tile, &picture, error))
        return error->status;
    if (picture.width == first->width && picture.height == first->height)
        shrink(layout, &picture, left, top);
    else
        cs_fail(error, CS_ERR_FILE,
                "%s/frame_%05u.png: found %u x %u pixels, expected %u x %u as in the first",
                folder, picture_of(layout, tile)->number, picture.width, picture.height,
                first->width, first->height);
    free(picture.rgb);
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
    layout->pen.look = look;
    layout->pen.left = layout->image->width - (double)BAR_WIDTH;
    /* the bar stands at the foot of its picture */
    const double length = 0.39 * height + 18 * fmax(height / 480, 0.75);
    layout->pen.top = floor((layout->image->height + length) / 2 - height);
    cs_colour_bar_draw(&bar, &layout->pen.lines, &frame);
}

static enum cs_status put_tiles(struct layout *layout, const char *folder,
                                const struct cs_image *first, struct cs_error *error) {
    const uint32_t tiles = layout->sheet->columns * layout->sheet->rows;
    for (uint32_t tile = 0; tile < tiles && !error->status; tile++)
        put_tile(layout, folder, tile, first, error);
    if (!error->status && layout->sheet->colour_bar)
        put_bar(layout);
    return error->status;
}

enum cs_status cs_contact_sheet_make(struct cs_contact_sheet *sheet, const char *folder,
                                     const struct cs_film_report *report,
                                     struct cs_image *image, struct cs_error *error) {
    struct layout layout = {.sheet = sheet, .report = report, .image = image};
    struct cs_arena arena = {0};
    struct cs_image first = {0};
    *image = (struct cs_image){0};
    choose_grid(sheet, report->n);
    sheet->colour_bar = has_one_range(report);
    cs_srgb_make(&layout.tone);
    if (!read_picture(&layout, folder, 0, &first, error) &&
        !init_sheet_image(&layout, &first, error) &&
        !cs_image_lines_init(&layout.pen, CS_COLOUR_BAR_LINES, image, &layout.tone, &arena,
                             error))
        put_tiles(&layout, folder, &first, error);
    free(first.rgb);
    cs_arena_finish(&arena);
    if (error->status) {
        free(image->rgb);
        *image = (struct cs_image){0};
    }
    return error->status;
}

/* Lays pictures out on a sheet: white paper, dark ink. */
#include "cli/film/film_sheet.h"

#include "base/image.h"
#include "draw/colour_bar.h"
#include "draw/glyph.h"
#include "draw/srgb.h"
#include "io/png.h"
#include "study/frame_picture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Draws flat lines, figures and the colour bar on an image in memory. */

struct cs_image_lines {
    struct cs_lines lines; /* first: see cs_lines */
    struct cs_image *image;
    const struct cs_srgb *srgb; /* both borrowed */
    double left, top;           /* pixels of the image where the pen's own begin */
    int32_t look;               /* whose colours a ramp has */
};

static void blend(const struct cs_image_lines *pen, long x, long y, uint32_t over,
                  double share) {
    const struct cs_image *image = pen->image;
    if (x < 0 || y < 0 || x >= (long)image->width || y >= (long)image->height || share <= 0)
        return;
    uint8_t *rgb = image->rgb + 3 * ((size_t)y * image->width + (size_t)x);
    const uint32_t under = rgb[0] | (uint32_t)rgb[1] << 8 | (uint32_t)rgb[2] << 16;
    const uint32_t mixed = cs_srgb_blend(under, over, (uint32_t)(255 * share + 0.5));
    for (int k = 0; k < 3; k++)
        rgb[k] = (uint8_t)(mixed >> 8 * k);
}

static double distance(const double p[2], const double a[2], const double b[2]) {
    const double way[2] = {b[0] - a[0], b[1] - a[1]}, to[2] = {p[0] - a[0], p[1] - a[1]};
    const double squared = way[0] * way[0] + way[1] * way[1];
    const double along = squared > 0 ? (way[0] * to[0] + way[1] * to[1]) / squared : 0;
    const double t = fmin(fmax(along, 0), 1);
    const double dx = to[0] - t * way[0], dy = to[1] - t * way[1];
    return sqrt(dx * dx + dy * dy);
}

/* covers a pixel as far as its centre is inside, over the width of a pixel */
static void cover_pixel(const struct cs_image_lines *pen, const double a[2], const double b[2],
                        double half, uint32_t colour, double alpha) {
    const long reach = (long)half + 1;
    const long right = (long)fmax(a[0], b[0]) + reach, below = (long)fmax(a[1], b[1]) + reach;
    for (long y = (long)fmin(a[1], b[1]) - reach; y <= below; y++)
        for (long x = (long)fmin(a[0], b[0]) - reach; x <= right; x++) {
            const double centre[2] = {(double)x + 0.5, (double)y + 0.5};
            const double inside = half + 0.5 - distance(centre, a, b);
            blend(pen, x, y, colour, alpha * fmin(fmax(inside, 0), 1));
        }
}

static void draw(struct cs_lines *lines, const struct cs_line_style *style) {
    const struct cs_image_lines *pen = (const struct cs_image_lines *)lines;
    const uint32_t colour =
        cs_srgb_pack(pen->srgb, style->colour[0], style->colour[1], style->colour[2]);
    for (uint32_t k = 0; k < lines->n; k++) {
        const float *ends = lines->ends[k];
        const double a[2] = {pen->left + (double)ends[0], pen->top + (double)ends[1]};
        const double b[2] = {pen->left + (double)ends[3], pen->top + (double)ends[4]};
        cover_pixel(pen, a, b, style->half_width, colour, style->alpha);
    }
}

/* the colour at a share of the map, from 0 at its lowest stop */
static uint32_t colour_at(const struct cs_image_lines *pen, double share) {
    float stops[6][4], mixed[3];
    cs_colour_stops(pen->look, stops);
    const double at = 5 * fmin(fmax(share, 0), 1);
    const int stop = at < 4 ? (int)at : 4;
    const float t = (float)(at - stop);
    for (int c = 0; c < 3; c++)
        mixed[c] = stops[stop][c] + t * (stops[stop + 1][c] - stops[stop][c]);
    return cs_srgb_pack(pen->srgb, mixed[0], mixed[1], mixed[2]);
}

static void ramp(struct cs_lines *lines, const double box[4]) {
    const struct cs_image_lines *pen = (const struct cs_image_lines *)lines;
    for (long y = (long)(box[1] + 0.5); y < (long)(box[1] + box[3] + 0.5); y++) {
        const double share = 1 - ((double)y + 0.5 - box[1]) / box[3];
        const uint32_t colour = colour_at(pen, share);
        for (long x = (long)(box[0] + 0.5); x < (long)(box[0] + box[2] + 0.5); x++)
            blend(pen, (long)pen->left + x, (long)pen->top + y, colour, 1);
    }
}

/* Prepares for so many lines at a time. CS_ERR_MEMORY. */
static enum cs_status image_lines_init(struct cs_image_lines *pen, uint32_t capacity,
                                       struct cs_image *image, const struct cs_srgb *tone,
                                       struct cs_arena *arena, struct cs_error *error) {
    *pen = (struct cs_image_lines){
        .lines = {.draw = draw, .ramp = ramp}, .image = image, .srgb = tone};
    return cs_lines_init(&pen->lines, capacity, arena, error);
}

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

/* Mean of the linear light in the box that a pixel of the sheet covers, by area. */
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
        !image_lines_init(&layout.pen, CS_COLOUR_BAR_LINES, image, &layout.tone, &arena, error))
        put_tiles(&layout, folder, &first, error);
    free(first.rgb);
    cs_arena_finish(&arena);
    if (error->status) {
        free(image->rgb);
        *image = (struct cs_image){0};
    }
    return error->status;
}

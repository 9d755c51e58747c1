/* Draws flat lines, figures and the colour bar on an image in memory. */
#include "film/image_lines.h"

#include "draw/glyph.h"

#include <math.h>

static void blend(const struct cs_image_lines *lines, long x, long y, uint32_t over,
                  double share) {
    const struct cs_image *image = lines->image;
    if (x < 0 || y < 0 || x >= (long)image->width || y >= (long)image->height || share <= 0)
        return;
    uint8_t *rgb = image->rgb + 3 * ((size_t)y * image->width + (size_t)x);
    const uint32_t under = rgb[0] | (uint32_t)rgb[1] << 8 | (uint32_t)rgb[2] << 16;
    const uint32_t mixed = cs_srgb_blend(under, over, (uint32_t)(255 * share + 0.5));
    for (int k = 0; k < 3; k++)
        rgb[k] = (uint8_t)(mixed >> 8 * k);
}

static double line_distance(const double p[2], const double a[2], const double b[2]) {
    const double way[2] = {b[0] - a[0], b[1] - a[1]}, to[2] = {p[0] - a[0], p[1] - a[1]};
    const double squared = way[0] * way[0] + way[1] * way[1];
    const double along = squared > 0 ? (way[0] * to[0] + way[1] * to[1]) / squared : 0;
    const double t = fmin(fmax(along, 0), 1);
    const double dx = to[0] - t * way[0], dy = to[1] - t * way[1];
    return sqrt(dx * dx + dy * dy);
}

/* covers a pixel as far as its centre is inside, over the width of a pixel */
static void cover_pixel(const struct cs_image_lines *lines, const double a[2],
                        const double b[2], double half, uint32_t colour, double alpha) {
    const long reach = (long)half + 1;
    const long right = (long)fmax(a[0], b[0]) + reach, below = (long)fmax(a[1], b[1]) + reach;
    for (long y = (long)fmin(a[1], b[1]) - reach; y <= below; y++)
        for (long x = (long)fmin(a[0], b[0]) - reach; x <= right; x++) {
            const double centre[2] = {(double)x + 0.5, (double)y + 0.5};
            const double inside = half + 0.5 - line_distance(centre, a, b);
            blend(lines, x, y, colour, alpha * fmin(fmax(inside, 0), 1));
        }
}

static void draw(struct cs_lines *lines, const struct cs_line_style *style) {
    const struct cs_image_lines *self = (const struct cs_image_lines *)lines;
    const uint32_t colour =
        cs_srgb_pack(self->srgb, style->colour[0], style->colour[1], style->colour[2]);
    for (uint32_t k = 0; k < lines->n; k++) {
        const float *ends = lines->ends[k];
        const double a[2] = {self->left + (double)ends[0], self->top + (double)ends[1]};
        const double b[2] = {self->left + (double)ends[3], self->top + (double)ends[4]};
        cover_pixel(self, a, b, style->half_width, colour, style->alpha);
    }
}

/* the colour at a share of the map, from 0 at its lowest stop */
static uint32_t colour_at(const struct cs_image_lines *lines, double share) {
    float stops[6][4], mixed[3];
    cs_colour_stops(lines->look, false, stops);
    const double at = 5 * fmin(fmax(share, 0), 1);
    const int stop = at < 4 ? (int)at : 4;
    const float t = (float)(at - stop);
    for (int c = 0; c < 3; c++)
        mixed[c] = stops[stop][c] + t * (stops[stop + 1][c] - stops[stop][c]);
    return cs_srgb_pack(lines->srgb, mixed[0], mixed[1], mixed[2]);
}

static void ramp(struct cs_lines *lines, const double box[4]) {
    const struct cs_image_lines *self = (const struct cs_image_lines *)lines;
    for (long y = (long)(box[1] + 0.5); y < (long)(box[1] + box[3] + 0.5); y++) {
        const double share = 1 - ((double)y + 0.5 - box[1]) / box[3];
        const uint32_t colour = colour_at(self, share);
        for (long x = (long)(box[0] + 0.5); x < (long)(box[0] + box[2] + 0.5); x++)
            blend(self, (long)self->left + x, (long)self->top + y, colour, 1);
    }
}

enum cs_status cs_image_lines_init(struct cs_image_lines *lines, uint32_t capacity,
                                   struct cs_image *image, const struct cs_srgb *srgb,
                                   struct cs_arena *arena, struct cs_error *error) {
    *lines = (struct cs_image_lines){
        .lines = {.draw = draw, .ramp = ramp}, .image = image, .srgb = srgb};
    return cs_lines_init(&lines->lines, capacity, arena, error);
}

/* thick_lines.c - set-up of thick lines: projection, clipping, a quad around each line.
 *
 * A line is given by its ends in m. It is cut at the near plane, projected, and widened on the
 * picture, so its width in pixels does not depend on the distance. Its quad reaches 1.5 pixels
 * beyond the line on all sides; depth is a plane over the quad through the depths of both
 * ends. */
#include "draw/cpu/thick_lines.h"

#include "base/arena.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* An unused item behind the last one, or NULL if out of memory. */
static struct cs_thick_line *next(struct cs_thick_lines *lines) {
    if (!CS_ARENA_REALLOC(lines->items, lines->capacity, lines->n + 1)) {
        lines->failed = true;
        return NULL;
    }
    return lines->items + lines->n;
}

// pixels within `by` of the range from a to b, inside the picture; false where there are none
static bool bound(float a, float b, float by, int size, int *from, int *to) {
    const float least = (a < b ? a : b) - by, most = (a < b ? b : a) + by;
    *from = (int)cs_clamp(least, 0, (float)size);
    *to = (int)cs_clamp(most, -1, (float)(size - 1));
    return *from <= *to && most >= 0;
}

/* Pixels within `reach` of the line, inside the picture; false if there are none. */
static bool set_box(const struct cs_shading_context *context, const float ends[4], float reach,
                    struct cs_thick_line *s) {
    return bound(ends[0], ends[2], reach, context->width, &s->left, &s->right) &&
           bound(ends[1], ends[3], reach, context->height, &s->top, &s->bottom);
}

/* Cuts a line at the near plane and projects it: ends in pixels from the bottom left. Returns
 * false if nothing is left. A cut at w = near is at t = (near - w_e) / (w_other - w_e). */
static bool project(const struct cs_thick_lines *lines, float p[2][3], float lift,
                    float ends[4], struct cs_clip_vertex corners[2]) {
    const struct cs_clip_transform *clip = lines->transform;
    cs_clip_transform_corner(clip, p[0], corners);
    cs_clip_transform_corner(clip, p[1], corners + 1);
    const float w[2] = {corners[0].clip[3], corners[1].clip[3]}, near = clip->near;
    for (int e = 0; e < 2; e++) {
        const float share = (near - w[e]) / (w[1 - e] - w[e]);
        if (w[e] >= near)
            continue;
        if (!(w[1 - e] >= near))
            return false;
        for (int i = 0; i < 3; i++)
            p[e][i] += share * (p[1 - e][i] - p[e][i]);
    }
    for (int e = 0; e < 2; e++) {
        struct cs_clip_vertex *c = corners + e;
        cs_clip_transform_corner(clip, p[e], c);
        // places far beside the picture are lines' too
        const float inverse = 1 / c->clip[3];
        ends[2 * e] = (c->clip[0] * inverse * 0.5f + 0.5f) * (float)clip->width;
        ends[2 * e + 1] = (c->clip[1] * inverse * 0.5f + 0.5f) * (float)clip->height;
        cs_clip_transform_move_depth(clip, p[e], lines->shading->view->eye, -lift, c);
    }
    return true;
}

// moves ends beyond 10^6 pixels along the line to that bound: nearer ones fit into integers
static bool clip_far_ends(float ends[4]) {
    const float most = 1e6f;
    for (int e = 0; e < 2; e++)
        for (int axis = 0; axis < 2; axis++) {
            float *end = ends + 2 * e, *other = ends + 2 * (1 - e);
            const float limit = end[axis] < 0 ? -most : most;
            if (end[axis] >= -most && end[axis] <= most)
                continue;
            if (!(other[axis] > -most && other[axis] < most))
                return false;
            const float share = (limit - other[axis]) / (end[axis] - other[axis]);
            end[1 - axis] = other[1 - axis] + share * (end[1 - axis] - other[1 - axis]);
            end[axis] = limit;
        }
    return true;
}

/* Position, direction and widths from the ends. A line thinner than a pixel keeps half a pixel
 * of half width and gets paler in proportion. */
static void set_line(const float ends[4], const struct cs_line_style *style,
                     struct cs_thick_line *s) {
    const float dx = ends[2] - ends[0], dy = ends[3] - ends[1];
    const float length = sqrtf(dx * dx + dy * dy), half = (float)style->half_width;
    const float share = 1 / (length > 1e-6f ? length : 1);
    s->x = ends[0];
    s->y = ends[1];
    s->length = length > 1e-6f ? length : 0;
    s->direction[0] = length > 1e-6f ? dx * share : 1;
    s->direction[1] = length > 1e-6f ? dy * share : 0;
    // below half a pixel a line gets paler instead of thinner
    s->half_width = half > 0.5f ? half : 0.5f;
    s->extent = half + 1.5f;
    s->coverage = (float)style->alpha * half / s->half_width;
}

/* Corners of the quad around a line: behind the first end to the left and right, then beyond
 * the other end; w and z are those of the ends. */
static void set_rectangle(const struct cs_thick_lines *lines, const float ends[4],
                          const struct cs_clip_vertex of[2], struct cs_thick_line *s,
                          struct cs_clip_vertex corners[4]) {
    const struct cs_clip_transform *clip = lines->transform;
    const float size[2] = {(float)clip->width, (float)clip->height};
    for (int k = 0; k < 4; k++) {
        const struct cs_clip_vertex *end = of + k / 2;
        const float on = k < 2 ? -s->extent : s->extent, side = k & 1 ? -1 : 1;
        const float across[2] = {-s->direction[1], s->direction[0]};
        for (int axis = 0; axis < 2; axis++) {
            float pixel = ends[k / 2 * 2 + axis] + on * s->direction[axis];
            pixel += side * s->extent * across[axis];
            corners[k].clip[axis] = (pixel * (1 / size[axis]) * 2 - 1) * end->clip[3];
        }
        corners[k].clip[2] = end->clip[2];
        corners[k].clip[3] = end->clip[3];
        cs_clip_transform_project(clip, corners + k);
    }
}

// a line whose ends are pixels from the top left: depth 0, w 1
static void make_flat(const float *from, int height, float ends[4],
                      struct cs_clip_vertex corners[2]) {
    for (int e = 0; e < 2; e++) {
        ends[2 * e] = from[3 * e];
        ends[2 * e + 1] = (float)height - from[3 * e + 1];
        corners[e] = (struct cs_clip_vertex){.clip = {0, 0, 0, 1}};
    }
}

/* Adds a line from `from` (two ends of three numbers), unless nothing of it is visible. */
static void add_line(struct cs_thick_lines *lines, const float *from,
                     const struct cs_line_style *style, uint32_t colour) {
    const int height = lines->shading->height;
    float p[2][3], ends[4];
    struct cs_clip_vertex corners[2], rectangle[4];
    const struct cs_clip_vertex *const order[3] = {rectangle + 1, rectangle, rectangle + 2};
    struct cs_thick_line *s = next(lines);
    memcpy(p, from, sizeof p);
    if (style->flat)
        make_flat(from, height, ends, corners);
    if (!s || (!style->flat && !project(lines, p, (float)style->depth_offset, ends, corners)) ||
        !clip_far_ends(ends))
        return;
    *s = (struct cs_thick_line){.colour = colour, .on_top = style->on_top || style->flat};
    set_line(ends, style, s);
    set_rectangle(lines, ends, corners, s, rectangle);
    cs_depth_of(lines->transform, order, s->depth);
    // from here on y is down, as in the picture
    s->y = (float)height - s->y;
    s->direction[1] = -s->direction[1];
    for (int e = 1; e < 4; e += 2)
        ends[e] = (float)height - ends[e];
    lines->n += set_box(lines->shading, ends, s->extent, s);
}

static void draw_lines(struct cs_lines *lines, const struct cs_line_style *style) {
    struct cs_thick_lines *strokes = (struct cs_thick_lines *)lines;
    const float *c = style->colour;
    const uint32_t colour = cs_srgb_pack(strokes->shading->srgb, cs_clamp(c[0], 0, 1),
                                         cs_clamp(c[1], 0, 1), cs_clamp(c[2], 0, 1));
    for (uint32_t i = 0; i < lines->n; i++)
        add_line(strokes, lines->ends[i], style, colour);
}

/* Adds the colour bar's rectangle of left, top, width, height in pixels. */
static void add_ramp(struct cs_lines *lines, const double box[4]) {
    struct cs_thick_lines *strokes = (struct cs_thick_lines *)lines;
    const float ends[4] = {(float)box[0], (float)box[1], (float)(box[0] + box[2]),
                           (float)(box[1] + box[3])};
    struct cs_thick_line *s = next(strokes);
    if (!s)
        return;
    *s = (struct cs_thick_line){.x = ends[0],
                                .y = ends[1],
                                .direction = {(float)box[2], (float)box[3]},
                                .uses_colour_map = true};
    strokes->n += set_box(strokes->shading, ends, 1, s);
}

enum cs_status cs_thick_lines_init(struct cs_thick_lines *lines,
                                   const struct cs_shading_context *context,
                                   const struct cs_clip_transform *clip,
                                   struct cs_error *error) {
    lines->lines.draw = draw_lines;
    lines->lines.ramp = add_ramp;
    lines->shading = context;
    lines->transform = clip;
    return cs_bins_init(&lines->bins, context->height, error);
}

void cs_thick_lines_bin(struct cs_thick_lines *lines) {
    cs_bins_sort(&lines->bins, lines->items, sizeof *lines->items,
                 offsetof(struct cs_thick_line, top), lines->n);
}

void cs_thick_lines_finish(struct cs_thick_lines *lines) {
    free(lines->items);
    cs_bins_finish(&lines->bins);
    lines->items = NULL;
}

/* Lists of items by band, one after the other in one block of memory. */

enum cs_status cs_bins_init(struct cs_bins *bins, int height, struct cs_error *error) {
    bins->bands = (uint32_t)((height + CS_ROWS - 1) / CS_ROWS);
    bins->band_ends = calloc(bins->bands + 1, sizeof *bins->band_ends);
    return bins->band_ends ? CS_OK
                           : cs_fail(error, CS_ERR_MEMORY, "out of memory for a picture");
}

/* band_ends[b + 1] holds the count of band b. A running sum makes band_ends[b] the start of its
 * list; putting moves it to the end. */
static void begin_put(struct cs_bins *bins) {
    for (uint32_t band = 0; band < bins->bands; band++)
        bins->band_ends[band + 1] += bins->band_ends[band];
    const size_t n = bins->band_ends[bins->bands];
    if (n <= bins->capacity)
        return;
    free(bins->list);
    bins->capacity = n + n / 4;
    bins->list = malloc(bins->capacity * sizeof *bins->list);
    bins->failed = !bins->list;
    if (bins->failed)
        bins->capacity = 0;
}

void cs_bins_sort(struct cs_bins *bins, const void *items, size_t size, size_t rows, size_t n) {
    memset(bins->band_ends, 0, (bins->bands + 1) * sizeof *bins->band_ends);
    bins->failed = false;
    for (int pass = 0; pass < 2 && !bins->failed; pass++) {
        for (size_t i = 0; i < n; i++) {
            const int *row = (const int *)(const void *)((const char *)items + i * size + rows);
            for (int band = row[0] / CS_ROWS; band <= row[1] / CS_ROWS; band++)
                if (pass)
                    bins->list[bins->band_ends[band]++] = (uint32_t)i;
                else
                    bins->band_ends[band + 1]++;
        }
        if (!pass)
            begin_put(bins);
    }
}

void cs_bins_finish(struct cs_bins *bins) {
    free(bins->band_ends);
    free(bins->list);
    *bins = (struct cs_bins){0};
}

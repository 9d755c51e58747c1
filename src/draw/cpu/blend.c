/* blend.c - memory of a band; blends thick lines over it, and resolves it.
 *
 * The coverage of a pixel is taken from the distance d of its middle to the line, a segment:
 *   clamp(half_width + 1/2 - d, 0, 1)
 * It falls from 1 to 0 over the pixel at the border, and d to a segment makes the ends round.
 * Each sample then decides whether it lies in the line's quad, and in front of the surface. */
#include "draw/cpu/thick_lines.h"

#include <math.h>

/* Pixels of row y that the strip around a line touches. In a row the strip has
 *   middle x + (y - y_0) u_x / u_y,   half width (extent + 1) / |u_y|.
 * A line nearly along the row (|u_y| < 0.05) gains nothing by it. */
static void row_of(const struct cs_thick_line *s, int y, int *left, int *right) {
    const float down = (float)y + 0.5f - s->y, ux = s->direction[0], uy = s->direction[1];
    const float slant = uy < 0 ? -uy : uy, capacity = (s->extent + 1) / (slant > 0 ? slant : 1);
    *left = s->left;
    *right = s->right;
    if (slant < 0.05f)
        return;
    const float middle = s->x + down * ux / uy;
    *left = cs_max(*left, (int)cs_clamp(middle - capacity, 0, (float)s->right + 1));
    *right = cs_min(*right, (int)cs_clamp(middle + capacity, -1, (float)s->right));
}

// the mask's lanes as bits 0..3
CS_INLINE unsigned bits(cs_i4 mask) {
    return (unsigned)(mask[0] & 1) | (unsigned)(mask[1] & 2) | (unsigned)(mask[2] & 4) |
           (unsigned)(mask[3] & 8);
}

// order of the quad's corners in which each edge has the inside to one side
static const int around[4] = {0, 2, 3, 1};

// samples of a pixel inside the quad, by the edge functions and top-left rule of triangles
CS_INLINE cs_i4 inside_small(const struct cs_thick_line *s,
                             const struct cs_sample_pattern *pattern, int x, int y) {
    cs_i4 mask = {-1, -1, -1, -1};
    for (int k = 0; k < 4; k++) {
        const int at = around[k], next = around[(k + 1) & 3];
        const int dx = s->quad[0][next] - s->quad[0][at];
        const int dy = s->quad[1][next] - s->quad[1][at];
        const int bias = dy < 0 || (dy == 0 && dx > 0) ? 0 : -1;
        mask &= dx * (pattern->y + (y * 256 - s->quad[1][at])) -
                    dy * (pattern->x + (x * 256 - s->quad[0][at])) + bias >=
                0;
    }
    return mask;
}

// the same in 64 bits, for quads whose edge functions overflow 32
static cs_i4 inside_large(const struct cs_thick_line *s,
                          const struct cs_sample_pattern *pattern, int x, int y) {
    cs_i4 mask = {-1, -1, -1, -1};
    for (int k = 0; k < 16; k++) {
        const int sample = k & 3, at = around[k >> 2], next = around[((k >> 2) + 1) & 3];
        const int64_t dx = (int64_t)s->quad[0][next] - s->quad[0][at];
        const int64_t dy = (int64_t)s->quad[1][next] - s->quad[1][at];
        const int64_t bias = dy < 0 || (dy == 0 && dx > 0) ? 0 : -1;
        const int64_t down = y * 256 + pattern->y[sample] - s->quad[1][at];
        const int64_t across = x * 256 + pattern->x[sample] - s->quad[0][at];
        if (dx * down - dy * across + bias < 0)
            mask[sample] = 0;
    }
    return mask;
}

// coverage 0..1 of a pixel whose middle is at (x, y) from the first end
CS_INLINE float pixel_coverage(const struct cs_thick_line *s, float x, float y) {
    const float along = cs_clamp(x * s->direction[0] + y * s->direction[1], 0, s->length);
    const float dx = x - along * s->direction[0], dy = y - along * s->direction[1];
    const float square = dx * dx + dy * dy, out = s->half_width + 0.5f;
    if (square >= out * out)
        return 0;
    const float cover = out - sqrtf(square);
    return cover < 1 ? cover : 1;
}

// blends a row of a line
static void blend_line(const struct cs_thick_line *s, int y, int height,
                       const struct cs_sample_pattern *pattern, struct cs_tile_buffer *tiles) {
    const cs_f4 across = __builtin_convertvector(pattern->x, cs_f4) * (1.0f / 256);
    const cs_f4 up = __builtin_convertvector(256 - pattern->y, cs_f4) * (1.0f / 256) +
                     (float)(height - 1 - y);
    const cs_f4 rise = s->depth.d_dy * up;
    const size_t row = (size_t)(y - tiles->samples.top) * (size_t)tiles->samples.width;
    int left, right;
    row_of(s, y, &left, &right);
    for (int x = left; x <= right; x++) {
        const float cover = pixel_coverage(s, (float)x + 0.5f - s->x, (float)y + 0.5f - s->y);
        const uint32_t share = (uint32_t)(s->coverage * cover * 255 + 0.5f);
        if (share == 0)
            continue;
        const size_t at = row + (size_t)x;
        const cs_f4 z = (s->depth.value + s->depth.d_dx * (across + (float)x)) + rise;
        cs_i4 mask =
            s->fits_32_bits ? inside_small(s, pattern, x, y) : inside_large(s, pattern, x, y);
        if (!s->on_top)
            mask &= CS_DEPTH_STEPS - z * CS_DEPTH_STEPS >= tiles->samples.depth[at];
        if (bits(mask))
            cs_tile_buffer_blend(tiles, at, bits(mask), s->colour, share);
    }
}

// packed colour of a value 0..1: linear between the six stops of the colour map
static uint32_t ramp_colour(const struct cs_shading_context *context, float value) {
    const float at = cs_clamp(value, 0, 1) * 5;
    const int low = cs_min((int)at, 4);
    const float *a = context->view->colour_stops[low],
                *b = context->view->colour_stops[low + 1];
    float c[3];
    for (int k = 0; k < 3; k++)
        c[k] = cs_clamp(a[k] + (b[k] - a[k]) * (at - (float)low), 0, 1);
    return cs_srgb_pack(context->srgb, c[0], c[1], c[2]);
}

// blends a row of the colour bar: one colour, over the samples inside the rectangle
static void blend_ramp(const struct cs_thick_lines *lines, const struct cs_thick_line *s, int y,
                       const struct cs_sample_pattern *pattern, struct cs_tile_buffer *tiles) {
    const size_t row = (size_t)(y - tiles->samples.top) * (size_t)tiles->samples.width;
    const uint32_t colour =
        ramp_colour(lines->shading, 1 - ((float)y + 0.5f - s->y) / s->direction[1]);
    for (int x = s->left; x <= s->right; x++) {
        unsigned mask = 0;
        for (int k = 0; k < 4; k++) {
            const float dx = (float)x + (float)pattern->x[k] / 256 - s->x;
            const float dy = (float)y + (float)pattern->y[k] / 256 - s->y;
            const bool in = dx >= 0 && dy >= 0 && dx < s->direction[0] && dy < s->direction[1];
            mask |= (unsigned)in << k;
        }
        if (mask)
            cs_tile_buffer_blend(tiles, row + (size_t)x, mask, colour, 255);
    }
}

CS_CLONES void cs_thick_lines_draw(const struct cs_thick_lines *lines, uint32_t band,
                                   const struct cs_sample_pattern *pattern,
                                   struct cs_tile_buffer *tiles) {
    size_t n;
    const uint32_t *list = cs_bins_of(&lines->bins, band, &n);
    const int last = tiles->samples.top + tiles->samples.rows - 1;
    for (size_t i = 0; i < n; i++) {
        const struct cs_thick_line *s = lines->items + list[i];
        for (int y = cs_max(s->top, tiles->samples.top); y <= cs_min(s->bottom, last); y++)
            if (s->uses_colour_map)
                blend_ramp(lines, s, y, pattern, tiles);
            else
                blend_line(s, y, lines->shading->height, pattern, tiles);
    }
}

/* Memory of a band, and the resolve: the mean of its samples. */

static enum cs_status take_samples(struct cs_samples *samples, int width,
                                   struct cs_arena *arena, struct cs_error *error) {
    const size_t n = (size_t)width * CS_ROWS;
    samples->width = width;
    samples->depth = cs_arena_alloc_array(arena, n, sizeof *samples->depth, error);
    samples->triangle_ids =
        cs_arena_alloc_array(arena, n, sizeof *samples->triangle_ids, error);
    return error->status;
}

enum cs_status cs_tile_buffer_init(struct cs_tile_buffer *tiles, int width,
                                   struct cs_arena *arena, struct cs_error *error) {
    const size_t n = (size_t)width * CS_ROWS;
    if (take_samples(&tiles->samples, width, arena, error) != CS_OK)
        return error->status;
    tiles->colours_capacity = (uint32_t)(CS_COLOURS_PER_PIXEL * n + CS_ROWS);
    tiles->first_colour = cs_arena_alloc_array(arena, n, sizeof *tiles->first_colour, error);
    tiles->sample_codes = cs_arena_alloc_array(arena, n, sizeof *tiles->sample_codes, error);
    tiles->colours =
        cs_arena_alloc_array(arena, tiles->colours_capacity, sizeof *tiles->colours, error);
    tiles->slots = cs_arena_alloc_array(arena, CS_FRAGMENT_SLOTS, sizeof *tiles->slots, error);
    return error->status;
}

// no triangle in rows top..top + rows - 1, with the depth of the far plane
static void clear(struct cs_samples *samples, int top, int rows) {
    const size_t n = (size_t)samples->width * (size_t)rows;
    const cs_f4 far = {0}; // the far plane
    const cs_i4 nothing = {CS_NOTHING, CS_NOTHING, CS_NOTHING, CS_NOTHING};
    samples->top = top;
    samples->rows = rows;
    for (size_t i = 0; i < n; i++) {
        samples->depth[i] = far;
        samples->triangle_ids[i] = nothing;
    }
}

void cs_tile_buffer_clear(struct cs_tile_buffer *tiles, int top, int rows) {
    clear(&tiles->samples, top, rows);
    tiles->n_colours = 0;
}

void cs_tile_buffer_resolve(const struct cs_tile_buffer *tiles, const struct cs_srgb *srgb,
                            struct cs_image *image) {
    const size_t n = (size_t)tiles->samples.width * (size_t)tiles->samples.rows;
    const size_t first = (size_t)tiles->samples.top * (size_t)tiles->samples.width;
    // copies, which stores of bytes cannot change
    const struct cs_image to = *image;
    const struct cs_tile_buffer from = *tiles;
    for (size_t i = 0; i < n; i++) {
        const uint32_t *colours = from.colours + from.first_colour[i],
                       code = from.sample_codes[i];
        // one colour for all samples needs no mean: decoding and encoding it would not change
        // it
        uint32_t c = *colours;
        if (code) {
            const uint32_t samples[4] = {colours[code & 3], colours[code >> 2 & 3],
                                         colours[code >> 4 & 3], colours[code >> 6]};
            c = cs_srgb_mean(srgb, samples);
        }
        cs_srgb_store(srgb, c, &to, first + i);
    }
}

/* blend.c - memory of a band; blends thick lines over it, and resolves it.
 *
 * The coverage of a pixel is taken from the distance d of its middle to the line, a segment:
 *   clamp(half_width + 1/2 - d, 0, 1)
 * It falls from 1 to 0 over the pixel at the border, and d to a segment makes the ends round.
 * Each sample then decides whether the line lies in front of the surface. */
#include "draw/cpu/thick_lines.h"

#include <math.h>
#include <string.h>

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
    struct cs_row_depth depth;
    const size_t row = (size_t)(y - tiles->samples.top) * (size_t)tiles->samples.width;
    int left, right;
    row_of(s, y, &left, &right);
    cs_row_depth_make(&depth, s->depth, pattern);
    for (int x = left; x <= right; x++) {
        const float cover = pixel_coverage(s, (float)x + 0.5f - s->x, (float)y + 0.5f - s->y);
        const uint32_t share = (uint32_t)(s->coverage * cover * 255 + 0.5f);
        if (share == 0)
            continue;
        const size_t at = row + (size_t)x;
        cs_f8 z;
        cs_samples_split(&tiles->samples, at, x, y, pattern);
        cs_row_depth_at(&depth, x, height - 1 - y, &z);
        const cs_i8 mask = (z >= tiles->samples.depth[at]) | -(int32_t)s->on_top;
        cs_tile_buffer_blend(tiles, at, &mask, s->colour, share);
    }
}

// blends a row of the colour bar: one colour, over the samples inside the rectangle
static void blend_ramp(const struct cs_thick_lines *lines, const struct cs_thick_line *s, int y,
                       const struct cs_sample_pattern *pattern, struct cs_tile_buffer *tiles) {
    const size_t row = (size_t)(y - tiles->samples.top) * (size_t)tiles->samples.width;
    float c[3];
    cs_ramp_colour(lines->shading, 1 - ((float)y + 0.5f - s->y) / s->direction[1], c);
    const uint32_t colour = cs_srgb_pack(lines->shading->srgb, cs_clamp(c[0], 0, 1),
                                         cs_clamp(c[1], 0, 1), cs_clamp(c[2], 0, 1));
    for (int x = s->left; x <= s->right; x++) {
        const cs_f8 dx = (float)x + __builtin_convertvector(pattern->x, cs_f8) / 256 - s->x;
        const cs_f8 dy = (float)y + __builtin_convertvector(pattern->y, cs_f8) / 256 - s->y;
        const cs_i8 mask =
            (dx >= 0) & (dy >= 0) & (dx < s->direction[0]) & (dy < s->direction[1]);
        cs_tile_buffer_blend(tiles, row + (size_t)x, &mask, colour, 255);
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

enum cs_status cs_tile_buffer_init(struct cs_tile_buffer *tiles, int width,
                                   struct cs_arena *arena, struct cs_error *error) {
    const size_t n = (size_t)width * CS_ROWS;
    tiles->samples.width = width;
    tiles->colours_capacity = (uint32_t)(CS_COLOURS_PER_PIXEL * n + CS_ROWS);
    CS_ARENA_ARRAY(arena, tiles->samples.whole, n, error);
    CS_ARENA_ARRAY(arena, tiles->samples.depth, n, error);
    CS_ARENA_ARRAY(arena, tiles->samples.triangle_ids, n, error);
    CS_ARENA_ARRAY(arena, tiles->first_colour, n, error);
    CS_ARENA_ARRAY(arena, tiles->sample_codes, n, error);
    CS_ARENA_ARRAY(arena, tiles->colours, tiles->colours_capacity, error);
    CS_ARENA_ARRAY(arena, tiles->slots, CS_FRAGMENT_SLOTS, error);
    return error->status;
}

// no triangle in rows top..top + rows - 1
void cs_tile_buffer_clear(struct cs_tile_buffer *tiles, int top, int rows) {
    struct cs_samples *samples = &tiles->samples;
    const size_t n = (size_t)samples->width * (size_t)rows;
    samples->top = top;
    samples->rows = rows;
    memset(samples->whole, CS_NOTHING, n * sizeof *samples->whole);
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
            uint32_t samples[CS_SAMPLES];
            for (uint32_t s = 0; s < CS_SAMPLES; s++)
                samples[s] = colours[code >> 3 * s & 7];
            c = cs_srgb_mean(srgb, samples);
        }
        cs_srgb_store(srgb, c, &to, first + i);
    }
}

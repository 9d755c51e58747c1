/* tile_buffer.c - memory of a band, and the resolve: the mean of its samples. */
#include "draw/cpu/thick_lines.h"

static enum cs_status take_samples(struct cs_samples *samples, int width,
                                   struct cs_arena *arena, struct cs_error *error) {
    const size_t n = (size_t)width * CS_ROWS;
    samples->width = width;
    samples->depth = cs_arena_alloc_array(arena, n, sizeof *samples->depth, error);
    samples->triangle_ids =
        cs_arena_alloc_array(arena, n, sizeof *samples->triangle_ids, error);
    return error->status;
}

enum cs_status cs_tile_buffer_init(struct cs_tile_buffer *tiles, int width, bool fades,
                                   bool ground, struct cs_arena *arena,
                                   struct cs_error *error) {
    const size_t n = (size_t)width * CS_ROWS;
    if (take_samples(&tiles->samples, width, arena, error) != CS_OK ||
        (ground && take_samples(&tiles->ground, width, arena, error) != CS_OK))
        return error->status;
    // a colour a row for the sky
    tiles->colours_capacity = (uint32_t)(CS_COLOURS_PER_PIXEL * n + CS_ROWS);
    tiles->first_colour = cs_arena_alloc_array(arena, n, sizeof *tiles->first_colour, error);
    tiles->sample_codes = cs_arena_alloc_array(arena, n, sizeof *tiles->sample_codes, error);
    tiles->colours =
        cs_arena_alloc_array(arena, tiles->colours_capacity, sizeof *tiles->colours, error);
    tiles->slots = cs_arena_alloc_array(arena, CS_FRAGMENT_SLOTS, sizeof *tiles->slots, error);
    if (fades)
        tiles->blend_pairs =
            cs_arena_alloc_array(arena, 8 * n, sizeof *tiles->blend_pairs, error);
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
    tiles->n_colours = tiles->n_blend_pairs = tiles->n_hidden = 0;
}

void cs_tile_buffer_clear_ground(struct cs_tile_buffer *tiles) {
    clear(&tiles->ground, tiles->samples.top, tiles->samples.rows);
}

void cs_tile_buffer_resolve(const struct cs_tile_buffer *tiles, const struct cs_srgb *tone,
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
            c = cs_srgb_mean(tone, samples);
        }
        cs_srgb_store(tone, c, &to, first + i);
    }
}

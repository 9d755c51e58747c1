/* band_pass.c - draws a band of the picture: visibility, fragments, blending, lines, resolve.
 *
 * All triangles of the band are filled with depth and index alone. Then each pixel is shaded
 * once per visible triangle; a slot collects fragments of one surface for the vector loops. */
#include "draw/cpu/band_pass.h"

#include <string.h>

void cs_band_pass_bin(struct cs_band_pass *pass) {
    cs_bins_sort(&pass->bins, pass->triangles.items, sizeof *pass->triangles.items,
                 offsetof(struct cs_triangle, top), pass->triangles.n);
}

static float value_at(const struct cs_plane_equation *slope, float x, float y) {
    return slope->value + slope->d_dx * x + slope->d_dy * y;
}

// the same in four pixels of a row
CS_INLINE cs_f4 values_at(const struct cs_plane_equation *slope, cs_f4 x, float y) {
    return slope->value + slope->d_dx * x + slope->d_dy * y;
}

CS_INLINE void put_four(cs_f4 from, float *to) {
    *(cs_f4_unaligned *)to = from;
}

/* Footprint of a pixel on a texture. Differences are taken in blocks of 2 x 2 pixels from the
 * bottom left, as OpenGL does. */
static struct cs_texel_footprint footprint_of(const struct cs_band_pass *pass,
                                              const struct cs_triangle *t,
                                              const struct cs_mipmap *mips, int x, int y) {
    const int last = pass->shading.height - 1;
    const float left = (float)((x & ~1) - t->left);
    const float low = (float)(last - ((last - y) & ~1) - t->top);
    const float places[3][2] = {{left, low}, {left + 1, low}, {left, low - 1}};
    struct cs_texel_footprint footprint;
    float uv[3][2], steps[2][2];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 2; k++)
            uv[i][k] = value_at(t->attributes + 4 + k, places[i][0], places[i][1]) /
                       value_at(&t->inverse, places[i][0], places[i][1]);
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 2; k++)
            steps[i][k] = uv[i + 1][k] - uv[0][k];
    cs_texel_footprint_make(mips, steps, &footprint);
    return footprint;
}

// the slot of one side of a surface; its fragments are shaded first if it is full or another's
CS_INLINE struct cs_fragments *slot_of(const struct cs_band_pass *pass,
                                       const struct cs_triangle *t,
                                       struct cs_tile_buffer *tiles) {
    const uint32_t key = 2u * t->surface + t->is_back_facing;
    struct cs_fragments *slot = tiles->slots + key % CS_FRAGMENT_SLOTS;
    if (slot->n == CS_FRAGMENTS || (slot->n && slot->key != key))
        cs_shade(&pass->shading, slot, tiles->colours);
    slot->key = key;
    slot->side = t->is_back_facing;
    slot->material = pass->materials + t->surface;
    return slot;
}

// m along the view from the depth at a pixel's middle, without the depth bias
static float along_of(const struct cs_band_pass *pass, const struct cs_triangle *t,
                      const struct cs_shading_material *material, int x, int y) {
    const float *depth = pass->shading.rays.depth;
    const struct cs_sample_pattern *pattern = pass->sample_pattern;
    const float up = (float)(pass->shading.height - 1 - y) + 0.5f + pattern->up[0];
    const float z = value_at(t->depth, (float)x + 0.5f + pattern->right[0], up);
    return depth[0] + z * (depth[1] - depth[0]) - material->depth_bias;
}

// n pixels of row y from x on
struct spot {
    int x, y, n;
    size_t pixel; // index of the first in the tile buffer
    uint32_t sky; // index of the colour of the sky in their row
};

/* Adds the fragments of a triangle at a spot; shading writes their colours to colours[out] and
 * those after it later. */
CS_INLINE void add_fragments(const struct cs_band_pass *pass, const struct cs_triangle *t,
                             const struct spot *spot, uint32_t out,
                             struct cs_tile_buffer *tiles) {
    for (int x = spot->x, end = x + spot->n, y = spot->y, count; x < end; x += count) {
        struct cs_fragments *f = slot_of(pass, t, tiles);
        const int first = f->n;
        const float down = (float)(y - t->top);
        count = cs_min(end - x, CS_FRAGMENTS - first);
        f->n += count;
        // in fours: what is written beyond the last one, the next ones overwrite
        for (int i = 0; i < count; i += 4) {
            const cs_f4 columns = (cs_f4){0, 1, 2, 3} + (float)(x + i);
            const cs_f4 across = columns - (float)t->left;
            const cs_f4 inverse = values_at(&t->inverse, across, down);
            put_four(columns, f->x + first + i);
            put_four((cs_f4){0} + (float)y, f->y + first + i);
            // the middle of a pixel may lie beyond the edge, and there beyond the horizon
            CS_LANES for (int k = 0; k < 4; k++) f->inverse[first + i + k] =
                inverse[k] > 1e-6f ? inverse[k] : 1e-6f;
            for (int k = 0; k < f->material->attributes; k++)
                put_four(values_at(t->attributes + k, across, down),
                         f->attributes[k] + first + i);
        }
        for (int i = 0; i < count; i++)
            f->colour_index[first + i] = out++;
        for (int i = 0; pass->shading.rays.parallel && i < count; i++)
            f->view_depth[first + i] = along_of(pass, t, f->material, x + i, y);
        // both pixels of a block of 2 x 2 have the same
        for (int i = 0; f->material->mode == CS_SURFACE_TEXTURED && i < count; i++)
            f->footprints[first + i] = i && ((x + i) & 1)
                                           ? f->footprints[first + i - 1]
                                           : footprint_of(pass, t, f->material->mips, x + i, y);
    }
}

// a pixel whose samples show several triangles: one fragment of each, colours in a row
CS_INLINE void add_mixed(const struct cs_band_pass *pass, const int32_t *shown,
                         const struct spot *spot, struct cs_tile_buffer *tiles) {
    int32_t things[CS_SAMPLES];
    uint32_t n = 0, code = 0;
    for (int s = 0; s < CS_SAMPLES; s++) {
        uint32_t k = 0;
        while (k < n && things[k] != shown[s])
            k++;
        if (k == n)
            things[n++] = shown[s];
        code |= k << 3 * s;
    }
    const uint32_t first = tiles->n_colours;
    tiles->first_colour[spot->pixel] = first;
    tiles->sample_codes[spot->pixel] = code;
    tiles->n_colours += n;
    for (uint32_t k = 0; k < n; k++)
        if (things[k] == CS_NOTHING)
            tiles->colours[first + k] = tiles->colours[spot->sky];
        else
            add_fragments(pass, pass->triangles.items + things[k], spot, first + k, tiles);
}

// the triangle that all samples of a pixel show, CS_NOTHING, or CS_SPLIT
CS_INLINE int32_t shown_by_all(const struct cs_samples *samples, size_t pixel) {
    if (samples->whole[pixel] != CS_SPLIT)
        return samples->whole[pixel];
    const cs_i4 *half = (const cs_i4 *)(samples->triangle_ids + pixel);
    const int32_t id = half[0][0];
    const cs_i4 other = (half[0] ^ id) | (half[1] ^ id);
    return (other[0] | other[1] | other[2] | other[3]) == 0 ? id : CS_SPLIT;
}

/* Adds the pixel where the spot begins and all after it that show the same triangle or sky in
 * all samples, which is the usual case, with one colour each. Sets spot->n. */
CS_INLINE void add_pixels(const struct cs_band_pass *pass, struct spot *spot,
                          struct cs_tile_buffer *tiles) {
    const struct cs_samples *samples = &tiles->samples;
    const int32_t id = shown_by_all(samples, spot->pixel);
    const bool is_sky = id == CS_NOTHING;
    uint32_t *first = tiles->first_colour + spot->pixel;
    spot->n = 1;
    if (id == CS_SPLIT) {
        add_mixed(pass, (const int32_t *)(samples->triangle_ids + spot->pixel), spot, tiles);
        return;
    }
    while (spot->n < samples->width - spot->x &&
           shown_by_all(samples, spot->pixel + (size_t)spot->n) == id)
        spot->n++;
    memset(tiles->sample_codes + spot->pixel, 0, (size_t)spot->n * sizeof(uint32_t));
    for (int i = 0; i < spot->n; i++)
        first[i] = is_sky ? spot->sky : tiles->n_colours + (uint32_t)i;
    if (is_sky)
        return;
    tiles->n_colours += (uint32_t)spot->n;
    add_fragments(pass, pass->triangles.items + id, spot, *first, tiles);
}

// colour of the sky in a row, dithered; transparent without background
static uint32_t sky_colour(const struct cs_band_pass *pass, int y) {
    float c[3];
    if (pass->shading.view->top_colour[3] < 1)
        return 0xff000000;
    cs_sky_colour(&pass->shading, (float)y, c);
    for (int k = 0; k < 3; k++)
        c[k] = cs_srgb_dithered(c[k], cs_srgb_dither(y));
    return cs_srgb_pack(pass->shading.srgb, c[0], c[1], c[2]);
}

// visibility, fragments and shading of a band
CS_CLONES static void show(const struct cs_band_pass *pass, uint32_t band,
                           struct cs_tile_buffer *tiles) {
    const struct cs_samples *on = &tiles->samples;
    size_t n;
    const uint32_t *list = cs_bins_of(&pass->bins, band, &n);
    for (size_t i = 0; i < n; i++)
        cs_raster_fill(on, (int32_t)list[i], pass->sample_pattern);
    for (int row = 0; row < on->rows; row++) {
        const uint32_t sky = tiles->n_colours++;
        tiles->colours[sky] = sky_colour(pass, on->top + row);
        struct spot spot = {0, on->top + row, 1, (size_t)row * (size_t)on->width, sky};
        for (; spot.x < on->width; spot.x += spot.n, spot.pixel += (size_t)spot.n)
            add_pixels(pass, &spot, tiles);
    }
    for (int i = 0; i < CS_FRAGMENT_SLOTS; i++)
        cs_shade(&pass->shading, tiles->slots + i, tiles->colours);
}

void cs_band_pass_draw(const struct cs_band_pass *pass, uint32_t band,
                       struct cs_tile_buffer *tiles) {
    const int top = (int)band * CS_ROWS;
    tiles->samples.triangles = pass->triangles.items;
    cs_tile_buffer_clear(tiles, top, cs_min(CS_ROWS, pass->shading.height - top));
    show(pass, band, tiles);
    cs_thick_lines_draw(&pass->thick_lines, band, pass->sample_pattern, tiles);
    cs_tile_buffer_resolve(tiles, pass->shading.srgb, pass->image);
}

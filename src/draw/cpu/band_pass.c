/* band_pass.c - draws a band of the picture: visibility, fragments, blending, lines, resolve.
 *
 * All triangles of the band are filled with depth and index alone. Then each pixel is shaded
 * once per visible triangle; a slot collects fragments of one surface for the vector loops. */
#include "draw/cpu/band_pass.h"

#include <math.h>

void cs_band_pass_bin(struct cs_band_pass *drawing) {
    const struct cs_triangles *all = &drawing->triangles;
    cs_bins_clear(&drawing->bins);
    for (size_t i = 0; i < all->n; i++)
        cs_bins_count(&drawing->bins, all->items[i].top, all->items[i].bottom);
    cs_bins_begin_put(&drawing->bins);
    for (size_t i = 0; i < all->n; i++)
        cs_bins_put(&drawing->bins, (uint32_t)i, all->items[i].top, all->items[i].bottom);
}

static float value_at(const struct cs_plane_equation *slope, float x, float y) {
    return slope->value + slope->d_dx * x + slope->d_dy * y;
}

/* Squared texels per pixel: the longer of the steps along a row and along a column (rho^2 of
 * mipmap.c). Differences are taken in blocks of 2 x 2 pixels from the bottom left, as OpenGL
 * does. */
static float texels_of(const struct cs_band_pass *drawing, const struct cs_triangle *t,
                       const struct cs_mipmap *mips, int x, int y) {
    const int last = drawing->shading.height - 1;
    const float left = (float)((x & ~1) - t->left);
    const float low = (float)(last - ((last - y) & ~1) - t->top);
    const float places[3][2] = {{left, low}, {left + 1, low}, {left, low - 1}};
    float uv[3][2], squares[2];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 2; k++)
            uv[i][k] = value_at(t->attributes + 4 + k, places[i][0], places[i][1]) /
                       value_at(&t->inverse, places[i][0], places[i][1]);
    for (int i = 0; i < 2; i++) {
        const float du = (uv[i + 1][0] - uv[0][0]) * (float)mips->levels[0].width;
        const float dv = (uv[i + 1][1] - uv[0][1]) * (float)mips->levels[0].height;
        squares[i] = du * du + dv * dv;
    }
    return squares[0] > squares[1] ? squares[0] : squares[1];
}

// the slot of one side of a surface; its fragments are shaded first if it is full or another's
static struct cs_fragments *slot_of(const struct cs_band_pass *drawing,
                                    const struct cs_triangle *t, struct cs_tile_buffer *tiles) {
    const uint32_t key = 2u * t->surface + t->is_back_facing;
    struct cs_fragments *slot = tiles->slots + key % CS_FRAGMENT_SLOTS;
    if (slot->n == CS_FRAGMENTS || (slot->n && slot->key != key))
        cs_shade(&drawing->shading, slot, tiles->colours);
    slot->key = key;
    slot->side = t->is_back_facing;
    slot->material = drawing->materials + t->surface;
    return slot;
}

// m along the view from the depth at a pixel's middle, without the depth bias
static float along_of(const struct cs_band_pass *drawing, const struct cs_triangle *t,
                      const struct cs_shading_material *coat, int x, int y) {
    const float *depth = drawing->shading.rays.depth;
    const float up = (float)(drawing->shading.height - 1 - y) + 0.5f;
    const float z = t->depth.value + t->depth.d_dx * ((float)x + 0.5f) + t->depth.d_dy * up;
    return depth[0] + z * (depth[1] - depth[0]) - coat->depth_bias;
}

// adds the fragment of a triangle at a pixel; shading writes its colour to colours[out] later
static void add_fragment(const struct cs_band_pass *drawing, const struct cs_triangle *t, int x,
                         int y, uint32_t out, struct cs_tile_buffer *tiles) {
    struct cs_fragments *f = slot_of(drawing, t, tiles);
    const float across = (float)(x - t->left), down = (float)(y - t->top);
    const float inverse = value_at(&t->inverse, across, down);
    const int i = f->n++;
    f->x[i] = (float)x;
    f->y[i] = (float)y;
    // the middle of a pixel may lie beyond the edge, and there beyond the horizon
    f->inverse[i] = inverse > 1e-6f ? inverse : 1e-6f;
    for (int k = 0; k < f->material->attributes; k++)
        f->attributes[k][i] = value_at(t->attributes + k, across, down);
    if (drawing->shading.rays.parallel)
        f->view_depth[i] = along_of(drawing, t, f->material, x, y);
    if (f->material->mode == CS_SURFACE_TEXTURED)
        f->texels[i] = texels_of(drawing, t, f->material->mips, x, y);
    f->colour_index[i] = out;
}

/* The square behind square `id` at a sample: the last one drawn before it that was nearest
 * then; CS_NOTHING: the sky. */
static int32_t find_behind(const struct cs_band_pass *drawing, int32_t id, int x, int y,
                           int sample) {
    const uint16_t surface = drawing->triangles.items[id].surface;
    float depth = 0;
    int32_t behind = CS_NOTHING;
    for (size_t i = 0; i < drawing->n_ground_squares; i++) {
        const struct cs_triangle *t = drawing->triangles.items + i;
        cs_f4 z;
        if (t->surface == surface)
            break;
        if (!(cs_raster_covers(t, drawing->sample_pattern, x, y, &z) >> sample & 1) ||
            !(z[sample] >= depth))
            continue;
        depth = z[sample];
        behind = (int32_t)i;
    }
    return behind;
}

struct spot {
    int x, y;
    size_t pixel; // its index in the tile buffer
    uint32_t sky; // index of the colour of the sky in its row
};

/* Adds the fragment of triangle `id`. A fading one also needs the colour behind it: another
 * fragment, found recursively, or the sky. Pairs are listed from back to front. */
static void add_shown(const struct cs_band_pass *drawing, int32_t id, const struct spot *spot,
                      int sample, uint32_t out, struct cs_tile_buffer *tiles) {
    const struct cs_triangle *t = drawing->triangles.items + id;
    if (drawing->materials[t->surface].fade_radius > 0) {
        const size_t most = 4 * (size_t)tiles->samples.width * CS_ROWS;
        const int32_t behind = find_behind(drawing, id, spot->x, spot->y, sample);
        uint32_t under = spot->sky;
        if (behind != CS_NOTHING && tiles->n_hidden < most) {
            tiles->n_hidden++;
            under = tiles->n_colours++;
            add_shown(drawing, behind, spot, sample, under, tiles);
        }
        tiles->blend_pairs[tiles->n_blend_pairs++] = (struct cs_blend_pair){out, under};
    }
    add_fragment(drawing, t, spot->x, spot->y, out, tiles);
}

// a pixel whose samples show several triangles: one fragment of each, colours in a row
static void add_mixed(const struct cs_band_pass *drawing, cs_i4 shown, const struct spot *spot,
                      struct cs_tile_buffer *tiles) {
    int samples[4]; // the first that shows each thing
    uint32_t n = 0, code = 0;
    for (int s = 0; s < 4; s++) {
        uint32_t k = 0;
        while (k < n && shown[samples[k]] != shown[s])
            k++;
        if (k == n)
            samples[n++] = s;
        code |= k << 2 * s;
    }
    const uint32_t first = tiles->n_colours;
    tiles->first_colour[spot->pixel] = first;
    tiles->sample_codes[spot->pixel] = (uint8_t)code;
    tiles->n_colours += n;
    for (uint32_t k = 0; k < n; k++)
        if (shown[samples[k]] == CS_NOTHING)
            tiles->colours[first + k] = tiles->colours[spot->sky];
        else
            add_shown(drawing, shown[samples[k]], spot, samples[k], first + k, tiles);
}

// a pixel of one triangle in all samples, the usual case, has one colour
static void add_pixel(const struct cs_band_pass *drawing, cs_i4 shown, const struct spot *spot,
                      struct cs_tile_buffer *tiles) {
    const int32_t id = shown[0];
    if (((shown[1] ^ id) | (shown[2] ^ id) | (shown[3] ^ id)) != 0) {
        add_mixed(drawing, shown, spot, tiles);
        return;
    }
    tiles->sample_codes[spot->pixel] = 0;
    tiles->first_colour[spot->pixel] = id == CS_NOTHING ? spot->sky : tiles->n_colours++;
    if (id != CS_NOTHING)
        add_shown(drawing, id, spot, 0, tiles->first_colour[spot->pixel], tiles);
}

// colour of the sky in a row: linear from top to bottom, or transparent without background
static uint32_t sky_colour(const struct cs_band_pass *drawing, int y) {
    const struct cs_view_block *view = drawing->shading.view;
    const float down = ((float)y + 0.5f) / (float)drawing->shading.height;
    float c[3];
    if (view->top_colour[3] < 1)
        return 0xff000000;
    for (int i = 0; i < 3; i++)
        c[i] = cs_clamp(
            view->top_colour[i] + down * (view->bottom_colour[i] - view->top_colour[i]), 0, 1);
    return cs_srgb_pack(drawing->shading.srgb, c[0], c[1], c[2]);
}

// visibility, fragments and shading of a band
static void show(const struct cs_band_pass *drawing, uint32_t band,
                 struct cs_tile_buffer *tiles) {
    const struct cs_samples *on = &tiles->samples;
    size_t n;
    const uint32_t *list = cs_bins_of(&drawing->bins, band, &n);
    for (size_t i = 0; i < n; i++)
        cs_raster_fill(drawing->triangles.items + list[i], (int32_t)list[i],
                       drawing->sample_pattern, on);
    for (int row = 0; row < on->rows; row++) {
        const uint32_t sky = tiles->n_colours++;
        tiles->colours[sky] = sky_colour(drawing, on->top + row);
        for (int x = 0; x < on->width; x++) {
            const size_t pixel = (size_t)row * (size_t)on->width + (size_t)x;
            const struct spot spot = {x, on->top + row, pixel, sky};
            add_pixel(drawing, on->triangle_ids[pixel], &spot, tiles);
        }
    }
    for (int i = 0; i < CS_FRAGMENT_SLOTS; i++)
        cs_shade(&drawing->shading, tiles->slots + i, tiles->colours);
    // pairs from back to front: the colour behind is final when it is used
    for (uint32_t i = 0; i < tiles->n_blend_pairs; i++) {
        uint32_t *over = tiles->colours + tiles->blend_pairs[i].front;
        *over = cs_srgb_blend(tiles->colours[tiles->blend_pairs[i].behind], *over,
                              255 - (*over >> 24));
    }
}

void cs_band_pass_draw(const struct cs_band_pass *drawing, uint32_t band,
                       struct cs_tile_buffer *tiles) {
    const int top = (int)band * CS_ROWS;
    cs_tile_buffer_clear(tiles, top, cs_min(CS_ROWS, drawing->shading.height - top));
    show(drawing, band, tiles);
    if (drawing->grid.square.n)
        cs_grid_draw(&drawing->grid, (int32_t)drawing->n_fixed, drawing->sample_pattern, tiles);
    cs_thick_lines_draw(&drawing->thick_lines, band, drawing->sample_pattern, tiles);
    cs_tile_buffer_resolve(tiles, drawing->shading.srgb, drawing->image);
}

/* Blends the lines of the ground and the shadows on it over a band.
 *
 * The ground is a plane y = height. A pixel's ray eye + t d meets it at t = (height - eye_y) /
 * d_y; no triangle's planes are needed. The opacity of its ink is
 *   near^2 (dark + (1 - dark) 0.55 lines)
 * near falls from 1 in the centre to 0 at the radius of the fade disc; dark is the shadow's
 * strength times the fraction of hidden light; lines is the coverage by the grid.
 *
 * Lines are a pixel wide at any distance: the ground's extent per pixel is measured as in
 * OpenGL, by differences in blocks of 2 x 2 pixels from the bottom. */

enum { N = CS_FRAGMENTS };

/* Pixels to be blended together. */
struct cells {
    int n;
    uint32_t pixels[N];
    uint8_t masks[N];
    float x[N], y[N];
};

// the point of the ground that a pixel shows; false above the horizon
static bool find_position(const struct cs_grid *grid, float x, float y, float place[3]) {
    const struct cs_rays *rays = &grid->shading->rays;
    const float height = grid->ground.fade_disc[1], above = height - rays->eye[1];
    float d[3];
    cs_ray_direction(grid->shading, x, y, d);
    const float fall = rays->parallel ? -rays->back[1] : d[1];
    const float way = rays->parallel ? above - d[1] : above;
    const float t = fall < 0 || fall > 0 ? way / fall : -1;
    cs_ray_point(grid->shading, x, y, t, place);
    place[1] = height;
    return rays->parallel ? fall < 0 : t > 0;
}

static float away(float a) {
    return a < 0 ? -a : a;
}

/* Coverage of a pixel by lines in steps of `step`. at: position across each axis of the ground;
 * wide: extent of a pixel along it. A line fades linearly over the pixel at its border. */
static float cover(const float at[2], const float wide[2], float step, float half_width) {
    float most = 0;
    for (int i = 0; i < 2; i++) {
        const float place = at[i] / step, least = 1e-6f;
        const float pixel = wide[i] / step > least ? wide[i] / step : least;
        const float off = away(place - floorf(place + 0.5f)) / pixel;
        // where lines come close they melt into a tint instead of a moire pattern
        const float c =
            cs_clamp(half_width + 0.5f - off, 0, 1) * cs_clamp(0.5f / pixel - 0.6f, 0, 1);
        most = c > most ? c : most;
    }
    return most;
}

// coverage by fine lines and by every tenth, stronger one
static float lines_at(const struct cs_grid *grid, float x, float y, const float p[3]) {
    const int size = grid->shading->height;
    const float beside_x = (float)((int)x ^ 1);
    const float beside_y = (float)(size - 1 - ((size - 1 - (int)y) ^ 1));
    const float pitch = grid->ground.line_spacing, at[2] = {p[0], p[2]};
    float a[3], b[3];
    find_position(grid, beside_x, y, a);
    find_position(grid, x, beside_y, b);
    const float wide[2] = {away(a[0] - p[0]) + away(b[0] - p[0]),
                           away(a[2] - p[2]) + away(b[2] - p[2])};
    const float fine = 0.5f * cover(at, wide, pitch, 0.45f);
    const float coarse = cover(at, wide, 10 * pitch, 0.7f);
    return fine > coarse ? fine : coarse;
}

/* Blends over the samples of the mask. If all samples share a colour they keep sharing one: a
 * new colour, since other pixels may share the old one. */
static void blend_pixel(struct cs_tile_buffer *tiles, size_t pixel, unsigned mask, uint32_t ink,
                        uint32_t share) {
    if (mask != 15 || tiles->sample_codes[pixel] != 0) {
        cs_tile_buffer_blend(tiles, pixel, mask, ink, share);
        return;
    }
    const uint32_t laid = tiles->n_colours++;
    tiles->colours[laid] =
        cs_srgb_blend(tiles->colours[tiles->first_colour[pixel]], ink, share);
    tiles->first_colour[pixel] = laid;
}

/* Blends the collected pixels: positions, one shadow query for all, opacities. */
static void blend_grid(const struct cs_grid *grid, struct cells *cells,
                       struct cs_tile_buffer *tiles) {
    static const float up[N] = {0}; // x and z of the normals
    float places[3][N], ones[N], shares[N];
    const float *span = grid->ground.fade_disc;
    bool seen[N];
    for (int i = 0; i < cells->n; i++) {
        float p[3];
        seen[i] = find_position(grid, cells->x[i], cells->y[i], p);
        for (int k = 0; k < 3; k++)
            places[k][i] = p[k];
        ones[i] = 1;
    }
    const struct cs_shadow_query lit = {.positions = {places[0], places[1], places[2]},
                                        .normals = {up, ones, up},
                                        .n_dot_l = ones,
                                        .visibility = shares,
                                        .n = cells->n};
    cs_shadow_map_sample(grid->shading->shadow_map, &lit);
    for (int i = 0; i < cells->n; i++) {
        const float p[3] = {places[0][i], places[1][i], places[2][i]};
        const float dx = p[0] - span[0], dz = p[2] - span[2];
        const float near = cs_clamp(1 - sqrtf(dx * dx + dz * dz) / span[3], 0, 1);
        const float dark = grid->ground.shadow * (1 - shares[i]);
        if (!seen[i] || !(near > 0))
            continue;
        const float lines =
            grid->ground.line_spacing > 0 ? lines_at(grid, cells->x[i], cells->y[i], p) : 0;
        const float share = near * near * (dark + (1 - dark) * 0.55f * lines);
        const uint32_t byte = (uint32_t)(share * 255 + 0.5f);
        if (byte)
            blend_pixel(tiles, cells->pixels[i], cells->masks[i], grid->ink, byte);
    }
    cells->n = 0;
}

// samples of a pixel that show the ground: in front of the sky or of what never moves
static unsigned mask_of(const struct cs_tile_buffer *tiles, size_t at, int32_t moving) {
    const struct cs_samples *on = &tiles->samples, *ground = &tiles->ground;
    const cs_i4 lies = (ground->triangle_ids[at] >= 0) & (on->triangle_ids[at] < moving) &
                       (ground->depth[at] >= on->depth[at]);
    return (unsigned)(lies[0] & 1) | (unsigned)(lies[1] & 2) | (unsigned)(lies[2] & 4) |
           (unsigned)(lies[3] & 8);
}

// the part of a band that the rectangle may touch
struct window {
    int left, right, top, bottom;
};

// fills the rectangle into the samples of the ground; returns the part of the band
static struct window fill(const struct cs_grid *grid, const struct cs_sample_pattern *pattern,
                          struct cs_tile_buffer *tiles) {
    const int last = tiles->samples.top + tiles->samples.rows - 1;
    struct window in = {tiles->samples.width, -1, last + 1, -1};
    for (size_t i = 0; i < grid->square.n; i++) {
        const struct cs_triangle *t = grid->square.items + i;
        in.left = cs_min(in.left, t->left);
        in.right = cs_max(in.right, t->right);
        in.top = cs_min(in.top, t->top);
        in.bottom = cs_max(in.bottom, t->bottom);
    }
    in.top = cs_max(in.top, tiles->samples.top);
    in.bottom = cs_min(in.bottom, last);
    if (in.top > in.bottom)
        return in;
    cs_tile_buffer_clear_ground(tiles);
    for (size_t i = 0; i < grid->square.n; i++)
        cs_raster_fill(grid->square.items + i, (int32_t)i, pattern, &tiles->ground);
    return in;
}

void cs_grid_draw(const struct cs_grid *grid, int32_t moving,
                  const struct cs_sample_pattern *pattern, struct cs_tile_buffer *tiles) {
    const struct window in = fill(grid, pattern, tiles);
    struct cells cells = {.n = 0};
    for (int y = in.top; y <= in.bottom; y++)
        for (int x = in.left; x <= in.right; x++) {
            const size_t at =
                (size_t)(y - tiles->samples.top) * (size_t)tiles->samples.width + (size_t)x;
            const unsigned mask = mask_of(tiles, at, moving);
            if (!mask)
                continue;
            cells.pixels[cells.n] = (uint32_t)at;
            cells.masks[cells.n] = (uint8_t)mask;
            cells.x[cells.n] = (float)x;
            cells.y[cells.n++] = (float)y;
            if (cells.n == N)
                blend_grid(grid, &cells, tiles);
        }
    blend_grid(grid, &cells, tiles);
}

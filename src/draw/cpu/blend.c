/* blend.c - blends thick lines, and lines of the ground and shadows on it, over a band.
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
static uint32_t ramp_colour(const struct cs_shading_context *easel, float value) {
    const float at = cs_clamp(value, 0, 1) * 5;
    const int low = cs_min((int)at, 4);
    const float *a = easel->view->colour_stops[low], *b = easel->view->colour_stops[low + 1];
    float c[3];
    for (int k = 0; k < 3; k++)
        c[k] = cs_clamp(a[k] + (b[k] - a[k]) * (at - (float)low), 0, 1);
    return cs_srgb_pack(easel->srgb, c[0], c[1], c[2]);
}

// blends a row of the colour bar: one colour, over the samples inside the rectangle
static void blend_ramp(const struct cs_thick_lines *strokes, const struct cs_thick_line *s,
                       int y, const struct cs_sample_pattern *pattern,
                       struct cs_tile_buffer *tiles) {
    const size_t row = (size_t)(y - tiles->samples.top) * (size_t)tiles->samples.width;
    const uint32_t colour =
        ramp_colour(strokes->shading, 1 - ((float)y + 0.5f - s->y) / s->direction[1]);
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

CS_CLONES void cs_thick_lines_draw(const struct cs_thick_lines *strokes, uint32_t band,
                                   const struct cs_sample_pattern *pattern,
                                   struct cs_tile_buffer *tiles) {
    size_t n;
    const uint32_t *list = cs_bins_of(&strokes->bins, band, &n);
    const int last = tiles->samples.top + tiles->samples.rows - 1;
    for (size_t i = 0; i < n; i++) {
        const struct cs_thick_line *s = strokes->items + list[i];
        for (int y = cs_max(s->top, tiles->samples.top); y <= cs_min(s->bottom, last); y++)
            if (s->uses_colour_map)
                blend_ramp(strokes, s, y, pattern, tiles);
            else
                blend_line(s, y, strokes->shading->height, pattern, tiles);
    }
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

/* Coverage of a pixel by lines in steps of `step`. at: position across each axis of the ground;
 * wide: extent of a pixel along it. A line fades linearly over the pixel at its border. */
static float cover(const float at[2], const float wide[2], float step, float half_width) {
    float most = 0;
    for (int i = 0; i < 2; i++) {
        const float place = at[i] / step, least = 1e-6f;
        const float pixel = wide[i] / step > least ? wide[i] / step : least;
        const float off = fabsf(place - floorf(place + 0.5f)) / pixel;
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
    const float wide[2] = {fabsf(a[0] - p[0]) + fabsf(b[0] - p[0]),
                           fabsf(a[2] - p[2]) + fabsf(b[2] - p[2])};
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
    cs_shade_lit_fraction(grid->shading, &lit);
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
    return bits(lies);
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

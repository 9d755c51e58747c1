/* grid.c - blends the lines of the ground and the shadows on it over a band.
 *
 * The ground is a plane y = height. A pixel's ray eye + t d meets it at t = (height - eye_y) /
 * d_y; no triangle's planes are needed. The opacity of its ink is
 *   near^2 (dark + (1 - dark) 0.55 lines)
 * near falls from 1 in the centre to 0 at the radius of the fade disc; dark is the shadow's
 * strength times the fraction of hidden light; lines is the coverage by the grid.
 *
 * Lines are a pixel wide at any distance: the ground's extent per pixel is measured as in
 * OpenGL, by differences in blocks of 2 x 2 pixels from the bottom. */
#include "draw/cpu/grid.h"

#include <math.h>

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

/* fragments.c - the ground: a plane with a pattern over x and z, which fades into haze.
 *
 * A pixel's ray eye + t d meets a plane of normal n where t d.n is constant, so a step of d by
 * d' to the next pixel moves the point by t (d' - d (d'.n) / (d.n)). Both steps give the width
 * of a pixel along x and z, over which the pattern is averaged.
 *
 * Squares are the product of two waves of 1 and -1, whose mean over a pixel is a difference of
 * their integral, a triangle wave. Lines are a pixel wide at any distance. */
#include "draw/cpu/fragments.h"

#include "draw/cpu/triangle.h"

#include <math.h>

enum { N = CS_FRAGMENTS };

/* Contrast of squares, chosen by trial; also in gl/shader_sources.c. */
#define CS_SQUARES 0.06f

// widths of pixels along x and z, in m; parallel rays have 1/w = 1
CS_INLINE void find_widths(const struct cs_shading_context *shading,
                           const struct cs_fragments *f, const struct cs_shading_work *w,
                           float wide[2][N]) {
    const struct cs_rays *r = &shading->rays;
    const float near = r->parallel ? 0 : 1;
    const float *n = f->material->ground.normal;
    const float sx = 2 * r->slope_x / (float)shading->width;
    const float sy = 2 * r->slope_y / (float)shading->height;
    const float right = r->right[0] * n[0] + r->right[1] * n[1] + r->right[2] * n[2];
    const float up = r->up[0] * n[0] + r->up[1] * n[1] + r->up[2] * n[2];
    // q.n is the height of the eye over the plane, one for all its points
    float down = 0;
    for (int k = 0; k < 3; k++)
        down += (near * (w->place[k][0] - r->eye[k]) + (1 - near) * r->back[k]) * n[k];
    const float share = 1 / (down > 1e-6f || down < -1e-6f ? down : 1e-6f);
    for (int a = 0; a < 2; a++) {
        const float eye = near * r->eye[2 * a] - (1 - near) * r->back[2 * a];
        const float across = r->right[2 * a], along = r->up[2 * a];
        // along an axis, a step across and a step up move the point by |t sx dx| + |t sy dy|
        for (int i = 0; i < N; i++) {
            const float q = (near * w->place[2 * a][i] - eye) * share;
            const float step = sx * fabsf(across - q * right) + sy * fabsf(along - q * up);
            wide[a][i] = step / f->inverse[i];
        }
    }
}

// distance from the nearest whole number, for |v| < 2^22: floats near 1.5 x 2^23 are whole
CS_INLINE float from_whole(float v) {
    const float whole = (v + 12582912.0f) - 12582912.0f;
    return fabsf(v - whole);
}

// integral of the wave that is 1 on 0..1 and -1 on 1..2
CS_INLINE float wave_integral(float u) {
    return 2 * from_whole(0.5f * u);
}

// mean of the product of both waves over pixels, -1..1
CS_INLINE void find_squares(float tile, float wide[2][N], struct cs_shading_work *w) {
    const float part = 1 / tile;
    for (int i = 0; i < N; i++)
        w->cover[i] = 1;
    for (int a = 0; a < 2; a++) {
        for (int i = 0; i < N; i++) {
            const float pixel = wide[a][i] * part;
            wide[a][i] = pixel > 0.01f ? pixel : 0.01f;
        }
        for (int i = 0; i < N; i++) {
            const float u = w->place[2 * a][i] * part, half = 0.5f * wide[a][i];
            w->cover[i] *= (wave_integral(u + half) - wave_integral(u - half)) / wide[a][i];
        }
    }
}

/* Coverage of a pixel by lines in steps of `step`. A line fades linearly over the pixel at its
 * border. */
CS_INLINE float line_cover(float x, float wide, float step, float half_width) {
    const float place = x / step, least = 1e-6f;
    const float pixel = wide / step > least ? wide / step : least;
    const float off = from_whole(place) / pixel;
    // where lines come close they melt into a tint instead of a moire pattern
    return cs_clamp(half_width + 0.5f - off, 0, 1) * cs_clamp(0.5f / pixel - 0.6f, 0, 1);
}

// coverage by fine lines and by every tenth, stronger one
CS_INLINE void find_lines(float tile, float wide[2][N], struct cs_shading_work *w) {
    for (int a = 0; a < 2; a++)
        for (int i = 0; i < N; i++) {
            const float x = w->place[2 * a][i];
            const float fine = 0.275f * line_cover(x, wide[a][i], tile, 0.45f);
            const float coarse = 0.55f * line_cover(x, wide[a][i], 10 * tile, 0.7f);
            const float most = fine > coarse ? fine : coarse;
            w->cover[i] = most > w->cover[i] ? most : w->cover[i];
        }
}

CS_CLONES void cs_shade_pattern(const struct cs_shading_context *shading,
                                const struct cs_fragments *f, struct cs_shading_work *w) {
    const struct cs_ground_style *ground = &f->material->ground;
    float wide[2][N];
    for (int i = 0; i < N; i++)
        w->cover[i] = 0;
    if (!(ground->tile > 0))
        return;
    find_widths(shading, f, w, wide);
    if (ground->lines)
        find_lines(ground->tile, wide, w);
    else
        find_squares(ground->tile, wide, w);
    // lines mix the base with ink, squares make it a little lighter or darker
    for (int k = 0; k < 3; k++) {
        const float base = f->material->base[f->side][k];
        const float change = ground->lines ? ground->ink[k] - base : CS_SQUARES * base;
        for (int i = 0; i < N; i++)
            w->base[k][i] = base + w->cover[i] * change;
    }
}

/* Fills `share` with the fraction of the diffuse light of all lights. */
static void find_lit_fraction(const struct cs_shading_context *shading, int n,
                              struct cs_shading_work *w) {
    float one[N];
    const struct cs_shadow_query query = cs_shading_query(w, one, n);
    for (int l = 0; l < (int)shading->view->size[3]; l++) {
        const float fraction = shading->view->lights[l].shadow_params[3];
        cs_shadow_map_sample(shading->shadow_maps + l, &query);
        for (int i = 0; i < n; i++)
            w->share[i] = (l ? w->share[i] : 0) + fraction * one[i];
    }
}

void cs_shade_shadows(const struct cs_shading_context *shading, const struct cs_fragments *f,
                      struct cs_shading_work *w) {
    const struct cs_ground_style *ground = &f->material->ground;
    for (int i = 0; i < N; i++)
        w->facing[i] = 1;
    find_lit_fraction(shading, f->n, w);
    for (int i = 0; i < f->n; i++) {
        const float dark = ground->shadow * (1 - w->share[i]);
        w->cover[i] = dark + (1 - dark) * w->cover[i];
        for (int k = 0; k < 3; k++)
            w->colour[k][i] = ground->ink[k];
    }
}

/* Fades the ground into the background, or into nothing without one: at the distance d haze of
 * radius R leaves (1 - d^2 / R^2)^2 of it. Colours are then dithered. */
CS_CLONES void cs_shade_haze(const struct cs_shading_context *shading,
                             const struct cs_fragments *f, struct cs_shading_work *w) {
    const struct cs_ground_style *ground = &f->material->ground;
    const float part = 1 / ground->radius;
    const bool opaque = shading->view->top_colour[3] >= 1, whole = ground->shadow <= 0;
    for (int i = 0; i < N; i++) {
        const float dx = (w->place[0][i] - ground->centre[0]) * part;
        const float dz = (w->place[2][i] - ground->centre[1]) * part;
        w->shine[i] = cs_clamp(1 - (dx * dx + dz * dz), 0, 1);
    }
    for (int i = 0; i < N; i++) {
        w->shine[i] *= w->shine[i];
        w->share[i] = cs_srgb_dither((int)f->y[i]);
    }
    for (int i = 0; i < N && !whole; i++)
        w->shine[i] *= w->cover[i];
    for (int i = 0; i < N; i++)
        w->cover[i] = opaque ? 1 : w->shine[i];
    for (int k = 0; k < 3; k++) {
        const float top = shading->view->top_colour[k];
        const float slope = (shading->view->bottom_colour[k] - top) / (float)shading->height;
        for (int i = 0; i < N; i++) {
            const float sky = cs_clamp(top + slope * (f->y[i] + 0.5f), 0, 1);
            const float left = opaque ? w->shine[i] : 1;
            w->colour[k][i] = cs_clamp(sky + left * (w->colour[k][i] - sky), 0, 1);
        }
        for (int i = 0; i < N; i++)
            w->colour[k][i] = cs_srgb_dithered(w->colour[k][i], w->share[i]);
    }
}

/* triangle.c - triangle set-up: corners on a grid of 1/256 pixel, planes of depth, attributes.
 *
 * Coverage (Pineda 1988). Edge k goes from corner k to corner k + 1; its edge function
 *   E_k(x, y) = dx_k (y - y_k) - dy_k (x - x_k)
 * is twice the signed area of the triangle (corner k, corner k + 1, sample). With y down and
 * the corners clockwise as seen, a sample is inside if no E_k is negative.
 *
 * Why whole numbers: corners and samples lie on the grid of 1/256 pixel, so E_k is exact. Two
 * triangles with a common edge compute E and -E of the same integers. Each sample on either
 * side of the edge, or on it (raster.c, top-left rule), therefore belongs to exactly one of
 * them. In floating point the two would round differently, which leaves gaps and double hits.
 *
 * Why planes: perspective division maps x, y, z, w to x/w, y/w, z/w. Over a triangle's plane
 *   a attribute + b x + c y + d w = 0   =>   attribute/w is linear in x/w and y/w.
 * The attribute 1 gives 1/w. The planes hold those two; shading divides one by the other.
 */
#include "draw/cpu/triangle.h"

#include "base/arena.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Projection, and clipping (Sutherland, Hodgman 1974) in clip coordinates.
 *
 * A point is inside the near plane if w >= near, and inside the side planes if |x|, |y| are at
 * most 16 w. Before the division by w these are linear, so an edge from a to b with signed
 * distances d_a >= 0 > d_b meets a plane at t = d_a / (d_a - d_b). Attributes are linear in
 * space and take the same t. There is no far plane: reversed depth may fall below 0.
 */

/* Half pictures beyond which triangles are cut: a guard band. Triangles that leave the picture
 * by less are not clipped, and edge functions still fit into 64 bits. */
static const float guard = 16;

enum { PLANES = 5 }; // near, left, right, below, above
enum { CLIP_VERTICES_MAX = 9 };

void cs_clip_transform_make(struct cs_clip_transform *clip, const float matrix[16], float near,
                            int width, int height) {
    for (int i = 0; i < 4; i++) {
        clip->x[i] = matrix[4 * i];
        clip->y[i] = matrix[4 * i + 1];
        clip->z[i] = matrix[4 * i + 2];
        clip->w[i] = matrix[4 * i + 3];
    }
    clip->near = near > 0 ? near : 0.5f;
    memset(clip->jitter, 0, sizeof clip->jitter);
    clip->width = width;
    clip->height = height;
}

static float row(const float r[4], const float p[3]) {
    return r[0] * p[0] + r[1] * p[1] + r[2] * p[2] + r[3];
}

// signed distance to a plane, in units of w; w alone decides about the near one
static float inside(const struct cs_clip_transform *clip, const struct cs_clip_vertex *c,
                    int plane) {
    const float at = c->clip[plane > 2], reach = guard * c->clip[3];
    return plane == 0 ? c->clip[3] - clip->near : plane & 1 ? at + reach : reach - at;
}

// viewport: clip coordinates -w..w to pixels, and depth to 0..1
static void set_pixel(const struct cs_clip_transform *clip, struct cs_clip_vertex *c) {
    const float half[2] = {0.5f * (float)clip->width, 0.5f * (float)clip->height};
    c->inverse = 1 / c->clip[3];
    c->x = c->clip[0] * c->inverse * half[0] + half[0];
    c->y = c->clip[1] * c->inverse * half[1] + half[1];
    c->z = c->clip[2] * c->inverse * 0.5f + 0.5f;
}

void cs_clip_transform_project(const struct cs_clip_transform *clip, struct cs_clip_vertex *c) {
    c->clip_mask = 0;
    for (int plane = 0; plane < PLANES; plane++)
        // true for NAN too
        c->clip_mask |= (uint32_t)(!(inside(clip, c, plane) >= 0)) << plane;
    if (!(c->clip_mask & 1))
        set_pixel(clip, c);
}

void cs_clip_transform_corner(const struct cs_clip_transform *clip, const float place[3],
                              struct cs_clip_vertex *corner) {
    corner->clip[0] = row(clip->x, place);
    corner->clip[1] = row(clip->y, place);
    corner->clip[2] = row(clip->z, place);
    corner->clip[3] = row(clip->w, place);
    cs_clip_transform_project(clip, corner);
}

void cs_clip_transform_move_depth(const struct cs_clip_transform *clip, const float place[3],
                                  const float eye[4], float by, struct cs_clip_vertex *corner) {
    float d[3], square = 0, moved[3];
    for (int i = 0; i < 3; i++) {
        d[i] = eye[3] * place[i] - eye[i];
        square += d[i] * d[i];
    }
    const float share = square > 0 ? by / sqrtf(square) : 0;
    for (int i = 0; i < 3; i++)
        moved[i] = place[i] + share * d[i];
    const float z = row(clip->z, moved), w = row(clip->w, moved);
    if (!(w > 0 && corner->clip[3] > 0))
        return;
    corner->clip[2] = z / w * corner->clip[3];
    cs_clip_transform_project(clip, corner);
}

// the point at fraction t from a to b; its pixel is not set yet
static struct cs_clip_vertex between(const struct cs_clip_vertex *a,
                                     const struct cs_clip_vertex *b, float t) {
    struct cs_clip_vertex c = {.clip_mask = 0};
    for (int i = 0; i < 4; i++)
        c.clip[i] = a->clip[i] + t * (b->clip[i] - a->clip[i]);
    for (int i = 0; i < CS_ATTRIBUTES; i++)
        c.attributes[i] = a->attributes[i] + t * (b->attributes[i] - a->attributes[i]);
    return c;
}

/* Clips a polygon of n corners by one plane; returns the number of corners left. A corner
 * inside is copied, an edge that crosses the plane adds the crossing. */
static int cut(const struct cs_clip_transform *clip, int plane, const struct cs_clip_vertex *in,
               int n, struct cs_clip_vertex *out) {
    int kept = 0;
    for (int i = 0; i < n; i++) {
        const struct cs_clip_vertex *a = in + i, *b = in + (i + 1) % n;
        const float at = inside(clip, a, plane), next = inside(clip, b, plane);
        if (at >= 0)
            out[kept++] = *a;
        // from the inner end, so that both triangles of an edge find the same point
        if (at >= 0 && next < 0)
            out[kept++] = between(a, b, at / (at - next));
        else if (at < 0 && next >= 0)
            out[kept++] = between(b, a, next / (next - at));
    }
    return kept;
}

/* Clips a triangle: writes a convex polygon with pixels set and returns its number of corners;
 * 0: nothing is left. Each of five planes adds at most one corner to three; one is spare. */
static int clip_triangle(const struct cs_clip_transform *clip,
                         const struct cs_clip_vertex *const corners[3],
                         struct cs_clip_vertex out[CLIP_VERTICES_MAX]) {
    struct cs_clip_vertex other[CLIP_VERTICES_MAX];
    int n = 3;
    for (int i = 0; i < 3; i++)
        out[i] = *corners[i];
    for (int plane = 0; plane < PLANES && n; plane++) {
        const int kept = cut(clip, plane, out, n, other);
        n = kept < 3 ? 0 : kept;
        memcpy(out, other, (size_t)n * sizeof *out);
    }
    // a cut lies on its plane but for rounding: w stays above 0
    for (int i = 0; i < n; i++)
        set_pixel(clip, out + i);
    return n;
}

/* Set-up of triangles. */

/* Side in 1/256 pixel up to which edge functions are computed in 32 bits. Both factors of a
 * product are below 16000 + 288, thus |product| < 2^28 and |E_k| < 2^29 in the box. */
enum { SMALL = 16000 };

/* Common part of all planes of a triangle: two sides (pixels, y down) divided by twice the area
 * (pixel^2), and the vector (across, down) from corner 0 to the middle of the first pixel. */
struct frame {
    double dx[2], dy[2], across, down;
};

// nearest point of the grid; floor instead of a cast keeps ties alike on both sides of 0
static int32_t snap(double pixel) {
    return (int32_t)floor(pixel * 256 + 0.5);
}

/* The plane through the values a, b, c of the three corners. Cramer's rule for
 *   b - a = sx dx0 + sy dy0,   c - a = sx dx1 + sy dy1. */
static struct cs_plane_equation slope(const struct frame *f, double a, double b, double c) {
    const double x = (b - a) * f->dy[1] - (c - a) * f->dy[0];
    const double y = (c - a) * f->dx[0] - (b - a) * f->dx[1];
    return (struct cs_plane_equation){(float)(a + x * f->across + y * f->down), (float)x,
                                      (float)y};
}

/* From the corners before rounding to the grid. If twice the area is below 1/512 pixel^2, the
 * slopes would be noise: the planes of such a sliver are flat. */
static struct frame make_frame(const struct cs_triangle *t,
                               const struct cs_clip_vertex *const p[3]) {
    const double from_top = t->bottom_row + 1 - (double)p[0]->y;
    struct frame f = {.across = t->left + 0.5 - (double)p[0]->x,
                      .down = t->top + 0.5 - from_top};
    for (int i = 0; i < 2; i++) {
        f.dx[i] = (double)p[i + 1]->x - (double)p[0]->x;
        f.dy[i] = (double)p[0]->y - (double)p[i + 1]->y;
    }
    const double area = f.dx[0] * f.dy[1] - f.dx[1] * f.dy[0];
    const double share = area > 1.0 / 512 ? 1 / area : 0;
    for (int i = 0; i < 2; i++) {
        f.dx[i] *= share;
        f.dy[i] *= share;
    }
    return f;
}

// plane through three points (x, y, z)
static struct cs_plane_equation depth_plane(const float a[3], const float b[3],
                                            const float c[3]) {
    const float ab[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    const float ca[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    const float area = ab[0] * ca[1] - ca[0] * ab[1];
    const float least = 1.0f / 512, share = area > least || area < -least ? 1 / area : 0;
    const float x = ab[2] * (ca[1] * share) - (ab[1] * share) * ca[2];
    const float y = ca[2] * (ab[0] * share) - ab[2] * (ca[0] * share);
    return (struct cs_plane_equation){a[2] - (x * a[0] + y * a[1]), x, y};
}

void cs_depth_of(const struct cs_clip_transform *clip,
                 const struct cs_clip_vertex *const corners[3],
                 struct cs_plane_equation depth[2]) {
    const float half[2] = {0.5f * (float)clip->width, 0.5f * (float)clip->height};
    const bool same = !memcmp(clip->jitter[0], clip->jitter[1], sizeof clip->jitter[0]);
    for (int pass = 0; pass < (same ? 1 : 2); pass++) {
        const float *jitter = clip->jitter[pass];
        float p[3][3];
        for (int i = 0; i < 3; i++) {
            const struct cs_clip_vertex *c = corners[i];
            for (int k = 0; k < 2; k++)
                p[i][k] =
                    (c->clip[k] + jitter[k] * c->clip[3]) * c->inverse * half[k] + half[k];
            p[i][2] = c->z;
        }
        depth[pass] = depth_plane(p[0], p[1], p[2]);
    }
    depth[1] = depth[same ? 0 : 1];
}

/* Depth plane from the corners in the caller's order, and the range of reversed depth that
 * bounds extrapolated samples. */
static void set_depth(struct cs_triangle *t, const struct cs_clip_transform *clip,
                      const struct cs_clip_vertex *const corners[3]) {
    const struct cs_clip_vertex *const order[3] = {
        corners[t->is_back_facing ? 0 : 1], corners[t->is_back_facing ? 1 : 0], corners[2]};
    cs_depth_of(clip, order, t->depth);
    t->depth_min = t->depth_max = cs_reversed_depth(order[0]->z);
    for (int i = 0; i < 3; i++) {
        const float near = cs_reversed_depth(corners[i]->z);
        t->depth_min = near < t->depth_min ? near : t->depth_min;
        t->depth_max = near > t->depth_max ? near : t->depth_max;
    }
}

/* Planes of 1/w and of the first n attributes over w. Attributes 0..2 are the normal: it points
 * to the viewer, so a back-facing triangle negates it. */
static void set_planes(struct cs_triangle *t, const struct cs_clip_vertex *const p[3], int n) {
    const struct frame f = make_frame(t, p);
    const float side = t->is_back_facing ? -1 : 1;
    t->inverse = slope(&f, (double)p[0]->inverse, (double)p[1]->inverse, (double)p[2]->inverse);
    for (int k = 0; k < n; k++) {
        double over[3];
        for (int i = 0; i < 3; i++)
            over[i] = (double)((k < 3 ? side : 1) * p[i]->attributes[k] * p[i]->inverse);
        t->attributes[k] = slope(&f, over[0], over[1], over[2]);
    }
}

/* Puts the corners on the grid and orders them clockwise as seen; p is reordered likewise. The
 * sign of twice the area tells the facing. Returns false if the rounded area is 0. */
static bool set_corners(struct cs_triangle *t, int height, const struct cs_clip_vertex *p[3]) {
    int64_t x[3], y[3];
    for (int i = 0; i < 3; i++) {
        x[i] = snap((double)p[i]->x);
        y[i] = snap(height - (double)p[i]->y);
    }
    const int64_t area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    t->is_back_facing = area > 0; // y points down here
    for (int i = 0; i < 3; i++) {
        const int from = area < 0 && i ? 3 - i : i;
        t->x[i] = (int32_t)x[from];
        t->y[i] = (int32_t)y[from];
    }
    if (area < 0) {
        const struct cs_clip_vertex *swap = p[1];
        p[1] = p[2];
        p[2] = swap;
    }
    return area != 0;
}

/* Pixels that the triangle may touch, cut to the picture. Returns false if there are none. */
static bool set_box(struct cs_triangle *t, int width, int height) {
    int left = t->x[0], right = left, top = t->y[0], bottom = top;
    for (int i = 1; i < 3; i++) {
        left = cs_min(left, t->x[i]);
        right = cs_max(right, t->x[i]);
        top = cs_min(top, t->y[i]);
        bottom = cs_max(bottom, t->y[i]);
    }
    t->fits_32_bits = right - left < SMALL && bottom - top < SMALL;
    // samples lie up to 16 beside their pixel (raster.c)
    t->left = cs_max((left - 17) >> 8, 0);
    t->right = cs_min((right + 16) >> 8, width - 1);
    t->top = cs_max(top >> 8, 0);
    t->bottom = cs_min(bottom >> 8, height - 1);
    return t->left <= t->right && t->top <= t->bottom;
}

void cs_triangles_reserve(struct cs_triangles *triangles, size_t n) {
    CS_ARENA_REALLOC(triangles->items, triangles->capacity, triangles->n + n);
}

// an unused item behind the last one, or NULL if out of memory
static struct cs_triangle *next(struct cs_triangles *triangles) {
    if (!CS_ARENA_REALLOC(triangles->items, triangles->capacity, triangles->n + 1)) {
        triangles->failed = true;
        return NULL;
    }
    return triangles->items + triangles->n;
}

/* Adds one triangle that lies inside the clip volume; n grows only if it covers any pixel. */
static void add_triangle(struct cs_triangles *triangles, const struct cs_clip_transform *clip,
                         const struct cs_clip_vertex *a, const struct cs_clip_vertex *b,
                         const struct cs_clip_vertex *c, const struct cs_triangle_kind *kind) {
    const struct cs_clip_vertex *const corners[3] = {a, b, c};
    const struct cs_clip_vertex *p[3] = {a, b, c};
    struct cs_triangle *t = next(triangles);
    if (!t || !set_corners(t, clip->height, p) || (t->is_back_facing && kind->front_only) ||
        !set_box(t, clip->width, clip->height))
        return;
    t->surface = kind->surface;
    t->bottom_row = clip->height - 1;
    set_depth(t, clip, corners);
    if (kind->attributes)
        set_planes(t, p, kind->attributes);
    triangles->n++;
}

void cs_triangles_add(struct cs_triangles *triangles, const struct cs_clip_transform *clip,
                      const struct cs_clip_vertex *const corners[3],
                      const struct cs_triangle_kind *kind) {
    struct cs_clip_vertex polygon[CLIP_VERTICES_MAX];
    if (!(corners[0]->clip_mask | corners[1]->clip_mask | corners[2]->clip_mask)) {
        add_triangle(triangles, clip, corners[0], corners[1], corners[2], kind);
        return;
    }
    // all corners outside the same plane: nothing is visible
    if (corners[0]->clip_mask & corners[1]->clip_mask & corners[2]->clip_mask)
        return;
    // the clipped polygon is convex: a fan about its first corner
    const int n = clip_triangle(clip, corners, polygon);
    for (int i = 2; i < n; i++)
        add_triangle(triangles, clip, polygon, polygon + i - 1, polygon + i, kind);
}

void cs_triangles_finish(struct cs_triangles *triangles) {
    free(triangles->items);
    *triangles = (struct cs_triangles){0};
}

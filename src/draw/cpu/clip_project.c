/* clip_project.c - projection, and clipping (Sutherland, Hodgman 1974) in clip coordinates.
 *
 * A point is inside the near plane if w >= near, and inside the side planes if |x|, |y| are at
 * most 16 w. Before the division by w these are linear, so an edge from a to b with signed
 * distances d_a >= 0 > d_b meets a plane at t = d_a / (d_a - d_b). Attributes are linear in
 * space and take the same t. There is no far plane: reversed depth may fall below 0.
 */
#include "draw/cpu/clip_project.h"

#include <string.h>

/* Half pictures beyond which triangles are cut: a guard band. Triangles that leave the picture
 * by less are not clipped, and edge functions still fit into 64 bits. */
static const float guard = 16;

enum { NEAR = 1, LEFT = 2, RIGHT = 4, BELOW = 8, ABOVE = 16, PLANES = 5 };

void cs_clip_transform_make(struct cs_clip_transform *lens, const float matrix[16], float near,
                            int width, int height) {
    for (int i = 0; i < 4; i++) {
        lens->x[i] = matrix[4 * i];
        lens->y[i] = matrix[4 * i + 1];
        lens->z[i] = matrix[4 * i + 2];
        lens->w[i] = matrix[4 * i + 3];
    }
    lens->near = near > 0 ? near : 0.5f;
    lens->width = width;
    lens->height = height;
}

static float row(const float r[4], const float p[3]) {
    return r[0] * p[0] + r[1] * p[1] + r[2] * p[2] + r[3];
}

// signed distance to a plane, in units of w; w alone decides about the near one
static float inside(const struct cs_clip_transform *lens, const struct cs_clip_vertex *c,
                    int plane) {
    const float reach = guard * c->clip[3];
    switch (1 << plane) {
    case NEAR:
        return c->clip[3] - lens->near;
    case LEFT:
        return c->clip[0] + reach;
    case RIGHT:
        return reach - c->clip[0];
    case BELOW:
        return c->clip[1] + reach;
    default:
        return reach - c->clip[1];
    }
}

// viewport: clip coordinates -w..w to pixels, and depth to 0..1
static void set_pixel(const struct cs_clip_transform *lens, struct cs_clip_vertex *c) {
    const float half[2] = {0.5f * (float)lens->width, 0.5f * (float)lens->height};
    c->inverse = 1 / c->clip[3];
    c->x = c->clip[0] * c->inverse * half[0] + half[0];
    c->y = c->clip[1] * c->inverse * half[1] + half[1];
    c->z = c->clip[2] * c->inverse * 0.5f + 0.5f;
}

void cs_clip_transform_project(const struct cs_clip_transform *lens, struct cs_clip_vertex *c) {
    c->clip_mask = 0;
    for (int plane = 0; plane < PLANES; plane++)
        // true for NAN too
        c->clip_mask |= (uint32_t)(!(inside(lens, c, plane) >= 0)) << plane;
    if (!(c->clip_mask & NEAR))
        set_pixel(lens, c);
}

void cs_clip_transform_corner(const struct cs_clip_transform *lens, const float place[3],
                              struct cs_clip_vertex *corner) {
    corner->clip[0] = row(lens->x, place);
    corner->clip[1] = row(lens->y, place);
    corner->clip[2] = row(lens->z, place);
    corner->clip[3] = row(lens->w, place);
    cs_clip_transform_project(lens, corner);
}

void cs_clip_transform_move_depth(const struct cs_clip_transform *lens, const float place[3],
                                  struct cs_clip_vertex *corner) {
    const float z = row(lens->z, place), w = row(lens->w, place);
    if (!(w > 0 && corner->clip[3] > 0))
        return;
    corner->clip[2] = z / w * corner->clip[3];
    cs_clip_transform_project(lens, corner);
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
static int cut(const struct cs_clip_transform *lens, int plane, const struct cs_clip_vertex *in,
               int n, struct cs_clip_vertex *out) {
    int kept = 0;
    for (int i = 0; i < n; i++) {
        const struct cs_clip_vertex *a = in + i, *b = in + (i + 1) % n;
        const float at = inside(lens, a, plane), next = inside(lens, b, plane);
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

int cs_clip_transform_clip(const struct cs_clip_transform *lens,
                           const struct cs_clip_vertex *const corners[3],
                           struct cs_clip_vertex out[CS_CLIP_VERTICES_MAX]) {
    struct cs_clip_vertex other[CS_CLIP_VERTICES_MAX];
    int n = 3;
    for (int i = 0; i < 3; i++)
        out[i] = *corners[i];
    for (int plane = 0; plane < PLANES && n; plane++) {
        const int kept = cut(lens, plane, out, n, other);
        n = kept < 3 ? 0 : kept;
        memcpy(out, other, (size_t)n * sizeof *out);
    }
    // a cut lies on its plane but for rounding: w stays above 0
    for (int i = 0; i < n; i++)
        set_pixel(lens, out + i);
    return n;
}

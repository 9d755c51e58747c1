/* triangle.h - triangles made ready to be filled, in the order in which they are drawn. */
#ifndef CS_DRAW_TRIANGLE_H
#define CS_DRAW_TRIANGLE_H

#include "base/status.h"
#include "draw/cpu/clip_project.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A quantity that is linear over the picture: v(x, y) = value + d_dx x + d_dy y.
 *
 * d_dx and d_dy are per pixel. (x, y) counts pixels from the middle of the first pixel of the
 * triangle's box, y down. The depth plane is the exception: its origin is the lower left corner
 * of the picture, y up, as in OpenGL's window coordinates. */
struct cs_plane_equation {
    float value, d_dx, d_dy;
};

/* One triangle ready to be filled: 1/256 pixel for coverage, planes for everything else. The
 * coverage test uses the rounded corners x, y; the planes use the unrounded ones. */
struct cs_triangle {
    int32_t x[3], y[3]; /* corners in 1/256 pixel, y down, turned clockwise as seen */
    int32_t left, right, top, bottom; /* pixels that it may touch, inside the picture */
    int32_t bottom_row;               /* of the picture: its height less 1 */
    struct cs_plane_equation depth;   /* of the window, 0 near to 1 far, with the depth bias */
    float depth_min, depth_max;       /* reversed depth of the corners: bounds of the samples */
    struct cs_plane_equation inverse; /* 1/w, in 1/m for perspective */
    struct cs_plane_equation attributes[CS_ATTRIBUTES]; /* divided by w; see triangle.c */
    uint16_t surface;    /* index of the surface, chosen by the caller */
    bool is_back_facing; /* seen from behind: normals are turned */
    bool fits_32_bits;   /* its edge functions fit into 32 bits (triangle.c) */
};

/* A growing array of triangles; a zeroed one is empty. Index in `items` = drawing order. */
struct cs_triangles {
    struct cs_triangle *items; /* owned */
    size_t n, capacity;
    bool failed; /* out of memory: some are missing */
};

/* How triangles are added: their surface and the attributes that shading needs. */
struct cs_triangle_kind {
    uint16_t surface;
    uint8_t attributes; /* how many are wanted */
    bool front_only;    /* leave out those seen from behind */
};

/* Adds the visible part of a triangle whose front is counter-clockwise. Clipping may add
 * several triangles, or none. A triangle whose corners fall on one line of the 1/256 grid is
 * dropped: it covers no sample. Neighbours that share an edge neither leave a gap nor share a
 * sample. Sets triangles->failed if out of memory; those added before stay valid. */
void cs_triangles_add(struct cs_triangles *triangles, const struct cs_clip_transform *clip,
                      const struct cs_clip_vertex *const corners[3],
                      const struct cs_triangle_kind *kind);

/* Plane of window depth through three corners, with the roundings of Mesa's software renderer:
 * relative to the first corner, in single precision. Mesa starts from the second corner of a
 * front-facing triangle and from the first of a back-facing one. */
struct cs_plane_equation cs_depth_of(const struct cs_clip_vertex *a,
                                     const struct cs_clip_vertex *b,
                                     const struct cs_clip_vertex *c);

/* Frees the array and leaves it empty. */
void cs_triangles_finish(struct cs_triangles *triangles);

#endif

/* triangle.h - triangles made ready to be filled, in the order in which they are drawn. */
#ifndef CS_DRAW_TRIANGLE_H
#define CS_DRAW_TRIANGLE_H

#include "base/status.h"
#include "draw/view.h"

#include <clothsim/clones.h>
#include <stddef.h>

/* Lanes: the samples of a pixel, or neighbours in a row. + - * / sqrt, comparisons and whole
 * numbers only, in one order and without contraction: the bits do not depend on the compiler or
 * the processor. Minima and maxima are comparisons, since fmin and fmax are calls. Eights are
 * passed by address: without AVX they have no registers, and the ABI none for them. */

/* four floats; four integers, or a mask of all ones and zeros; four floats at any address */
typedef float cs_f4 __attribute__((vector_size(16)));
typedef int32_t cs_i4 __attribute__((vector_size(16)));
typedef float cs_f4_unaligned __attribute__((vector_size(16), aligned(4)));
typedef float cs_f8 __attribute__((vector_size(32)));
typedef int32_t cs_i8 __attribute__((vector_size(32)));

/* Before a loop over lanes that chooses: kept whole, it becomes minima, maxima and blends. */
#define CS_LANES _Pragma("GCC unroll 1")

CS_INLINE int cs_min(int a, int b) {
    return a < b ? a : b;
}
CS_INLINE int cs_max(int a, int b) {
    return a > b ? a : b;
}
/* Limits v to least..most; NaN becomes least. */
CS_INLINE float cs_clamp(float v, float least, float most) {
    const float raised = v > least ? v : least;
    return raised < most ? raised : most;
}

/* Projection of points to pixels, for the camera and for the light.
 *
 * Window depth z runs from 0 at the near plane to 1 at the far one, and is a plane across the
 * picture. Samples compare reversed depth, 0 at the far plane, in the steps of a depth buffer
 * of 24 bits. These steps are coarse enough that a line just above the cloth is visible where
 * it is in OpenGL, whose roundings are followed. */

enum { CS_ATTRIBUTES = 6 }; /* normal, a value, texture coordinates */

/* The first three rows divide by the fourth: pixel and depth follow from x/w, y/w, z/w. */
struct cs_clip_transform {
    float x[4], y[4], z[4], w[4]; /* rows of the matrix: clip coordinates from (place, 1) */
    float near;                   /* smallest w that is not clipped */
    float jitter[2][2];           /* of two passes: x and y that are added to clip x/w, y/w */
    int width, height;            /* pixels */
};

/* A corner of a triangle between the world and the picture. */
struct cs_clip_vertex {
    float clip[4]; /* x, y, z, w */
    float attributes[CS_ATTRIBUTES];
    float x, y, z;      /* pixels from the bottom left, depth 0..1; set if w >= near */
    float inverse;      /* 1/w; set if w >= near */
    uint32_t clip_mask; /* bits: outside the near plane, left, right, below, above */
};

/* Depth 1 in steps: 2^24 - 1. */
#define CS_DEPTH_STEPS 16777215.0f

/* Window depth to reversed depth. Products of 2^23 steps and more are rounded to whole steps,
 * since a float has 24 bits; nearer ones keep fractions. */
CS_INLINE float cs_reversed_depth(float z) {
    return CS_DEPTH_STEPS - z * CS_DEPTH_STEPS;
}

/* Takes a matrix by columns, clip from world. near: smallest w of a perspective; 0: parallel
 * rays, where w is 1 and nothing is clipped by it. */
void cs_clip_transform_make(struct cs_clip_transform *clip, const float matrix[16], float near,
                            int width, int height);

/* Transforms a point in m and sets all members of a corner but its attributes. */
void cs_clip_transform_corner(const struct cs_clip_transform *clip, const float place[3],
                              struct cs_clip_vertex *corner);

/* Sets clip_mask of a corner whose clip coordinates are set, and its pixel if w >= near. */
void cs_clip_transform_project(const struct cs_clip_transform *clip,
                               struct cs_clip_vertex *corner);

/* Moves the depth of a corner at a place away from the eye by `by` m, and keeps its pixel, if
 * both points are before the eye. Between its particles a cloth is a chord that cuts into a
 * sphere below it; unmoved, specks of the sphere would show. */
void cs_clip_transform_move_depth(const struct cs_clip_transform *clip, const float place[3],
                                  const float eye[4], float by, struct cs_clip_vertex *corner);

/* Rays through pixels: their origin and axes (shade.h: cs_ray_direction). */
struct cs_rays {
    float eye[3], right[3], up[3], back[3]; /* m; unit vectors */
    float slope_x, slope_y;                 /* tangents of the rays at the picture's edges */
    float shift;    /* of the picture to the left, in halves of its width */
    bool parallel;  /* origins differ instead: slope_x, slope_y in m from the middle */
    float depth[2]; /* m along parallel rays at the near and the far plane */
};

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
    int32_t left, right, top, bottom;  /* pixels that it may touch, inside the picture */
    int32_t bottom_row;                /* of the picture: its height less 1 */
    struct cs_plane_equation depth[2]; /* of the window, 0 near to 1 far, with the depth bias;
                                          of both passes */
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

/* Makes room for n more triangles at once, before most of them are added; whoever adds one
 * finds a lack of memory. */
void cs_triangles_reserve(struct cs_triangles *triangles, size_t n);

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

/* Planes of window depth through three corners, with the roundings of Mesa's software renderer:
 * relative to the first corner, in single precision. Mesa starts from the second corner of a
 * front-facing triangle and from the first of a back-facing one. OpenGL draws eight samples in
 * two passes of four (gl/canvas.c), each with its picture moved and roundings of its own, which
 * decide whether a line just above a steep surface is visible. */
void cs_depth_of(const struct cs_clip_transform *clip,
                 const struct cs_clip_vertex *const corners[3],
                 struct cs_plane_equation depth[2]);

/* Frees the array and leaves it empty. */
void cs_triangles_finish(struct cs_triangles *triangles);

#endif

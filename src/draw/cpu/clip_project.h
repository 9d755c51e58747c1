/* clip_project.h - how points of the world come to pixels, for the camera and for the light.
 *
 * The window's depth z runs from 0 at the near plane to 1 at the far one, and is a plane across
 * the picture. What is compared is nearness, 0 at the far plane, in the steps of a depth buffer
 * of 24 bits: coarse enough that a line which lies on cloth by a hair shows where it does in
 * OpenGL, whose roundings are followed. */
#ifndef CS_CPU_CLIP_PROJECT_H
#define CS_CPU_CLIP_PROJECT_H

#include "draw/view.h"

#include <clothsim/clones.h>
#include <stdbool.h>

enum { CS_ATTRIBUTES = 6 }; /* normal, a value, texture coordinates */

struct cs_clip_transform {
    float x[4], y[4], z[4], w[4]; /* rows of the matrix: clip coordinates from (place, 1) */
    float near;                   /* least w */
    int width, height;            /* pixels */
};

/* A corner of a triangle on its way to the picture. */
struct cs_clip_vertex {
    float clip[4]; /* x, y, z, w */
    float attributes[CS_ATTRIBUTES];
    float x, y, z;      /* pixels from the bottom left, and depth; where inside only */
    float inverse;      /* 1/w; where inside only */
    uint32_t clip_mask; /* bits: beyond the near plane, left, right, below, above */
};

/* 1 of depth. */
#define CS_DEPTH_STEPS 16777215.0f

/* Depth to nearness: a product with so many steps is rounded to a whole one, but for what is
 * nearer than twice the near plane. */
CS_INLINE float cs_reversed_depth(float z) {
    return CS_DEPTH_STEPS - z * CS_DEPTH_STEPS;
}

/* matrix: by columns, clip from world. near: least w of a perspective, 0: parallel. */
void cs_clip_transform_make(struct cs_clip_transform *lens, const float matrix[16], float near,
                            int width, int height);

/* Sets all of a corner but its attributes. */
void cs_clip_transform_corner(const struct cs_clip_transform *lens, const float place[3],
                              struct cs_clip_vertex *corner);

/* Finds out what a corner with clip set lies beyond, and its pixel where nothing. */
void cs_clip_transform_project(const struct cs_clip_transform *lens,
                               struct cs_clip_vertex *corner);

/* Gives a corner the depth of another place, at its own. */
void cs_clip_transform_move_depth(const struct cs_clip_transform *lens, const float place[3],
                                  struct cs_clip_vertex *corner);

/* Cuts a triangle to what lies inside: a convex polygon of returned corners, 0: none. */
enum { CS_CLIP_VERTICES_MAX = 9 };
int cs_clip_transform_clip(const struct cs_clip_transform *lens,
                           const struct cs_clip_vertex *const corners[3],
                           struct cs_clip_vertex out[CS_CLIP_VERTICES_MAX]);

/* Where the rays through pixels start, and their frame. */
struct cs_rays {
    float eye[3], right[3], up[3], back[3]; /* m; unit vectors */
    float slope_x, slope_y;                 /* of the rays at the edges */
    bool parallel;  /* rays start side by side, slope_x and slope_y in m from the middle */
    float depth[2]; /* m along them at the near and the far plane; of parallel ones */
};

#endif

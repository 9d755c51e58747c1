/* clip_project.h - projection of points to pixels, for the camera and for the light.
 *
 * Window depth z runs from 0 at the near plane to 1 at the far one, and is a plane across the
 * picture. Samples compare reversed depth, 0 at the far plane, in the steps of a depth buffer
 * of 24 bits. These steps are coarse enough that a line just above the cloth is visible where
 * it is in OpenGL, whose roundings are followed. */
#ifndef CS_CPU_CLIP_PROJECT_H
#define CS_CPU_CLIP_PROJECT_H

#include "draw/view.h"

#include <clothsim/clones.h>
#include <stdbool.h>

enum { CS_ATTRIBUTES = 6 }; /* normal, a value, texture coordinates */

/* The first three rows divide by the fourth: pixel and depth follow from x/w, y/w, z/w. */
struct cs_clip_transform {
    float x[4], y[4], z[4], w[4]; /* rows of the matrix: clip coordinates from (place, 1) */
    float near;                   /* smallest w that is not clipped */
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
void cs_clip_transform_make(struct cs_clip_transform *lens, const float matrix[16], float near,
                            int width, int height);

/* Transforms a point in m and sets all members of a corner but its attributes. */
void cs_clip_transform_corner(const struct cs_clip_transform *lens, const float place[3],
                              struct cs_clip_vertex *corner);

/* Sets clip_mask of a corner whose clip coordinates are set, and its pixel if w >= near. */
void cs_clip_transform_project(const struct cs_clip_transform *lens,
                               struct cs_clip_vertex *corner);

/* Gives a corner the depth of another point in m, at its own pixel. Leaves it unchanged if one
 * of them is behind the eye. */
void cs_clip_transform_move_depth(const struct cs_clip_transform *lens, const float place[3],
                                  struct cs_clip_vertex *corner);

/* Clips a triangle: writes a convex polygon with pixels set and returns its number of corners;
 * 0: nothing is left. Each of five planes adds at most one corner to three; one is spare. */
enum { CS_CLIP_VERTICES_MAX = 9 };
int cs_clip_transform_clip(const struct cs_clip_transform *lens,
                           const struct cs_clip_vertex *const corners[3],
                           struct cs_clip_vertex out[CS_CLIP_VERTICES_MAX]);

/* Rays through pixels: their origin and axes (shade.h: cs_ray_direction). */
struct cs_rays {
    float eye[3], right[3], up[3], back[3]; /* m; unit vectors */
    float slope_x, slope_y;                 /* tangents of the rays at the picture's edges */
    bool parallel;  /* origins differ instead: slope_x, slope_y in m from the middle */
    float depth[2]; /* m along parallel rays at the near and the far plane */
};

#endif

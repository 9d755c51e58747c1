/* raster.h - visibility: the triangle that each sample shows, eight samples per pixel as lanes.
 *
 * A sample belongs to a triangle if it lies inside all edges, or on a top or left edge
 * (OpenGL's rule). Edge functions are integers, so the test is exact (triangle.c). Of two
 * triangles at the same depth the later one shows. */
#ifndef CS_DRAW_RASTER_H
#define CS_DRAW_RASTER_H

#include "draw/cpu/triangle.h"
#include "draw/srgb.h"

enum { CS_ROWS = 8, CS_NOTHING = -1, CS_SPLIT = -2 };

/* Depth and triangle of the samples of some rows of the picture; memory of the tile buffer.
 * Most pixels show one triangle, whose plane tells their depth: they store no more than its
 * index. */
struct cs_samples {
    int32_t *whole;      /* (rows, width) triangle of all samples, CS_NOTHING, or CS_SPLIT: */
    cs_f8 *depth;        /* (rows, width) reversed depth, 0 at the far plane; lanes: samples */
    cs_i8 *triangle_ids; /* (rows, width) index of the visible triangle, or CS_NOTHING */
    const struct cs_triangle *triangles; /* borrowed */
    int width, top; /* pixels per row; row of the picture that is row 0 here */
    int rows;       /* at most CS_ROWS */
};

/* Positions of the samples of a pixel, in 1/256 from its top left corner. Fewer than eight are
 * repeated in the other lanes. OpenGL moves the picture by `right` and `up` pixels in the pass
 * that draws a sample. */
struct cs_sample_pattern {
    cs_i8 x, y;
    cs_f8 right, up;
};

/* Returns the pattern of 8 samples, 4 or 1. */
const struct cs_sample_pattern *cs_sample_pattern_of(int64_t samples);

/* Gives a transform the jitter of the pattern's passes. */
void cs_sample_pattern_jitter(const struct cs_sample_pattern *pattern,
                              struct cs_clip_transform *clip);

/* Depth of the samples of a row; lanes 0..3 and 4..7 are of two passes. */
struct cs_row_depth {
    cs_f8 value, d_dx, d_dy, across, up;
};

CS_INLINE void cs_row_depth_make(struct cs_row_depth *row,
                                 const struct cs_plane_equation depth[2],
                                 const struct cs_sample_pattern *pattern) {
    const struct cs_plane_equation a = depth[0], b = depth[1];
    row->value =
        (cs_f8){a.value, a.value, a.value, a.value, b.value, b.value, b.value, b.value};
    row->d_dx = (cs_f8){a.d_dx, a.d_dx, a.d_dx, a.d_dx, b.d_dx, b.d_dx, b.d_dx, b.d_dx};
    row->d_dy = (cs_f8){a.d_dy, a.d_dy, a.d_dy, a.d_dy, b.d_dy, b.d_dy, b.d_dy, b.d_dy};
    row->across = __builtin_convertvector(pattern->x, cs_f8) * (1.0f / 256) + pattern->right;
    row->up = __builtin_convertvector(256 - pattern->y, cs_f8) * (1.0f / 256) + pattern->up;
}

/* Reversed depth of the samples of pixel x, `below` rows from the lowest; sums in the order of
 * OpenGL. */
CS_INLINE void cs_row_depth_at(const struct cs_row_depth *row, int x, int below,
                               cs_f8 *nearness) {
    const cs_f8 rise = row->d_dy * (row->up + (float)below);
    const cs_f8 z = (row->value + row->d_dx * (row->across + (float)x)) + rise;
    *nearness = CS_DEPTH_STEPS - z * CS_DEPTH_STEPS;
}

/* Fills triangle number `id` into the rows. */
void cs_raster_fill(const struct cs_samples *samples, int32_t id,
                    const struct cs_sample_pattern *pattern);

/* Stores depth and triangle of each sample of pixel (x, y), number `at`, unless it is split. */
void cs_samples_split(const struct cs_samples *samples, size_t at, int x, int y,
                      const struct cs_sample_pattern *pattern);

/* Raises a map of one sample per pixel, in the middle, to the reversed depth of a triangle: the
 * map becomes the maximum of both. Touches rows top to top + rows - 1; `stride` floats per row;
 * map points at pixel (0, 0). Up to 3 floats beyond the picture's right edge are rewritten with
 * their old value, so each row needs that much space. */
void cs_raster_raise(const struct cs_triangle *triangle, float *map, size_t stride, int top,
                     int rows);

#endif

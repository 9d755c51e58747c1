/* raster.h - visibility: the triangle that each sample shows, four samples per pixel as lanes.
 *
 * A sample belongs to a triangle if it lies inside all edges, or on a top or left edge
 * (OpenGL's rule). Edge functions are integers, so the test is exact (triangle.c). Of two
 * triangles at the same depth the later one shows. */
#ifndef CS_DRAW_RASTER_H
#define CS_DRAW_RASTER_H

#include "draw/cpu/triangle.h"

enum { CS_ROWS = 16, CS_NOTHING = -1 };

/* Depth and triangle of the samples of some rows of the picture; memory of the tile buffer. */
struct cs_samples {
    cs_f4 *depth;        /* (rows, width) reversed depth, 0 at the far plane; lanes: samples */
    cs_i4 *triangle_ids; /* (rows, width) index of the visible triangle, or CS_NOTHING */
    int width, top;      /* pixels per row; row of the picture that is row 0 here */
    int rows;            /* at most CS_ROWS */
};

/* Positions of the samples in a pixel, in 1/256 from its top left corner: OpenGL's pattern of
 * four, or one in the middle, repeated in all lanes. */
struct cs_sample_pattern {
    cs_i4 x, y;
};
extern const struct cs_sample_pattern cs_sample_pattern_four, cs_sample_pattern_one;

/* Fills a triangle into the rows, as index `id`. */
void cs_raster_fill(const struct cs_triangle *triangle, int32_t id,
                    const struct cs_sample_pattern *pattern, const struct cs_samples *samples);

/* Raises a map of one sample per pixel, in the middle, to the reversed depth of a triangle: the
 * map becomes the maximum of both. Touches rows top to top + rows - 1; `stride` floats per row;
 * map points at pixel (0, 0). Up to 3 floats beyond the picture's right edge are rewritten with
 * their old value, so each row needs that much space. */
void cs_raster_raise(const struct cs_triangle *triangle, float *map, size_t stride, int top,
                     int rows);

#endif

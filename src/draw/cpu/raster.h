/* raster.h - which triangle each sample shows: four samples a pixel, the lanes of a vector.
 *
 * A sample belongs to a triangle if it lies inside all edges, or on one that is a top or left
 * one (as OpenGL fills). Edges are whole numbers, so that this is exact. Of two triangles as
 * near the later one shows. */
#ifndef CS_DRAW_RASTER_H
#define CS_DRAW_RASTER_H

#include "draw/cpu/lanes.h"
#include "draw/cpu/triangle.h"

enum { CS_ROWS = 16, CS_NOTHING = -1 };

/* Samples of some rows of the picture. */
struct cs_samples {
    cs_f4 *depth;        /* (rows, width) nearness */
    cs_i4 *triangle_ids; /* (rows, width) triangles, or CS_NOTHING */
    int width, top;      /* first row */
    int rows;
};

/* Where samples lie in a pixel, in 1/256 from its top left: of four as in OpenGL's pattern, or
 * one in the middle four times. */
struct cs_sample_pattern {
    cs_i4 x, y;
};
extern const struct cs_sample_pattern cs_sample_pattern_four, cs_sample_pattern_one;

/* Fills a triangle into the rows, as number `id`. */
void cs_raster_fill(const struct cs_triangle *triangle, int32_t id,
                    const struct cs_sample_pattern *pattern, const struct cs_samples *samples);

/* The samples of a pixel that lie inside, as bits; and its nearness there. */
unsigned cs_raster_covers(const struct cs_triangle *triangle,
                          const struct cs_sample_pattern *pattern, int x, int y, cs_f4 *depth);

/* Raises a map of one sample a pixel, in the middle, to the nearness of a triangle. Rows top to
 * top + rows - 1 are touched; `stride` floats a row, and map points at pixel (0, 0). A row may
 * be written, unchanged, up to 3 pixels beyond the picture's right edge. */
void cs_raster_raise(const struct cs_triangle *triangle, float *map, size_t stride, int top,
                     int rows);

#endif

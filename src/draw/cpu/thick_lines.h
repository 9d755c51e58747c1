/* thick_lines.h - lines with round ends and the bar's rectangle, laid over the surfaces. */
#ifndef CS_CPU_THICK_LINES_H
#define CS_CPU_THICK_LINES_H

#include "draw/cpu/bins.h"
#include "draw/cpu/tile_buffer.h"
#include "draw/line.h"

/* A line on the picture, or a rectangle. */
struct cs_thick_line {
    float x, y; /* pixels: its first end, or the rectangle's corner */
    float direction[2],
        length; /* unit vector to the other end, and how far; or width, height */
    struct cs_plane_equation depth; /* of the rectangle about the line, as that of a triangle */
    float half_width, extent, coverage; /* half width, of the rectangle, and how much covers */
    uint32_t colour;
    int32_t quad[2][4];                         /* x and y of the rectangle in 1/256 pixel */
    int left, right, top, bottom;               /* pixels that it may touch */
    bool on_top, uses_colour_map, fits_32_bits; /* small: its edges fit into 32 bits */
};

struct cs_thick_lines {
    struct cs_lines lines; /* first: what overlays add to */
    const struct cs_shading_context *shading;
    const struct cs_clip_transform *transform;
    struct cs_thick_line *items; /* owned, in the order of drawing */
    size_t n, capacity;
    bool failed; /* out of memory: some are missing */
    struct cs_bins bins;
};

enum cs_status cs_thick_lines_init(struct cs_thick_lines *strokes,
                                   const struct cs_shading_context *easel,
                                   const struct cs_clip_transform *clip,
                                   struct cs_error *error);

/* Once all are there: finds out which bands they touch. */
void cs_thick_lines_bin(struct cs_thick_lines *strokes);

/* Lays those of a band over it. */
void cs_thick_lines_draw(const struct cs_thick_lines *strokes, uint32_t band,
                         const struct cs_sample_pattern *pattern, struct cs_tile_buffer *tiles);

void cs_thick_lines_finish(struct cs_thick_lines *strokes);

#endif

/* thick_lines.h - lines with round ends and the colour bar's rectangle, over the surfaces. */
#ifndef CS_CPU_THICK_LINES_H
#define CS_CPU_THICK_LINES_H

#include "draw/cpu/bins.h"
#include "draw/cpu/tile_buffer.h"
#include "draw/line.h"

/* A line on the picture, or the rectangle of the colour bar (uses_colour_map). Pixels, y
 * down. */
struct cs_thick_line {
    float x, y;                 /* first end, or corner of the rectangle */
    float direction[2], length; /* unit vector to the other end and distance; or width, height
                                   of the rectangle */
    struct cs_plane_equation depth;     /* of the quad around the line, as of a triangle */
    float half_width, extent, coverage; /* half width; that of the quad; opacity 0..1 */
    uint32_t colour;
    int32_t quad[2][4];           /* x and y of the quad's corners in 1/256 pixel */
    int left, right, top, bottom; /* pixels that it may touch */
    bool on_top, uses_colour_map, fits_32_bits; /* fits: edge functions fit into 32 bits */
};

/* All lines of a picture, as a renderer's cs_lines. */
struct cs_thick_lines {
    struct cs_lines lines; /* first: what overlays add to */
    const struct cs_shading_context *shading;
    const struct cs_clip_transform *transform;
    struct cs_thick_line *items; /* owned, in the order of drawing */
    size_t n, capacity;
    bool failed; /* out of memory: some are missing */
    struct cs_bins bins;
};

/* Sets the calls of `lines`; shading and clip are borrowed. CS_ERR_MEMORY. */
enum cs_status cs_thick_lines_init(struct cs_thick_lines *strokes,
                                   const struct cs_shading_context *easel,
                                   const struct cs_clip_transform *clip,
                                   struct cs_error *error);

/* Sorts the lines into bands, after the last was added. */
void cs_thick_lines_bin(struct cs_thick_lines *strokes);

/* Blends the lines of a band over its samples, in the order in which they were added. */
void cs_thick_lines_draw(const struct cs_thick_lines *strokes, uint32_t band,
                         const struct cs_sample_pattern *pattern, struct cs_tile_buffer *tiles);

/* Frees the memory. */
void cs_thick_lines_finish(struct cs_thick_lines *strokes);

#endif

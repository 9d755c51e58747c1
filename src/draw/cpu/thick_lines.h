/* thick_lines.h - lines with round ends and the colour bar's rectangle, over the surfaces. */
#ifndef CS_CPU_THICK_LINES_H
#define CS_CPU_THICK_LINES_H

#include "draw/cpu/raster.h"
#include "draw/cpu/tile_buffer.h"
#include "draw/glyph.h"

/* Lists of the items that touch each band of CS_ROWS rows, in their order.
 *
 * A counting sort: all items are counted, cs_bins_begin_put makes room, then all are put in the
 * same order. An item is listed in each band that it touches. */

/* Lists of all bands in one block of memory. */
struct cs_bins {
    uint32_t bands;
    size_t *band_ends; /* (bands + 1), owned: end of each band's list, start of the next */
    uint32_t *list;    /* (capacity), owned */
    size_t capacity;
    bool failed; /* out of memory: the bins are empty */
};

/* Makes bins for a picture of `height` rows; they are filled again per picture.
 * CS_ERR_MEMORY. */
enum cs_status cs_bins_init(struct cs_bins *bins, int height, struct cs_error *error);

/* Sets all counts to 0. */
void cs_bins_clear(struct cs_bins *bins);

/* Counts an item in rows top..bottom of the picture. */
CS_INLINE void cs_bins_count(struct cs_bins *bins, int top, int bottom) {
    for (int band = top / CS_ROWS; band <= bottom / CS_ROWS; band++)
        bins->band_ends[band + 1]++;
}

/* Turns counts into the starts of the lists; call it after the last count. */
void cs_bins_begin_put(struct cs_bins *bins);

/* Puts item number `item`, which was counted with the same rows. */
CS_INLINE void cs_bins_put(struct cs_bins *bins, uint32_t item, int top, int bottom) {
    for (int band = top / CS_ROWS; band <= bottom / CS_ROWS && !bins->failed; band++)
        bins->list[bins->band_ends[band]++] = item;
}

/* Returns the *n items of a band; NULL if there are none. */
CS_INLINE const uint32_t *cs_bins_of(const struct cs_bins *bins, uint32_t band, size_t *n) {
    const size_t begin = band ? bins->band_ends[band - 1] : 0;
    *n = bins->failed ? 0 : bins->band_ends[band] - begin;
    return *n ? bins->list + begin : NULL; // an empty picture has no list
}

/* Frees the memory. */
void cs_bins_finish(struct cs_bins *bins);

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

/* thick_lines.h - a band of pixels, and lines with round ends and the colour bar over its
 * surfaces. */
#ifndef CS_CPU_THICK_LINES_H
#define CS_CPU_THICK_LINES_H

#include "base/image.h"
#include "draw/cpu/raster.h"
#include "draw/cpu/shade.h"
#include "draw/glyph.h"

/* Pixels of a band of rows while it is drawn: visible fragments first, then lines over them, at
 * last the mean of the samples. Most pixels show one fragment in all samples and store one
 * colour; eight only if an edge or a blend distinguishes the samples. */

enum {
    CS_FRAGMENT_SLOTS = 16, /* surfaces' sides whose fragments are collected at a time */
    CS_COLOURS_PER_PIXEL = 2 * CS_SAMPLES, /* shown, laid over */
    CS_PIXEL_SPLIT = 076543210,            /* codes: a colour for each sample, in their order */
};

/* Sample s of pixel i has colours[first_colour[i] + (sample_codes[i] >> 3 s & 7)]. Colours are
 * packed sRGB (srgb.h). All arrays are of the arena, and are reused from band to band. */
struct cs_tile_buffer {
    struct cs_samples samples; /* visible surfaces */
    uint32_t *first_colour;    /* (rows, width) index of a pixel's first colour */
    uint32_t *sample_codes; /* (rows, width) eight offsets of 3 bits; 0: one colour for all */
    uint32_t *colours;      /* (colours_capacity) */
    uint32_t n_colours, colours_capacity;
    struct cs_fragments *slots; /* (CS_FRAGMENT_SLOTS) fragments not yet shaded */
};

/* Allocates a band of CS_ROWS rows from the arena. Returns CS_ERR_MEMORY through error. */
enum cs_status cs_tile_buffer_init(struct cs_tile_buffer *tiles, int width,
                                   struct cs_arena *arena, struct cs_error *error);

/* Starts a band: no sample shows anything. */
void cs_tile_buffer_clear(struct cs_tile_buffer *tiles, int top, int rows);

/* Returns the colours of a pixel, one per sample; copies them apart if they are shared. */
CS_INLINE uint32_t *cs_tile_buffer_split_pixel(struct cs_tile_buffer *tiles, size_t pixel) {
    const uint32_t first = tiles->first_colour[pixel], code = tiles->sample_codes[pixel];
    if (code == CS_PIXEL_SPLIT)
        return tiles->colours + first;
    uint32_t *apart = tiles->colours + tiles->n_colours;
    for (uint32_t s = 0; s < CS_SAMPLES; s++)
        apart[s] = tiles->colours[first + (code >> 3 * s & 7)];
    tiles->first_colour[pixel] = tiles->n_colours;
    tiles->sample_codes[pixel] = CS_PIXEL_SPLIT;
    tiles->n_colours += CS_SAMPLES;
    return apart;
}

/* Blends a colour over the samples of a mask, with an opacity of 0..255. */
CS_INLINE void cs_tile_buffer_blend(struct cs_tile_buffer *tiles, size_t pixel,
                                    const cs_i8 *mask, uint32_t colour, uint32_t share) {
    uint32_t *apart = NULL;
    for (int s = 0; s < CS_SAMPLES; s++)
        if ((*mask)[s]) {
            apart = apart ? apart : cs_tile_buffer_split_pixel(tiles, pixel);
            apart[s] = cs_srgb_blend(apart[s], colour, share);
        }
}

/* Writes the mean of the samples of each pixel into the picture's rows. */
void cs_tile_buffer_resolve(const struct cs_tile_buffer *tiles, const struct cs_srgb *srgb,
                            struct cs_image *image);

/* Lists of the items that touch each band of CS_ROWS rows, in their order.
 *
 * A counting sort: all items are counted, room is made, then all are put in the same order. An
 * item is listed in each band that it touches. */

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

/* Lists n items of `size` bytes each, at whose byte `rows` their first and their last row in
 * the picture stand, as two int. */
void cs_bins_sort(struct cs_bins *bins, const void *items, size_t size, size_t rows, size_t n);

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
    struct cs_plane_equation depth[2];  /* of the quad around the line, as of a triangle */
    float half_width, extent, coverage; /* half width; that of the quad; opacity 0..1 */
    uint32_t colour;
    int left, right, top, bottom; /* pixels that it may touch */
    bool on_top, uses_colour_map;
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
enum cs_status cs_thick_lines_init(struct cs_thick_lines *lines,
                                   const struct cs_shading_context *context,
                                   const struct cs_clip_transform *clip,
                                   struct cs_error *error);

/* Sorts the lines into bands, after the last was added. */
void cs_thick_lines_bin(struct cs_thick_lines *lines);

/* Blends the lines of a band over its samples, in the order in which they were added. */
void cs_thick_lines_draw(const struct cs_thick_lines *lines, uint32_t band,
                         const struct cs_sample_pattern *pattern, struct cs_tile_buffer *tiles);

/* Frees the memory. */
void cs_thick_lines_finish(struct cs_thick_lines *lines);

#endif

/* tile_buffer.h - pixels of a band of rows while it is drawn: visible fragments first, then
 * lines and fading surfaces over them, at last the mean of the samples.
 *
 * Most pixels show one fragment in all four samples and store one colour. A pixel stores four
 * colours only if an edge or a blend distinguishes its samples. */
#ifndef CS_CPU_TILE_BUFFER_H
#define CS_CPU_TILE_BUFFER_H

#include "base/image.h"
#include "draw/cpu/raster.h"
#include "draw/cpu/shade.h"

enum {
    CS_FRAGMENT_SLOTS = 16,    /* surfaces' sides whose fragments are collected at a time */
    CS_COLOURS_PER_PIXEL = 12, /* four shown, four behind those that fade, four laid over */
    CS_PIXEL_SPLIT = 0xe4,     /* codes: a colour for each sample, in their order */
};

/* A fragment that lets light through, and the one behind it. */
struct cs_blend_pair {
    uint32_t front, behind; /* indices into `colours` */
};

/* Sample s of pixel i has colours[first_colour[i] + (sample_codes[i] >> 2 s & 3)]. Colours are
 * packed sRGB (srgb.h). All arrays are of the arena, and are reused from band to band. */
struct cs_tile_buffer {
    struct cs_samples samples; /* visible surfaces */
    struct cs_samples ground;  /* of the ground alone; depth NULL: not wanted */
    uint32_t *first_colour;    /* (rows, width) index of a pixel's first colour */
    uint8_t *sample_codes;     /* (rows, width) four offsets of 2 bits; 0: one colour for all */
    uint32_t *colours;         /* (colours_capacity) */
    uint32_t n_colours, colours_capacity;
    struct cs_blend_pair *blend_pairs; /* NULL: nothing fades */
    uint32_t n_blend_pairs, n_hidden;
    struct cs_fragments *slots; /* (CS_FRAGMENT_SLOTS) fragments not yet shaded */
};

/* Allocates a band of CS_ROWS rows from the arena. fades: some surface lets light through;
 * ground: keep samples of the ground. Returns CS_ERR_MEMORY through error. */
enum cs_status cs_tile_buffer_init(struct cs_tile_buffer *tiles, int width, bool fades,
                                   bool ground, struct cs_arena *arena, struct cs_error *error);

/* Starts a band: no sample shows anything. */
void cs_tile_buffer_clear(struct cs_tile_buffer *tiles, int top, int rows);
/* Clears the samples of the ground likewise, for the rows of the last cs_tile_buffer_clear. */
void cs_tile_buffer_clear_ground(struct cs_tile_buffer *tiles);

/* Returns the four colours of a pixel, one per sample; copies them apart if they are shared. */
CS_INLINE uint32_t *cs_tile_buffer_split_pixel(struct cs_tile_buffer *tiles, size_t pixel) {
    const uint32_t first = tiles->first_colour[pixel], code = tiles->sample_codes[pixel];
    if (code == CS_PIXEL_SPLIT)
        return tiles->colours + first;
    uint32_t *apart = tiles->colours + tiles->n_colours;
    for (uint32_t s = 0; s < 4; s++)
        apart[s] = tiles->colours[first + (code >> 2 * s & 3)];
    tiles->first_colour[pixel] = tiles->n_colours;
    tiles->sample_codes[pixel] = CS_PIXEL_SPLIT;
    tiles->n_colours += 4;
    return apart;
}

/* Blends a colour over the samples of a mask, with an opacity of 0..255. */
CS_INLINE void cs_tile_buffer_blend(struct cs_tile_buffer *tiles, size_t pixel, unsigned mask,
                                    uint32_t colour, uint32_t share) {
    uint32_t *apart = cs_tile_buffer_split_pixel(tiles, pixel);
    for (int s = 0; s < 4; s++)
        if (mask >> s & 1)
            apart[s] = cs_srgb_blend(apart[s], colour, share);
}

/* Writes the mean of the samples of each pixel into the picture's rows. */
void cs_tile_buffer_resolve(const struct cs_tile_buffer *tiles, const struct cs_srgb *tone,
                            struct cs_image *image);

#endif

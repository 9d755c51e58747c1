/* tile_buffer.h - the pixels of a band while it is drawn: first the fragments that samples
 * show, then what is laid over them, at last their mean.
 *
 * A pixel whose samples all show one fragment keeps one colour, so that four are only touched
 * where there is an edge. */
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

/* A fragment that lets through what is behind it. */
struct cs_blend_pair {
    uint32_t front, behind; /* colours */
};

struct cs_tile_buffer {
    struct cs_samples samples;
    struct cs_samples ground; /* depth NULL: not wanted */
    uint32_t *first_colour;   /* (rows, width) first colour of a pixel */
    uint8_t *sample_codes;    /* (rows, width) which colour after it each sample has, 2 bits */
    uint32_t *colours;
    uint32_t n_colours, colours_capacity;
    struct cs_blend_pair *blend_pairs; /* NULL: nothing fades */
    uint32_t n_blend_pairs, n_hidden;
    struct cs_fragments *slots; /* (CS_FRAGMENT_SLOTS) */
};

/* rows of CS_ROWS; memory from the arena. */
enum cs_status cs_tile_buffer_init(struct cs_tile_buffer *tiles, int width, bool fades,
                                   bool ground, struct cs_arena *arena, struct cs_error *error);

/* Begins with a band: nothing shows. */
void cs_tile_buffer_clear(struct cs_tile_buffer *tiles, int top, int rows);
/* Of the ground too. */
void cs_tile_buffer_clear_ground(struct cs_tile_buffer *tiles);

/* The four colours of a pixel, apart. */
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

/* Lays a colour over the samples of a mask, with a share of 0..255. */
CS_INLINE void cs_tile_buffer_blend(struct cs_tile_buffer *tiles, size_t pixel, unsigned mask,
                                    uint32_t colour, uint32_t share) {
    uint32_t *apart = cs_tile_buffer_split_pixel(tiles, pixel);
    for (int s = 0; s < 4; s++)
        if (mask >> s & 1)
            apart[s] = cs_srgb_blend(apart[s], colour, share);
}

/* Averages the samples into the picture's rows. */
void cs_tile_buffer_resolve(const struct cs_tile_buffer *tiles, const struct cs_srgb *tone,
                            struct cs_image *image);

#endif

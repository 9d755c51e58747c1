/* board.h - the pixels of a band while it is drawn: first the fragments that samples show, then
 * what is laid over them, at last their mean.
 *
 * A pixel whose samples all show one fragment keeps one colour, so that four are only touched
 * where there is an edge. */
#ifndef CS_DRAW_BOARD_H
#define CS_DRAW_BOARD_H

#include "base/image.h"
#include "draw/cpu/raster.h"
#include "draw/cpu/shade.h"

enum {
    CS_SLOTS = 16,           /* surfaces' sides whose fragments are collected at a time */
    CS_COLOURS_A_PIXEL = 12, /* four shown, four behind those that fade, four laid over */
    CS_APART = 0xe4,         /* codes: a colour for each sample, in their order */
};

/* A fragment that lets through what is behind it. */
struct cs_glaze {
    uint32_t over, under; /* colours */
};

struct cs_board {
    struct cs_samples samples;
    struct cs_samples ground; /* depth NULL: not wanted */
    uint32_t *base;           /* (rows, width) first colour of a pixel */
    uint8_t *codes;           /* (rows, width) which colour after it each sample has, 2 bits */
    uint32_t *colours;
    uint32_t n_colours, most_colours;
    struct cs_glaze *glazes; /* NULL: nothing fades */
    uint32_t n_glazes, n_behind;
    struct cs_fragments *slots; /* (CS_SLOTS) */
};

/* rows of CS_ROWS; memory from the arena. */
enum cs_status cs_board_init(struct cs_board *board, int width, bool fades, bool ground,
                             struct cs_arena *arena, struct cs_error *error);

/* Begins with a band: nothing shows. */
void cs_board_clear(struct cs_board *board, int top, int rows);
/* Of the ground too. */
void cs_board_clear_ground(struct cs_board *board);

/* The four colours of a pixel, apart. */
CS_INLINE uint32_t *cs_board_apart(struct cs_board *board, size_t pixel) {
    const uint32_t first = board->base[pixel], code = board->codes[pixel];
    if (code == CS_APART)
        return board->colours + first;
    uint32_t *apart = board->colours + board->n_colours;
    for (uint32_t s = 0; s < 4; s++)
        apart[s] = board->colours[first + (code >> 2 * s & 3)];
    board->base[pixel] = board->n_colours;
    board->codes[pixel] = CS_APART;
    board->n_colours += 4;
    return apart;
}

/* Lays a colour over the samples of a mask, with a share of 0..255. */
CS_INLINE void cs_board_lay(struct cs_board *board, size_t pixel, unsigned mask,
                            uint32_t colour, uint32_t share) {
    uint32_t *apart = cs_board_apart(board, pixel);
    for (int s = 0; s < 4; s++)
        if (mask >> s & 1)
            apart[s] = cs_tone_blend(apart[s], colour, share);
}

/* Averages the samples into the picture's rows. */
void cs_board_resolve(const struct cs_board *board, const struct cs_tone *tone,
                      struct cs_image *image);

#endif

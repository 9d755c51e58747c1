/* strokes.h - lines with round ends and the bar's rectangle, laid over the surfaces. */
#ifndef CS_DRAW_STROKES_H
#define CS_DRAW_STROKES_H

#include "draw/cpu/bins.h"
#include "draw/cpu/board.h"
#include "draw/line.h"

/* A line on the picture, or a rectangle. */
struct cs_stroke {
    float x, y;               /* pixels: its first end, or the rectangle's corner */
    float along[2], length;   /* unit vector to the other end, and how far; or width, height */
    struct cs_slope depth;    /* of the rectangle about the line, as that of a triangle */
    float wide, reach, share; /* half width, of the rectangle, and how much covers */
    uint32_t colour;
    int32_t corners[2][4];        /* x and y of the rectangle in 1/256 pixel */
    int left, right, top, bottom; /* pixels that it may touch */
    bool over, ramp, small;       /* small: its edges fit into 32 bits */
};

struct cs_strokes {
    struct cs_lines lines; /* first: what overlays add to */
    const struct cs_easel *easel;
    const struct cs_lens *lens;
    struct cs_stroke *items; /* owned, in the order of drawing */
    size_t n, capacity;
    bool failed; /* out of memory: some are missing */
    struct cs_bins bins;
};

enum cs_status cs_strokes_init(struct cs_strokes *strokes, const struct cs_easel *easel,
                               const struct cs_lens *lens, struct cs_error *error);

/* Once all are there: finds out which bands they touch. */
void cs_strokes_sort(struct cs_strokes *strokes);

/* Lays those of a band over it. */
void cs_strokes_draw(const struct cs_strokes *strokes, uint32_t band,
                     const struct cs_pattern *pattern, struct cs_board *board);

void cs_strokes_finish(struct cs_strokes *strokes);

#endif

/* drawing.h - a picture under way: all that the bands of it are drawn from. */
#ifndef CS_DRAW_DRAWING_H
#define CS_DRAW_DRAWING_H

#include "draw/cpu/grid.h"
#include "draw/cpu/strokes.h"

struct cs_drawing {
    struct cs_easel easel;
    const struct cs_pattern *pattern;
    struct cs_coat *coats; /* (surfaces), owned by an arena */

    struct cs_triangles triangles; /* first those that never move, squares before all else */
    size_t n_squares, n_fixed;     /* of them */
    struct cs_bins bins;

    struct cs_grid grid;
    struct cs_strokes strokes;
    struct cs_image *image; /* borrowed */
};

/* Once all triangles are there: finds out which bands they touch. */
void cs_drawing_sort(struct cs_drawing *drawing);

/* Draws one band into the image. Any number of bands at the same time, on a board each. */
void cs_drawing_band(const struct cs_drawing *drawing, uint32_t band, struct cs_board *board);

#endif

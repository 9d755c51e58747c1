/* drawing.h - a picture under way: all that the bands of it are drawn from. */
#ifndef CS_DRAW_DRAWING_H
#define CS_DRAW_DRAWING_H

#include "draw/cpu/strokes.h"
#include "draw/ground.h"

struct cs_drawing {
    struct cs_easel easel;
    const struct cs_pattern *pattern;
    struct cs_coat *coats; /* (surfaces), owned by an arena */

    struct cs_triangles triangles; /* first those that never move, squares before all else */
    size_t n_squares, n_fixed;     /* of them */
    struct cs_bins bins;

    bool has_ground;
    struct cs_ground ground;
    uint32_t ground_ink;
    struct cs_triangles ground_square;

    struct cs_strokes strokes;
    struct cs_image *image; /* borrowed */
};

/* Once all triangles are there: finds out which bands they touch. */
void cs_drawing_sort(struct cs_drawing *drawing);

/* Draws one band into the image. Any number of bands at the same time, on a board each. */
void cs_drawing_band(const struct cs_drawing *drawing, uint32_t band, struct cs_board *board);

/* Lays the grid over what is there but the triangles that move: a part of cs_drawing_band. */
void cs_ground_draw(const struct cs_drawing *drawing, struct cs_board *board);

#endif

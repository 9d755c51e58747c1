/* band_pass.h - a picture under way: all that the bands of it are drawn from. */
#ifndef CS_CPU_BAND_PASS_H
#define CS_CPU_BAND_PASS_H

#include "draw/cpu/grid.h"
#include "draw/cpu/thick_lines.h"

struct cs_band_pass {
    struct cs_shading_context shading;
    const struct cs_sample_pattern *sample_pattern;
    struct cs_shading_material *materials; /* (surfaces), owned by an arena */

    struct cs_triangles triangles;    /* first those that never move, squares before all else */
    size_t n_ground_squares, n_fixed; /* of them */
    struct cs_bins bins;

    struct cs_grid grid;
    struct cs_thick_lines thick_lines;
    struct cs_image *image; /* borrowed */
};

/* Once all triangles are there: finds out which bands they touch. */
void cs_band_pass_bin(struct cs_band_pass *drawing);

/* Draws one band into the image. Any number of bands at the same time, on a board each. */
void cs_band_pass_draw(const struct cs_band_pass *drawing, uint32_t band,
                       struct cs_tile_buffer *tiles);

#endif

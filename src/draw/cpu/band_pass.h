/* band_pass.h - everything that the bands of a picture are drawn from. */
#ifndef CS_CPU_BAND_PASS_H
#define CS_CPU_BAND_PASS_H

#include "draw/cpu/thick_lines.h"
#include "draw/ground.h"

/* Blends the ground over a band: shadows, and lines of a grid. */

/* The ground in one picture. */
struct cs_grid {
    struct cs_ground ground;
    uint32_t ink;                             /* packed colour of lines and shadows */
    struct cs_triangles square;               /* its rectangle as the camera sees it */
    const struct cs_shading_context *shading; /* borrowed */
};

/* Blends the ground over the samples of a band, but not over triangles from index `moving` on:
 * those are bodies, which stand on it. The tile buffer has samples of the ground. */
void cs_grid_draw(const struct cs_grid *grid, int32_t moving,
                  const struct cs_sample_pattern *pattern, struct cs_tile_buffer *tiles);

/* Inputs of all bands; constant while bands are drawn. */
struct cs_band_pass {
    struct cs_shading_context shading;
    const struct cs_sample_pattern *sample_pattern;
    struct cs_shading_material *materials; /* (surfaces), owned by an arena */

    struct cs_triangles triangles;    /* squares of planes, other colliders, bodies */
    size_t n_ground_squares, n_fixed; /* of squares; of all colliders */
    struct cs_bins bins;

    struct cs_grid grid;
    struct cs_thick_lines thick_lines;
    struct cs_image *image; /* borrowed */
};

/* Sorts the triangles into bands, after the last was added. */
void cs_band_pass_bin(struct cs_band_pass *drawing);

/* Draws one band into the image. Threads may draw bands at the same time, each in its own tile
 * buffer. */
void cs_band_pass_draw(const struct cs_band_pass *drawing, uint32_t band,
                       struct cs_tile_buffer *tiles);

#endif

/* band_pass.h - everything that the bands of a picture are drawn from. */
#ifndef CS_CPU_BAND_PASS_H
#define CS_CPU_BAND_PASS_H

#include "draw/cpu/thick_lines.h"

/* Inputs of all bands; constant while bands are drawn. */
struct cs_band_pass {
    struct cs_shading_context shading;
    const struct cs_sample_pattern *sample_pattern;
    struct cs_shading_material *materials; /* (surfaces), owned by an arena */

    struct cs_triangles triangles; /* colliders and the ground, then bodies */
    size_t n_fixed;                /* of colliders and the ground */
    struct cs_bins bins;

    struct cs_thick_lines thick_lines;
    struct cs_image *image; /* borrowed */
};

/* Sorts the triangles into bands, after the last was added. */
void cs_band_pass_bin(struct cs_band_pass *pass);

/* Draws one band into the image. Threads may draw bands at the same time, each in its own tile
 * buffer. */
void cs_band_pass_draw(const struct cs_band_pass *pass, uint32_t band,
                       struct cs_tile_buffer *tiles);

#endif

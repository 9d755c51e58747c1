/* grid.h - blends the ground over a band: shadows, and lines of a grid. */
#ifndef CS_DRAW_GRID_H
#define CS_DRAW_GRID_H

#include "draw/cpu/tile_buffer.h"
#include "draw/ground.h"

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

#endif

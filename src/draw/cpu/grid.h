/* grid.h - the ground, laid over a band. */
#ifndef CS_DRAW_GRID_H
#define CS_DRAW_GRID_H

#include "draw/cpu/tile_buffer.h"
#include "draw/ground.h"

struct cs_grid {
    struct cs_ground ground;
    uint32_t ink;                             /* as the picture's colours */
    struct cs_triangles square;               /* where it may show in this picture */
    const struct cs_shading_context *shading; /* borrowed */
};

/* Lays it over what a board shows but triangles from number `moving` on, those that move. The
 * board has room for the ground. */
void cs_grid_draw(const struct cs_grid *grid, int32_t moving,
                  const struct cs_sample_pattern *pattern, struct cs_tile_buffer *tiles);

#endif

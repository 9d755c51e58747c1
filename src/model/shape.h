/* shape.h - bodies made into particles: places, areas, masses, pins. */
#ifndef CS_SHAPE_H
#define CS_SHAPE_H

#include "model/scene.h"

/* Places of a grid's particles, placed rigidly: written to x[first..] of x (3,n). */
void cs_shape_place(const struct cs_body *body, uint32_t n, uint32_t first, double *x);

/* Share of the rest area of grid particle (row, column) in m2: a quarter of each cell at it. */
double cs_shape_area(const struct cs_body *body, uint32_t row, uint32_t column);

/* Marks the body's pinned particles: pinned[0..count) = true. x as from cs_shape_place. */
void cs_shape_pin(const struct cs_body *body, uint32_t n, uint32_t first, const double *x,
                  bool *pinned);

#endif

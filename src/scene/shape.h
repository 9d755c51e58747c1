/* shape.h - bodies made into particles: positions, areas, pins. */
#ifndef CS_SHAPE_H
#define CS_SHAPE_H

#include "scene/scene.h"

/* Particles of a body, its placement and its velocity at time 0. */
int64_t cs_shape_count(const struct cs_body *body);
const struct cs_pose *cs_shape_placement(const struct cs_body *body);
const double *cs_shape_velocity(const struct cs_body *body);

/* Rows of the rotation by a unit quaternion x, y, z, w. */
void cs_quaternion_matrix(const double q[4], double r[9]);

/* Rows of the rotation of a place: its matrix, or that of its unit quaternion. */
void cs_pose_rotation(const struct cs_pose *place, double r[9]);

/* Positions of a body's particles, placed rigidly: written to x[first..] of x (3,n). */
void cs_shape_position(const struct cs_body *body, uint32_t n, uint32_t first, double *x);

/* Share of the rest area of the body's particle i in m2: a quarter of each cell at it, a third
 * of each triangle. */
double cs_shape_area(const struct cs_body *body, uint32_t i);

/* Marks the body's pinned particles: pinned[0..count) = true. x as from cs_shape_position. No
 * pin is at fault. */
void cs_shape_pin(const struct cs_body *body, uint32_t n, uint32_t first, const double *x,
                  bool *pinned);

/* true if the body, its mesh made, can have no such pin: an index beyond its particles, a named
 * edge of a mesh, a box inside out. text (size bytes) then says so. */
bool cs_shape_pin_fault(const struct cs_body *body, const struct cs_pin *pin, char *text,
                        size_t size);

#endif

/* solid.h - a collider as triangles, where it is. No OpenGL here. */
#ifndef CS_DRAW_SOLID_H
#define CS_DRAW_SOLID_H

#include "draw/mesh.h"
#include "model/contact/obstacle.h"

/* Vertices of a collider's triangles, three each, none shared: two triangles of a plane or a
 * floor, thousands of a box or a capsule; 0 of a sphere, which is a ball (ball.h) placed and
 * scaled, and of one that is not visible. */
uint32_t cs_solid_count(const struct cs_obstacle *obstacle);

/* Fills them in the world's coordinates, counter-clockwise seen from outside. A plane's square
 * lies a little below its place, or it would show through cloth of that cell (m) on it. */
void cs_solid_fill(const struct cs_obstacle *obstacle, double cell, struct cs_vertex *out);

#endif

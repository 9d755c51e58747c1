/* polygon.h - cuts the faces of mesh files into triangles. */
#ifndef CS_POLYGON_H
#define CS_POLYGON_H

#include <stdbool.h>
#include <stdint.h>

/* Corners of the largest concave polygon that is cut: the time grows with their cube. */
enum { CS_POLYGON_MAX = 1024 };

/* Cuts a polygon of n >= 3 corners at the positions x (n, 3) into n - 2 triangles, (n - 2, 3)
 * numbers of corners in the sense of the polygon. `next` (n) is scratch. The triangles are a
 * fan from corner 0 where each of them faces the way of the polygon, else ears (Meisters 1975).
 * Returns false if ears are needed, and the polygon crosses itself or has more than
 * CS_POLYGON_MAX corners; the triangles left over are then a fan. */
bool cs_polygon_cut(const double (*x)[3], uint32_t n, uint32_t *next, uint32_t *triangles);

#endif

/* mesh_mend.h - mends a mesh of a file to a surface, an oriented manifold with boundary: welds
 * doubled vertices, turns and removes faces; and cuts polygons into triangles. */
#ifndef CS_MESH_MEND_H
#define CS_MESH_MEND_H

#include "mesh/raw_mesh.h"

#include <stdbool.h>
#include <stdint.h>

/* Mends a mesh whose corners exist, and sets its sources. In this order: faces without area
 * and faces twice are removed; faces against their neighbours are turned; edges of more than
 * two triangles are cut, where two neighbours of opposite direction stay joined; with `weld`,
 * open edges in one place are joined, if they have opposite directions; vertices of no face are
 * removed. A mesh without such faults keeps its order and its bits. The result does not depend
 * on the order of qsort. CS_ERR_MEMORY. */
enum cs_status cs_mesh_mend(struct cs_raw_mesh *raw, bool weld, struct cs_mesh_mends *mends,
                            struct cs_error *error);

/* Cuts the faces of mesh files into triangles. */

/* Corners of the largest concave polygon that is cut: the time grows with their cube. */
enum { CS_POLYGON_MAX = 1024 };

/* Cuts a polygon of n >= 3 corners at the positions x (n, 3) into n - 2 triangles, (n - 2, 3)
 * numbers of corners in the sense of the polygon. `next` (n) is scratch. The triangles are a
 * fan from corner 0 where each of them faces the way of the polygon, else ears (Meisters 1975).
 * Returns false if ears are needed, and the polygon crosses itself or has more than
 * CS_POLYGON_MAX corners; the triangles left over are then a fan. */
bool cs_polygon_cut(const double (*x)[3], uint32_t n, uint32_t *next, uint32_t *triangles);

#endif

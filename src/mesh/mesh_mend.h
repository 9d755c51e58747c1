/* mesh_mend.h - mends a mesh of a file to a surface: an oriented manifold with boundary. */
#ifndef CS_MESH_MEND_H
#define CS_MESH_MEND_H

#include "mesh/raw_mesh.h"

/* Mends a mesh whose corners exist, and sets its sources. In this order: faces without area
 * and faces twice are removed; faces against their neighbours are turned; edges of more than
 * two triangles are cut, where two neighbours of opposite direction stay joined; with `weld`,
 * open edges in one place are joined, if they have opposite directions; vertices of no face are
 * removed. A mesh without such faults keeps its order and its bits. The result does not depend
 * on the order of qsort. CS_ERR_MEMORY. */
enum cs_status cs_mesh_mend(struct cs_raw_mesh *raw, bool weld, struct cs_mesh_mends *mends,
                            struct cs_error *error);

#endif

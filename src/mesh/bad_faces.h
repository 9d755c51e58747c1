/* bad_faces.h - removes faces without area and repeated faces from a mesh. */
#ifndef CS_BAD_FACES_H
#define CS_BAD_FACES_H

#include "mesh/raw_mesh.h"

/* Removes the faces without area, and counts them. A vertex within 1e-6 of its longest side of
 * another one of the face becomes that one. Otherwise its middle vertex divides the neighbour
 * across its longest side; where there is none, the face is left out. CS_ERR_MEMORY. */
enum cs_status cs_flat_faces_remove(struct cs_raw_mesh *raw, struct cs_mesh_mends *mends,
                                    struct cs_error *error);

/* Removes each face with the vertices of an earlier one, and counts them. CS_ERR_MEMORY. */
enum cs_status cs_repeated_faces_remove(struct cs_raw_mesh *raw, struct cs_mesh_mends *mends,
                                        struct cs_error *error);

#endif

/* bad_faces.h - removes faces without area and repeated faces from a mesh, and turns the others
 * alike. */
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

/* Turns faces until neighbours over an edge of two triangles have one orientation, and counts
 * them: of each piece those that are fewer, of as many the later ones. A piece that has but one
 * side stays as it is. CS_ERR_MEMORY. */
enum cs_status cs_faces_turn_alike(struct cs_raw_mesh *raw, struct cs_mesh_mends *mends,
                                   struct cs_error *error);

#endif

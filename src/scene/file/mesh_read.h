/* mesh_read.h - strict reader of triangle meshes from Wavefront OBJ files.
 *
 * Read: v (a fourth number is refused), vt, f with v, v/vt, v//vn or v/vt/vn, negative numbers
 * counted from the end; polygons are cut into a fan from their first corner. Ignored: comments,
 * vn, o, g, s, usemtl, mtllib. Anything else is refused.
 */
#ifndef CS_MESH_READ_H
#define CS_MESH_READ_H

#include "mesh/trimesh.h"

/* Reads and finishes a mesh; coordinates are multiplied by scale. Messages start with
 * `name:line: `. mesh->file_hash is that of the file's bytes. CS_ERR_FILE if the file cannot be
 * read or the mesh is not sound (cs_trimesh_finish), CS_ERR_MEMORY. */
enum cs_status cs_mesh_read(const char *path, const char *name, const double scale[3],
                            struct cs_trimesh *mesh, struct cs_arena *arena,
                            struct cs_error *error);

/* The same from text in memory. */
enum cs_status cs_mesh_read_text(const char *name, const char *text, size_t length,
                                 const double scale[3], struct cs_trimesh *mesh,
                                 struct cs_arena *arena, struct cs_error *error);

#endif

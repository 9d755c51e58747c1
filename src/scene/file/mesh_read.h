/* mesh_read.h - reads triangle meshes from Wavefront OBJ files (obj_read.h) and mends them
 * (mesh_mend.h). */
#ifndef CS_MESH_READ_H
#define CS_MESH_READ_H

#include "scene/file/obj_read.h"

struct cs_collider;
struct cs_mesh_source;

/* Sets out to a position of the file in metres, y up: scaled, in the unit of source, turned.
 * out may be p. */
void cs_mesh_to_scene(const struct cs_mesh_source *source, const double p[3], double out[3]);

/* Reads, mends and finishes a mesh; of `source` scale, units, up, weld and set are read.
 * Messages start with `name:line: `. mesh->file_hash is that of the file's bytes.
 * CS_ERR_FILE if the file cannot be read, or the mesh is no oriented surface even when
 * mended (cs_trimesh_finish), CS_ERR_MEMORY. */
enum cs_status cs_mesh_read(const char *path, const char *name,
                            const struct cs_mesh_source *source, struct cs_trimesh *mesh,
                            struct cs_arena *arena, struct cs_error *error);

/* The same from text in memory. */
enum cs_status cs_mesh_read_text(const char *name, const char *text, size_t length,
                                 const struct cs_mesh_source *source, struct cs_trimesh *mesh,
                                 struct cs_arena *arena, struct cs_error *error);

/* Reads positions (3, n) of the vertices of a collider's mesh from a file that has its faces,
 * and the hash of the file's bytes. CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_mesh_read_positions(const char *path, const char *name,
                                      const struct cs_collider *collider, double *positions,
                                      char file_hash[CS_HASH_DIGITS], struct cs_error *error);

#endif

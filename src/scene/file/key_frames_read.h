/* key_frames_read.h - strict reader of the key frames of a mesh.
 *
 * PC2, as clothsim export writes it and Blender and Maya do: "POINTCACHE2", 0, version 1,
 * points, first frame, frames per sample, samples; then floats x y z of each point, sample by
 * sample. First frame and frames per sample are not used: start and rate of the scene count.
 *
 * NPZ, as numpy.savez writes it: stored members alone. The array has the shape (key frames,
 * vertices, 3), the type <f4 or <f8 and C order. The checksum is tested.
 *
 * OBJ: one file for each key frame, each a whole mesh (mesh_read.h) with the same triangles. */
#ifndef CS_KEY_FRAMES_READ_H
#define CS_KEY_FRAMES_READ_H

#include "mesh/trimesh.h"

#include <clothsim/option.h>

struct cs_collider;
struct cs_key_frames;
struct cs_vertex_paths;

/* Prints the name of file k of the key frames; returns false after the last one. */
bool cs_key_frames_file(const struct cs_key_frames *keys, uint32_t k, char out[CS_TEXT_MAX]);

/* Reads and finishes the paths of a collider's key frames from files in `folder`, for the
 * vertices of its mesh; positions are multiplied by its scale. Messages start with the file's
 * name. CS_ERR_SCENE: a name outside the folder, or a wrong number of files. CS_ERR_FILE,
 * CS_ERR_MEMORY. */
enum cs_status cs_key_frames_read(const char *folder, const struct cs_collider *collider,
                                  struct cs_vertex_paths *paths, struct cs_arena *arena,
                                  struct cs_error *error);

/* The same from the bytes of a PC2 or NPZ file in memory; the file's name says which. */
enum cs_status cs_key_frames_read_bytes(const char *bytes, size_t length,
                                        const struct cs_collider *collider,
                                        struct cs_vertex_paths *paths, struct cs_arena *arena,
                                        struct cs_error *error);

#endif

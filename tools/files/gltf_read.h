/* gltf_read.h - glTF in its binary form (.glb) as OBJ.
 *
 * A library would do it at a price: libassimp-dev of Debian 12 brings 6 packages and 22 MB, to
 * read forty formats in C++; libtinygltf-dev 3 packages and 1.2 MB of C++, which needs a second
 * compiler here and leaves accessors and nodes to its caller, the larger half of gltf_read.c.
 */
#ifndef CS_GLTF_READ_H
#define CS_GLTF_READ_H

#include "base/status.h"
#include "base/text.h"

#include <stdbool.h>

/* True if these are the bytes of a .glb file. */
bool cs_gltf_is(const char *bytes, size_t length);

/* Adds the triangles of the nodes of its scene to obj, placed by their transforms: `g` for each
 * node with a name, `usemtl` for each material with one, `vt` of TEXCOORD_0. Primitives of
 * points and lines are passed over. CS_ERR_FILE with one fault, where the file is cut or
 * inconsistent, or has compressed, sparse or outer data; CS_ERR_MEMORY. */
enum cs_status cs_gltf_to_obj(const char *name, const char *bytes, size_t length,
                              struct cs_text *obj, struct cs_error *error);

#endif

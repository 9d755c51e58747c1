/* obj_read.h - reads Wavefront OBJ files of any exporter: positions, texture coordinates, faces
 * and their names.
 *
 * Readers of others do less for a simulation: tinyobjloader (Debian has it) is C++, fast_obj
 * (Debian has it not) stores floats, and neither names the line of a fault or keeps doubles;
 * assimp also gives vertices new numbers, which pins and key frames name. */
#ifndef CS_OBJ_READ_H
#define CS_OBJ_READ_H

#include "mesh/mesh_mend.h"

/* A file as it is, before any mending; zeroed: none. */
struct cs_obj {
    struct cs_raw_mesh mesh;
    struct cs_mesh_mends mends;   /* polygons that cross themselves */
    struct cs_mesh_label *labels; /* (n_labels), malloc'd; their names are the arena's */
    uint32_t n_labels;
    bool is_textured; /* a corner has a texture coordinate */
    uint32_t n_skipped;
    struct cs_text skipped; /* first words of lines passed over, each once */
    uint32_t *face_list;    /* vertices of the faces, each face closed by UINT32_MAX */
    size_t n_face_list;
};

/* Reads v, vt, f, l, p, g, o and usemtl. Polygons are cut into triangles. Passes over vn, vp,
 * s, mg and mtllib, and counts lines of other programs. Of v the first three numbers are read:
 * a weight or colours may follow. Numbers of a corner are v, v/vt, v/vt/vn, v//vn or v/, from 1
 * or, negative, from the last back. Lines end with LF, CR or both, and go on after a backslash.
 * CS_ERR_FILE with the faults of the whole file,
 * CS_ERR_MEMORY. cs_obj_finish must be called in any case. */
enum cs_status cs_obj_read(const char *name, const char *text, size_t length,
                           struct cs_obj *out, struct cs_arena *arena, struct cs_error *error);
void cs_obj_finish(struct cs_obj *obj);

#endif

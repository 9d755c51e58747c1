/* obj.h - Wavefront OBJ: one text file a sample, with the same faces in each. */
#ifndef CS_EXPORT_OBJ_H
#define CS_EXPORT_OBJ_H

#include "base/text.h"
#include "io/export/export_mesh.h"
#include "io/export/export_sample.h"

/* All that follows the points: texture coordinates, a group for each body, faces and lines. */
enum cs_status cs_obj_print_tail(const struct cs_export_mesh *skin, struct cs_text *tail,
                                 struct cs_error *error);

/* Writes FOLDER/bodies_00012.obj, positions to nine digits, beside and renamed. CS_ERR_FILE. */
enum cs_status cs_obj_write(const struct cs_export_mesh *skin, const struct cs_text *tail,
                            const char *folder, const struct cs_export_sample *sample,
                            struct cs_error *error);

#endif

/* vtp.h - VTK's XML PolyData: one file a sample. */
#ifndef CS_EXPORT_VTP_H
#define CS_EXPORT_VTP_H

#include "base/text.h"
#include "io/export/export_mesh.h"
#include "io/export/export_sample.h"

/* What the files of all samples have in common. Zeroed: nothing. */
struct cs_vtp {
    struct cs_text header;  /* XML up to the appended data, owned */
    uint8_t *constant_part; /* appended data that stay, which the arena owns */
    size_t constant_bytes;
};

enum cs_status cs_vtp_make(struct cs_vtp *vtp, const struct cs_export_mesh *skin,
                           struct cs_arena *arena, struct cs_error *error);

/* Writes FOLDER/bodies_00012.vtp with the fields of the skin, raw doubles; beside and renamed.
 * CS_ERR_FILE. */
enum cs_status cs_vtp_write(const struct cs_vtp *vtp, const struct cs_export_mesh *skin,
                            const char *folder, const struct cs_export_sample *sample,
                            struct cs_error *error);

#endif

/* pc2.h - PC2 point caches: the points of all samples in one file, in the order of the OBJ. */
#ifndef CS_EXPORT_PC2_H
#define CS_EXPORT_PC2_H

#include "io/export/append_file.h"
#include "io/export/export_mesh.h"
#include "io/export/export_sample.h"

/* Zeroed: closed. */
struct cs_pc2 {
    struct cs_append_file file;
    uint32_t n_samples;
    uint32_t *floats; /* (n, 3) of one sample, the arena's */
};

/* FOLDER/bodies.pc2, or colliders.pc2. CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_pc2_open(struct cs_pc2 *cache, const struct cs_export_mesh *skin,
                           const struct cs_export_settings *settings, struct cs_arena *arena,
                           struct cs_error *error);

/* Adds a sample; then the file says that it has it. */
enum cs_status cs_pc2_add(struct cs_pc2 *cache, const struct cs_export_mesh *skin,
                          struct cs_error *error);

#endif

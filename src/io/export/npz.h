/* npz.h - one NumPy archive of a whole run: meshes, times and the values of all samples. */
#ifndef CS_EXPORT_NPZ_H
#define CS_EXPORT_NPZ_H

#include "io/export/append_file.h"
#include "io/export/export_mesh.h"
#include "io/export/export_sample.h"

/* How long its arrays are is known at the end only: until then samples lie one behind the other
 * in FOLDER/run.npz.part. Zeroed: closed. */
struct cs_npz {
    struct cs_append_file part_file;
    const char *folder; /* borrowed */
    uint32_t frame_interval,
        n_samples; /* frames from one sample to the next, samples there are */
    uint64_t sample_bytes;
};

/* CS_ERR_FILE, as in all below. skins: bodies, colliders. */
enum cs_status cs_npz_open(struct cs_npz *npz, const struct cs_export_mesh *const skins[2],
                           const struct cs_export_settings *settings, struct cs_error *error);

enum cs_status cs_npz_add(struct cs_npz *npz, const struct cs_export_mesh *const skins[2],
                          double t, struct cs_error *error);

/* Writes FOLDER/run.npz, beside and renamed; the fields of the skins are overwritten. The part
 * goes unless the run may go on. */
enum cs_status cs_npz_finish(struct cs_npz *npz, const struct cs_export_mesh *const skins[2],
                             bool goes_on, struct cs_error *error);

#endif

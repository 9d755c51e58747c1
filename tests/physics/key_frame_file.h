/* key_frame_file.h - key frames of a shape, by a motion in closed form, as a file. */
#ifndef KEY_FRAME_FILE_H
#define KEY_FRAME_FILE_H

#include "../suite.h"
#include "base/serialise.h"
#include "export/npy.h"
#include "export/writer.h"
#include "mesh/trimesh.h"

#include <stdio.h>

/* x of a vertex p of the shape at t */
typedef void point_motion(double t, const double p[3], double x[3]);

/* Writes `keys` key frames of a shape to an NPZ file in doubles. */
static inline void write_keys(const char *file, enum cs_mesh_shape shape, uint32_t detail,
                              point_motion *moved, uint32_t keys, double rate) {
    struct cs_arena arena = {0};
    struct cs_trimesh mesh = {0};
    struct cs_error error = {0};
    char head[CS_NPY_HEAD];
    ck_assert(!cs_trimesh_make(&mesh, shape, detail, &arena, &error));
    struct cs_zip zip = {.file = fopen(file, "wb")};
    ck_assert_ptr_nonnull(zip.file);
    cs_npy_head(head, "<f8", (uint64_t[3]){keys, mesh.n, 3}, 3);
    cs_zip_begin(&zip, "positions.npy", sizeof head + 24 * (uint64_t)keys * mesh.n);
    cs_zip_put(&zip, head, sizeof head);
    for (uint32_t k = 0; k < keys; k++)
        for (size_t i = 0; i < mesh.n; i++) {
            double x[3];
            uint64_t words[3];
            moved(k / rate,
                  (double[3]){mesh.positions[i], mesh.positions[mesh.n + i],
                              mesh.positions[2 * (size_t)mesh.n + i]},
                  x);
            for (int c = 0; c < 3; c++)
                words[c] = cs_double_to_le64(x[c]);
            cs_zip_put(&zip, words, sizeof words);
        }
    cs_zip_end(&zip);
    cs_zip_finish(&zip);
    ck_assert_int_eq(fclose(zip.file), 0);
    cs_arena_finish(&arena);
}

#endif

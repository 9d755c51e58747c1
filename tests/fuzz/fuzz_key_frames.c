/* Any bytes as the key frames of a mesh of three vertices, PC2 or NPZ: whole paths or a
 * refusal. */
#include "mesh/vertex_paths.h"
#include "scene/collider_keys.h"
#include "scene/file/key_frames_read.h"
#include "scene/mesh_keys.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
    static const struct cs_trimesh mesh = {.n = 3};
    struct cs_mesh_source source = {.scale = {1, 2, 0.5},
                                    .key_frames = {.present = true, .rate = 24, .end = 1}};
    const struct cs_collider collider = {.mesh = &source, .geometry = &mesh};
    const char *name = length > 1 && bytes[0] == 'P' && bytes[1] == 'O' ? "a.pc2" : "a.npz";
    struct cs_vertex_paths paths = {0};
    struct cs_arena arena = {0};
    struct cs_error error = {0};
    strcpy(source.key_frames.file, name);
    const enum cs_status status = cs_key_frames_read_bytes((const char *)bytes, length,
                                                           &collider, &paths, &arena, &error);
    CS_ASSERT(status == error.status);
    if (status)
        CS_ASSERT(status == CS_ERR_FILE && !strncmp(error.message, name, strlen(name)));
    for (double t = -1; !status && t < 2; t += 0.3) {
        double p[3];
        const struct cs_path_weights at = cs_vertex_paths_weights(&paths, t);
        cs_vertex_paths_sum(&paths, &at, at.position, 2, p);
        CS_ASSERT(isfinite(p[0]) && at.key[0] < paths.n_keys && at.key[1] < paths.n_keys);
    }
    cs_arena_finish(&arena);
    return 0;
}

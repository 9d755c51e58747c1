/* Any bytes as an OBJ file: a sound mesh or a refusal. */
#include "scene/file/mesh_read.h"
#include "scene/mesh_keys.h"

#include <stdint.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
    const struct cs_mesh_source source = {
        .scale = {1, 2, 0.5}, .weld = length % 2 == 0, .up = length % 3 == 0};
    struct cs_trimesh mesh = {0};
    struct cs_arena arena = {0};
    struct cs_error error = {0};
    const enum cs_status status = cs_mesh_read_text("fuzz.obj", (const char *)bytes, length,
                                                    &source, &mesh, &arena, &error);
    CS_ASSERT(status == error.status);
    if (status)
        CS_ASSERT(status == CS_ERR_FILE && !strncmp(error.message, "fuzz.obj:", 9));
    for (uint32_t k = 0; !status && k < 3 * mesh.n_triangles; k++)
        CS_ASSERT(mesh.triangles[k] < mesh.n);
    for (uint32_t k = 0; !status && k < 2 * mesh.n_edges; k++)
        CS_ASSERT(mesh.edges[k] < mesh.n);
    cs_arena_finish(&arena);
    return 0;
}

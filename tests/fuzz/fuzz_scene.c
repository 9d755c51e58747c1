/* Any bytes as a scene: read or refused with a place, and what was read prints and reads back.
 */
#include "read_back.h"
#include "scene/scene.h"

#include <stdint.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

/* A shape of very many triangles is no mistake, and takes seconds to make. */
static bool is_fine(const uint8_t *bytes, size_t length) {
    static const char key[] = "\"detail\"";
    const uint8_t *at = bytes, *end = bytes + length;
    while ((at = memmem(at, (size_t)(end - at), key, sizeof key - 1))) {
        at += sizeof key - 1;
        size_t digits = 0;
        for (size_t k = 0; at + k < end && k < 8; k++)
            digits += (at[k] >= '0' && at[k] <= '9') || at[k] == 'e' || at[k] == 'E';
        if (digits > 1)
            return true;
    }
    return false;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
    if (is_fine(bytes, length))
        return 0;
    static const struct cs_override overrides[] = {
        {"integrator.dt", "0.001"}, {"bodies[0].pins[0]", "top"}, {"forces.drag", "0.5"}};
    struct cs_scene scene;
    struct cs_error error = {0}, of_override = {0};
    const enum cs_status status =
        cs_scene_read_text(&scene, "fuzz.json", (const char *)bytes, length, NULL, 0, &error);
    CS_ASSERT(status == error.status);
    if (status)
        CS_ASSERT((status == CS_ERR_SCENE || status == CS_ERR_FILE) &&
                  !strncmp(error.message, "fuzz.json:", 10));
    else
        read_back(&scene);
    cs_scene_finish(&scene);

    cs_scene_read_text(&scene, "fuzz.json", (const char *)bytes, length, overrides,
                       sizeof overrides / sizeof *overrides, &of_override);
    cs_scene_finish(&scene);
    return 0;
}

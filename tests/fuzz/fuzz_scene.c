/* Any bytes as a scene: read or refused with a place, and what was read prints and reads back.
 */
#include "io/scene_read.h"
#include "io/scene_write.h"

#include <stdint.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

/* The resolved text of a scene reads as a scene with the same text. */
static void read_back(const struct cs_scene *scene) {
    struct cs_text first = {0}, second = {0};
    struct cs_error error = {0};
    struct cs_scene back;
    cs_scene_print(scene, NULL, NULL, 0, &first);
    cs_scene_read_text(&back, "back.json", cs_text_get(&first), first.length, NULL, 0, &error);
    CS_ASSERT(!error.status);
    cs_scene_print(&back, NULL, NULL, 0, &second);
    CS_ASSERT(!strcmp(cs_text_get(&first), cs_text_get(&second)));
    cs_text_finish(&first);
    cs_text_finish(&second);
    cs_scene_finish(&back);
}

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

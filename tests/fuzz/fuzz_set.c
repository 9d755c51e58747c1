/* Any lines as --set of a scene: taken, or refused with the place; what is taken prints and
 * reads back as the same scene. */
#include "read_back.h"
#include "scene/scene.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

enum { LINES_MAX = 8 };

static const char scene_text[] =
    "{\"bodies\": [{\"cloth\": {\"grid\": [3, 2]}, \"mass\": {\"total\": 1}, \"pins\": "
    "[\"top\", 4]},\n"
    " {\"cloth\": {\"grid\": [2, 2]}, \"mass\": {\"particle\": 0.1}}],\n"
    "\"colliders\": [{\"floor\": {\"height\": -1}}, {\"sphere\": {\"centre\": [0, -3, 0]}}],\n"
    "\"events\": [{\"at\": 0.1, \"impact\": {\"direction\": [0, 1, 0], \"impulse\": 1}}]}\n";

/* PATH=VALUE of each line, as the command line cuts it; returns how many */
static uint32_t cut(char *text, struct cs_override *overrides) {
    uint32_t n = 0;
    for (char *line; n < LINES_MAX && (line = strsep(&text, "\n"));) {
        char *equals = strchr(line, '=');
        if (!equals || equals == line || !equals[1])
            continue;
        *equals = 0;
        overrides[n++] = (struct cs_override){line, equals + 1};
    }
    return n;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
    struct cs_override overrides[LINES_MAX];
    struct cs_scene scene;
    struct cs_error error = {0};
    char *text = strndup((const char *)bytes, length);
    if (!text)
        return 0;
    const uint32_t n = cut(text, overrides);
    const enum cs_status status = cs_scene_read_text(
        &scene, "fuzz.json", scene_text, sizeof scene_text - 1, overrides, n, &error);
    CS_ASSERT(status == error.status);
    CS_ASSERT(n || !status);
    if (status)
        CS_ASSERT((status == CS_ERR_SCENE || status == CS_ERR_USAGE || status == CS_ERR_FILE) &&
                  (!strncmp(error.message, "fuzz.json:", 10) ||
                   !strncmp(error.message, "--set ", 6)));
    else
        read_back(&scene);
    cs_scene_finish(&scene);
    free(text);
    return 0;
}

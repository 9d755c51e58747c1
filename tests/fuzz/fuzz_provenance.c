/* Any bytes as run.json, as origin.json or as the text in a picture: a scene that can be read
 * and run again, or a refusal. */
#include "scene/file/scene_read.h"
#include "reproduce/provenance_read.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

/* the scene and what changed; scenes have a target of their own */
static void take(struct cs_provenance *provenance) {
    struct cs_session_settings settings = {0};
    struct cs_error error = {0};
    struct cs_text changes = {0};
    CS_ASSERT(provenance->version && provenance->scene_file && provenance->method);
    cs_provenance_number(provenance->json, "frames");
    if (cs_provenance_to_session(provenance, "no-such-folder", &settings, &error))
        CS_ASSERT(error.status == CS_ERR_USAGE);
    else {
        CS_ASSERT(settings.text && !strncmp(settings.scene, "no-such-folder/", 15));
        CS_ASSERT(!strchr(settings.scene + 15, '/') && !settings.n_plugins);
    }
    cs_provenance_add_changed_files(provenance, &changes);
    cs_text_finish(&changes);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
    struct cs_provenance provenance = {0};
    struct cs_error error = {0};
    char *text = strndup((const char *)bytes, length);
    if (!text)
        return 0;
    const enum cs_status status =
        cs_provenance_read_text(&provenance, "fuzz.json", text, &error);
    CS_ASSERT(status == error.status);
    if (status)
        CS_ASSERT(status == CS_ERR_FILE && strstr(error.message, "fuzz.json"));
    else
        take(&provenance);
    cs_provenance_finish(&provenance);
    free(text);
    return 0;
}

/* Any bytes as the manifest of a folder with one picture: what it lists lies in the folder, and
 * verify, merge and --resume agree on what has changed. Once as they are, and once with the
 * hash at the end put right. */
#include "base/hash.h"
#include "cli/manifest.h"
#include "folder.h"

#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

static const char picture[] = "frame_00001.png", tail[] = "# all of it ";

static void read_manifest(const char *bytes, size_t length) {
    struct cs_text lines = {0};
    struct cs_error error = {0}, changed = {0}, consumed = {0};
    uint32_t n, differing;
    fuzz_write(CS_MANIFEST_NAME, bytes, length);
    const enum cs_status status =
        cs_manifest_check(fuzz_folder, &lines, &n, &differing, &error);
    CS_ASSERT(status == error.status);
    if (status)
        CS_ASSERT(status == CS_ERR_FILE && strstr(error.message, CS_MANIFEST_NAME) && !n);
    /* names have no slash, so that none leads out of the folder */
    CS_ASSERT(!strchr(cs_text_get(&lines), '/'));
    cs_manifest_check_files(fuzz_folder, "*", &changed);
    CS_ASSERT(status ? changed.status : differing || !changed.status);
    cs_manifest_consume(fuzz_folder, &consumed);
    /* it is gone if a run goes on, and stays if that is refused */
    CS_ASSERT(!access(fuzz_path(CS_MANIFEST_NAME), F_OK) == !!consumed.status);
    CS_ASSERT(changed.status || !consumed.status);
    cs_text_finish(&lines);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
    struct cs_text signed_ = {0};
    char digits[CS_HASH_DIGITS];
    fuzz_write(picture, "a picture", strlen("a picture"));
    read_manifest((const char *)bytes, length);
    const uint8_t *last = memmem(bytes, length, tail, strlen(tail));
    cs_text_add_bytes(&signed_, bytes, last ? (size_t)(last - bytes) : length);
    cs_hash_bytes(cs_text_get(&signed_), signed_.length, digits);
    cs_text_add(&signed_, "%s%s\n", tail, digits);
    read_manifest(cs_text_get(&signed_), signed_.length);
    cs_text_finish(&signed_);
    return 0;
}

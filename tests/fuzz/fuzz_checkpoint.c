/* Any bytes as a checkpoint: refused, or all of its record is there. Once as they are, and once
 * with the checksum put right, since else hardly any damage gets behind it. */
#include "base/hash.h"
#include "cli/run/checkpoint.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

static const struct cs_checkpoint_key keys[] = {{"scene", "{\n  \"dt\": 0.001\n}"},
                                                {"method", "rk4"}};
enum { FACTS = sizeof keys / sizeof *keys };

/* values of all kinds until there is none left */
static void take_all(struct cs_serialiser *serialiser) {
    while (!serialiser->failed && !cs_serialiser_is_done(serialiser)) {
        double real = 0;
        const size_t before = serialiser->position;
        CS_SERIALISER(serialiser, real);
        CS_ASSERT(serialiser->failed || serialiser->position == before + sizeof real);
        CS_ASSERT(serialiser->position <= serialiser->length);
    }
}

/* no more than one file, which is in memory */
static void read_file(const char *bytes, size_t length) {
    char path[64];
    struct cs_serialiser serialiser;
    struct cs_error error = {0};
    const int file = memfd_create("fuzz", MFD_CLOEXEC);
    if (file < 0 || write(file, bytes, length) != (ssize_t)length)
        abort();
    snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    const enum cs_status status = cs_checkpoint_read(path, keys, FACTS, &serialiser, &error);
    CS_ASSERT(status == error.status);
    if (status)
        CS_ASSERT(status == CS_ERR_FILE && error.message[0] == '"');
    else
        take_all(&serialiser);
    cs_serialiser_finish(&serialiser);
    close(file);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
    read_file((const char *)bytes, length);
    if (length < CS_HASH_DIGITS)
        return 0;
    char *copy = malloc(length), digits[CS_HASH_DIGITS];
    if (!copy)
        return 0;
    memcpy(copy, bytes, length);
    cs_hash_bytes(copy, length - CS_HASH_DIGITS, digits);
    digits[CS_HASH_DIGITS - 1] = '\n';
    memcpy(copy + length - CS_HASH_DIGITS, digits, CS_HASH_DIGITS);
    read_file(copy, length);
    free(copy);
    return 0;
}

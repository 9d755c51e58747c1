/* Writes values into memory, or reads them back. Each value lies directly after the one before,
 * without names or lengths; only texts have their length. */
#include "base/serialise.h"

#include "base/arena.h"

#include <stdlib.h>

/* Appends n bytes. Returns false if out of memory. */
static bool write_bytes(struct cs_serialiser *serialiser, const void *value, size_t n) {
    if (n > (size_t)-1 / 4 - serialiser->length ||
        !CS_ARENA_REALLOC(serialiser->bytes, serialiser->capacity, serialiser->length + n))
        return false;
    memcpy(serialiser->bytes + serialiser->length, value, n);
    serialiser->length += n;
    return true;
}

/* Reads the next n bytes. Returns false if fewer are left. */
static bool read_bytes(struct cs_serialiser *serialiser, void *value, size_t n) {
    if (n > serialiser->length - serialiser->position)
        return false;
    memcpy(value, serialiser->bytes + serialiser->position, n);
    serialiser->position += n;
    return true;
}

void cs_serialiser_bytes(struct cs_serialiser *serialiser, void *value, size_t n) {
    if (serialiser->failed || n == 0)
        return;
    serialiser->failed = serialiser->is_reading ? !read_bytes(serialiser, value, n)
                                                : !write_bytes(serialiser, value, n);
}

void cs_serialiser_begin(struct cs_serialiser *serialiser) {
    serialiser->length = serialiser->position = 0;
    serialiser->is_reading = serialiser->failed = false;
}

bool cs_serialiser_is_done(const struct cs_serialiser *serialiser) {
    return serialiser->is_reading && !serialiser->failed &&
           serialiser->position == serialiser->length;
}

void cs_serialiser_finish(struct cs_serialiser *serialiser) {
    free(serialiser->bytes);
    *serialiser = (struct cs_serialiser){0};
}

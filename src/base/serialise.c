/* Writes values into memory, or reads them back. Each value lies directly after the one before,
 * without names or lengths; only texts have their length. */
#include "base/serialise.h"

#include "base/arena.h"

#include <stdlib.h>
#include <string.h>

/* Appends n bytes. Returns false if out of memory. */
static bool write_bytes(struct cs_serialiser *record, const void *value, size_t n) {
    if (n > (size_t)-1 / 4 - record->length ||
        !CS_ARENA_REALLOC(record->bytes, record->capacity, record->length + n))
        return false;
    memcpy(record->bytes + record->length, value, n);
    record->length += n;
    return true;
}

/* Reads the next n bytes. Returns false if fewer are left. */
static bool read_bytes(struct cs_serialiser *record, void *value, size_t n) {
    if (n > record->length - record->position)
        return false;
    memcpy(value, record->bytes + record->position, n);
    record->position += n;
    return true;
}

void cs_serialiser_bytes(struct cs_serialiser *record, void *value, size_t n) {
    if (record->failed || n == 0)
        return;
    record->failed =
        record->is_reading ? !read_bytes(record, value, n) : !write_bytes(record, value, n);
}

void cs_serialiser_begin(struct cs_serialiser *record) {
    record->length = record->position = 0;
    record->is_reading = record->failed = false;
}

bool cs_serialiser_is_done(const struct cs_serialiser *record) {
    return record->is_reading && !record->failed && record->position == record->length;
}

void cs_serialiser_finish(struct cs_serialiser *record) {
    free(record->bytes);
    *record = (struct cs_serialiser){0};
}

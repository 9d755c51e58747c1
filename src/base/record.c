/* Writes values into memory, or reads them back. */
#include "base/record.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

static bool has_room(struct cs_record *record, size_t n) {
    if (n <= record->capacity - record->length)
        return true;
    if (n > (size_t)-1 / 4 - record->length)
        return false;
    const size_t capacity = 2 * (record->length + n);
    char *larger = realloc(record->bytes, capacity);
    if (!larger)
        return false;
    record->bytes = larger;
    record->capacity = capacity;
    return true;
}

static bool write_bytes(struct cs_record *record, const void *value, size_t n) {
    if (!has_room(record, n))
        return false;
    memcpy(record->bytes + record->length, value, n);
    record->length += n;
    return true;
}

static bool read_bytes(struct cs_record *record, void *value, size_t n) {
    if (n > record->length - record->at)
        return false;
    memcpy(value, record->bytes + record->at, n);
    record->at += n;
    return true;
}

void cs_record_bytes(struct cs_record *record, void *value, size_t n) {
    if (record->failed || n == 0)
        return;
    record->failed =
        record->loading ? !read_bytes(record, value, n) : !write_bytes(record, value, n);
}

void cs_record_text(struct cs_record *record, struct cs_text *text) {
    size_t length = text->length;
    CS_RECORD(record, length);
    if (!record->loading)
        cs_record_bytes(record, text->bytes, length);
    if (!record->loading || record->failed)
        return;
    record->failed = length > record->length - record->at || length > INT_MAX;
    if (record->failed)
        return;
    cs_text_add(text, "%.*s", (int)length, record->bytes + record->at);
    record->at += length;
    record->failed = text->failed;
}

void cs_record_begin(struct cs_record *record) {
    record->length = record->at = 0;
    record->loading = record->failed = false;
}

bool cs_record_is_done(const struct cs_record *record) {
    return record->loading && !record->failed && record->at == record->length;
}

void cs_record_finish(struct cs_record *record) {
    free(record->bytes);
    *record = (struct cs_record){0};
}

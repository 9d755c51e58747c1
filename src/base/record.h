/* record.h - values on their way into a checkpoint, or back by the same calls in the same
 * order: so that what is written and what is read cannot differ.
 *
 * Values are bytes of this machine and this build; what a checkpoint is for is checked before
 * it is read (io/checkpoint.h). */
#ifndef CS_RECORD_H
#define CS_RECORD_H

#include "base/text.h"

#include <stdbool.h>
#include <stddef.h>

/* Zeroed: an empty one, to write. */
struct cs_record {
    char *bytes; /* owned */
    size_t length, capacity;
    size_t at;    /* of the next read */
    bool loading; /* reads into the values, instead of writing them */
    bool failed;  /* no memory, or nothing left to read: the values are not to be used */
};

/* n bytes of a value that holds no pointer. */
void cs_record_bytes(struct cs_record *record, void *value, size_t n);

/* A field, or an array, of a fixed size. */
#define CS_RECORD(record, value) cs_record_bytes(record, &(value), sizeof(value))

/* A text; one that is read is empty before. */
void cs_record_text(struct cs_record *record, struct cs_text *text);

/* Empties one to be written anew, in the memory it has. */
void cs_record_begin(struct cs_record *record);

/* Whether all of one that was read has been read, and no more. */
bool cs_record_is_done(const struct cs_record *record);

void cs_record_finish(struct cs_record *record);

#endif

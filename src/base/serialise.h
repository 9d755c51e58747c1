/* serialise.h - values on their way into a checkpoint, or back by the same calls in the same
 * order: so that what is written and what is read cannot differ.
 *
 * Values are bytes of this machine and this build; what a checkpoint is for is checked before
 * it is read (io/checkpoint.h). */
#ifndef CS_SERIALISE_H
#define CS_SERIALISE_H

#include "base/text.h"

#include <stdbool.h>
#include <stddef.h>

/* Zeroed: an empty one, to write. */
struct cs_serialiser {
    char *bytes; /* owned */
    size_t length, capacity;
    size_t position; /* of the next read */
    bool is_reading; /* reads into the values, instead of writing them */
    bool failed;     /* no memory, or nothing left to read: the values are not to be used */
};

/* n bytes of a value that holds no pointer. */
void cs_serialiser_bytes(struct cs_serialiser *record, void *value, size_t n);

/* A field, or an array, of a fixed size. */
#define CS_SERIALISER(record, value) cs_serialiser_bytes(record, &(value), sizeof(value))

/* A text; one that is read is empty before. */
void cs_serialiser_text(struct cs_serialiser *record, struct cs_text *text);

/* Empties one to be written anew, in the memory it has. */
void cs_serialiser_begin(struct cs_serialiser *record);

/* Whether all of one that was read has been read, and no more. */
bool cs_serialiser_is_done(const struct cs_serialiser *record);

void cs_serialiser_finish(struct cs_serialiser *record);

#endif

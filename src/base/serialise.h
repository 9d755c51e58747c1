/* serialise.h - symmetric serialisation: the same calls write a checkpoint and read it back, so
 * the two formats cannot diverge; numbers in little-endian order for files.
 *
 * Values are bytes of this machine and build: cli/run/checkpoint.h checks that a checkpoint
 * fits them before it is read. */
#ifndef CS_SERIALISE_H
#define CS_SERIALISE_H

#include "base/text.h"

#include <endian.h>
#include <stdint.h>
#include <string.h>

/* A buffer of serialised values. A zeroed struct is empty, for writing. */
struct cs_serialiser {
    char *bytes; /* owned */
    size_t length, capacity;
    size_t position; /* of the next read */
    bool is_reading; /* calls read into the values instead of writing them */
    bool failed;     /* out of memory, or nothing left to read: values must not be used */
};

/* Writes or reads n bytes of a value without pointers. After a failure calls do nothing. */
void cs_serialiser_bytes(struct cs_serialiser *serialiser, void *value, size_t n);

/* Writes or reads a variable or array of fixed size. */
#define CS_SERIALISER(record, value) cs_serialiser_bytes(record, &(value), sizeof(value))

/* Empties the buffer for writing again; its memory is kept. */
void cs_serialiser_begin(struct cs_serialiser *serialiser);

/* Tells, after reading, whether exactly all bytes were read. */
bool cs_serialiser_is_done(const struct cs_serialiser *serialiser);

/* Frees the buffer; *record is empty afterwards. */
void cs_serialiser_finish(struct cs_serialiser *serialiser);

/* Bits of a double in little-endian order, to be written as they are. */
static inline uint64_t cs_double_to_le64(double value) {
    uint64_t word;
    memcpy(&word, &value, sizeof word);
    return htole64(word);
}

/* Inverse of cs_double_to_le64. */
static inline double cs_double_from_le64(uint64_t word) {
    double value;
    word = le64toh(word);
    memcpy(&value, &word, sizeof value);
    return value;
}

/* The same for a float. */
static inline uint32_t cs_float_to_le32(float value) {
    uint32_t word;
    memcpy(&word, &value, sizeof word);
    return htole32(word);
}

#endif

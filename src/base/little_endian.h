/* little_endian.h - converts numbers to and from little-endian file format. */
#ifndef CS_LITTLE_ENDIAN_H
#define CS_LITTLE_ENDIAN_H

#include <endian.h>
#include <stdint.h>
#include <string.h>

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

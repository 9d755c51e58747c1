/* little_endian.h - numbers as files have them: little-endian on every machine. */
#ifndef CS_LITTLE_ENDIAN_H
#define CS_LITTLE_ENDIAN_H

#include <endian.h>
#include <stdint.h>
#include <string.h>

static inline uint64_t cs_double_to_le64(double value) {
    uint64_t word;
    memcpy(&word, &value, sizeof word);
    return htole64(word);
}

static inline double cs_double_from_le64(uint64_t word) {
    double value;
    word = le64toh(word);
    memcpy(&value, &word, sizeof value);
    return value;
}

static inline uint32_t cs_float_to_le32(float value) {
    uint32_t word;
    memcpy(&word, &value, sizeof word);
    return htole32(word);
}

#endif

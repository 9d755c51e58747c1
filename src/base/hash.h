/* hash.h - XXH3 of 128 bits, as 32 hexadecimal digits. */
#ifndef CS_HASH_H
#define CS_HASH_H

#include <stddef.h>

enum { CS_HASH_DIGITS = 33 };

/* Hash of n doubles as little-endian bytes, whatever the machine's order, in canonical form. */
void cs_hash_doubles(const double *values, size_t n, char digits[CS_HASH_DIGITS]);
void cs_hash_bytes(const void *bytes, size_t length, char digits[CS_HASH_DIGITS]);

#endif

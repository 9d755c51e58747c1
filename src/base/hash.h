/* hash.h - XXH3 hashes of 128 bits, as 32 hexadecimal digits and a zero byte; and CRC-32. */
#ifndef CS_HASH_H
#define CS_HASH_H

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

enum { CS_HASH_DIGITS = 33 };

/* Hash of n doubles as little-endian bytes on every machine, printed in canonical (big-endian)
 * form. */
void cs_hash_doubles(const double *values, size_t n, char digits[CS_HASH_DIGITS]);
void cs_hash_bytes(const void *bytes, size_t length, char digits[CS_HASH_DIGITS]);

/* Hash and size (may be NULL) of a regular file, read block by block: the digits that
 * `xxh128sum` prints. On CS_ERR_FILE digits is empty. */
enum cs_status cs_hash_file(const char *path, uint64_t *size, char digits[CS_HASH_DIGITS],
                            struct cs_error *error);

/* CRC-32 of ZIP archives (ISO 3309), continued from that of the bytes before, 0 at the start.
 */
uint32_t cs_hash_crc32(uint32_t crc, const void *bytes, size_t length);

#endif

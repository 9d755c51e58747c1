/* XXH3-128 of doubles and bytes, printed in canonical form, and CRC-32. */
#include "base/hash.h"

#include "base/file.h"

#include <endian.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* the state lives on the stack, so its layout must be that of the code that works on it */
#define XXH_INLINE_ALL
#include <xxhash.h>

/* Prints a hash in canonical form. */
static void print_digits(XXH128_hash_t hash, char digits[CS_HASH_DIGITS]) {
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, hash);
    for (size_t i = 0; i < sizeof canonical.digest; i++)
        snprintf(digits + 2 * i, 3, "%02x", canonical.digest[i]);
}

void cs_hash_doubles(const double *values, size_t n, char digits[CS_HASH_DIGITS]) {
    enum { BLOCK = 512 };
    uint64_t words[BLOCK];
    XXH3_state_t state;
    XXH3_128bits_reset(&state);
    for (size_t done = 0; done < n;) {
        const size_t count = n - done < BLOCK ? n - done : BLOCK;
        memcpy(words, values + done, count * sizeof *words);
        for (size_t i = 0; i < count; i++)
            words[i] = htole64(words[i]);
        XXH3_128bits_update(&state, words, count * sizeof *words);
        done += count;
    }
    print_digits(XXH3_128bits_digest(&state), digits);
}

void cs_hash_bytes(const void *bytes, size_t length, char digits[CS_HASH_DIGITS]) {
    print_digits(XXH3_128bits(bytes, length), digits);
}

/* Hashes a file to its end. Returns false on failure, with errno. */
static bool add_all(int file, XXH3_state_t *state, uint64_t *size) {
    enum { BLOCK_BYTES = 1 << 16 };
    char block[BLOCK_BYTES];
    ssize_t got;
    while ((got = read(file, block, sizeof block)) != 0) {
        if (got < 0 && errno != EINTR)
            return false;
        if (got > 0) {
            XXH3_128bits_update(state, block, (size_t)got);
            *size += (uint64_t)got;
        }
    }
    return true;
}

enum cs_status cs_hash_file(const char *path, uint64_t *size, char digits[CS_HASH_DIGITS],
                            struct cs_error *error) {
    struct stat info;
    XXH3_state_t state;
    XXH3_128bits_reset(&state);
    uint64_t bytes = 0;
    *digits = 0;
    // without O_NONBLOCK a fifo would wait here for its writer
    const int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (file >= 0 && !fstat(file, &info) && !S_ISREG(info.st_mode))
        cs_fail(error, CS_ERR_FILE, "cannot read \"%s\": it is not a regular file", path);
    else if (file < 0 || !add_all(file, &state, &bytes))
        cs_fail(error, cs_file_status(errno), "cannot read \"%s\": %s", path, strerror(errno));
    else
        print_digits(XXH3_128bits_digest(&state), digits);
    if (file >= 0)
        close(file);
    if (size)
        *size = bytes;
    return error->status;
}

/* Divides by the polynomial edb88320 (bits in reverse), a byte at a time, by a table of what
 * each byte leaves (Sarwate 1988). */
static uint32_t remainders[256];
static pthread_once_t remainders_made = PTHREAD_ONCE_INIT;

static void make_remainders(void) {
    for (uint32_t byte = 0; byte < 256; byte++) {
        remainders[byte] = byte;
        for (int bit = 0; bit < 8; bit++)
            remainders[byte] = remainders[byte] >> 1 ^ (remainders[byte] & 1 ? 0xedb88320u : 0);
    }
}

uint32_t cs_hash_crc32(uint32_t crc, const void *bytes, size_t length) {
    pthread_once(&remainders_made, make_remainders);
    crc = ~crc;
    for (size_t i = 0; i < length; i++)
        crc = crc >> 8 ^ remainders[(crc ^ ((const uint8_t *)bytes)[i]) & 255];
    return ~crc;
}

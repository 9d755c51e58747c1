/* XXH3-128 of doubles and bytes, printed in canonical form. */
#include "base/hash.h"

#include <endian.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* the state lives on the stack, so its layout must be that of the code that works on it */
#define XXH_INLINE_ALL
#include <xxhash.h>

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

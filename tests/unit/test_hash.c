/* The hash is the published XXH3-128, and the same for the same doubles everywhere; CRC-32 is
 * zlib's. */
#include "base/file.h"
#include "base/hash.h"
#include "unit.h"

#include <zlib.h>

/* canonical digits as `xxh128sum` prints them */
TEST(bytes_match_known_digests) {
    static const struct {
        const char *bytes, *digits;
    } rows[] = {{"", "99aa06d3014798d86001c324468d497f"},
                {"a", "a96faf705af16834e6c632b61e964e1f"},
                {"abc", "06b05ab6733a618578af5f94892f3950"}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char digits[CS_HASH_DIGITS];
        cs_hash_bytes(rows[i].bytes, strlen(rows[i].bytes), digits);
        ck_assert_str_eq(digits, rows[i].digits);
    }
}

TEST(no_doubles_hash_like_no_bytes) {
    char digits[CS_HASH_DIGITS];
    cs_hash_doubles(NULL, 0, digits);
    ck_assert_str_eq(digits, "99aa06d3014798d86001c324468d497f");
}

/* a file of several blocks, and what is none */
TEST(files_hash_as_their_bytes) {
    enum { LENGTH = 150000 };
    char *bytes = malloc(LENGTH), of_file[CS_HASH_DIGITS], of_bytes[CS_HASH_DIGITS];
    struct cs_error error = {0};
    uint64_t size;
    ck_assert_ptr_nonnull(bytes);
    for (size_t i = 0; i < LENGTH; i++)
        bytes[i] = (char)(i * i / 7);
    cs_file_write("h", bytes, LENGTH, &error);
    cs_hash_file("h", &size, of_file, &error);
    UNIT_ASSERT_OK(&error);
    cs_hash_bytes(bytes, LENGTH, of_bytes);
    ck_assert_str_eq(of_file, of_bytes);
    ck_assert_uint_eq(size, LENGTH);
    ck_assert_int_eq(cs_hash_file(".", &size, of_file, &error), CS_ERR_FILE);
    ck_assert_str_eq(of_file, "");
    free(bytes);
}

/* 1.0, -2.5 and 1e-300 as the bytes that a little-endian machine holds, written out, so that
 * the test means the same on every machine. */
TEST(doubles_hash_as_little_endian_bytes) {
    static const double values[] = {1.0, -2.5, 1e-300};
    static const unsigned char bytes[] = {0,    0,    0,    0,    0,    0,    0xf0, 0x3f,
                                          0,    0,    0,    0,    0,    0,    4,    0xc0,
                                          0x59, 0xf3, 0xf8, 0xc2, 0x1f, 0x6e, 0xa5, 0x01};
    char of_values[CS_HASH_DIGITS], of_bytes[CS_HASH_DIGITS];
    cs_hash_doubles(values, 3, of_values);
    cs_hash_bytes(bytes, sizeof bytes, of_bytes);
    ck_assert_str_eq(of_values, of_bytes);
}

/* every length round the blocks of the hash: by pieces the same as at once */
TEST(pieces_do_not_show) {
    enum { MOST = 1300 };
    double values[MOST];
    unsigned char bytes[8 * MOST];
    for (int i = 0; i < MOST; i++) {
        uint64_t word;
        values[i] = 0.1 * i - 3;
        memcpy(&word, values + i, 8);
        for (int b = 0; b < 8; b++)
            bytes[8 * i + b] = (unsigned char)(word >> 8 * b);
    }
    for (size_t n = 0; n <= MOST; n += n < 40 || (n > 500 && n < 530) ? 1 : 13) {
        char of_values[CS_HASH_DIGITS], of_bytes[CS_HASH_DIGITS];
        cs_hash_doubles(values, n, of_values);
        cs_hash_bytes(bytes, 8 * n, of_bytes);
        ck_assert_str_eq(of_values, of_bytes);
    }
}

TEST(one_bit_changes_the_hash) {
    double values[64] = {0};
    char before[CS_HASH_DIGITS], after[CS_HASH_DIGITS];
    cs_hash_doubles(values, 64, before);
    values[63] = -0.0;
    cs_hash_doubles(values, 64, after);
    ck_assert_str_ne(before, after);
}

/* the check value of the catalogue of CRC algorithms, then zlib's for all lengths and starts */
TEST(crc_is_that_of_zlib) {
    unsigned char bytes[100];
    ck_assert_uint_eq(cs_hash_crc32(0, "123456789", 9), 0xcbf43926u);
    for (size_t i = 0; i < sizeof bytes; i++)
        bytes[i] = (unsigned char)(i * i * 31 / 7);
    for (size_t begin = 0; begin < 9; begin++)
        for (size_t n = 0; begin + n <= sizeof bytes; n++) {
            const uint32_t whole = cs_hash_crc32(0, bytes + begin, n);
            UNIT_ASSERT_OFTEN(whole == crc32(0, bytes + begin, (unsigned)n));
            // in two pieces
            UNIT_ASSERT_OFTEN(cs_hash_crc32(cs_hash_crc32(0, bytes + begin, n / 3),
                                            bytes + begin + n / 3, n - n / 3) == whole);
        }
}

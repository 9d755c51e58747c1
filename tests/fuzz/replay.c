/* Feeds files to a fuzz target: each as it is, and cut and damaged in ways that are the same in
 * every run, so that the targets are tests on machines without a fuzzer too.
 *
 *     fuzz_scene [-l LIST] [-n DAMAGES] FILE...
 *
 * LIST holds inputs that a fuzzer has found, a line of hexadecimal digits each (corpus.py):
 * they are fed as they are.
 */
#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

enum { FILE_BYTES_MAX = 1 << 20, CUTS_MAX = 2000 };

static uint64_t next_number(uint64_t *state) {
    /* xorshift of 64 bits (Marsaglia 2003) */
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return *state;
}

/* a copy of exactly this length, so that a sanitiser sees a read behind it */
static void feed(const uint8_t *bytes, size_t length) {
    uint8_t *copy = malloc(length ? length : 1);
    if (!copy)
        abort();
    memcpy(copy, bytes, length);
    LLVMFuzzerTestOneInput(copy, length);
    free(copy);
}

/* changes a few places of bytes; returns the new length, at most 2 * length */
static size_t damage(uint8_t *bytes, size_t length, uint64_t *state) {
    static const char *const pieces[] = {
        "-1",      "1e999", "null", "\"\"", "{}", "[]", "0",    "1e308", "true",
        "\\u0000", "\xff",  "\"",   "}",    "]",  ",",  "[[[[", "\n",    "9999999999"};
    const size_t most = 2 * length;
    for (uint64_t n = 1 + next_number(state) % 4; n && length; n--) {
        const size_t at = next_number(state) % length;
        const char *piece = pieces[next_number(state) % (sizeof pieces / sizeof *pieces)];
        const size_t size = strlen(piece);
        switch (next_number(state) % 4) {
        case 0:
            bytes[at] ^= (uint8_t)(1u << next_number(state) % 8);
            break;
        case 1:
            bytes[at] = (uint8_t)next_number(state);
            break;
        case 2: /* a byte less */
            memmove(bytes + at, bytes + at + 1, length - at - 1);
            length--;
            break;
        case 3: /* a piece in between */
            if (length + size > most)
                break;
            memmove(bytes + at + size, bytes + at, length - at);
            memcpy(bytes + at, piece, size);
            length += size;
            break;
        }
    }
    return length;
}

static void replay(const uint8_t *bytes, size_t length, long damages) {
    feed(bytes, length);
    const size_t step = length / CUTS_MAX + 1;
    for (size_t cut = 0; cut < length; cut += step)
        feed(bytes, cut);

    uint64_t state = 0x9e3779b97f4a7c15u + length;
    uint8_t *copy = malloc(2 * length + 1);
    if (!copy)
        abort();
    for (long i = 0; i < damages; i++) {
        memcpy(copy, bytes, length);
        feed(copy, damage(copy, length, &state));
    }
    free(copy);
}

static int value_of(int digit) {
    return digit <= '9' ? digit - '0' : digit - 'a' + 10;
}

/* how many inputs there are in a list; 0: it cannot be read */
static long feed_list(const char *path) {
    static uint8_t bytes[FILE_BYTES_MAX];
    FILE *file = fopen(path, "r");
    size_t digits = 0;
    long n = 0;
    for (int digit; file && (digit = fgetc(file)) != EOF && digits / 2 < sizeof bytes;)
        if (digit == '\n') {
            feed(bytes, digits / 2);
            digits = 0;
            n++;
        } else {
            uint8_t *at = bytes + digits++ / 2;
            *at = (uint8_t)(*at << 4 | value_of(digit));
        }
    if (file)
        fclose(file);
    return n;
}

int main(int argc, char **argv) {
    static uint8_t bytes[FILE_BYTES_MAX];
    long damages = 500, listed = 0;
    int first = 1;
    if (argc > 2 && !strcmp(argv[1], "-l")) {
        if (!(listed = feed_list(argv[2]))) {
            fprintf(stderr, "cannot read \"%s\"\n", argv[2]);
            return 1;
        }
        first = 3;
    }
    if (argc > first + 1 && !strcmp(argv[first], "-n")) {
        damages = strtol(argv[first + 1], NULL, 10);
        first += 2;
    }
    for (int i = first; i < argc; i++) {
        FILE *file = fopen(argv[i], "rb");
        if (!file) {
            fprintf(stderr, "cannot read \"%s\": %s\n", argv[i], strerror(errno));
            return 1;
        }
        const size_t length = fread(bytes, 1, sizeof bytes, file);
        fclose(file);
        replay(bytes, length, damages);
    }
    printf("%ld inputs as they are, %d files cut and damaged %ld times each: no crash\n",
           listed, argc - first, damages);
    return argc == first;
}

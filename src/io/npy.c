/* Writes arrays of 3-vectors as NumPy files, format 1.0. */
#include "io/npy.h"

#include "base/file.h"

#include <endian.h>
#include <stdio.h>
#include <string.h>

/* magic, version, length of the rest, then a Python dictionary padded to a multiple of 64 */
enum { HEADER_BYTES = 128, BLOCK = 512 };

static void make_header(char header[HEADER_BYTES], uint32_t n) {
    const int rest = HEADER_BYTES - 10;
    memset(header, ' ', HEADER_BYTES);
    memcpy(header, "\x93NUMPY\x01\x00", 8);
    header[8] = (char)(rest & 0xff);
    header[9] = (char)(rest >> 8);
    const int length =
        snprintf(header + 10, HEADER_BYTES - 10,
                 "{'descr': '<f8', 'fortran_order': False, 'shape': (%u, 3), }", n);
    header[10 + length] = ' ';
    header[HEADER_BYTES - 1] = '\n';
}

/* a double as its little-endian bytes */
static uint64_t word_of(double value) {
    uint64_t word;
    memcpy(&word, &value, sizeof word);
    return htole64(word);
}

enum cs_status cs_npy_write(const char *path, const double *a, uint32_t n,
                            struct cs_error *error) {
    struct cs_file_out out;
    char header[HEADER_BYTES];
    const enum cs_status status = cs_file_create(&out, path, error);
    if (status)
        return status;
    /* failures of fwrite are seen by finish */
    make_header(header, n);
    fwrite(header, 1, sizeof header, out.file);
    for (uint32_t i = 0; i < n;) {
        uint64_t rows[BLOCK][3];
        uint32_t count = 0;
        for (; count < BLOCK && i < n; count++, i++)
            for (size_t c = 0; c < 3; c++)
                rows[count][c] = word_of(a[c * n + i]);
        fwrite(rows, sizeof *rows, count, out.file);
    }
    return cs_file_finish(&out, error);
}

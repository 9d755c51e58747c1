/* Writes NumPy files, format 1.0.
 *
 *   offset  bytes  field
 *   0       6      0x93 "NUMPY"
 *   6       2      version 1, 0
 *   8       2      length of the rest of the header, little-endian: 118
 *   10      118    Python dictionary, padded with blanks, ended by a newline
 *   128     ...    numbers
 * The dictionary is {'descr': TYPE, 'fortran_order': False, 'shape': (N, ...), }. */
#include "export/npy.h"

#include "base/file.h"
#include "base/serialise.h"

#include <stdio.h>
#include <string.h>

enum { BLOCK = 512 }; /* rows converted at a time */

/* A fixed length leaves blanks enough for three axes of any length. */
void cs_npy_head(char head[CS_NPY_HEAD], const char *type, const uint64_t *shape,
                 unsigned n_axes) {
    const int rest = CS_NPY_HEAD - 10;
    memset(head, ' ', CS_NPY_HEAD);
    memcpy(head, "\x93NUMPY\x01\x00", 8);
    head[8] = (char)(rest & 0xff);
    head[9] = (char)(rest >> 8);
    char *at = head + 10;
    at += sprintf(at, "{'descr': '%s', 'fortran_order': False, 'shape': (", type);
    /* a tuple of one number has a comma too */
    for (unsigned k = 0; k < n_axes; k++)
        at += sprintf(at, "%s%llu%s", k ? " " : "", (unsigned long long)shape[k],
                      k + 1 < n_axes || n_axes == 1 ? "," : "");
    at += sprintf(at, "), }");
    *at = ' ';
    head[CS_NPY_HEAD - 1] = '\n';
}

enum cs_status cs_npy_write(const char *path, const double *a, uint32_t n,
                            struct cs_error *error) {
    struct cs_file_out out;
    const uint64_t shape[2] = {n, 3};
    char head[CS_NPY_HEAD];
    const enum cs_status status = cs_file_create(&out, path, error);
    if (status)
        return status;
    /* failures of fwrite are seen by finish */
    cs_npy_head(head, "<f8", shape, 2);
    fwrite(head, 1, sizeof head, out.file);
    for (uint32_t i = 0; i < n;) {
        uint64_t rows[BLOCK][3];
        uint32_t count = 0;
        for (; count < BLOCK && i < n; count++, i++)
            for (size_t c = 0; c < 3; c++)
                rows[count][c] = cs_double_to_le64(a[c * n + i]);
        fwrite(rows, sizeof *rows, count, out.file);
    }
    return cs_file_finish(&out, error);
}

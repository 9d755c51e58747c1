/* npy.h - arrays as NumPy files (format 1.0 of numpy.lib.format). */
#ifndef CS_NPY_H
#define CS_NPY_H

#include "base/status.h"

#include <stdint.h>

enum { CS_NPY_HEAD = 128 }; /* bytes before the numbers: a multiple of 64, as the format asks */

/* Writes the header of an array of any element type, such as "<f8", with up to three axes of
 * the given lengths, in C order (last axis fastest). The numbers follow it without padding. */
void cs_npy_head(char head[CS_NPY_HEAD], const char *type, const uint64_t *shape,
                 unsigned n_axes);

/* Writes component-major a (3,n) as a C-ordered float64 array of shape (n,3), little-endian on
 * every machine. Writes a temporary file and renames it. On failure CS_ERR_FILE, and no file is
 * left. */
enum cs_status cs_npy_write(const char *path, const double *a, uint32_t n,
                            struct cs_error *error);

#endif

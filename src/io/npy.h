/* npy.h - arrays as NumPy files. */
#ifndef CS_NPY_H
#define CS_NPY_H

#include "base/status.h"

#include <stdint.h>

enum { CS_NPY_HEAD = 128 };

/* What stands before the numbers of an array of any type, such as "<f8", and of up to three
 * axes: format 1.0, in C order. */
void cs_npy_head(char head[CS_NPY_HEAD], const char *type, const uint64_t *shape,
                 unsigned n_axes);

/* Writes component-major a (3,n) as a C-ordered float64 array of shape (n,3), NumPy format 1.0,
 * little-endian on every machine. Beside and renamed. On failure CS_ERR_FILE, no file is left.
 */
enum cs_status cs_npy_write(const char *path, const double *a, uint32_t n,
                            struct cs_error *error);

#endif

/* rows.h - a run of springs in pieces: both ends' rows, and forces added back to them. */
#ifndef CS_ROWS_H
#define CS_ROWS_H

#include "model/clones.h"

#include <stddef.h>
#include <stdint.h>

enum { PIECE = 256 }; /* springs whose forces wait in a buffer on the stack */

/* one piece of a run: both ends' rows of an array of 3-vectors */
struct ends {
    const double *ax, *ay, *az, *bx, *by, *bz;
};

CS_INLINE struct ends ends_of(const double *p, uint32_t n, uint32_t a, uint32_t b) {
    const double *y = p + n, *z = y + n;
    return (struct ends){p + a, y + a, z + a, p + b, y + b, z + b};
}

CS_INLINE void add_row(size_t count, const double *restrict from, double *restrict to) {
    for (size_t i = 0; i < count; i++)
        to[i] += from[i];
}

CS_INLINE void take_row(size_t count, const double *restrict from, double *restrict to) {
    for (size_t i = 0; i < count; i++)
        to[i] -= from[i];
}

/* adds the buffered forces at the first ends and takes them at the second */
CS_INLINE void scatter(uint32_t count, const double *fx, const double *fy, const double *fz,
                       size_t n, uint32_t a, uint32_t b, double *f) {
    add_row(count, fx, f + a);
    add_row(count, fy, f + n + a);
    add_row(count, fz, f + 2 * n + a);
    take_row(count, fx, f + b);
    take_row(count, fy, f + n + b);
    take_row(count, fz, f + 2 * n + b);
}

#endif

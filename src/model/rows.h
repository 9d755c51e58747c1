/* rows.h - a run of springs in pieces: both ends' rows, and forces added back to them.
 *
 * A grid's rows are read and written where they lie; the ends of a mesh are gathered into rows
 * on the stack, and the forces are added back one by one. */
#ifndef CS_ROWS_H
#define CS_ROWS_H

#include "model/clones.h"
#include "model/springs.h"

enum { PIECE = 256 }; /* springs whose forces wait in a buffer on the stack */

/* one piece of a run: both ends' rows of an array of 3-vectors */
struct ends {
    const double *ax, *ay, *az, *bx, *by, *bz;
};

/* where the rows of a mesh's piece are gathered: ax, ay, az, bx, by, bz */
struct gathered {
    double rows[6][PIECE];
};

/* one piece: its springs, and what stands in for the run's constants in a run with lists */
struct piece {
    const struct cs_spring_run *run;
    uint32_t start, count;
    const double *lengths, *stiffnesses;
};

CS_INLINE struct piece piece_of(const struct cs_spring_run *run, uint32_t start) {
    const uint32_t left = run->count - start;
    return (struct piece){run, start, left < PIECE ? left : PIECE,
                          run->lengths ? run->lengths + start : NULL,
                          run->stiffnesses ? run->stiffnesses + start : NULL};
}

CS_INLINE struct ends ends_of(const struct piece *piece, const double *p, size_t n,
                              struct gathered *gathered) {
    const double *a = p + piece->run->a, *b = p + piece->run->b;
    if (!piece->run->ends) {
        a += piece->start;
        b += piece->start;
        return (struct ends){a, a + n, a + 2 * n, b, b + n, b + 2 * n};
    }
    const uint32_t *ends = piece->run->ends + 2 * (size_t)piece->start;
    double(*rows)[PIECE] = gathered->rows;
    for (size_t i = 0; i < piece->count; i++) {
        const size_t from = ends[2 * i], to = ends[2 * i + 1];
        rows[0][i] = a[from];
        rows[1][i] = a[n + from];
        rows[2][i] = a[2 * n + from];
        rows[3][i] = b[to];
        rows[4][i] = b[n + to];
        rows[5][i] = b[2 * n + to];
    }
    return (struct ends){rows[0], rows[1], rows[2], rows[3], rows[4], rows[5]};
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
CS_INLINE void scatter(const struct piece *piece, const double *fx, const double *fy,
                       const double *fz, size_t n, double *f) {
    double *a = f + piece->run->a, *b = f + piece->run->b;
    if (!piece->run->ends) {
        a += piece->start;
        b += piece->start;
        add_row(piece->count, fx, a);
        add_row(piece->count, fy, a + n);
        add_row(piece->count, fz, a + 2 * n);
        take_row(piece->count, fx, b);
        take_row(piece->count, fy, b + n);
        take_row(piece->count, fz, b + 2 * n);
        return;
    }
    /* the three rows side by side: neighbours in the list often share an end, and would wait
     * for each other */
    const uint32_t *ends = piece->run->ends + 2 * (size_t)piece->start;
    for (size_t i = 0; i < piece->count; i++) {
        const size_t from = ends[2 * i], to = ends[2 * i + 1];
        a[from] += fx[i];
        a[n + from] += fy[i];
        a[2 * n + from] += fz[i];
        b[to] -= fx[i];
        b[n + to] -= fy[i];
        b[2 * n + to] -= fz[i];
    }
}

#endif

/* positions.h - particles as four numbers each, x and the inverse mass: one load and one store
 * a particle, for loops over vectors that go through particles in any order.
 *
 * WIDTH, 2, 4 or 8, is the number of particles that a vector has: as many as the processor's
 * own, because gcc takes wider ones apart, number by number. Each lane has its own arithmetic,
 * and results do not depend on the width. */
#ifndef POSITIONS_H
#define POSITIONS_H

#include <clothsim/clones.h>
#include <stddef.h>
#include <stdint.h>

enum { PLACE = 4 };

typedef double quad __attribute__((vector_size(PLACE * sizeof(double)), may_alias));

/* The particle that begins at number k of the positions. */
CS_INLINE quad *position_at(double *positions, size_t k) {
    return (quad *)(positions + k);
}

/* Reads n particles from x (3,n). */
CS_INLINE void gather_positions(double *positions, size_t n, const double *x,
                                const double *inv_mass) {
    for (size_t i = 0; i < n; i++)
        *position_at(positions, PLACE * i) = (quad){x[i], x[n + i], x[2 * n + i], inv_mass[i]};
}

/* Writes n particles to x (3,n). */
CS_INLINE void scatter_positions(const double *positions, size_t n, double *x) {
    for (size_t i = 0; i < n; i++)
        for (size_t c = 0; c < 3; c++)
            x[c * n + i] = positions[PLACE * i + c];
}
#ifdef WIDTH
/* One number of each of WIDTH particles. */
typedef double lanes __attribute__((vector_size(WIDTH * sizeof(double)), may_alias));

#if WIDTH == 2
/* x, y, z in m and inverse mass in 1/kg of WIDTH particles, which begin at `item`. */
CS_INLINE void read_positions(double *positions, const uint32_t *item, lanes to[PLACE]) {
    for (size_t c = 0; c < PLACE; c += WIDTH) {
        const lanes p = *(lanes *)(positions + item[0] + c),
                    q = *(lanes *)(positions + item[1] + c);
        to[c] = __builtin_shufflevector(p, q, 0, 2);
        to[c + 1] = __builtin_shufflevector(p, q, 1, 3);
    }
}

/* The reverse. */
CS_INLINE void write_positions(double *positions, const uint32_t *item,
                               const lanes from[PLACE]) {
    for (size_t c = 0; c < PLACE; c += WIDTH) {
        *(lanes *)(positions + item[0] + c) =
            __builtin_shufflevector(from[c], from[c + 1], 0, 2);
        *(lanes *)(positions + item[1] + c) =
            __builtin_shufflevector(from[c], from[c + 1], 1, 3);
    }
}
#else
/* Numbers k and k + 2 of the rows of two vectors in turn, and two numbers from k on of each. */
#if WIDTH == 8
#define PICK_PAIRS(k)  k, k + 8, k + 2, k + 10, k + 4, k + 12, k + 6, k + 14
#define PICK_HALVES(k) k, k + 1, k + 8, k + 9, k + 4, k + 5, k + 12, k + 13
#else
#define PICK_PAIRS(k)  k, k + 4, k + 2, k + 6
#define PICK_HALVES(k) k, k + 1, k + 4, k + 5
#endif

/* Turns four rows of four numbers into columns, in each half of a vector of 8. */
CS_INLINE void transpose(const lanes *from, lanes *to) {
    const lanes p = __builtin_shufflevector(from[0], from[1], PICK_PAIRS(0));
    const lanes q = __builtin_shufflevector(from[0], from[1], PICK_PAIRS(1));
    const lanes r = __builtin_shufflevector(from[2], from[3], PICK_PAIRS(0));
    const lanes s = __builtin_shufflevector(from[2], from[3], PICK_PAIRS(1));
    to[0] = __builtin_shufflevector(p, r, PICK_HALVES(0));
    to[1] = __builtin_shufflevector(q, s, PICK_HALVES(0));
    to[2] = __builtin_shufflevector(p, r, PICK_HALVES(2));
    to[3] = __builtin_shufflevector(q, s, PICK_HALVES(2));
}

/* x, y, z in m and inverse mass in 1/kg of WIDTH particles, which begin at `item`. */
CS_INLINE void read_positions(double *positions, const uint32_t *item, lanes to[PLACE]) {
    lanes rows[PLACE];
    for (size_t l = 0; l < PLACE; l++)
#if WIDTH == 8
        rows[l] = __builtin_shufflevector(*position_at(positions, item[l]),
                                          *position_at(positions, item[l + PLACE]), 0, 1, 2, 3,
                                          4, 5, 6, 7);
#else
        rows[l] = *position_at(positions, item[l]);
#endif
    transpose(rows, to);
}

/* The reverse. */
CS_INLINE void write_positions(double *positions, const uint32_t *item,
                               const lanes from[PLACE]) {
    lanes rows[PLACE];
    transpose(from, rows);
    for (size_t l = 0; l < PLACE; l++) {
#if WIDTH == 8
        *position_at(positions, item[l + PLACE]) =
            __builtin_shufflevector(rows[l], rows[l], 4, 5, 6, 7);
#endif
        *position_at(positions, item[l]) =
            __builtin_shufflevector(rows[l], rows[l], 0, 1, 2, 3);
    }
}
#endif
#endif

#endif

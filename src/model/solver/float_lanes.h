/* float_lanes.h - 16 floats at a time, and vectors and symmetric 3x3 blocks of them.
 *
 * The compiler maps them to the vectors that the processor has. Each lane has its own
 * arithmetic, so the bits are the same in each. */
#ifndef CS_FLOAT_LANES_H
#define CS_FLOAT_LANES_H

#include <clothsim/clones.h>
#include <stddef.h>
#include <stdint.h>

enum { CS_LANES = 16 };

/* The calling convention for such vectors depends on the instruction set. That does not matter,
 * because every function that takes or returns them is inlined. */
#pragma GCC diagnostic ignored "-Wpsabi"

/* One number of each of 16 cells. */
typedef float lanes __attribute__((vector_size(4 * CS_LANES)));
/* The same at any address in an array of floats. */
typedef float unaligned_lanes __attribute__((vector_size(4 * CS_LANES), aligned(4), may_alias));

/* 16 vectors, component by component. */
struct vectors {
    lanes x, y, z;
};
/* 16 symmetric 3x3 blocks. */
struct lane_blocks {
    lanes xx, xy, xz, yy, yz, zz;
};

CS_INLINE lanes get(const float *from) {
    return *(const unaligned_lanes *)from;
}
CS_INLINE void put(float *to, lanes value) {
    *(unaligned_lanes *)to = value;
}

/* Read and write three or six rows that begin n floats apart. */
CS_INLINE struct vectors get3(const float *from, size_t n) {
    return (struct vectors){get(from), get(from + n), get(from + 2 * n)};
}
/* The numbers rounded to multiples of 1e-30 where they are below 1e-23. What decays over many
 * cells would become subnormal, which takes processors a hundred times as long, and adds
 * nothing to a residual that is scaled to 1. */
CS_INLINE lanes without_tiny(lanes value) {
    return (value + 1e-23F) - 1e-23F;
}
CS_INLINE void put3(float *to, size_t n, struct vectors v) {
    put(to, without_tiny(v.x));
    put(to + n, without_tiny(v.y));
    put(to + 2 * n, without_tiny(v.z));
}
CS_INLINE struct lane_blocks get6(const float *from, size_t n) {
    return (struct lane_blocks){get(from),         get(from + n),     get(from + 2 * n),
                                get(from + 3 * n), get(from + 4 * n), get(from + 5 * n)};
}
CS_INLINE void put6(float *to, size_t n, struct lane_blocks b) {
    const lanes rows[6] = {b.xx, b.xy, b.xz, b.yy, b.yz, b.zz};
    for (size_t c = 0; c < 6; c++)
        put(to + c * n, rows[c]);
}
/* Reads the vectors of 16 cells anywhere in an array (3,n). */
CS_INLINE struct vectors gather3(const float *from, size_t n, const uint32_t *places) {
    float rows[3 * CS_LANES];
    for (size_t l = 0; l < CS_LANES; l++) {
        rows[l] = from[places[l]];
        rows[CS_LANES + l] = from[n + places[l]];
        rows[2 * CS_LANES + l] = from[2 * n + places[l]];
    }
    return get3(rows, CS_LANES);
}

/* Arithmetic lane by lane; sums run from left to right. */
CS_INLINE struct vectors plus(struct vectors a, struct vectors b) {
    return (struct vectors){a.x + b.x, a.y + b.y, a.z + b.z};
}
CS_INLINE struct vectors minus(struct vectors a, struct vectors b) {
    return (struct vectors){a.x - b.x, a.y - b.y, a.z - b.z};
}
CS_INLINE struct vectors scaled(float a, struct vectors b) {
    return (struct vectors){a * b.x, a * b.y, a * b.z};
}
CS_INLINE struct lane_blocks plus6(struct lane_blocks a, struct lane_blocks b) {
    return (struct lane_blocks){a.xx + b.xx, a.xy + b.xy, a.xz + b.xz,
                                a.yy + b.yy, a.yz + b.yz, a.zz + b.zz};
}
/* Symmetric block times vector. */
CS_INLINE struct vectors times(struct lane_blocks b, struct vectors p) {
    return (struct vectors){b.xx * p.x + b.xy * p.y + b.xz * p.z,
                            b.xy * p.x + b.yy * p.y + b.yz * p.z,
                            b.xz * p.x + b.yz * p.y + b.zz * p.z};
}

#endif

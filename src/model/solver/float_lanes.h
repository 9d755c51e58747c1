/* float_lanes.h - 16 floats at a time, and vectors and symmetric 3x3 blocks of them.
 *
 * The compiler makes of them what the processor has; each lane has its own arithmetic, so the
 * bits are the same in each. */
#ifndef CS_FLOAT_LANES_H
#define CS_FLOAT_LANES_H

#include <clothsim/clones.h>
#include <stddef.h>
#include <stdint.h>

enum { CS_LANES = 16 };

/* every function that takes or gives them is inlined, so that how they are passed, which
 * depends on the instruction set, does not matter */
#pragma GCC diagnostic ignored "-Wpsabi"

typedef float lanes __attribute__((vector_size(4 * CS_LANES)));
/* the same anywhere in an array of floats */
typedef float unaligned_lanes __attribute__((vector_size(4 * CS_LANES), aligned(4), may_alias));

struct vectors {
    lanes x, y, z;
};
struct lane_blocks {
    lanes xx, xy, xz, yy, yz, zz;
};

CS_INLINE lanes get(const float *from) {
    return *(const unaligned_lanes *)from;
}
CS_INLINE void put(float *to, lanes value) {
    *(unaligned_lanes *)to = value;
}

/* three and six rows, which begin n floats apart */
CS_INLINE struct vectors get3(const float *from, size_t n) {
    return (struct vectors){get(from), get(from + n), get(from + 2 * n)};
}
CS_INLINE void put3(float *to, size_t n, struct vectors v) {
    put(to, v.x);
    put(to + n, v.y);
    put(to + 2 * n, v.z);
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
CS_INLINE struct vectors gather3(const float *from, size_t n, const uint32_t *places) {
    float rows[3 * CS_LANES];
    for (size_t l = 0; l < CS_LANES; l++) {
        rows[l] = from[places[l]];
        rows[CS_LANES + l] = from[n + places[l]];
        rows[2 * CS_LANES + l] = from[2 * n + places[l]];
    }
    return get3(rows, CS_LANES);
}

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
CS_INLINE struct vectors times(struct lane_blocks b, struct vectors p) {
    return (struct vectors){b.xx * p.x + b.xy * p.y + b.xz * p.z,
                            b.xy * p.x + b.yy * p.y + b.yz * p.z,
                            b.xz * p.x + b.yz * p.y + b.zz * p.z};
}

#endif

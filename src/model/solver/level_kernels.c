/* level_kernels.c - the loops over the cells of one multigrid level in single precision.
 *
 * A sweep fuses product, residual and smoother: one pass over the springs, which take 96 of the
 * 172 bytes of a first-level cell. CS_WIDTH cells are computed at a time. Each lane has its own
 * arithmetic, and results do not depend on the width. The file is compiled for two: with AVX2 a
 * vector of 16 floats lies in memory, and a sweep takes 1.4 times as long as with vectors of 8;
 * AVX-512 loses 1.5 times by these (docs/notes/smoother-and-memory.md). */
#include "model/solver/level_kernels.h"

#include "model/solver/extra_springs.h"

#include <clothsim/clones.h>
#include <clothsim/small.h>

enum {
    AHEAD = 256,  /* distance of prefetches in cells; chosen by trial */
    BIG = 1 << 14 /* levels with more cells do not fit the cache, and prefetch */
};

/* The calling convention for such vectors depends on the instruction set. That does not matter,
 * because every function that takes or returns them is inlined. */
#pragma GCC diagnostic ignored "-Wpsabi"

/* One number of each of CS_WIDTH cells. */
typedef float lanes __attribute__((vector_size(4 * CS_WIDTH)));
/* The same at any address in an array of floats. */
typedef float unaligned_lanes __attribute__((vector_size(4 * CS_WIDTH), aligned(4), may_alias));

/* Vectors, component by component. */
struct vectors {
    lanes x, y, z;
};
/* Symmetric 3x3 blocks. */
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
/* Reads the vectors of cells anywhere in an array (3,n). */
CS_INLINE struct vectors gather3(const float *from, size_t n, const uint32_t *places) {
    float rows[3 * CS_WIDTH];
    for (size_t l = 0; l < CS_WIDTH; l++) {
        rows[l] = from[places[l]];
        rows[CS_WIDTH + l] = from[n + places[l]];
        rows[2 * CS_WIDTH + l] = from[2 * n + places[l]];
    }
    return get3(rows, CS_WIDTH);
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

/* (s I + w w^T) p for springs whose numbers lie n floats apart. */
CS_INLINE struct vectors factored_times(const float *spring, size_t n, struct vectors p) {
    const lanes s = get(spring);
    const struct vectors w = get3(spring + n, n);
    const lanes along = w.x * p.x + w.y * p.y + w.z * p.z;
    return (struct vectors){s * p.x + along * w.x, s * p.y + along * w.y,
                            s * p.z + along * w.z};
}

/* y += the products of a mesh's springs at the cells from i on, slot by slot. */
CS_INLINE struct vectors add_lists(const struct cs_level *level, size_t i, const float *p,
                                   struct vectors here, struct vectors y) {
    const uint32_t *starts = level->starts + i / CS_LANES;
    const size_t lane = i % CS_LANES;
    for (size_t k = starts[0]; k < starts[1]; k++) {
        const struct vectors there =
            gather3(p, level->stride, level->neighbours + k * CS_LANES + lane);
        const struct lane_blocks b = get6(level->springs + k * 6 * CS_LANES + lane, CS_LANES);
        y = plus(y, times(b, minus(here, there)));
    }
    return y;
}

/* Prefetches the springs of cells to come. Each step and component is a stream of its own: 24
 * with six factored or four full kinds of springs, which is more than the processor's
 * prefetcher follows. */
CS_INLINE void fetch_springs(const struct cs_level *level, size_t i) {
    const size_t at = i + AHEAD < level->n ? i + AHEAD : i;
    const size_t rows = level->n_neighbour_offsets * (cs_level_is_factored(level) ? 4 : 6);
    for (size_t c = 0; c < rows; c++)
        __builtin_prefetch(level->springs + c * level->n + at);
}

/* y += the products of a grid's springs at the cells from i on. Every step gives two: the
 * spring that begins here (offset +step) and the one that ends here, which is stored at cell i
 * - step. */
CS_INLINE struct vectors add_steps(const struct cs_level *level, const bool factored, size_t i,
                                   const float *p, struct vectors here, struct vectors y) {
    const size_t n = level->n;
    const float *spring = level->springs + i;
    for (uint32_t s = 0; s < level->n_neighbour_offsets; s++) {
        const size_t step = level->neighbour_offsets[s];
        const struct vectors ahead = minus(here, get3(p + i + step, level->stride));
        const struct vectors back = minus(here, get3(p + i - step, level->stride));
        if (factored) {
            y = plus(y, factored_times(spring, n, ahead));
            y = plus(y, factored_times(spring - step, n, back));
        } else {
            y = plus(y, times(get6(spring, n), ahead));
            y = plus(y, times(get6(spring - step, n), back));
        }
        spring += (factored ? 4 : 6) * n;
    }
    return y;
}

/* Returns A p of the cells from i on, where p is `here`. The form is a constant of every
 * caller, so the compiler removes the tests. */
CS_INLINE struct vectors product(const struct cs_level *level, const enum cs_level_form form,
                                 size_t i, const float *p, struct vectors here) {
    if (form == CS_LEVEL_FACTORED) {
        const lanes mass = get(level->diagonal + i);
        const struct vectors y = {mass * here.x, mass * here.y, mass * here.z};
        return add_steps(level, true, i, p, here, y);
    }
    const struct vectors y = times(get6(level->diagonal + i, level->n), here);
    return form == CS_LEVEL_MESH
               ? add_lists(level, i, p, here, y)
               : add_steps(level, form == CS_LEVEL_FACTORED_BLOCKS, i, p, here, y);
}

/* One sweep: residual -= A d, and, unless e is NULL, e = a d + b D^-1 residual, solution += e.
 */
CS_INLINE void sweep_form(const struct cs_level_loop *loop, const enum cs_level_form form,
                          size_t begin, size_t end) {
    struct cs_level *level = loop->level;
    const size_t n = level->n, stride = level->stride;
    const bool fetches = loop->fetches && form != CS_LEVEL_MESH && n > BIG;
    for (size_t i = begin; i < end; i += CS_WIDTH) {
        if (fetches && i % CS_LANES == 0)
            fetch_springs(level, i);
        const struct vectors d = get3(loop->d + i, stride);
        const struct vectors r =
            minus(get3(level->residual + i, stride), product(level, form, i, loop->d, d));
        put3(level->residual + i, stride, r);
        if (!loop->e)
            continue;
        const struct vectors z = times(get6(level->inverse + i, n), r);
        const struct vectors e = plus(scaled(loop->a, d), scaled(loop->b, z));
        put3(loop->e + i, stride, e);
        put3(level->solution + i, stride, plus(get3(level->solution + i, stride), e));
    }
}

/* Subtracts the extra springs' part of A d from the residual of the cells that have any. It
 * runs before the sweep of the same block, which then reads the updated residual.
 */
CS_INLINE void subtract_extra(const struct cs_level_loop *loop, size_t begin, size_t end) {
    struct cs_level *level = loop->level;
    const size_t n = level->stride;
    const float *joint = loop->d - level->first;
    for (size_t i = begin; i < end; i += CS_WIDTH) {
        const struct cs_extra_springs_slots slots =
            cs_extra_springs_of(level->extra_springs, i / CS_LANES);
        const size_t lane = i % CS_LANES;
        if (!slots.n)
            continue;
        const struct vectors here = get3(loop->d + i, n);
        struct vectors r = get3(level->residual + i, n);
        for (size_t k = 0; k < slots.n; k++) {
            const struct vectors there = gather3(joint, n, slots.cells + k * CS_LANES + lane);
            const struct lane_blocks b =
                get6(slots.springs + k * 6 * CS_LANES + lane, CS_LANES);
            r = minus(r, times(b, minus(here, there)));
        }
        put3(level->residual + i, n, r);
    }
}

/* Dispatches to a copy of the sweep for each form. */
CS_CLONES static void sweep(const struct cs_level_loop *loop, size_t begin, size_t end) {
    const enum cs_level_form form = loop->level->form;
    if (loop->level->extra_springs && loop->level->extra_springs->is_nonempty)
        subtract_extra(loop, begin, end);
    if (form == CS_LEVEL_FACTORED)
        sweep_form(loop, CS_LEVEL_FACTORED, begin, end);
    else if (form == CS_LEVEL_FACTORED_BLOCKS)
        sweep_form(loop, CS_LEVEL_FACTORED_BLOCKS, begin, end);
    else if (form == CS_LEVEL_GRID_BLOCKS)
        sweep_form(loop, CS_LEVEL_GRID_BLOCKS, begin, end);
    else
        sweep_form(loop, CS_LEVEL_MESH, begin, end);
}

/* The first move of a smoother from 0: solution = e = b D^-1 residual. No product is needed. */
CS_CLONES static void start(const struct cs_level_loop *loop, size_t begin, size_t end) {
    struct cs_level *level = loop->level;
    const size_t n = level->n, stride = level->stride;
    for (size_t i = begin; i < end; i += CS_WIDTH) {
        const struct vectors z =
            times(get6(level->inverse + i, n), get3(level->residual + i, stride));
        put3(loop->e + i, stride, scaled(loop->b, z));
        put3(level->solution + i, stride, scaled(loop->b, z));
    }
}

/* s I + w w^T of springs. */
CS_INLINE struct lane_blocks expanded(const float *spring, size_t n) {
    const lanes s = get(spring);
    const struct vectors w = get3(spring + n, n);
    return (struct lane_blocks){s + w.x * w.x, w.x * w.y, w.x * w.z,
                                s + w.y * w.y, w.y * w.z, s + w.z * w.z};
}

/* Sums the springs' blocks at the cells from i on: their part of D. */
CS_INLINE struct lane_blocks sum_springs(const struct cs_level *level, size_t i) {
    const size_t n = level->n;
    struct lane_blocks sum = {0};
    if (level->form == CS_LEVEL_MESH) {
        const uint32_t *starts = level->starts + i / CS_LANES;
        for (size_t k = starts[0]; k < starts[1]; k++)
            sum = plus6(sum, get6(level->springs + k * 6 * CS_LANES + i % CS_LANES, CS_LANES));
        return sum;
    }
    const bool factored = cs_level_is_factored(level);
    const float *spring = level->springs + i;
    for (uint32_t s = 0; s < level->n_neighbour_offsets; s++) {
        const float *back = spring - level->neighbour_offsets[s];
        sum = plus6(sum, factored ? expanded(spring, n) : get6(spring, n));
        sum = plus6(sum, factored ? expanded(back, n) : get6(back, n));
        spring += (factored ? 4 : 6) * n;
    }
    return sum;
}

/* Inverts blocks in place, in double precision: a flat sheet has only its mass across it,
 * and the determinant is a small difference of large products. Dead cells, and blocks that are
 * not positive definite, get 0 and are then left alone by the smoother. */
CS_INLINE void invert_blocks(float *m, size_t n, const float *own) {
    for (size_t l = 0; l < CS_WIDTH; l++) {
        double block[6], cofactors[6];
        for (size_t c = 0; c < 6; c++)
            block[c] = (double)m[c * n + l];
        const double determinant = cs_sym3_cofactors(block, cofactors);
        const bool regular = own[l] > 0 && cs_sym3_is_definite(block, cofactors, determinant);
        const double factor = regular ? 1 / determinant : 0;
        for (size_t c = 0; c < 6; c++)
            m[c * n + l] = (float)(cofactors[c] * factor);
    }
}

/* Sets the inverses of a range of cells. loop->b is the fraction of the trace that D gets on
 * top. */
CS_CLONES static void invert(const struct cs_level_loop *loop, size_t begin, size_t end) {
    struct cs_level *level = loop->level;
    const size_t n = level->n;
    for (size_t i = begin; i < end; i += CS_WIDTH) {
        struct lane_blocks sum = sum_springs(level, i);
        if (level->extra_springs && level->extra_springs->is_nonempty)
            sum = plus6(sum, get6(level->extra_springs->diagonal_share + i, n));
        if (level->form == CS_LEVEL_FACTORED) {
            const lanes mass = get(level->diagonal + i);
            sum.xx += mass, sum.yy += mass, sum.zz += mass;
        } else {
            sum = plus6(sum, get6(level->diagonal + i, n));
        }
        const lanes extra = loop->b * (sum.xx + sum.yy + sum.zz);
        sum.xx += extra, sum.yy += extra, sum.zz += extra;
        put6(level->inverse + i, n, sum);
        invert_blocks(level->inverse + i, n, level->diagonal + i);
    }
}

#define JOIN(a, b)   a##b
#define OF_WIDTH(at) JOIN(cs_level_kernels_, at)
const struct cs_level_kernels OF_WIDTH(CS_WIDTH) = {sweep, start, invert};

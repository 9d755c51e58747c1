/* Kernels of one multigrid level in single precision: product, Chebyshev smoother and inverse
 * diagonal blocks. */
#include "model/solver/multigrid_level.h"

#include "base/pool.h"
#include "model/solver/extra_springs.h"
#include "model/solver/float_lanes.h"
#include "model/solver/wavefront.h"

#include <clothsim/small.h>

enum {
    /* of one block of a loop at least, a whole number of lanes: so few that the blocks of all
     * loops of a smoother stay in a processor's own cache, up to 256 cells a row */
    CELLS = 512,
    CELLS_FEW = 128, /* where threads would else have no blocks to share */
    LOOPS = 4,       /* of a smoother and what follows it at most */
    AHEAD = 256,     /* cells after which numbers are asked for */
    BIG = 1 << 14    /* cells that are not all in that cache */
};

enum cs_status cs_level_alloc(struct cs_level *level, size_t n_numbers, struct cs_arena *arena,
                              struct cs_error *error) {
    const size_t n = level->n, own = level->form == CS_LEVEL_FACTORED ? 1 : 6;
    float **vectors[4] = {&level->residual, &level->solution, &level->correction,
                          &level->correction_next};
    level->springs = cs_arena_alloc_array(arena, n_numbers, sizeof(float), error);
    level->diagonal = cs_arena_alloc_array(arena, own * n, sizeof(float), error);
    level->inverse = cs_arena_alloc_array(arena, 6 * n, sizeof(float), error);
    for (int k = 0; k < 4; k++)
        *vectors[k] = cs_arena_alloc_array(arena, 3 * n, sizeof(float), error);
    return error->status;
}

/* A loop over the cells of a level: d is the last move, e the next one. */
struct loop {
    struct cs_level *level;
    void (*task)(const struct loop *loop, size_t begin, size_t end);
    const float *d;
    float *e; /* NULL: r alone changes */
    float a, b;
    bool fetches; /* the first loop to look at a block's springs */
};

/* loops one after another, each of which looks at the cells around its own */
struct loops {
    struct loop loops[LOOPS];
    uint32_t n, at;
    size_t cells; /* of a block */
};

static void run_block(void *arg, uint32_t number, uint32_t block) {
    const struct loops *loops = arg;
    const struct loop *loop = loops->loops + number;
    const size_t begin = loop->level->begin + block * loops->cells, end = begin + loops->cells;
    loop->task(loop, begin, end < loop->level->end ? end : loop->level->end);
}

static void run_block_of_one(void *arg, uint32_t block) {
    run_block(arg, ((const struct loops *)arg)->at, block);
}

/* so many that no spring of a grid reaches beyond the next block */
static size_t cells_of_block(const struct cs_level *level) {
    const uint32_t threads = cs_pool_threads();
    const bool few = threads > 1 && level->end - level->begin < 2 * LOOPS * threads * CELLS;
    size_t cells = few ? CELLS_FEW : CELLS;
    for (uint32_t s = 0; s < level->n_neighbour_offsets; s++)
        cells = level->neighbour_offsets[s] > cells ? level->neighbour_offsets[s] : cells;
    return (cells + CS_LANES - 1) / CS_LANES * CS_LANES;
}

/* a mesh, and a body that meets itself */
static bool has_neighbours_anywhere(const struct cs_level *level) {
    return level->form == CS_LEVEL_MESH ||
           (level->extra_springs && level->extra_springs->is_nonempty);
}

/* where neighbours are anywhere, one loop after the other */
static void run(struct loops *loops) {
    const struct cs_level *level = loops->loops->level;
    loops->cells = cells_of_block(level);
    const uint32_t blocks =
        (uint32_t)((level->end - level->begin + loops->cells - 1) / loops->cells);
    if (!has_neighbours_anywhere(level))
        cs_wavefront_run(&(struct cs_wavefront){loops->n, blocks, run_block, loops});
    else
        for (loops->at = 0; loops->at < loops->n; loops->at++)
            cs_pool_run(blocks, run_block_of_one, loops);
}

static void run_one(struct loop loop) {
    run(&(struct loops){.loops = {loop}, .n = 1});
}

/* (s I + w w^T) p */
CS_INLINE struct vectors factored_times(const float *spring, size_t n, struct vectors p) {
    const lanes s = get(spring);
    const struct vectors w = get3(spring + n, n);
    const lanes along = w.x * p.x + w.y * p.y + w.z * p.z;
    return (struct vectors){s * p.x + along * w.x, s * p.y + along * w.y,
                            s * p.z + along * w.z};
}

CS_INLINE struct vectors add_lists(const struct cs_level *level, size_t i, const float *p,
                                   struct vectors here, struct vectors y) {
    const uint32_t *starts = level->starts + i / CS_LANES;
    for (size_t k = starts[0]; k < starts[1]; k++) {
        const struct vectors there = gather3(p, level->n, level->neighbours + k * CS_LANES);
        const struct lane_blocks b = get6(level->springs + k * 6 * CS_LANES, CS_LANES);
        y = plus(y, times(b, minus(here, there)));
    }
    return y;
}

/* Asks for the springs of cells to come: a row of a kind is a stream of its own, and so many
 * streams at once are more than processors follow by themselves. */
CS_INLINE void fetch_springs(const struct cs_level *level, size_t i) {
    const size_t at = i + AHEAD < level->n ? i + AHEAD : i;
    const size_t rows = level->n_neighbour_offsets * (cs_level_is_factored(level) ? 4 : 6);
    for (size_t c = 0; c < rows; c++)
        __builtin_prefetch(level->springs + c * level->n + at);
}

/* springs that begin here, and springs that end here */
CS_INLINE struct vectors add_steps(const struct cs_level *level, const bool factored, size_t i,
                                   const float *p, struct vectors here, struct vectors y) {
    const size_t n = level->n;
    const float *spring = level->springs + i;
    for (uint32_t s = 0; s < level->n_neighbour_offsets; s++) {
        const size_t step = level->neighbour_offsets[s];
        const struct vectors ahead = minus(here, get3(p + i + step, n));
        const struct vectors back = minus(here, get3(p + i - step, n));
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

/* A p of the 16 cells from i on, where p is `here` */
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

/* r -= A d, and where that is not all: e = a d + b D^-1 r, x += e */
CS_INLINE void sweep_form(const struct loop *loop, const enum cs_level_form form, size_t begin,
                          size_t end) {
    struct cs_level *level = loop->level;
    const size_t n = level->n;
    const bool fetches = loop->fetches && form != CS_LEVEL_MESH && n > BIG;
    for (size_t i = begin; i < end; i += CS_LANES) {
        if (fetches)
            fetch_springs(level, i);
        const struct vectors d = get3(loop->d + i, n);
        const struct vectors r =
            minus(get3(level->residual + i, n), product(level, form, i, loop->d, d));
        put3(level->residual + i, n, r);
        if (!loop->e)
            continue;
        const struct vectors z = times(get6(level->inverse + i, n), r);
        const struct vectors e = plus(scaled(loop->a, d), scaled(loop->b, z));
        put3(loop->e + i, n, e);
        put3(level->solution + i, n, plus(get3(level->solution + i, n), e));
    }
}

/* r -= the links' share of A d, of those cells that have any */
CS_INLINE void alloc_links(const struct loop *loop, size_t begin, size_t end) {
    struct cs_level *level = loop->level;
    const size_t n = level->n;
    for (size_t i = begin; i < end; i += CS_LANES) {
        const struct cs_extra_springs_slots slots =
            cs_extra_springs_of(level->extra_springs, i / CS_LANES);
        if (!slots.n)
            continue;
        const struct vectors here = get3(loop->d + i, n);
        struct vectors r = get3(level->residual + i, n);
        for (size_t k = 0; k < slots.n; k++) {
            const struct vectors there = gather3(loop->d, n, slots.cells + k * CS_LANES);
            const struct lane_blocks b = get6(slots.springs + k * 6 * CS_LANES, CS_LANES);
            r = minus(r, times(b, minus(here, there)));
        }
        put3(level->residual + i, n, r);
    }
}

/* a copy of the loop for every form */
CS_CLONES static void sweep(const struct loop *loop, size_t begin, size_t end) {
    const enum cs_level_form form = loop->level->form;
    if (loop->level->extra_springs && loop->level->extra_springs->is_nonempty)
        alloc_links(loop, begin, end);
    if (form == CS_LEVEL_FACTORED)
        sweep_form(loop, CS_LEVEL_FACTORED, begin, end);
    else if (form == CS_LEVEL_FACTORED_BLOCKS)
        sweep_form(loop, CS_LEVEL_FACTORED_BLOCKS, begin, end);
    else if (form == CS_LEVEL_GRID_BLOCKS)
        sweep_form(loop, CS_LEVEL_GRID_BLOCKS, begin, end);
    else
        sweep_form(loop, CS_LEVEL_MESH, begin, end);
}

void cs_level_subtract_product(struct cs_level *level) {
    run_one(
        (struct loop){.level = level, .task = sweep, .d = level->correction, .fetches = true});
}

/* x = e = b D^-1 r */
CS_CLONES static void start(const struct loop *loop, size_t begin, size_t end) {
    struct cs_level *level = loop->level;
    const size_t n = level->n;
    for (size_t i = begin; i < end; i += CS_LANES) {
        const struct vectors z =
            times(get6(level->inverse + i, n), get3(level->residual + i, n));
        put3(loop->e + i, n, scaled(loop->b, z));
        put3(level->solution + i, n, scaled(loop->b, z));
    }
}

/* Chebyshev's iteration (Saad 2003, alg. 12.1): with t = 7/6 and h = 5/6 the centre and half
 * the length of [1/3, 2] and c = t / h, the first move is D^-1 r / t, and the next ones are
 * q' q d + 2 q' / h D^-1 r with q' = 1 / (2 c - q) after q, from q = 1 / c on. */
static const float first_gain = 6 / 7.0F;
static const struct {
    float a, b;
} gains[2] = {{25 / 73.0F, 84 / 73.0F}, {350 / 1694.0F, 1752 / 1694.0F}};

void cs_level_smooth_down(struct cs_level *level) {
    float *d = level->correction, *e = level->correction_next;
    run(&(struct loops){.loops = {{level, start, NULL, d, 0, first_gain, false},
                                  {level, sweep, d, e, gains[0].a, gains[0].b, true},
                                  {level, sweep, e, d, gains[1].a, gains[1].b, false},
                                  {level, sweep, d, NULL, 0, 0, false}},
                        .n = 4});
}

void cs_level_smooth_up(struct cs_level *level) {
    float *d = level->correction, *e = level->correction_next;
    run(&(struct loops){.loops = {{level, sweep, d, e, 0, first_gain, true},
                                  {level, sweep, e, d, gains[0].a, gains[0].b, false},
                                  {level, sweep, d, e, gains[1].a, gains[1].b, false}},
                        .n = 3});
}

void cs_level_solve_diagonal(struct cs_level *level) {
    run_one((struct loop){.level = level, .task = start, .e = level->correction, .b = 1});
}

CS_INLINE struct lane_blocks expanded(const float *spring, size_t n) {
    const lanes s = get(spring);
    const struct vectors w = get3(spring + n, n);
    return (struct lane_blocks){s + w.x * w.x, w.x * w.y, w.x * w.z,
                                s + w.y * w.y, w.y * w.z, s + w.z * w.z};
}

/* the springs' blocks of the 16 cells from i on, added up */
CS_INLINE struct lane_blocks sum_springs(const struct cs_level *level, size_t i) {
    const size_t n = level->n;
    struct lane_blocks sum = {0};
    if (level->form == CS_LEVEL_MESH) {
        const uint32_t *starts = level->starts + i / CS_LANES;
        for (size_t k = starts[0]; k < starts[1]; k++)
            sum = plus6(sum, get6(level->springs + k * 6 * CS_LANES, CS_LANES));
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

/* the 16 blocks at m, in double: a flat sheet has only its mass across, and the determinant is
 * a small difference. 0 where a cell is dead */
CS_INLINE void invert_blocks(float *m, size_t n, const float *own) {
    for (size_t l = 0; l < CS_LANES; l++) {
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

CS_CLONES static void invert(const struct loop *loop, size_t begin, size_t end) {
    struct cs_level *level = loop->level;
    const size_t n = level->n;
    for (size_t i = begin; i < end; i += CS_LANES) {
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

void cs_level_invert(struct cs_level *level) {
    run_one((struct loop){.level = level, .task = invert, .b = 1.0F / (1 << 20)});
}

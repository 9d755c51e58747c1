/* Kernels of one multigrid level in single precision: product, Chebyshev smoother and inverse
 * diagonal blocks.
 *
 * A sweep fuses product, residual and smoother: one pass over the springs, which take 96 of the
 * 172 bytes of a first-level cell. The sweeps of a smoother run as a wavefront (wavefront.h). A
 * level that does not fit the cache is therefore fetched about once per smoother, not once per
 * sweep. CS_LANES = 16 cells are computed at a time. Each lane has its own arithmetic, and
 * results do not depend on the vector width. */
#include "model/solver/multigrid_hierarchy.h"

#include "base/pool.h"
#include "model/solver/extra_springs.h"
#include "model/solver/float_lanes.h"
#include "model/solver/wavefront.h"

#include <clothsim/small.h>

enum {
    /* Smallest block of a loop, in cells, a multiple of CS_LANES. Up to 256 cells per row, the
     * blocks at work in all loops of a smoother fit a processor's own cache (measured with
     * 1 MiB per processor, docs/notes). */
    CELLS = 512,
    CELLS_FEW = 128, /* the same on levels that would have too few blocks for the threads */
    LOOPS = 4,       /* most loops of a smoother, with its last product */
    AHEAD = 256,     /* distance of prefetches in cells; chosen by trial */
    BIG = 1 << 14    /* levels with more cells do not fit that cache, and prefetch */
};

enum cs_status cs_level_alloc(struct cs_level *level, size_t n_numbers, struct cs_arena *arena,
                              struct cs_error *error) {
    const size_t n = level->n, own = level->form == CS_LEVEL_FACTORED ? 1 : 6;
    level->springs = cs_arena_alloc_array(arena, n_numbers, sizeof(float), error);
    level->diagonal = cs_arena_alloc_array(arena, own * n, sizeof(float), error);
    level->inverse = cs_arena_alloc_array(arena, 6 * n, sizeof(float), error);
    return error->status;
}

/* One loop over the cells of a level. d is the last correction, e the next one. */
struct loop {
    struct cs_level *level;
    void (*task)(const struct loop *loop, size_t begin, size_t end);
    const float *d;
    float *e;     /* NULL: only the residual changes */
    float a, b;   /* gains: e = a d + b D^-1 r */
    bool fetches; /* the first loop to read a block's springs, which prefetches them */
};

/* Dependent loops in their order: each reads what its predecessor wrote in the neighbouring
 * blocks. */
struct loops {
    struct loop loops[LOOPS];
    uint32_t n, at; /* number of loops; the one that runs, if they run one by one */
    size_t cells;   /* per block */
};

/* Runs one loop on one block of cells. */
static void run_block(void *arg, uint32_t number, uint32_t block) {
    const struct loops *loops = arg;
    const struct loop *loop = loops->loops + number;
    const size_t begin = loop->level->begin + block * loops->cells, end = begin + loops->cells;
    loop->task(loop, begin, end < loop->level->end ? end : loop->level->end);
}

/* The same for loops that run one by one. */
static void run_block_of_one(void *arg, uint32_t block) {
    run_block(arg, ((const struct loops *)arg)->at, block);
}

/* Cells per block. No spring of a grid may reach beyond the next block, because a wavefront
 * only guarantees the two neighbours. Small levels get small blocks if there are threads to
 * share them. */
static size_t cells_of_block(const struct cs_level *level) {
    const uint32_t threads = cs_pool_threads();
    const bool few = threads > 1 && level->end - level->begin < 2 * LOOPS * threads * CELLS;
    size_t cells = few ? CELLS_FEW : CELLS;
    for (uint32_t s = 0; s < level->n_neighbour_offsets; s++)
        cells = level->neighbour_offsets[s] > cells ? level->neighbour_offsets[s] : cells;
    return (cells + CS_LANES - 1) / CS_LANES * CS_LANES;
}

/* Tells whether springs may join any two cells: in a mesh, and with extra springs. */
static bool has_neighbours_anywhere(const struct cs_level *level) {
    return level->form == CS_LEVEL_MESH ||
           (level->extra_springs && level->extra_springs->is_nonempty);
}

/* Sets the cells per block, and returns the number of blocks. */
static uint32_t cut(struct loops *loops) {
    const struct cs_level *level = loops->loops->level;
    loops->cells = cells_of_block(level);
    return (uint32_t)((level->end - level->begin + loops->cells - 1) / loops->cells);
}

/* Runs one of the loops. */
static void run_number(struct loops *loops, uint32_t number) {
    loops->at = number;
    cs_pool_run(cut(loops), run_block_of_one, loops);
}

/* Runs the loops as a wavefront if springs are short, else one after the other. */
static void run(struct loops *loops) {
    if (has_neighbours_anywhere(loops->loops->level))
        for (uint32_t k = 0; k < loops->n; k++)
            run_number(loops, k);
    else
        cs_wavefront_run(&(struct cs_wavefront){loops->n, cut(loops), run_block, loops});
}

/* Runs a single loop over all blocks. */
static void run_one(struct loop loop) {
    run(&(struct loops){.loops = {loop}, .n = 1});
}

bool cs_level_is_coupled(const struct cs_level_group *group) {
    bool coupled = false;
    for (uint32_t b = 0; b < group->n && group->n > 1; b++)
        coupled = coupled || (group->levels[b]->extra_springs &&
                              group->levels[b]->extra_springs->is_nonempty);
    return coupled;
}

/* Runs the loops of all bodies: body after body, or, if these are coupled, loop after loop. */
static void run_group(const struct cs_level_group *group,
                      struct loops (*loops_of)(struct cs_level *level)) {
    struct loops loops = loops_of(group->levels[0]);
    const uint32_t rounds = cs_level_is_coupled(group) ? loops.n : 1;
    for (uint32_t round = 0; round < rounds; round++)
        for (uint32_t b = 0; b < group->n; b++) {
            loops = loops_of(group->levels[b]);
            if (rounds == 1)
                run(&loops);
            else
                run_number(&loops, round);
        }
}

/* (s I + w w^T) p for 16 springs, whose numbers lie n floats apart. */
CS_INLINE struct vectors factored_times(const float *spring, size_t n, struct vectors p) {
    const lanes s = get(spring);
    const struct vectors w = get3(spring + n, n);
    const lanes along = w.x * p.x + w.y * p.y + w.z * p.z;
    return (struct vectors){s * p.x + along * w.x, s * p.y + along * w.y,
                            s * p.z + along * w.z};
}

/* y += the products of a mesh's springs at the cells i to i + 15, slot by slot. */
CS_INLINE struct vectors add_lists(const struct cs_level *level, size_t i, const float *p,
                                   struct vectors here, struct vectors y) {
    const uint32_t *starts = level->starts + i / CS_LANES;
    for (size_t k = starts[0]; k < starts[1]; k++) {
        const struct vectors there =
            gather3(p, level->stride, level->neighbours + k * CS_LANES);
        const struct lane_blocks b = get6(level->springs + k * 6 * CS_LANES, CS_LANES);
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

/* y += the products of a grid's springs at the cells i to i + 15. Every step gives two: the
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

/* Returns A p of the cells i to i + 15, where p is `here`. The form is a constant of every
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
CS_INLINE void sweep_form(const struct loop *loop, const enum cs_level_form form, size_t begin,
                          size_t end) {
    struct cs_level *level = loop->level;
    const size_t n = level->n, stride = level->stride;
    const bool fetches = loop->fetches && form != CS_LEVEL_MESH && n > BIG;
    for (size_t i = begin; i < end; i += CS_LANES) {
        if (fetches)
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

/* Subtracts the extra springs' part of A d from the residual of 16 cells at a time, where there
 * are any. It runs before the sweep of the same block, which then reads the updated residual.
 */
CS_INLINE void alloc_links(const struct loop *loop, size_t begin, size_t end) {
    struct cs_level *level = loop->level;
    const size_t n = level->stride;
    const float *joint = loop->d - level->first;
    for (size_t i = begin; i < end; i += CS_LANES) {
        const struct cs_extra_springs_slots slots =
            cs_extra_springs_of(level->extra_springs, i / CS_LANES);
        if (!slots.n)
            continue;
        const struct vectors here = get3(loop->d + i, n);
        struct vectors r = get3(level->residual + i, n);
        for (size_t k = 0; k < slots.n; k++) {
            const struct vectors there = gather3(joint, n, slots.cells + k * CS_LANES);
            const struct lane_blocks b = get6(slots.springs + k * 6 * CS_LANES, CS_LANES);
            r = minus(r, times(b, minus(here, there)));
        }
        put3(level->residual + i, n, r);
    }
}

/* Dispatches to a copy of the sweep for each form. */
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

/* The first move of a smoother from 0: solution = e = b D^-1 residual. No product is needed. */
CS_CLONES static void start(const struct loop *loop, size_t begin, size_t end) {
    struct cs_level *level = loop->level;
    const size_t n = level->n, stride = level->stride;
    for (size_t i = begin; i < end; i += CS_LANES) {
        const struct vectors z =
            times(get6(level->inverse + i, n), get3(level->residual + i, stride));
        put3(loop->e + i, stride, scaled(loop->b, z));
        put3(level->solution + i, stride, scaled(loop->b, z));
    }
}

/* Gains of Chebyshev's iteration (Saad 2003, algorithm 12.1) on [1/3, 2], whose centre is t =
 * 7/6 and half of whose length is h = 5/6. With c = t / h = 7/5 the first move is D^-1 r / t.
 * The next ones are
 *
 *   d' = q' q d + (2 q' / h) D^-1 r,   q' = 1 / (2 c - q),   q0 = 1 / c
 *
 * which gives q = 5/7, 35/73, 365/847, and from them the fractions below. */
static const float first_gain = 6 / 7.0F;
/* The second and the third move: a and b of e = a d + b D^-1 r. */
static const struct {
    float a, b;
} gains[2] = {{25 / 73.0F, 84 / 73.0F}, {350 / 1694.0F, 1752 / 1694.0F}};

/* Three moves from the start 0, and the product that makes the residual for the next level. */
static struct loops loops_down(struct cs_level *level) {
    float *d = level->correction, *e = level->correction_next;
    return (struct loops){.loops = {{level, start, NULL, d, 0, first_gain, false},
                                    {level, sweep, d, e, gains[0].a, gains[0].b, true},
                                    {level, sweep, e, d, gains[1].a, gains[1].b, false},
                                    {level, sweep, d, NULL, 0, 0, false}},
                          .n = 4};
}

void cs_level_smooth_down(const struct cs_level_group *group) {
    run_group(group, loops_down);
}

/* The first sweep subtracts the product with the coarse correction and makes the first move (a
 * = 0: Chebyshev's iteration starts again). The last residual is not needed. */
static struct loops loops_up(struct cs_level *level) {
    float *d = level->correction, *e = level->correction_next;
    return (struct loops){.loops = {{level, sweep, d, e, 0, first_gain, true},
                                    {level, sweep, e, d, gains[0].a, gains[0].b, false},
                                    {level, sweep, d, e, gains[1].a, gains[1].b, false}},
                          .n = 3};
}

void cs_level_smooth_up(const struct cs_level_group *group) {
    run_group(group, loops_up);
}

/* `start` with the gain 1. */
void cs_level_solve_diagonal(struct cs_level *level) {
    run_one((struct loop){.level = level, .task = start, .e = level->correction, .b = 1});
}

/* s I + w w^T of 16 springs. */
CS_INLINE struct lane_blocks expanded(const float *spring, size_t n) {
    const lanes s = get(spring);
    const struct vectors w = get3(spring + n, n);
    return (struct lane_blocks){s + w.x * w.x, w.x * w.y, w.x * w.z,
                                s + w.y * w.y, w.y * w.z, s + w.z * w.z};
}

/* Sums the springs' blocks at the cells i to i + 15: their part of D. */
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

/* Inverts 16 blocks in place, in double precision: a flat sheet has only its mass across it,
 * and the determinant is a small difference of large products. Dead cells, and blocks that are
 * not positive definite, get 0 and are then left alone by the smoother. */
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

/* Sets the inverses of a range of cells. loop->b is the fraction of the trace that D gets on
 * top. */
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

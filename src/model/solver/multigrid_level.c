/* One multigrid level: product, Chebyshev smoother and inverse diagonal blocks, as loops over
 * its cells (level_kernels.h).
 *
 * The sweeps of a smoother run as a wavefront (level_kernels.h). A level that does not fit the
 * cache is therefore fetched about once per smoother, not once per sweep. */
#include "model/solver/level_kernels.h"

#include "base/pool.h"
#include "model/solver/extra_springs.h"

enum {
    /* Smallest block of a loop, in cells, a multiple of CS_LANES. Up to 256 cells per row, the
     * blocks at work in all loops of a smoother fit a processor's own cache (measured with
     * 1 MiB per processor, docs/notes). */
    CELLS = 512,
    CELLS_FEW = 128, /* the same on levels that would have too few blocks for the threads */
    LOOPS = 4        /* most loops of a smoother, with its last product */
};

/* The kernels of the width at which this processor is fastest. */
static const struct cs_level_kernels *kernels(void) {
#if defined(__x86_64__) && defined(__GNUC__)
    if (__builtin_cpu_supports("avx512vl"))
        return &cs_level_kernels_16;
#endif
    return &cs_level_kernels_8;
}

enum cs_status cs_level_alloc(struct cs_level *level, size_t n_numbers, struct cs_arena *arena,
                              struct cs_error *error) {
    const size_t n = level->n, own = level->form == CS_LEVEL_FACTORED ? 1 : 6;
    level->springs = cs_arena_alloc_array(arena, n_numbers, sizeof(float), error);
    level->diagonal = cs_arena_alloc_array(arena, own * n, sizeof(float), error);
    level->inverse = cs_arena_alloc_array(arena, 6 * n, sizeof(float), error);
    return error->status;
}

/* Dependent loops in their order: each reads what its predecessor wrote in the neighbouring
 * blocks. */
struct loops {
    struct cs_level_loop loops[LOOPS];
    uint32_t n, at; /* number of loops; the one that runs, if they run one by one */
    size_t cells;   /* per block */
};

/* Runs one loop on one block of cells. */
static void run_block(void *arg, uint32_t number, uint32_t block) {
    const struct loops *loops = arg;
    const struct cs_level_loop *loop = loops->loops + number;
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
static void run_one(struct cs_level_loop loop) {
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

void cs_level_subtract_product(struct cs_level *level) {
    run_one((struct cs_level_loop){
        .level = level, .task = kernels()->sweep, .d = level->correction, .fetches = true});
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
    const struct cs_level_kernels *of = kernels();
    float *d = level->correction, *e = level->correction_next;
    return (struct loops){.loops = {{level, of->start, NULL, d, 0, first_gain, false},
                                    {level, of->sweep, d, e, gains[0].a, gains[0].b, true},
                                    {level, of->sweep, e, d, gains[1].a, gains[1].b, false},
                                    {level, of->sweep, d, NULL, 0, 0, false}},
                          .n = 4};
}

void cs_level_smooth_down(const struct cs_level_group *group) {
    run_group(group, loops_down);
}

/* The first sweep subtracts the product with the coarse correction and makes the first move (a
 * = 0: Chebyshev's iteration starts again). The last residual is not needed. */
static struct loops loops_up(struct cs_level *level) {
    const struct cs_level_kernels *of = kernels();
    float *d = level->correction, *e = level->correction_next;
    return (struct loops){.loops = {{level, of->sweep, d, e, 0, first_gain, true},
                                    {level, of->sweep, e, d, gains[0].a, gains[0].b, false},
                                    {level, of->sweep, d, e, gains[1].a, gains[1].b, false}},
                          .n = 3};
}

void cs_level_smooth_up(const struct cs_level_group *group) {
    run_group(group, loops_up);
}

/* `start` with the gain 1. */
void cs_level_solve_diagonal(struct cs_level *level) {
    run_one((struct cs_level_loop){
        .level = level, .task = kernels()->start, .e = level->correction, .b = 1});
}

void cs_level_invert(struct cs_level *level) {
    run_one((struct cs_level_loop){
        .level = level, .task = kernels()->invert, .b = 1.0F / (1 << 20)});
}

/* Runs dependent loops over the blocks of an array as one wavefront.
 *
 * In the plane of blocks (across) and loops (up), a stretch is a trapezium and a wedge the
 * triangle between two of them, standing on its tip:
 *
 *   loop 2   ___wwww___      _: done by the stretches
 *   loop 1   ____ww____      w: done by the wedge, after them
 *   loop 0   __________ */

/* Stretches per thread: a late thread leaves some of its own to the others. Chosen by trial. */
enum { STRETCHES = 4 };

/* The wavefront cut into n stretches. */
struct stretches {
    const struct cs_wavefront *wave;
    uint32_t n;
};

/* First block of a stretch; stretches differ by at most one block. */
static uint32_t begin_of(const struct stretches *all, uint32_t stretch) {
    return (uint32_t)((uint64_t)all->wave->n_blocks * stretch / all->n);
}

/* Loop k reaches block b at time b + k: its predecessor has just done block b + 1. At a border
 * with another stretch, loop k stops k blocks before it. */
static void run_stretch(void *arg, uint32_t stretch) {
    const struct stretches *all = arg;
    const struct cs_wavefront *wavefront = all->wave;
    const uint32_t begin = begin_of(all, stretch), end = begin_of(all, stretch + 1);
    const uint32_t left = stretch > 0, right = stretch + 1 < all->n;
    for (uint32_t time = begin; time < end + wavefront->n_loops; time++)
        for (uint32_t k = 0; k < wavefront->n_loops && begin + k <= time; k++) {
            const uint32_t block = time - k;
            if (block >= begin + k * left && block + k * right < end)
                wavefront->step(wavefront->arg, k, block);
        }
}

/* Completes the loops around the border after a stretch: loop k lacks k blocks on either side.
 */
static void run_wedge(void *arg, uint32_t stretch) {
    const struct stretches *all = arg;
    const struct cs_wavefront *wavefront = all->wave;
    const uint32_t middle = begin_of(all, stretch + 1);
    for (uint32_t k = 1; k < wavefront->n_loops; k++)
        for (uint32_t block = middle - k; block < middle + k; block++)
            wavefront->step(wavefront->arg, k, block);
}

/* A stretch has at least 2 n_loops blocks, so that the wedges at its two ends never touch and
 * may run at the same time. */
void cs_wavefront_run(const struct cs_wavefront *wavefront) {
    const uint32_t threads = cs_pool_threads();
    const uint32_t wanted = threads > 1 ? STRETCHES * threads : 1;
    const uint32_t most = wavefront->n_blocks / (2 * wavefront->n_loops);
    struct stretches all = {wavefront, wanted < most ? wanted : most > 1 ? most : 1};
    cs_pool_run(all.n, run_stretch, &all);
    cs_pool_run(all.n - 1, run_wedge, &all);
}

/* Splits the work of a system among threads: particles into blocks, springs of meshes into
 * chunks.
 *
 * A grid's springs reach at most two rows, so a thread computes those of its rows, and those of
 * the rows at its border twice. A mesh's springs reach anywhere; they are computed once, in
 * chunks, into slots, and each thread then gathers the forces on its own particles. */
#include "model/plan.h"

#include "base/pool.h"
#include "scene/body_keys.h"
#include "scene/body_particles.h"

/* Blocks per thread, so that the others can take over the work of one that is held up; and the
 * least particles per block, because springs across borders are computed twice. Chosen by
 * trial. */
enum { BLOCKS = 4, LEAST = 256 };

/* Upper bounds for the arrays of the partition. */
struct sizes {
    size_t particles, runs, blocks;
    size_t listed_runs, listed_springs, starts; /* of meshes */
};

/* Least particles of a block. */
static uint32_t block_size(size_t n, uint32_t threads) {
    const size_t even = (n + BLOCKS * threads - 1) / (BLOCKS * threads);
    return (uint32_t)(even > LEAST ? even : LEAST);
}

/* Counts what the bodies have. */
static struct sizes sizes_of(const struct cs_scene *scene, uint32_t threads) {
    const struct cs_body *bodies = cs_scene_bodies(scene);
    struct sizes sizes = {0};
    for (uint32_t b = 0; b < scene->bodies.n; b++) {
        uint32_t springs = 0;
        const size_t n = (size_t)cs_body_count(bodies + b),
                     runs = cs_springs_of_body(bodies + b, b, 0, NULL, NULL, &springs);
        sizes.particles += n;
        sizes.runs += runs;
        if (!bodies[b].mesh)
            continue;
        sizes.listed_runs += runs;
        sizes.listed_springs += springs;
        sizes.starts += runs * (n + 1);
    }
    /* no block but the last is smaller than block_size */
    sizes.blocks = sizes.particles / block_size(sizes.particles, threads) + 1;
    return sizes;
}

/* End of the block that begins at `begin`: rounded up to a whole row in a grid. */
static uint32_t end_of_block(const struct cs_system *system, uint32_t begin, uint32_t size) {
    if (system->view.n - begin <= size)
        return system->view.n;
    const struct cs_body_range *body = system->bodies;
    while (begin + size > body->first + body->count)
        body++;
    const uint32_t within = begin + size - body->first;
    if (body->mesh)
        return body->first + within;
    return body->first + (within + body->columns - 1) / body->columns * body->columns;
}

/* The block of a particle: binary search. */
static uint32_t find_block(const struct cs_block *blocks, uint32_t n, uint32_t particle) {
    uint32_t low = 0;
    for (uint32_t high = n; high - low > 1;) {
        const uint32_t middle = low + (high - low) / 2;
        *(blocks[middle].begin <= particle ? &low : &high) = middle;
    }
    return low;
}

/* Notes that run r has an end in a block. fan is the first run of its row, or r: a row is
 * evaluated as a whole, so a block starts with its first run. */
static void touch(struct cs_block *block, uint32_t fan, uint32_t r) {
    if (block->end_run == 0)
        block->first_run = fan;
    block->end_run = r + 1;
}

/* Cuts the particles into blocks, and finds the runs that each must evaluate. */
static void build_blocks(struct cs_system *system, const struct sizes *sizes, uint32_t threads,
                         struct cs_error *error) {
    const uint32_t size = block_size(sizes->particles, threads);
    struct cs_springs *springs = &system->springs;
    struct cs_block *blocks =
        cs_arena_alloc_array(&system->arena, sizes->blocks, sizeof *blocks, error);
    if (!blocks)
        return;
    uint32_t n = 0;
    for (uint32_t begin = 0; begin < system->view.n; begin = blocks[n++].end)
        blocks[n] = (struct cs_block){begin, end_of_block(system, begin, size), 0, 0};
    for (uint32_t r = 0, fan = 0; r < springs->n_runs; r++) {
        const struct cs_spring_run *run = springs->runs + r;
        if (!run->columns || run->row != springs->runs[fan].row)
            fan = r;
        const uint32_t last =
            run->ends ? run->first_a + system->bodies[run->body].count - 1 : run->first_b;
        const uint32_t to = find_block(blocks, n, last);
        uint32_t b = find_block(blocks, n, run->first_a);
        touch(blocks + b, fan, r);
        /* a mesh's springs end in all blocks between; a grid's run ends in two rows alone */
        for (b = run->ends ? b + 1 : to; b <= to; b++)
            touch(blocks + b, fan, r);
    }
    springs->blocks = blocks;
    springs->n_blocks = n;
}

/* Lists the springs at each particle, ascending: a counting sort. Counts are stored two places
 * further on, so that filling moves the starts to where they belong. The number of entry e of
 * ends is spring e / 2, end e modulo 2. */
static void list_around(const struct cs_spring_run *run, uint32_t n, uint32_t *starts,
                        uint32_t *around) {
    for (size_t e = 0; e < 2 * (size_t)run->count; e++)
        // the last particle's list needs no start after it
        if (run->ends[e] + 2 <= n)
            starts[run->ends[e] + 2]++;
    for (uint32_t i = 2; i <= n; i++)
        starts[i] += starts[i - 1];
    for (uint32_t e = 0; e < 2 * run->count; e++)
        around[starts[run->ends[e] + 1]++] = e;
}

/* Cuts the springs of meshes into chunks, and makes their slots. */
static void build_chunks(struct cs_system *system, const struct sizes *sizes,
                         struct cs_error *error) {
    struct cs_springs *springs = &system->springs;
    struct cs_arena *arena = &system->arena;
    struct cs_spring_slots *waits =
        cs_arena_alloc_array(arena, sizes->runs, sizeof *waits, error);
    const size_t most_lots = sizes->listed_springs / CS_SPRING_CHUNK_MAX + sizes->listed_runs;
    struct cs_spring_chunk *chunks =
        cs_arena_alloc_array(arena, most_lots, sizeof *chunks, error);
    uint32_t *starts = cs_arena_alloc_array(arena, sizes->starts, sizeof *starts, error);
    uint32_t *around =
        cs_arena_alloc_array(arena, sizes->listed_springs, 2 * sizeof *around, error);
    double *forces =
        cs_arena_alloc_array(arena, sizes->listed_springs, 3 * sizeof *forces, error);
    if (error->status)
        return;
    for (uint32_t r = 0; r < springs->n_runs; r++) {
        const struct cs_spring_run *run = springs->runs + r;
        const uint32_t n = system->bodies[run->body].count;
        if (!run->ends)
            continue;
        /* springs by particle: each thread adds to its own particles, in the springs' order */
        waits[r] = (struct cs_spring_slots){n, starts, around, forces};
        list_around(run, n, starts, around);
        starts += n + 1;
        around += 2 * (size_t)run->count;
        forces += 3 * (size_t)run->count;
        for (uint32_t begin = 0; begin < run->count; begin += CS_SPRING_CHUNK_MAX)
            chunks[springs->n_chunks++] = (struct cs_spring_chunk){
                r, begin,
                run->count - begin < CS_SPRING_CHUNK_MAX ? run->count
                                                         : begin + CS_SPRING_CHUNK_MAX};
    }
    springs->chunks = chunks;
    springs->slots = waits;
}

/* With one thread there is one block of everything, and no slots. */
enum cs_status cs_thread_partition_build(struct cs_system *system, struct cs_error *error) {
    const uint32_t threads = cs_pool_threads();
    system->springs.n_blocks = 1;
    if (threads == 1)
        return CS_OK;
    const struct sizes sizes = sizes_of(system->scene, threads);
    build_blocks(system, &sizes, threads, error);
    CS_ARENA_ARRAY(&system->arena, system->springs.energies, sizes.runs, error);
    if (!error->status && sizes.listed_runs)
        build_chunks(system, &sizes, error);
    return error->status;
}

/* How threads share a system: blocks of whole rows that cover it, runs where they have ends,
 * chunks with every spring once, springs around every particle. */
#include "base/pool.h"
#include "model/plan.h"
#include "scene/scene.h"
#include "sheet.h"

#define CLOTH "{\"cloth\": {\"grid\": [%d, %d]}, \"mass\": {\"total\": 1}}"
#define MESH                                                                                   \
    "{\"mesh\": {\"shape\": \"sphere\", \"detail\": 16}, \"network\": {\"springs\": 2},"       \
    " \"mass\": {\"total\": 1}, \"springs\": {\"bend\": 5}}"

static const uint32_t threads[] = {2, 3, 7, CS_POOL_THREADS_MAX};
static const char *const scenes[] = {
    "{\"bodies\": [" CLOTH "]}",
    "{\"bodies\": [" CLOTH ", " MESH ", " CLOTH ", " MESH "]}",
};
static const int grids[][2] = {{40, 50}, {1, 900}, {900, 1}, {700, 3}, {3, 700}, {2, 2}};
enum {
    SCENES = 2,
    GRIDS = sizeof grids / sizeof *grids,
    THREADS = sizeof threads / sizeof *threads,
    CASES = SCENES * GRIDS * THREADS
};

static void make(struct sheet *sheet, int i, uint32_t n_threads) {
    const int *grid = grids[i % GRIDS], *other = grids[(i + 1) % GRIDS];
    struct cs_error error = {0};
    cs_pool_start(n_threads, &error);
    UNIT_ASSERT_OK(&error);
    if (i < GRIDS)
        sheet_open(sheet, 0, scenes[0], grid[0], grid[1]);
    else
        sheet_open(sheet, 0, scenes[1], grid[0], grid[1], other[0], other[1]);
}

static void unmake(struct sheet *sheet) {
    sheet_close(sheet);
    cs_pool_stop();
}

/* whether a block may begin there: not within a row */
static bool is_border(const struct cs_system *system, uint32_t particle) {
    for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
        const struct cs_body_range *body = system->bodies + b;
        if (particle > body->first && particle < body->first + body->count)
            return body->mesh || (particle - body->first) % body->columns == 0;
    }
    return true;
}

TEST(blocks_cover_whole_rows_and_their_runs) {
    for (int k = 0; k < CASES; k++) {
        struct sheet sheet;
        make(&sheet, k / THREADS, threads[k % THREADS]);
        const struct cs_springs *springs = &sheet.system.springs;
        uint32_t end = 0;
        for (uint32_t b = 0; b < springs->n_blocks; b++) {
            const struct cs_block *block = springs->blocks + b;
            ck_assert_uint_eq(block->begin, end);
            ck_assert_uint_gt(block->end, block->begin);
            ck_assert(is_border(&sheet.system, block->begin));
            end = block->end;
            for (uint32_t r = 0; r < springs->n_runs; r++)
                for (uint32_t i = 0; i < springs->runs[r].count; i++) {
                    const uint32_t ends[2] = {cs_spring_a(springs->runs + r, i),
                                              cs_spring_b(springs->runs + r, i)};
                    for (int e = 0; e < 2; e++)
                        if (ends[e] >= block->begin && ends[e] < block->end &&
                            (r < block->first_run || r >= block->end_run))
                            ck_abort_msg("run %u is not among those of block %u", r, b);
                }
        }
        ck_assert_uint_eq(end, sheet.n);
        unmake(&sheet);
    }
}

TEST(lots_have_each_listed_spring_once) {
    struct sheet sheet;
    make(&sheet, GRIDS, 3);
    const struct cs_springs *springs = &sheet.system.springs;
    uint8_t *times = calloc(springs->n, 1);
    ck_assert_ptr_nonnull(times);
    for (uint32_t k = 0; k < springs->n_chunks; k++) {
        const struct cs_spring_chunk *chunk = springs->chunks + k;
        ck_assert_uint_gt(chunk->end, chunk->begin);
        for (uint32_t i = chunk->begin; i < chunk->end; i++)
            times[springs->runs[chunk->run].first + i]++;
    }
    for (uint32_t r = 0; r < springs->n_runs; r++)
        for (uint32_t i = 0; i < springs->runs[r].count; i++)
            if (times[springs->runs[r].first + i] != (springs->runs[r].ends != NULL))
                ck_abort_msg("spring %u of run %u is in %d lots", i, r,
                             times[springs->runs[r].first + i]);
    free(times);
    unmake(&sheet);
}

/* ascending at each particle, each end once */
TEST(springs_wait_at_both_ends) {
    struct sheet sheet;
    make(&sheet, GRIDS, 2);
    const struct cs_springs *springs = &sheet.system.springs;
    uint32_t listed = 0;
    for (uint32_t r = 0; r < springs->n_runs; r++) {
        const struct cs_spring_run *run = springs->runs + r;
        const struct cs_spring_slots *wait = springs->slots + r;
        ck_assert_uint_eq(wait->n > 0, run->ends != NULL);
        if (!run->ends)
            continue;
        listed++;
        ck_assert_uint_eq(wait->particle_begin[0], 0);
        ck_assert_uint_eq(wait->particle_begin[wait->n], 2 * run->count);
        for (uint32_t i = 0; i < wait->n; i++)
            for (uint32_t k = wait->particle_begin[i]; k < wait->particle_begin[i + 1]; k++) {
                if (run->ends[wait->particle_springs[k]] != i)
                    ck_abort_msg("spring %u does not end at %u", wait->particle_springs[k] >> 1,
                                 i);
                if (k > wait->particle_begin[i] &&
                    wait->particle_springs[k] <= wait->particle_springs[k - 1])
                    ck_abort_msg("springs of particle %u are out of order", i);
            }
    }
    ck_assert_uint_eq(listed, 6);
    unmake(&sheet);
}

TEST(bytes_are_those_taken) {
    for (int k = 0; k < CASES; k++) {
        struct sheet alone, shared;
        make(&alone, k / THREADS, 1);
        const size_t least = alone.system.arena.used;
        ck_assert_uint_eq(alone.system.plan.rows[CS_FEATURE_THREADS].bytes, 0);
        ck_assert_uint_eq(alone.system.springs.n_blocks, 1);
        unmake(&alone);
        make(&shared, k / THREADS, threads[k % THREADS]);
        ck_assert_uint_eq(shared.system.arena.used,
                          least + shared.system.plan.rows[CS_FEATURE_THREADS].bytes);
        unmake(&shared);
    }
}

/* Loops in a wave leave what they leave one after the other, and do each block once. */
#include "base/pool.h"
#include "model/solver/level_kernels.h"
#include "unit.h"

#include <stdatomic.h>

enum { BLOCKS = 90, LOOPS = 5 };

/* two arrays that change places: loop k adds up three neighbours of one into the other */
struct sums {
    uint32_t n;
    uint64_t arrays[2][BLOCKS + 2]; /* a border of zeros */
    _Atomic uint32_t done[LOOPS][BLOCKS];
};

static void add_up(void *arg, uint32_t loop, uint32_t block) {
    struct sums *sums = arg;
    const uint64_t *from = sums->arrays[loop % 2] + block;
    sums->arrays[(loop + 1) % 2][block + 1] = 3 * from[0] + from[1] + 7 * from[2] + loop;
    atomic_fetch_add(&sums->done[loop][block], 1);
}

static void begin(struct sums *sums, uint32_t n) {
    *sums = (struct sums){.n = n};
    for (uint32_t b = 1; b <= n; b++)
        sums->arrays[0][b] = (b * 2654435761u) % 1000;
}

static void same_as_one_by_one(uint32_t loops, uint32_t blocks) {
    static struct sums wavefront, one;
    begin(&wavefront, blocks);
    begin(&one, blocks);
    cs_wavefront_run(&(struct cs_wavefront){loops, blocks, add_up, &wavefront});
    for (uint32_t k = 0; k < loops; k++)
        for (uint32_t b = 0; b < blocks; b++)
            add_up(&one, k, b);
    for (uint32_t b = 0; b <= blocks + 1; b++)
        UNIT_ASSERT_OFTEN(wavefront.arrays[loops % 2][b] == one.arrays[loops % 2][b]);
    for (uint32_t k = 0; k < loops; k++)
        for (uint32_t b = 0; b < blocks; b++)
            UNIT_ASSERT_OFTEN(wavefront.done[k][b] == 1);
}

TEST(wave_is_one_loop_after_the_other) {
    struct cs_error error = {0};
    for (uint32_t threads = 1; threads <= 7; threads += threads < 4 ? 1 : 3) {
        ck_assert_int_eq(cs_pool_start(threads, &error), CS_OK);
        for (uint32_t loops = 1; loops <= LOOPS; loops++)
            for (uint32_t blocks = 1; blocks <= BLOCKS; blocks++)
                same_as_one_by_one(loops, blocks);
    }
    cs_pool_stop();
}

/* Runs dependent loops over the blocks of an array as one wavefront, so that a block is still
 * in the cache when the next loop comes to it. */
#include "model/solver/wavefront.h"

#include "base/pool.h"

enum { STRETCHES = 4 /* a thread, so that one that comes late leaves them to others */ };

struct stretches {
    const struct cs_wavefront *wave;
    uint32_t n;
};

static uint32_t begin_of(const struct stretches *all, uint32_t stretch) {
    return (uint32_t)((uint64_t)all->wave->n_blocks * stretch / all->n);
}

/* Loop k reaches block b at time b + k: its forerunner has just done b + 1. */
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

/* what two stretches have left between them */
static void run_wedge(void *arg, uint32_t stretch) {
    const struct stretches *all = arg;
    const struct cs_wavefront *wavefront = all->wave;
    const uint32_t middle = begin_of(all, stretch + 1);
    for (uint32_t k = 1; k < wavefront->n_loops; k++)
        for (uint32_t block = middle - k; block < middle + k; block++)
            wavefront->step(wavefront->arg, k, block);
}

void cs_wavefront_run(const struct cs_wavefront *wavefront) {
    const uint32_t threads = cs_pool_threads();
    const uint32_t wanted = threads > 1 ? STRETCHES * threads : 1;
    const uint32_t most = wavefront->n_blocks / (2 * wavefront->n_loops);
    struct stretches all = {wavefront, wanted < most ? wanted : most > 1 ? most : 1};
    cs_pool_run(all.n, run_stretch, &all);
    cs_pool_run(all.n - 1, run_wedge, &all);
}

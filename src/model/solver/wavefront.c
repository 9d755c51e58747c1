/* Runs dependent loops over the blocks of an array as one wavefront.
 *
 * In the plane of blocks (across) and loops (up), a stretch is a trapezium and a wedge the
 * triangle between two of them, standing on its tip:
 *
 *   loop 2   ___wwww___      _: done by the stretches
 *   loop 1   ____ww____      w: done by the wedge, after them
 *   loop 0   __________ */
#include "model/solver/wavefront.h"

#include "base/pool.h"

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

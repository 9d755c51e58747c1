/* parallel.h - a loop over all numbers on the host's threads. */
#ifndef PARALLEL_H
#define PARALLEL_H

#include <clothsim/integrator.h>

/* Runs part(arg, begin, end) over 0..n-1 on the host's threads, or here if the host is older
 * than that call. */
static inline void parallel_for(const struct cs_host *host, size_t n,
                                void (*part)(void *arg, size_t begin, size_t end), void *arg) {
    const struct cs_vector_kernels *vector = host->vector;
    if (CS_HAS(vector, parallel_for))
        vector->parallel_for(n, part, arg);
    else
        part(arg, 0, n);
}

/* f (3,n) = all forces at (t, x, v), and then a loop, in which a range may move x and v of its
 * own particles: in one pass where the host can. */
static inline void force_then(const struct cs_host *host, double t, const double *x,
                              const double *v, double *f, const struct cs_loop *loop) {
    if (CS_HAS(host, force_then) && host->force_then) {
        host->force_then(host->ctx, t, x, v, f, loop);
        return;
    }
    host->force(host->ctx, t, x, v, CS_PART_ALL, f);
    parallel_for(host, host->view->n, loop->part, loop->arg);
}

#endif

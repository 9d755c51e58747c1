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

#endif

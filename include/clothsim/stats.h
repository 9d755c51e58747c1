/* SPDX-License-Identifier: MIT */
/* stats.h - counts that a method reports, and the passage of its history into a checkpoint. */
#ifndef CLOTHSIM_STATS_H
#define CLOTHSIM_STATS_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Counts that only the method knows. */
struct cs_stats {
    uint32_t size;
    /* Rejected steps, and nonlinear iterations. */
    uint64_t rejected, newton;
    /* Set-ups of the linear solver that a library asked for. */
    uint64_t setups;
    /* Passes of its own over all springs, each about a force evaluation; late: ask CS_HAS. */
    uint64_t sweeps;
    /* Errors of position of its accepted steps as it estimates them, added up: in m, as a root
     * of the mean square over the particles. 0: it has no estimate; late: ask CS_HAS. */
    double local_error;
};

/* The passage of a method's history into a checkpoint, or back. save and load make the same
 * calls with the same counts in the same order, so that one function may be both. */
struct cs_archive {
    /* sizeof at the host's build: see CS_HAS. */
    uint32_t size;
    void *ctx;
    /* n values: save has them read, load has them written. */
    void (*reals)(void *ctx, double *values, size_t n);
    void (*integers)(void *ctx, uint64_t *values, size_t n);
};

#ifdef __cplusplus
}
#endif
#endif

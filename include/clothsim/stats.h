/* SPDX-License-Identifier: MIT */
/* stats.h - counts that a method reports, and the passage of its history into a checkpoint. */
#ifndef CLOTHSIM_STATS_H
#define CLOTHSIM_STATS_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Counts that only the method knows, from when it was created on. The host sets size, and the
 * rest to 0; it shows them in reports and in tables of comparison. No result depends on them.
 */
struct cs_stats {
    /* sizeof at the host's build: see CS_HAS. */
    uint32_t size;
    /* Steps tried and rejected, none of which counts as a step; and iterations of nonlinear
     * solves, those of rejected steps included. */
    uint64_t rejected, newton;
    /* Set-ups of the linear solver that a library asked for: each may bring a new matrix and
     * a new preconditioner. */
    uint64_t setups;
    /* Passes of its own over all springs, each about the work of a force evaluation, which
     * tables of work add to those of the host; late: ask CS_HAS. */
    uint64_t sweeps;
    /* Errors of position of its accepted steps as it estimates them, added up: in m, as a root
     * of the mean square over the particles. 0: it has no estimate; late: ask CS_HAS. */
    double local_error;
};

/* The passage of a method's history into a checkpoint, or back. save and load make the same
 * calls with the same counts in the same order, so that one function may be both. The host
 * owns the archive: a method keeps no pointer to it. */
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

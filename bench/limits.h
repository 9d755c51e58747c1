/* limits.h - what the machine can do at best, as loops that a kernel can be held against. */
#ifndef BENCH_LIMITS_H
#define BENCH_LIMITS_H

#include "timing.h"

#include <stddef.h>

/* in all, of a loop that the nearest cache has room for; and an element of the triad */
enum { BENCH_LOOP_BYTES = 24 << 10, BENCH_TRIAD_BYTES = 24 };

/* Work over three arrays in one block of memory. */
struct bench_loop {
    double *a, *b, *c; /* (n) each; a owns the block */
    size_t n;
};

/* bytes of all three arrays together. CS_ERR_MEMORY. */
enum cs_status bench_loop_init(struct bench_loop *loop, size_t bytes, struct cs_error *error);
void bench_loop_finish(struct bench_loop *loop);

/* Independent elements, all that a spring's length asks of the divider: a = 1 / sqrt(b); and
 * a = sqrt(b). The object is a struct bench_loop. */
void bench_sqrt_divide(void *loop);
void bench_sqrt(void *loop);
/* a = b + 3 c (McCalpin 1995). */
void bench_triad(void *loop);

/* Median ns an element of a measured task over a loop. */
double bench_loop_ns(const struct bench_task *task);

#endif

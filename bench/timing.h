/* timing.h - how long a piece of work takes: warm-up, then samples in turns. */
#ifndef BENCH_TIMING_H
#define BENCH_TIMING_H

#include "bench.h"

struct bench_spread {
    double median, min, max; /* s */
};

struct bench_task {
    void (*run)(void *object); /* the work, once; may be called any number of times */
    void *object;
    uint32_t calls;           /* in one sample: as many as its least time asks for */
    struct bench_spread time; /* of one call */
};

enum { BENCH_SAMPLES_MAX = 15 };

/* Median and range of n values, which are sorted. */
struct bench_spread bench_spread_of(double *values, uint32_t n);

/* How many samples are worth their time where one takes this many seconds. */
uint32_t bench_samples(const struct bench_settings *settings, double seconds);

/* Calls each task once to warm up, then takes samples of all tasks in turns, so that a clock
 * that wanders does so for all of them. Processor time of the process with one thread, else
 * wall time. */
void bench_measure(const struct bench_settings *settings, struct bench_task *tasks, uint32_t n);

#endif

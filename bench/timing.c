/* Measures how long a piece of work takes: a warm-up, then samples in turns. */
#include "timing.h"

#include "base/clock.h"
#include "study/compare/timing_rounds.h"

enum { TASKS_MAX = 32 };

static double now(const struct bench_settings *settings) {
    return settings->threads > 1 ? cs_clock_wall() : cs_clock_cpu();
}

struct bench_spread bench_spread_of(double *values, uint32_t n) {
    cs_sort(values, n);
    return (struct bench_spread){cs_quantile(values, n, 0.5), values[0], values[n - 1]};
}

uint32_t bench_samples(const struct bench_settings *settings, double seconds) {
    if (settings->quick)
        return seconds > 0.2 ? 1 : 3;
    return seconds > 2 ? 3 : seconds > 0.2 ? 7 : 11;
}

static double sample(const struct bench_settings *settings, const struct bench_task *task) {
    const double begin = now(settings);
    for (uint32_t k = 0; k < task->calls; k++)
        task->run(task->object);
    return (now(settings) - begin) / task->calls;
}

/* As many calls as fill the least time of a sample; the last sample counts for nothing. */
static double warm_up(const struct bench_settings *settings, struct bench_task *task) {
    const double least = settings->quick ? 1e-3 : 1e-2;
    double seconds;
    for (task->calls = 1;; task->calls *= 2) {
        seconds = sample(settings, task);
        if (seconds * task->calls >= least || task->calls >= 1u << 24)
            return seconds * task->calls;
    }
}

void bench_measure(const struct bench_settings *settings, struct bench_task *tasks,
                   uint32_t n) {
    double seconds[TASKS_MAX][BENCH_SAMPLES_MAX];
    uint32_t wanted[TASKS_MAX];
    CS_ASSERT(n <= TASKS_MAX);
    for (uint32_t k = 0; k < n; k++)
        wanted[k] = bench_samples(settings, warm_up(settings, tasks + k));
    for (uint32_t turn = 0; turn < BENCH_SAMPLES_MAX; turn++)
        for (uint32_t k = 0; k < n; k++)
            if (turn < wanted[k])
                seconds[k][turn] = sample(settings, tasks + k);
    for (uint32_t k = 0; k < n; k++)
        tasks[k].time = bench_spread_of(seconds[k], wanted[k]);
}

/* Measures what the machine can do at best: its divider and its memory. */
#include "limits.h"

#include <clothsim/clones.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum cs_status bench_loop_init(struct bench_loop *loop, size_t bytes, struct cs_error *error) {
    const size_t n = bytes / (8 * BENCH_TRIAD_BYTES) * 8; /* 64-byte aligned */
    *loop = (struct bench_loop){.a = aligned_alloc(64, 3 * n * sizeof(double)), .n = n};
    if (!loop->a)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for arrays of %zu bytes", bytes);
    loop->b = loop->a + n;
    loop->c = loop->b + n;
    for (size_t i = 0; i < n; i++) {
        loop->a[i] = 0;
        loop->b[i] = 1 + (double)(i % 7);
        loop->c[i] = 2 + (double)(i % 5);
    }
    return CS_OK;
}

void bench_loop_finish(struct bench_loop *loop) {
    free(loop->a);
}

CS_CLONES void bench_sqrt_divide(void *object) {
    const struct bench_loop *loop = object;
    double *restrict a = loop->a;
    const double *b = loop->b;
    for (size_t i = 0; i < loop->n; i++)
        a[i] = 1 / sqrt(b[i]);
}

CS_CLONES void bench_sqrt(void *object) {
    const struct bench_loop *loop = object;
    double *restrict a = loop->a;
    const double *b = loop->b;
    for (size_t i = 0; i < loop->n; i++)
        a[i] = sqrt(b[i]);
}

CS_CLONES void bench_triad(void *object) {
    const struct bench_loop *loop = object;
    double *restrict a = loop->a;
    const double *b = loop->b, *c = loop->c;
    for (size_t i = 0; i < loop->n; i++)
        a[i] = b[i] + 3 * c[i];
}

double bench_loop_ns(const struct bench_task *task) {
    const struct bench_loop *loop = task->object;
    return 1e9 * task->time.median / (double)loop->n;
}

#define KIB ((size_t)1 << 10)
#define MIB ((size_t)1 << 20)

static const struct {
    const char *name;
    void (*run)(void *loop);
    size_t bytes;
    bool slow;
} rows[] = {
    {"sqrt and divide", bench_sqrt_divide, BENCH_LOOP_BYTES, false},
    {"sqrt", bench_sqrt, BENCH_LOOP_BYTES, false},
    {"triad", bench_triad, BENCH_LOOP_BYTES, false},
    {"triad", bench_triad, MIB, false},
    {"triad", bench_triad, 16 * MIB, false},
    {"triad", bench_triad, 256 * MIB, true},
    {"triad", bench_triad, 1536 * MIB, true},
};
enum { ROWS = sizeof rows / sizeof *rows };

static void add_row(struct bench_table *table, uint32_t r, const struct bench_task *task) {
    const struct bench_loop *loop = task->object;
    const double ns = 1e9 / (double)loop->n;
    char rate[32] = "";
    if (rows[r].run == bench_triad)
        snprintf(rate, sizeof rate, "%.1f", BENCH_TRIAD_BYTES / bench_loop_ns(task));
    bench_table_add(table, "%s,%zu,%.4f,%.4f,%.4f,%s", rows[r].name, rows[r].bytes / KIB,
                    ns * task->time.median, ns * task->time.min, ns * task->time.max, rate);
}

static enum cs_status run(const struct bench_settings *settings, struct bench_table *table,
                          struct cs_error *error) {
    struct bench_loop loops[ROWS] = {0};
    struct bench_task tasks[ROWS] = {0};
    uint32_t n = 0;
    for (uint32_t r = 0; r < ROWS && !error->status; r++) {
        if (rows[r].slow && settings->quick)
            continue;
        tasks[n] = (struct bench_task){.run = rows[r].run, .object = loops + n};
        bench_loop_init(loops + n++, rows[r].bytes, error);
    }
    bench_report("%u loops", n);
    if (!error->status)
        bench_measure(settings, tasks, n);
    for (uint32_t k = 0, r = 0; k < n && !error->status; k++, r++) {
        /* rows that were passed over have no task */
        while (rows[r].slow && settings->quick)
            r++;
        add_row(table, r, tasks + k);
    }
    for (uint32_t k = 0; k < n; k++)
        bench_loop_finish(loops + k);
    return error->status;
}

static const char *const columns[] = {"loop",   "kib",    "median_ns", "min_ns",
                                      "max_ns", "gb_a_s", NULL};
const struct bench_section bench_limits = {
    .name = "limits",
    .summary = "ns an element of independent work; the triad also in GB/s",
    .columns = columns,
    .n_keys = 2,
    .measured = "median_ns",
    .run = run,
};

/* bench.h - what every section of the benchmark is given, and what it gives. */
#ifndef BENCH_H
#define BENCH_H

#include "table.h"

#include <stdbool.h>
#include <stdint.h>

struct bench_settings {
    bool quick;          /* small sizes, few samples: is everything there, not how fast is it */
    uint32_t threads;    /* that the model may use */
    const char *scratch; /* folder of this run, gone at its end */
};

/* One section: measures, and adds its rows to a table of its own. Rows that were added before a
 * failure are kept. */
struct bench_section {
    const char *name, *summary;
    const char *const *columns; /* closed by NULL */
    uint32_t n_keys;            /* the first columns, which name the case */
    const char *measured;       /* the column by which two results are compared */
    enum cs_status (*run)(const struct bench_settings *settings, struct bench_table *table,
                          struct cs_error *error);
};

extern const struct bench_section bench_limits, bench_kernels, bench_steps, bench_thesis,
    bench_plain, bench_pairs, bench_contact, bench_pictures, bench_pipeline, bench_bdf;

/* One line of progress on standard error. */
void bench_report(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif

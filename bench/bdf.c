/* Runs BDF of SciPy and CVODE used plainly beside cvode-bdf; bdf_peers.py does the work. */
#include "child.h"

#include <string.h>

static enum cs_status run(const struct bench_settings *settings, struct bench_table *table,
                          struct cs_error *error) {
    /* Debian's own, which has the packages */
    const char *arguments[] = {"/usr/bin/python3",
                               BENCH_ROOT "/bench/bdf_peers.py",
                               BENCH_PROGRAM,
                               BENCH_ROOT "/scenes/drum.json",
                               BENCH_CVODE_PLAIN,
                               settings->quick ? "--quick" : NULL,
                               NULL};
    struct bench_usage usage;
    struct cs_text output = {0};
    bench_report("%s",
                 settings->quick ? "the drum, 0.05 s" : "hanging sheets and the drum, 0.5 s");
    if (!bench_child_run(arguments, &output, &usage, error))
        for (char *line = output.bytes, *end; line && *line; line = end) {
            end = line + strcspn(line, "\n");
            bench_table_add(table, "%.*s", (int)(end - line), line);
            end += *end == '\n';
        }
    cs_text_finish(&output);
    return error->status;
}

static const char *const columns[] = {"scene",       "solver",      "rtol",    "median_s",
                                      "min_s",       "max_s",       "error_m", "forces",
                                      "times_scipy", "times_plain", NULL};
const struct bench_section bench_bdf = {
    .name = "bdf",
    .summary = "s of the processor for BDF at the same error: SciPy's, CVODE's and clothsim's",
    .columns = columns,
    .n_keys = 3,
    .measured = "median_s",
    .run = run,
};

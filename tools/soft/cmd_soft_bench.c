/* clothsim soft-bench: measures spring networks against shape matching on a soft body.
 *
 *   options -> checks -> cs_soft_run: a row per body -> soft.csv -> tables
 * Rows measured before an interruption are written. */
#include "base/file.h"
#include "cli/commands.h"
#include "cli/line/print.h"
#include "cli/manifest.h"
#include "cli/run_folder.h"
#include "soft/soft.h"

#include <stdio.h>

struct options {
    struct cs_soft soft;
    const char *folder;
    bool overwrite, quiet;
};
static const struct options defaults = {.soft = {.seconds = 0.5, .draw = true},
                                        .folder = "soft"};

static const struct cs_arg rows[] = {
    {"budget", 0, "SECONDS", "processor time of the measurement of a body (default: 0.5)",
     CS_ARG_INTO(struct options, soft.seconds)},
    {"no-render", 0, NULL, "do not time pictures", CS_ARG_INTO(struct options, soft.draw)},
    CS_ARG_SET(struct options, soft.session),
    CS_ARG_PLUGIN(struct options, soft.session),
    {"out", 'o', "DIR", "folder for soft.csv and soft.txt (default: soft); see: clothsim plot",
     CS_ARG_INTO(struct options, folder)},
    {"overwrite", 'y', NULL, "replace the files of an earlier run",
     CS_ARG_INTO(struct options, overwrite)},
    CS_ARG_QUIET(struct options, quiet),
};

static enum cs_status write_one(const char *folder, const char *name,
                                void (*print)(const struct cs_soft *, struct cs_text *),
                                const struct cs_soft *soft, struct cs_error *error) {
    struct cs_text text = {0};
    char path[4200];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    print(soft, &text);
    return cs_file_write_text(path, &text, error);
}

static enum cs_status write_files(const char *folder, const struct cs_soft *soft,
                                  struct cs_error *error) {
    if (write_one(folder, "soft.csv", cs_soft_print_csv, soft, error) ||
        write_one(folder, "soft.txt", cs_soft_print, soft, error))
        return error->status;
    return cs_manifest_write_study(folder, error);
}

/* Checks everything that can be refused before a measurement of minutes; the folder last. */
static enum cs_status prepare(const struct options *options, struct cs_error *error) {
    char path[4096];
    snprintf(path, sizeof path, "%s/soft.csv", options->folder);
    if ((!options->overwrite && cs_output_check_file(path, error)) ||
        cs_soft_check(&options->soft, error))
        return error->status;
    return cs_folder_create(options->folder, error);
}

static enum cs_status measure_series(struct cs_soft *soft, bool quiet, struct cs_error *error) {
    struct cs_progress progress;
    cs_progress_begin(&progress, "body", quiet);
    soft->progress = cs_progress_show;
    soft->ctx = &progress;
    cs_soft_run(soft, error);
    cs_progress_end(&progress);
    return error->status;
}

static enum cs_status soft_bench(struct cs_args *args, struct cs_error *error) {
    struct options *options = args->options;
    struct cs_soft *soft = &options->soft;
    struct cs_text out = {0};
    soft->session.scene = args->operands[0];
    soft->session.run.stop = cs_interrupt_catch();
    if (prepare(options, error) ||
        (measure_series(soft, options->quiet, error) && error->status != CS_ERR_INTERRUPT))
        return error->status;
    /* what was measured before an interrupt is kept */
    struct cs_error later = {0};
    if (soft->n && !write_files(options->folder, soft, &later) && !options->quiet) {
        cs_soft_print(soft, &out);
        cs_print_out(stdout, &out, &later);
    }
    return later.status ? cs_fail(error, later.status, "%s", later.message) : error->status;
}

const struct cs_command cs_command_soft_bench = {
    .name = "soft-bench",
    .operands = "SCENE",
    .summary = CS_SUMMARY_soft_bench,
    .notes = "The first body of SCENE is a mesh of the shape \"limbs\" with a network.\n\n"
             "Example: clothsim soft-bench scenes/bear_springs.json -o soft\n",
    CS_COMMAND_OPTIONS(rows, defaults),
    .operands_min = 1,
    .operands_max = 1,
    .main = soft_bench,
};

/* clothsim soft-bench: measures spring networks against shape matching on a soft body. */
#include "base/file.h"
#include "cli/commands.h"
#include "cli/line/interrupt.h"
#include "cli/line/print.h"
#include "cli/line/progress.h"
#include "cli/run_output.h"
#include "io/gnuplot.h"
#include "study/soft/soft_report.h"

#include <stdio.h>

enum {
    SOFT_TIME,
    SOFT_DRAW,
    SOFT_SET,
    SOFT_PLUGIN,
    SOFT_OUT,
    SOFT_OVERWRITE,
    SOFT_QUIET,
    SOFT_ROWS
};

static const struct cs_arg rows[SOFT_ROWS] = {
    [SOFT_TIME] = {"time", 't', "SECONDS",
                   "processor time that a body is measured for (default: 0.5)", false},
    [SOFT_DRAW] = {"no-draw", 0, NULL, "leave the time of pictures out", false},
    [SOFT_SET] = {"set", 's', "PATH=VALUE",
                  "another value for a key of the scene; may be repeated", true},
    [SOFT_PLUGIN] = {"plugin", 'p', "FILE", "load an integrator module; may be repeated", true},
    [SOFT_OUT] =
        {"out", 'o', "DIR",
         "folder for soft.csv, soft.txt, soft.gp and, with gnuplot, soft.png (default: "
         "soft)",
         false},
    [SOFT_OVERWRITE] = {"overwrite", 'y', NULL, "replace the files of an earlier run", false},
    [SOFT_QUIET] = {"quiet", 'q', NULL, "no progress and no tables", false},
};

static void show_progress(void *ctx, uint32_t done, uint32_t total) {
    cs_progress_show(ctx, done, total);
}

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
    bool drawn;
    if (write_one(folder, "soft.csv", cs_soft_print_csv, soft, error) ||
        write_one(folder, "soft.txt", cs_soft_print, soft, error) ||
        write_one(folder, "soft.gp", cs_soft_print_plot, soft, error))
        return error->status;
    return cs_gnuplot_run(folder, "soft.gp", &drawn, error);
}

/* all that can be refused is looked at before minutes go by, the folder last */
static enum cs_status prepare(const struct cs_args *args, const struct cs_soft *soft,
                              const char *folder, struct cs_error *error) {
    char path[4096];
    snprintf(path, sizeof path, "%s/soft.csv", folder);
    if (!cs_args_get(args, SOFT_OVERWRITE) && cs_output_check_file(path, error))
        return error->status;
    return cs_soft_check(soft, error) ? error->status : cs_folder_make(folder, error);
}

static enum cs_status measure(struct cs_args *args, struct cs_soft *soft,
                              struct cs_error *error) {
    struct cs_progress progress;
    cs_progress_begin(&progress, cs_args_get(args, SOFT_QUIET));
    progress.what = "body";
    soft->progress = show_progress;
    soft->ctx = &progress;
    cs_soft_run(soft, error);
    cs_progress_end(&progress);
    return error->status;
}

static enum cs_status soft_bench(struct cs_args *args, struct cs_error *error) {
    const char *given = cs_args_get(args, SOFT_OUT), *folder = given ? given : "soft";
    struct cs_soft soft = {.seconds = 0.5, .draw = !cs_args_get(args, SOFT_DRAW)};
    struct cs_text out = {0};
    soft.session.scene = args->operands[0];
    soft.session.run.stop = cs_interrupt_catch();
    if (cs_args_real(args, SOFT_TIME, &soft.seconds, error) ||
        cs_args_overrides(args, SOFT_SET, &soft.session.overrides, &soft.session.n_overrides,
                          error) ||
        cs_args_all(args, SOFT_PLUGIN, &soft.session.plugins, &soft.session.n_plugins, error) ||
        prepare(args, &soft, folder, error))
        return error->status;
    measure(args, &soft, error);
    if (error->status && error->status != CS_ERR_INTERRUPT)
        return error->status;
    /* what was measured before an interrupt is kept */
    struct cs_error later = {0};
    if (soft.n && !write_files(folder, &soft, &later) && !cs_args_get(args, SOFT_QUIET)) {
        cs_soft_print(&soft, &out);
        cs_print_out(stdout, &out, &later);
    }
    return later.status ? cs_fail(error, later.status, "%s", later.message) : error->status;
}

const struct cs_command cs_command_soft_bench = {
    .name = "soft-bench",
    .operands = "SCENE",
    .summary = "measure spring networks against shape matching on a soft body",
    .notes = "The first body of SCENE is a mesh of the shape \"limbs\" with a network.\n\n"
             "Example: clothsim soft-bench scenes/bear_springs.json -o soft\n",
    .rows = rows,
    .n_rows = SOFT_ROWS,
    .least = 1,
    .most = 1,
    .main = soft_bench,
};

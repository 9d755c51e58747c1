/* clothsim advise: finds a safe step for each method, what limits it and what a frame costs. */
#include "base/pool.h"
#include "cli/commands.h"
#include "cli/line/interrupt.h"
#include "cli/line/print.h"
#include "cli/line/progress.h"
#include "study/stability/advise.h"
#include "study/workers.h"

enum {
    ADVISE_INTEGRATORS,
    ADVISE_CHECK,
    ADVISE_TIME,
    ADVISE_BUDGET,
    ADVISE_JOBS,
    ADVISE_SET,
    ADVISE_PLUGIN,
    ADVISE_QUIET,
    ADVISE_ROWS
};

static const struct cs_arg rows[ADVISE_ROWS] = {
    [ADVISE_INTEGRATORS] = {"integrators", 'i', "NAME[:KEY=VALUE,...]",
                            "a method; may be repeated (default: all)", true},
    [ADVISE_CHECK] = {"check", 0, NULL, "bisect the limits as well, and print them beside",
                      false},
    [ADVISE_TIME] = {"time", 't', "SECONDS", "simulated by every run, at least (default: 0.5)",
                     false},
    [ADVISE_BUDGET] = {"budget", 0, "SECONDS",
                       "processor time that one run may take (default: 20)", false},
    [ADVISE_JOBS] = {"jobs", 'j', "N", "methods at a time (default: one a processor)", false},
    [ADVISE_SET] = {"set", 's', "PATH=VALUE",
                    "another value for a key of the scene; may be repeated", true},
    [ADVISE_PLUGIN] = {"plugin", 'p', "FILE", "load an integrator module; may be repeated",
                       true},
    [ADVISE_QUIET] = {"quiet", 'q', NULL, "no progress", false},
};

static void show_progress(void *ctx, uint32_t done, uint32_t total) {
    cs_progress_show(ctx, done, total);
}

static enum cs_status advise(struct cs_args *args, struct cs_error *error) {
    struct cs_progress progress;
    struct cs_text out = {0};
    struct cs_advise study = {
        .session = {.scene = args->operands[0]},
        .seconds = 0.5,
        .budget = 20,
        .check = cs_args_get(args, ADVISE_CHECK),
        .workers = cs_pool_processors(CS_WORKERS_MOST),
        .progress = show_progress,
        .ctx = &progress,
    };
    /* one flag stops the current run and keeps further ones from starting */
    study.session.run.stop = study.stop = cs_interrupt_catch();
    if (cs_args_real(args, ADVISE_TIME, &study.seconds, error) ||
        cs_args_real(args, ADVISE_BUDGET, &study.budget, error) ||
        cs_args_whole(args, ADVISE_JOBS, 1, CS_WORKERS_MOST, &study.workers, error) ||
        cs_args_all(args, ADVISE_INTEGRATORS, &study.methods, &study.n_methods, error) ||
        cs_args_overrides(args, ADVISE_SET, &study.session.overrides,
                          &study.session.n_overrides, error) ||
        cs_args_all(args, ADVISE_PLUGIN, &study.session.plugins, &study.session.n_plugins,
                    error))
        return error->status;
    cs_progress_begin(&progress, cs_args_get(args, ADVISE_QUIET));
    progress.what = "method";
    cs_advise_run(&study, error);
    /* the line goes before anything is printed below it */
    cs_progress_end(&progress);
    if (!error->status) {
        cs_advise_print(&study, &out);
        cs_print_out(stdout, &out, error);
    }
    cs_advise_finish(&study);
    return error->status;
}

const struct cs_command cs_command_advise = {
    .name = "advise",
    .operands = "SCENE",
    .summary = "say which step each method takes safely, and what binds it",
    .notes = "Example: clothsim advise scenes/hang.json -i velocity-verlet\n",
    .rows = rows,
    .n_rows = ADVISE_ROWS,
    .least = 1,
    .most = 1,
    .main = advise,
};

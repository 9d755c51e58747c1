/* clothsim advise: finds a safe step for each method, what limits it and what a frame costs. */
#include "base/pool.h"
#include "cli/commands.h"
#include "cli/line/interrupt.h"
#include "cli/line/print.h"
#include "cli/line/progress.h"
#include "study/compare/cell_list_parse.h"
#include "study/compare/compare.h"
#include "study/compare/verdict.h"
#include "study/process_pool.h"
#include "study/stability/advise_print.h"

enum {
    ADVISE_INTEGRATORS,
    ADVISE_CHECK,
    ADVISE_ERROR,
    ADVISE_OUT,
    ADVISE_TIME,
    ADVISE_BUDGET,
    ADVISE_JOBS,
    ADVISE_SET,
    ADVISE_PLUGIN,
    ADVISE_QUIET,
    ADVISE_ROWS
};

static const struct cs_arg rows[ADVISE_ROWS] = {
    [ADVISE_INTEGRATORS] =
        {"integrators", 'i', "LIST",
         "methods, NAME:KEY=VALUE,...,NAME...; may be repeated (default: all)", true},
    [ADVISE_CHECK] = {"check", 0, NULL, "bisect the limits as well, and print them beside",
                      false},
    [ADVISE_ERROR] = {"error", 0, "METRES",
                      "say which method and step is the cheapest for that error of position at "
                      "the end of the time (default: 0.5 s), by a comparison",
                      false},
    [ADVISE_OUT] = {"out", 'o', "DIR",
                    "folder of that comparison, which goes on where it was (default: advise)",
                    false},
    [ADVISE_TIME] = {"time", 't', "SECONDS",
                     "that the steps are for: simulated by every run, at least (default: 10)",
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

/* "NAME:options,NAME:options" of the methods that are asked for; "" for all. */
static void join(const struct cs_advise *study, struct cs_text *list) {
    for (uint32_t k = 0; k < study->n_methods; k++)
        cs_text_add(list, "%s%s", k ? "," : "", study->methods[k]);
}

/* files that stand in the place of methods */
static enum cs_status add_modules(struct cs_args *args, struct cs_compare_settings *settings,
                                  struct cs_error *error) {
    struct cs_session_settings *session = &settings->run.session;
    return settings->methods
               ? cs_cell_list_add_modules(settings->methods, &args->arena, &session->plugins,
                                          &session->n_plugins, error)
               : CS_OK;
}

/* The answer by a comparison: the steps that are tried are those of its sweep. */
static enum cs_status advise_for_error(struct cs_args *args, const struct cs_advise *study,
                                       double bound, struct cs_error *error) {
    const char *folder = cs_args_get(args, ADVISE_OUT);
    struct cs_compare compare = {0};
    struct cs_text list = {0}, out = {0};
    join(study, &list);
    folder = folder ? folder : "advise";
    struct cs_compare_settings settings = {.run = {.session = study->session},
                                           .methods =
                                               study->n_methods ? cs_text_get(&list) : NULL,
                                           .accuracy = bound < 1e-6 ? bound : 1e-6,
                                           .runs = 15,
                                           .folder = folder,
                                           .cache = folder};
    const double seconds = cs_args_get(args, ADVISE_TIME) ? study->seconds : 0.5;
    if (list.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the list of methods");
    else if (!add_modules(args, &settings, error) &&
             !cs_recorded_run_count_frames(&settings.run, seconds, error) &&
             !cs_compare_run(&compare, &settings, error)) {
        cs_verdict_print_at(&compare, bound, &out);
        cs_compare_warn(&compare, "warning: ", &out);
        cs_print_out(stdout, &out, error);
    }
    cs_compare_finish(&compare);
    cs_text_finish(&list);
    return error->status;
}

static enum cs_status advise(struct cs_args *args, struct cs_error *error) {
    struct cs_progress progress;
    struct cs_text out = {0};
    struct cs_advise study = {
        .session = {.scene = args->operands[0]},
        .seconds = 10,
        .budget = 20,
        .bisect_too = cs_args_get(args, ADVISE_CHECK),
        .workers = cs_pool_processors(CS_PROCESS_POOL_MAX),
        .progress = show_progress,
        .ctx = &progress,
    };
    /* one flag stops the current run and keeps further ones from starting */
    study.session.run.stop = study.stop = cs_interrupt_catch();
    double bound = 0;
    if (cs_args_real(args, ADVISE_ERROR, &bound, error) ||
        cs_args_real(args, ADVISE_TIME, &study.seconds, error) ||
        cs_args_real(args, ADVISE_BUDGET, &study.budget, error) ||
        cs_args_integer(args, ADVISE_JOBS, 1, CS_PROCESS_POOL_MAX, &study.workers, error) ||
        cs_args_methods(args, ADVISE_INTEGRATORS, &study.methods, &study.n_methods, error) ||
        cs_args_overrides(args, ADVISE_SET, &study.session.overrides,
                          &study.session.n_overrides, error) ||
        cs_args_get_all(args, ADVISE_PLUGIN, &study.session.plugins, &study.session.n_plugins,
                        error))
        return error->status;
    if (cs_args_get(args, ADVISE_ERROR))
        return advise_for_error(args, &study, bound, error);
    cs_progress_begin(&progress, cs_args_get(args, ADVISE_QUIET));
    progress.label = "method";
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
    .operands_min = 1,
    .operands_max = 1,
    .main = advise,
};

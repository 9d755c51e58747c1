/* clothsim advise: finds the largest safe time step of each method, its limit and its cost.
 *
 *   options -> cs_advise_run: theory, probe runs, bisection -> table
 *   options with --error -> cs_compare_run -> the cheapest method and step for that error */
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

struct options {
    struct cs_advise study;
    double error; /* m; 0: not asked for */
    const char *folder;
    bool quiet;
};
static const struct options defaults = {.study = {.seconds = 10, .budget = 20},
                                        .folder = "advise"};

static const struct cs_arg rows[] = {
    {"integrators", 'i', "LIST",
     "methods, NAME:KEY=VALUE,...,NAME...; may be repeated (default: all)",
     CS_ARG_LIST(struct options, study.methods, study.n_methods), .methods = true},
    {"check", 0, NULL, "bisect the limits too, and print both",
     CS_ARG_INTO(struct options, study.bisect_too)},
    {"error", 0, "METRES",
     "run a comparison to find the cheapest method and step with this position error at the "
     "end of the time (default: 0.5 s)",
     CS_ARG_INTO(struct options, error)},
    {"out", 'o', "DIR",
     "folder of that comparison, which continues where it stopped (default: advise)",
     CS_ARG_INTO(struct options, folder)},
    {"time", 't', "SECONDS",
     "simulated time that the steps must survive, the minimum for every run (default: 10)",
     CS_ARG_INTO(struct options, study.seconds)},
    {"budget", 0, "SECONDS", "maximum processor time of one run (default: 20)",
     CS_ARG_INTO(struct options, study.budget)},
    {"jobs", 'j', "N", "methods run in parallel (default: one per processor)",
     CS_ARG_INTO(struct options, study.workers), .min = 1, .max = CS_PROCESS_POOL_MAX},
    CS_ARG_SET(struct options, study.session),
    CS_ARG_PLUGIN(struct options, study.session),
    {"quiet", 'q', NULL, "no progress", CS_ARG_INTO(struct options, quiet)},
};

/* "NAME:options,NAME:options" of the requested methods; "" for all. */
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

/* Answers "cheapest way to an error" by a comparison over its default range of steps. */
static enum cs_status advise_for_error(struct cs_args *args, struct cs_error *error) {
    const struct options *options = args->options;
    const struct cs_advise *study = &options->study;
    const double bound = options->error;
    struct cs_compare compare = {0};
    struct cs_text list = {0}, out = {0};
    join(study, &list);
    struct cs_compare_settings settings = {.run = {.session = study->session},
                                           .methods =
                                               study->n_methods ? cs_text_get(&list) : NULL,
                                           .accuracy = bound < 1e-6 ? bound : 1e-6,
                                           .runs = 15,
                                           .folder = options->folder,
                                           .cache = options->folder};
    const double seconds = cs_args_is_given(args, "time") ? study->seconds : 0.5;
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

/* The same flag stops the present run and prevents further ones. */
static enum cs_status advise(struct cs_args *args, struct cs_error *error) {
    struct cs_progress progress;
    struct cs_text out = {0};
    struct options *options = args->options;
    struct cs_advise *study = &options->study;
    study->session.scene = args->operands[0];
    if (!study->workers)
        study->workers = cs_pool_processors(CS_PROCESS_POOL_MAX);
    /* one flag stops the current run and keeps further ones from starting */
    study->session.run.stop = study->stop = cs_interrupt_catch();
    if (options->error > 0)
        return advise_for_error(args, error);
    study->progress = cs_progress_show;
    study->ctx = &progress;
    cs_progress_begin(&progress, "method", options->quiet);
    cs_advise_run(study, error);
    /* the line goes before anything is printed below it */
    cs_progress_end(&progress);
    if (!error->status) {
        cs_advise_print(study, &out);
        cs_print_out(stdout, &out, error);
    }
    cs_advise_finish(study);
    return error->status;
}

const struct cs_command cs_command_advise = {
    .name = "advise",
    .operands = "SCENE",
    .summary = "find the largest safe step of each method and what limits it",
    .notes = "Example: clothsim advise scenes/hang.json -i velocity-verlet\n",
    CS_COMMAND_OPTIONS(rows, defaults),
    .operands_min = 1,
    .operands_max = 1,
    .main = advise,
};

/* clothsim compare: measures error against run time for integrators on a scene. */
#include "cli/commands.h"
#include "cli/external_modules.h"
#include "cli/line/interrupt.h"
#include "cli/line/print.h"
#include "cli/line/progress.h"
#include "cli/study_file_conflicts.h"
#include "study/compare/cell_list_parse.h"
#include "study/compare/compare.h"
#include "study/compare/compare_report.h"
#include "study/compare/compare_sheet.h"
#include "study/compare/compare_table.h"
#include "study/compare/verdict.h"
#include "study/isolate.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    COMPARE_INTEGRATORS,
    COMPARE_TIME,
    COMPARE_SET,
    COMPARE_PLUGIN,
    COMPARE_OUT,
    COMPARE_RUNS,
    COMPARE_RANK,
    COMPARE_BUDGET,
    COMPARE_ACCURACY,
    COMPARE_REFERENCE,
    COMPARE_CACHE,
    COMPARE_FRESH,
    COMPARE_PICTURES,
    COMPARE_RENDERER,
    COMPARE_SHARD,
    COMPARE_REPORT,
    COMPARE_LEDGER,
    COMPARE_STRICT,
    COMPARE_QUIET,
    COMPARE_ROWS
};

/* for one call of a method: the frames of a reference may take long */
enum { PATIENCE_SECONDS = 600 };

static const struct cs_arg rows[COMPARE_ROWS] = {
    [COMPARE_INTEGRATORS] = {"integrators", 'i', "LIST",
                             "methods, NAME:KEY=VALUE,KEY=LOW..HIGH,NAME...; dt and rtol may "
                             "be ranges (default: all methods)",
                             false},
    [COMPARE_TIME] = {"time", 't', "SECONDS", "simulated time (default: 0.5)", false},
    [COMPARE_SET] = {"set", 's', "PATH=VALUE",
                     "another value for a key of the scene; may be repeated", true},
    [COMPARE_PLUGIN] = {"plugin", 'p', "FILE", "load an integrator module; may be repeated",
                        true},
    [COMPARE_OUT] = {"out", 'o', "DIR",
                     "folder of compare.csv, compare.json, compare.md and the diagrams "
                     "(default: compare)",
                     false},
    [COMPARE_RUNS] = {"runs", 0, "N",
                      "rounds in which the cells of the verdict are timed, at most; fewer are "
                      "enough where factors are known to 2 % (default: 40)",
                      false},
    [COMPARE_RANK] = {"rank", 0, "NAME",
                      "what the verdict goes by: error, path, largest, velocity or energy "
                      "(default: error)",
                      false},
    [COMPARE_BUDGET] = {"budget", 0, "SECONDS",
                        "processor time that one run may take; a series ends at its first row "
                        "over it (default: 25 s shared by the cells, at most 4 s each)",
                        false},
    [COMPARE_ACCURACY] = {"accuracy", 0, "METRES",
                          "error that must still mean something (default: 1e-6)", false},
    [COMPARE_REFERENCE] = {"reference", 0, "NAME:KEY=VALUE,...",
                           "method of the reference; give two of different families", true},
    [COMPARE_CACHE] = {"cache", 0, "DIR", "where references are kept (default: DIR of -o)",
                       false},
    [COMPARE_FRESH] = {"fresh", 0, NULL, "write over the compare.csv that is there", false},
    [COMPARE_PICTURES] = {"pictures", 0, NULL,
                          "draw the last frame of the methods at equal step and at equal cost, "
                          "coloured by their error",
                          false},
    [COMPARE_RENDERER] = {"renderer", 0, "NAME", "cpu, osmesa, egl or auto (default: auto)",
                          false},
    [COMPARE_SHARD] = {"shard", 0, "K/N",
                       "run the K-th of N shares of the cells; see: clothsim merge", false},
    [COMPARE_REPORT] = {"report", 0, NULL,
                        "write compare.html as well: one file with diagrams, tables, verdict, "
                        "machine and the command",
                        false},
    [COMPARE_LEDGER] =
        {"ledger", 0, NULL,
         "run each cell once more, to say where its energy went: what the method "
         "made or lost, and the work of each force",
         false},
    [COMPARE_STRICT] = {"strict", 0, NULL, "exit with 8 where a cell blew up or failed", false},
    [COMPARE_QUIET] = {"quiet", 'q', NULL, "no progress and no rows, only the verdict", false},
};

/* What the calls from within a comparison need. */
struct screen {
    struct cs_compare compare;
    struct cs_progress progress;
    bool quiet;
    struct cs_error error; /* of printing */
};

static void show(struct screen *screen, struct cs_text *text) {
    cs_progress_end(&screen->progress);
    cs_print_out(stdout, text, &screen->error);
}

static void show_reference(void *ctx, uint32_t done, uint32_t total, const char *what) {
    struct screen *screen = ctx;
    (void)what;
    screen->progress.label = "reference, run";
    cs_progress_show(&screen->progress, done, total);
    if (done == total)
        cs_progress_end(&screen->progress);
}

static void show_begin(void *ctx) {
    struct screen *screen = ctx;
    struct cs_text text = {0};
    cs_table_add_reference(&screen->compare, &text);
    if (!screen->quiet) {
        cs_text_add(&text, "\n");
        cs_table_add_head(&screen->compare, &text);
    }
    show(screen, &text);
    cs_progress_begin(&screen->progress, screen->quiet);
    screen->progress.label = "cell";
}

static void show_row(void *ctx, const struct cs_cell *cell, bool taken) {
    struct screen *screen = ctx;
    struct cs_text text = {0};
    if (screen->quiet)
        return;
    cs_table_add_row(&screen->compare, cell, &text);
    show(screen, &text);
    if (!taken)
        cs_progress_show(&screen->progress, screen->compare.n_done, screen->compare.cells.n);
}

static void show_round(void *ctx, uint32_t done, uint32_t most) {
    struct screen *screen = ctx;
    screen->progress.label = "round";
    cs_progress_show(&screen->progress, done, most);
}

static enum cs_status read_reference(struct cs_args *args, struct cs_compare_settings *settings,
                                     struct cs_error *error) {
    const char *const *methods;
    uint32_t n;
    if (cs_args_get_all(args, COMPARE_REFERENCE, &methods, &n, error))
        return error->status;
    if (n != 0 && n != 2)
        return cs_fail(error, CS_ERR_USAGE,
                       "--reference: found %u, expected two methods of different families", n);
    for (uint32_t k = 0; k < n; k++)
        settings->reference[k] = methods[k];
    return CS_OK;
}

static enum cs_status read_settings(struct cs_args *args, struct cs_compare_settings *settings,
                                    struct cs_error *error) {
    const char *folder = cs_args_get(args, COMPARE_OUT),
               *cache = cs_args_get(args, COMPARE_CACHE);
    struct cs_session_settings *session = &settings->run.session;
    *settings = (struct cs_compare_settings){
        .methods = cs_args_get(args, COMPARE_INTEGRATORS),
        .accuracy = 1e-6,
        .runs = 40,
        .folder = folder ? folder : "compare",
        .overwrite = cs_args_get(args, COMPARE_FRESH),
        .ledger = cs_args_get(args, COMPARE_LEDGER),
    };
    settings->cache = cache ? cache : settings->folder;
    int rank = CS_NORM_END;
    double seconds = 0.5;
    session->scene = args->operands[0];
    session->run.stop = cs_interrupt_catch();
    if (cs_args_choice(args, COMPARE_RANK, cs_norm_names, &rank, error) ||
        cs_args_integer(args, COMPARE_RUNS, 1, CS_ROUNDS_MAX, &settings->runs, error) ||
        cs_args_real(args, COMPARE_BUDGET, &settings->budget, error) ||
        cs_args_shard(args, COMPARE_SHARD, &settings->shard, error) ||
        cs_args_real(args, COMPARE_ACCURACY, &settings->accuracy, error) ||
        read_reference(args, settings, error) ||
        cs_args_overrides(args, COMPARE_SET, &session->overrides, &session->n_overrides,
                          error) ||
        cs_args_get_all(args, COMPARE_PLUGIN, &session->plugins, &session->n_plugins, error) ||
        (settings->methods &&
         cs_cell_list_add_modules(settings->methods, &args->arena, &session->plugins,
                                  &session->n_plugins, error)))
        return error->status;
    static const char *const files[] = {"compare.csv",  "compare.json", "compare.md",
                                        "compare.html", "origin.json",  NULL};
    if (cs_study_files_check(session, settings->folder, files, error))
        return error->status;
    settings->ranking_norm = (enum cs_norm)rank;
    /* last: the length of a frame may come from --set */
    return cs_args_real(args, COMPARE_TIME, &seconds, error)
               ? error->status
               : cs_recorded_run_count_frames(&settings->run, seconds, error);
}

static enum cs_status print_verdict(struct screen *screen, struct cs_error *error) {
    struct cs_ranking ranking;
    struct cs_text text = {0};
    if (cs_ranking_make(&ranking, &screen->compare, error))
        return error->status;
    cs_text_add(&text, "\n");
    cs_table_add_series(&screen->compare, &text);
    cs_text_add(&text, "\n");
    cs_table_add_ledger(&screen->compare, &text);
    if (screen->compare.settings->ledger)
        cs_text_add(&text, "\n");
    cs_verdict_print(&ranking, "", &screen->compare, &text);
    cs_compare_warn(&screen->compare, "warning: ", &text);
    cs_ranking_finish(&ranking);
    return cs_print_out(stdout, &text, error);
}

/* The command that was typed, in quotes where a shell needs them. */
static void add_word(struct cs_text *out, const char *word) {
    const bool plain = !word[strspn(word, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
                                          "0123456789_-+./:=,")];
    cs_text_add(out, " ");
    for (const char *c = plain ? word : "'"; *c; c++)
        cs_text_add(out, "%c", *c);
    for (const char *c = plain ? "" : word; *c; c++)
        cs_text_add(out, *c == '\'' ? "'\\''" : "%c", *c);
    cs_text_add(out, "%s", plain ? "" : "'");
}

static void add_command(const struct cs_args *args, struct cs_text *out) {
    cs_text_add(out, "clothsim compare");
    for (uint32_t k = 0; k < args->n_operands; k++)
        add_word(out, args->operands[k]);
    for (uint32_t k = 0; k < args->n_given; k++) {
        cs_text_add(out, " --%s", rows[args->given[k].row].name);
        if (rows[args->given[k].row].value)
            add_word(out, args->given[k].value);
    }
}

static enum cs_status check_cells(const struct cs_compare *compare, struct cs_error *error) {
    uint32_t bad = 0;
    for (uint32_t k = 0; k < compare->cells.n; k++)
        bad += !strcmp(compare->cells.cells[k].outcome, "failed") ||
               !strncmp(compare->cells.cells[k].outcome, "blew up", 7);
    return bad ? cs_fail(error, CS_ERR_UNSTABLE, "%u of %u cells blew up or failed", bad,
                         compare->cells.n)
               : CS_OK;
}

static enum cs_status compare_here(void *ctx, struct cs_error *error) {
    struct cs_args *args = ctx;
    struct cs_compare_settings settings;
    struct screen screen = {.quiet = cs_args_get(args, COMPARE_QUIET)};
    int kind = CS_RENDERER_AUTO;
    if (read_settings(args, &settings, error) ||
        cs_args_choice(args, COMPARE_RENDERER, cs_renderer_names, &kind, error))
        return error->status;
    struct cs_text command = {0};
    add_command(args, &command);
    settings.command = cs_text_get(&command);
    settings.html = cs_args_get(args, COMPARE_REPORT);
    settings.reference_progress = show_reference;
    settings.on_begin = show_begin;
    settings.row = show_row;
    settings.on_round = show_round;
    settings.ctx = &screen;
    cs_progress_begin(&screen.progress, screen.quiet);
    if (!cs_compare_run(&screen.compare, &settings, error)) {
        cs_progress_end(&screen.progress);
        /* files first: they must not be lost because printing failed */
        if (!cs_compare_write_report(&screen.compare, error) &&
            !print_verdict(&screen, error) && cs_args_get(args, COMPARE_PICTURES))
            cs_compare_contact_sheet_write(&screen.compare, (enum cs_renderer_kind)kind, error);
        if (!error->status && cs_args_get(args, COMPARE_STRICT))
            check_cells(&screen.compare, error);
    }
    cs_progress_end(&screen.progress);
    cs_compare_finish(&screen.compare);
    cs_text_finish(&command);
    /* callbacks return nothing: errors of their printing are reported here */
    return error->status ? error->status
           : screen.error.status
               ? cs_fail(error, screen.error.status, "%s", screen.error.message)
               : CS_OK;
}

static enum cs_status compare(struct cs_args *args, struct cs_error *error) {
    const char *methods = cs_args_get(args, COMPARE_INTEGRATORS);
    struct cs_isolate isolate = {
        .seconds = PATIENCE_SECONDS, .task = compare_here, .ctx = args};
    if (!cs_external_modules_requested(args, COMPARE_PLUGIN, &methods, 1))
        return compare_here(args, error);
    isolate.stop = cs_interrupt_catch();
    return cs_isolate_run(&isolate, error);
}

const struct cs_command cs_command_compare = {
    .name = "compare",
    .operands = "SCENE",
    .summary = "error against run time of integrators on a scene",
    .notes = "Rows are kept in compare.csv as they finish: an interrupted comparison goes on\n"
             "when it is run again, and other methods are added to it. Contact by force and\n"
             "events stay; contact by projection, strain limit and velocity loss are off.\n\n"
             "Example: clothsim compare scenes/drum.json -i rk4,tr-bdf2:dt=1e-3..2e-2 -o cmp\n",
    .rows = rows,
    .n_rows = COMPARE_ROWS,
    .operands_min = 1,
    .operands_max = 1,
    .main = compare,
};

/* clothsim compare: measures error against run time for integrators on a scene.
 *
 *   options -> cs_compare_settings -> cs_compare_run (rows are printed as they finish)
 *   -> report files -> summary of series, ledger, verdict, warnings -> contact sheets
 * Files are written before the verdict is printed, so a closed output loses no result. */
#include "cli/commands.h"
#include "cli/line/print.h"
#include "cli/manifest.h"
#include "cli/run_folder.h"
#include "cli/show/screen.h"
#include "study/compare/cell_list_parse.h"
#include "study/compare/compare.h"
#include "study/compare/equal_error.h"

#include <stdio.h>
#include <string.h>

/* s for one call of a method: an advance of a reference at tight tolerances may take long. */
enum { PATIENCE_SECONDS = 600 };

struct options {
    struct cs_compare_settings compare;
    double seconds;
    uint32_t frames;               /* 0: those that cover the seconds */
    const char *const *references; /* (n_references) */
    uint32_t n_references;
    const char *mesh; /* LOW..HIGH; NULL: the scene's */
    enum cs_renderer_kind renderer;
    bool show, strict, quiet;
};
static const struct options defaults = {
    .compare = {.accuracy = 1e-6, .runs = 40, .ranking_norm = CS_NORM_END, .folder = "compare"},
    .seconds = 0.5};

static const struct cs_arg rows[] = {
    {"integrators", 'i', "LIST",
     "methods, NAME:KEY=VALUE,KEY=LOW..HIGH,NAME...; dt and rtol may be ranges; may be "
     "repeated "
     "(default: all methods)",
     CS_ARG_INTO(struct options, compare.methods), .repeatable = true},
    {"time", 't', "SECONDS", "simulated time (default: 0.5)",
     CS_ARG_INTO(struct options, seconds)},
    {"frames", 'n', "N", "simulate frames 1 to N (default: by the time)",
     CS_ARG_INTO(struct options, frames), .min = 1, .max = 1000000},
    CS_ARG_SET(struct options, compare.run.session),
    CS_ARG_PLUGIN(struct options, compare.run.session),
    {"out", 'o', "DIR",
     "folder of compare.csv, compare.json, compare.md and the diagrams (default: compare)",
     CS_ARG_INTO(struct options, compare.folder)},
    {"runs", 0, "N",
     "maximum number of rounds that time the cells of the verdict; fewer if the factors are "
     "known to 2 % (default: 40)",
     CS_ARG_INTO(struct options, compare.runs), .min = 1, .max = CS_ROUNDS_MAX},
    {"error-norm", 0, "NAME",
     "error norm used for the ranking: error, path, largest, velocity or energy (default: "
     "error)",
     CS_ARG_INTO(struct options, compare.ranking_norm), .names = cs_norm_names},
    {"budget", 0, "SECONDS",
     "maximum work of one run in nominal seconds; a series ends at its first row above it "
     "(default: 6 divided among the series, at most 4)",
     CS_ARG_INTO(struct options, compare.budget)},
    {"accuracy", 0, "METRES", "smallest error that the comparison must resolve (default: 1e-6)",
     CS_ARG_INTO(struct options, compare.accuracy)},
    {"reference", 0, "NAME:KEY=VALUE,...",
     "method of the reference; give two of different families",
     CS_ARG_LIST(struct options, references, n_references)},
    {"mesh", 0, "LOW..HIGH",
     "compare on grids of LOW, 2 LOW, ... HIGH cells along the first row, each in a folder of "
     "its own, and print the error of each mesh, against the finest, beside that of the step",
     CS_ARG_INTO(struct options, mesh)},
    {"reference-budget", 0, "SECONDS",
     "maximum work of explicit methods of the reference in nominal seconds; then implicit ones "
     "follow (default: 20)",
     CS_ARG_INTO(struct options, compare.reference_budget)},
    {"cache", 0, "DIR", "folder of stored references (default: DIR of -o)",
     CS_ARG_INTO(struct options, compare.cache)},
    {"overwrite", 'y', NULL, "replace an existing compare.csv",
     CS_ARG_INTO(struct options, compare.overwrite)},
    {"pictures", 0, NULL,
     "draw the last frames at equal step and at equal cost, coloured by their error",
     CS_ARG_INTO(struct options, compare.pictures)},
    {"renderer", 0, "NAME", "cpu, osmesa or auto (default: auto)",
     CS_ARG_INTO(struct options, renderer), .names = cs_renderer_names},
    {"shard", 0, "K/N", "run shard K of N of the cells; see: clothsim merge",
     CS_ARG_INTO(struct options, compare.shard)},
    {"report", 0, NULL,
     "write compare.html as well: one file with diagrams, tables, verdict, machine and the "
     "command",
     CS_ARG_INTO(struct options, compare.html)},
    {"ledger", 0, NULL,
     "run each cell once more for its energy balance: the energy that the method gained or "
     "lost, and the work of each force",
     CS_ARG_INTO(struct options, compare.ledger)},
    {"show", 0, NULL, "draw the diagram of error against work in the terminal",
     CS_ARG_INTO(struct options, show)},
    {"strict", 0, NULL, "exit with 8 if a cell blew up or failed",
     CS_ARG_INTO(struct options, strict)},
    CS_ARG_QUIET(struct options, quiet),
};

/* Context of the callbacks of a comparison. */
struct screen {
    struct cs_compare compare;
    struct cs_screen terminal; /* opened by --show */
    struct cs_progress progress;
    bool quiet;
    struct cs_error error; /* of printing */
};

/* Prints a text in place of the progress line. Errors are kept for the end. */
static void show(struct screen *screen, struct cs_text *text) {
    cs_progress_end(&screen->progress);
    cs_print_out(stdout, text, &screen->error);
}

/* Prints a remark; a closed standard error hides no result. */
static void remark(struct screen *screen, struct cs_text *text) {
    cs_progress_end(&screen->progress);
    cs_print_out(stderr, text, &(struct cs_error){0});
}

static void show_reference(void *ctx, uint32_t done, uint32_t total, const char *what) {
    struct screen *screen = ctx;
    struct cs_text text = {0};
    if (done == 0 && what && !screen->quiet)
        cs_table_add_estimate(&screen->compare, &text);
    remark(screen, &text);
    cs_progress_show(&screen->progress, done, total);
}

/* Called after the reference: prints its summary and the head of the table. */
static void show_begin(void *ctx) {
    struct screen *screen = ctx;
    struct cs_text text = {0};
    if (!screen->quiet) {
        cs_table_add_reference(&screen->compare, &text);
        cs_text_add(&text, "\n");
        cs_table_add_head(&screen->compare, &text);
        show(screen, &text);
    }
    cs_progress_begin(&screen->progress, "cell", screen->quiet);
}

static void show_row(void *ctx, const struct cs_cell *cell, bool taken) {
    struct screen *screen = ctx;
    struct cs_text text = {0};
    if (screen->quiet)
        return;
    cs_table_add_row(&screen->compare, cell, &text);
    show(screen, &text); // how many cells equal errors need is not known
    if (!taken && screen->compare.n_done <= screen->compare.cells.n)
        cs_progress_show(&screen->progress, screen->compare.n_done, screen->compare.cells.n);
}

static void show_round(void *ctx, uint32_t done, uint32_t most) {
    struct screen *screen = ctx;
    struct cs_text text = {0};
    if (done == 0 && !screen->quiet)
        cs_verdict_print_preliminary(&screen->compare, &text, &screen->error);
    remark(screen, &text);
    screen->progress.label = "round";
    cs_progress_show(&screen->progress, done, most);
}

/* Takes none or two methods. */
static enum cs_status set_reference(struct options *options, struct cs_error *error) {
    if (options->n_references != 0 && options->n_references != 2)
        return cs_fail(error, CS_ERR_USAGE,
                       "--reference: found %u, expected two methods of different families",
                       options->n_references);
    for (uint32_t k = 0; k < options->n_references; k++)
        options->compare.reference[k] = options->references[k];
    return CS_OK;
}

/* Frames of every run: as given, or those that cover the time. */
static enum cs_status count_frames(struct options *options, struct cs_error *error) {
    options->compare.run.frames = options->frames;
    return options->frames
               ? CS_OK
               : cs_session_fit_frames(&options->compare.run.session,
                                       &options->compare.run.frames, &options->seconds, error);
}

/* Completes the settings; the frames last, because their length may come from --set. */
static enum cs_status make_settings(struct cs_args *args, struct cs_error *error) {
    static const char *const files[] = {"compare.csv",  "compare.json", "compare.md",
                                        "compare.html", "origin.json",  NULL};
    struct options *options = args->options;
    struct cs_compare_settings *settings = &options->compare;
    struct cs_session_settings *session = &settings->run.session;
    settings->cache = settings->cache ? settings->cache : settings->folder;
    if (settings->methods && !strcmp(settings->methods, "all"))
        settings->methods = NULL;
    session->scene = args->operands[0];
    session->run.stop = cs_interrupt_catch();
    if (set_reference(options, error) ||
        (settings->methods &&
         cs_cell_list_add_modules(settings->methods, &args->arena, &session->plugins,
                                  &session->n_plugins, error)) ||
        cs_study_files_check(session, settings->folder, files, error) ||
        cs_study_folder_check(session, settings->folder, error))
        return error->status;
    return count_frames(options, error);
}

static enum cs_status print_verdict(struct screen *screen, struct cs_error *error) {
    struct cs_ranking ranking;
    struct cs_text text = {0}, verdict = {0};
    if (cs_ranking_make(&ranking, &screen->compare, error))
        return error->status;
    if (!screen->quiet) {
        cs_text_add(&text, "\n");
        cs_table_add_series(&screen->compare, true, &text);
        cs_text_add(&text, "\n");
    }
    if (screen->compare.settings->ledger && !screen->quiet) {
        cs_table_add_ledger(&screen->compare, &text);
        cs_text_add(&text, "\n");
    }
    cs_verdict_print(&ranking, "", &screen->compare, &verdict);
    cs_compare_warn(&screen->compare, "warning: ", &verdict);
    cs_print_sentences(cs_text_get(&verdict), &text);
    text.failed |= verdict.failed;
    cs_text_finish(&verdict);
    cs_ranking_finish(&ranking);
    return cs_print_out(stdout, &text, error);
}

/* Draws error against work, which is the same on every machine. */
static enum cs_status print_diagram(struct screen *screen, struct cs_error *error) {
    struct cs_plot_settings settings;
    struct cs_diagram plot;
    struct cs_text text = {0};
    cs_compare_plot_settings(&screen->compare, CS_WIDTH_COLUMN, &settings);
    settings.title = screen->compare.scene;
    settings.second = NULL;
    cs_text_add(&text, "\n");
    if (!cs_plot_make(&plot, &settings, error))
        cs_screen_print_diagram(&screen->terminal, &plot, &text);
    cs_plot_finish(&plot);
    return error->status ? error->status : cs_print_raw(stdout, &text, error);
}

/* Fails if no cell finished, which is no answer; strict: if one blew up or failed. */
static enum cs_status check_cells(const struct cs_compare *compare, bool strict,
                                  struct cs_error *error) {
    const struct cs_cell *cells = compare->cells.cells;
    const uint32_t n = compare->cells.n;
    uint32_t bad = 0, good = 0;
    for (uint32_t k = 0; k < n; k++) {
        bad += cs_cell_has_failed(cells + k) || !strncmp(cells[k].outcome, "blew up", 7);
        good += cs_cell_is_finished(cells + k);
    }
    if (strict && bad)
        cs_fail(error, CS_ERR_UNSTABLE, "%u of %u cells blew up or failed", bad, n);
    else if (n && !good)
        cs_fail(error, CS_ERR_UNSTABLE, "no answer: no cell finished; %s: %s", cells->series,
                cells->outcome);
    return error->status;
}

/* Makes and prints one comparison; takes its results for a level of a mesh, or NULL. */
static enum cs_status compare_once(struct options *options, struct cs_mesh_study *study,
                                   struct cs_mesh_level *level, struct cs_error *error) {
    struct cs_compare_settings *settings = &options->compare;
    struct screen screen = {.quiet = options->quiet};
    if (options->show && cs_screen_open(&screen.terminal, false, error))
        return error->status;
    settings->ctx = &screen;
    cs_progress_begin(&screen.progress, "reference", screen.quiet);
    if (!cs_compare_run(&screen.compare, settings, error)) {
        cs_progress_end(&screen.progress);
        struct cs_error unseen = {0};
        if (settings->pictures)
            cs_compare_contact_sheet_write(&screen.compare, options->renderer, &unseen);
        /* files first: they must not be lost because drawing or printing failed */
        if (!cs_compare_write_report(&screen.compare, error) &&
            !cs_manifest_write_study(settings->folder, error) && !print_verdict(&screen, error))
            *error = unseen;
        if (!error->status && options->show)
            print_diagram(&screen, error);
        if (!error->status && level)
            cs_mesh_level_store(study, level, &screen.compare, error);
        if (!error->status && (options->strict || !level))
            check_cells(&screen.compare, options->strict, error);
    }
    if (error->status == CS_ERR_INTERRUPT)
        cs_manifest_write_study(settings->folder, error);
    cs_progress_end(&screen.progress);
    cs_compare_finish(&screen.compare);
    /* callbacks return nothing: errors of their printing are reported here */
    if (!error->status)
        *error = screen.error;
    return error->status;
}

/* Compares on each mesh of a scene, in FOLDER/SCENE-CELLS. */
static enum cs_status compare_meshes(struct options *options, struct cs_mesh_study *study,
                                     struct cs_error *error) {
    struct cs_compare_settings *settings = &options->compare;
    struct cs_session_settings *session = &settings->run.session;
    const struct cs_session_settings given = *session;
    const char *folder = settings->folder, *name = strrchr(session->scene, '/');
    if (cs_mesh_study_begin(study, options->mesh, session, error))
        return error->status;
    name = name ? name + 1 : session->scene;
    for (uint32_t k = 0; k < study->n && !error->status; k++) {
        struct cs_mesh_level *level = study->levels + k;
        struct cs_text text = {0}, below = {0};
        // grids are overrides after those given
        session->overrides = level->overrides;
        session->n_overrides = level->n_overrides;
        cs_text_add(&below, "%s/%.*s-%u", folder, (int)strcspn(name, "."), name, level->cells);
        settings->folder = cs_text_get(&below);
        cs_text_add(&text, "%s%s, %u cells\n", k ? "\n" : "", session->scene, level->cells);
        if (!cs_print_out(stdout, &text, error))
            compare_once(options, study, level, error);
        cs_text_finish(&below);
    }
    settings->folder = folder;
    *session = given;
    if (!error->status)
        cs_mesh_study_measure(study);
    return error->status;
}

/* Several scenes, each on its meshes. */
static enum cs_status compare_scenes(struct cs_args *args, struct cs_error *error) {
    struct options *options = args->options;
    struct cs_mesh_study *studies =
        cs_arena_alloc_array(&args->arena, args->n_operands, sizeof *studies, error);
    for (uint32_t k = 0; k < args->n_operands && !error->status; k++) {
        options->compare.run.session.scene = args->operands[k];
        if (!count_frames(options, error))
            compare_meshes(options, studies + k, error);
    }
    struct cs_text text = {0};
    if (!error->status && !cs_mesh_studies_report(studies, args->n_operands,
                                                  options->compare.folder, &text, error))
        cs_print_out(stdout, &text, error);
    // failed ones too
    for (uint32_t k = 0; studies && k < args->n_operands; k++)
        cs_mesh_study_finish(studies + k);
    return error->status;
}

static enum cs_status compare_here(void *ctx, struct cs_error *error) {
    struct cs_args *args = ctx;
    struct options *options = args->options;
    struct cs_compare_settings *settings = &options->compare;
    if (args->n_operands > 1 && !options->mesh)
        return cs_fail(error, CS_ERR_USAGE, "found %u scenes, expected one, or --mesh",
                       args->n_operands);
    if (make_settings(args, error))
        return error->status;
    // the command is part of the report
    struct cs_text command = {0};
    cs_study_print_command(args, "compare", &command);
    settings->command = cs_text_get(&command);
    settings->reference_progress = show_reference;
    settings->on_begin = show_begin;
    settings->row = show_row;
    settings->on_round = show_round;
    if (options->mesh)
        compare_scenes(args, error);
    else
        compare_once(options, NULL, NULL, error);
    cs_text_finish(&command);
    return error->status;
}

static enum cs_status compare(struct cs_args *args, struct cs_error *error) {
    struct options *options = args->options;
    if (cs_args_refuse_both(args, "frames", "time", error))
        return error->status;
    options->compare.isolates_cells =
        cs_external_modules_requested(args, &options->compare.methods, 1);
    return options->compare.isolates_cells
               ? cs_external_modules_isolate(args, PATIENCE_SECONDS, 0.5, compare_here, error)
               : compare_here(args, error);
}

const struct cs_command cs_command_compare = {
    .name = "compare",
    .operands = "SCENE...",
    .summary = "error against run time of integrators: work-precision",
    .notes =
        "Each row is written to compare.csv as it finishes: the same command continues an\n"
        "interrupted comparison, and other methods are added to it. Contact by force and\n"
        "events stay; contact by projection, strain limit and velocity loss are off.\n\n"
        "Example: clothsim compare scenes/drum.json -i rk4,tr-bdf2:dt=1e-3..2e-2 -o cmp\n",
    CS_COMMAND_OPTIONS(rows, defaults),
    .operands_min = 1,
    .operands_max = 16,
    .main = compare,
};

/* clothsim golden: recomputes golden hashes and images, and reports differences, or with
 * --accept writes the new ones.
 *
 *   options -> cs_golden_check: per row a run, its hash or picture, a verdict -> counts */
#include "base/install_paths.h"
#include "base/pool.h"
#include "cli/commands.h"
#include "cli/file_conflicts.h"
#include "cli/line/print.h"
#include "golden/golden.h"
#include "golden/golden_report.h"
#include "session/process_pool.h"
#include "session/recorded_run.h"
#include "session/session.h"
#include "study/compare/compare_curves.h"

#include <stdio.h>
#include <string.h>

struct options {
    struct cs_golden golden;
    const struct cs_override *sets;
    uint32_t n_sets;
    double seconds; /* of the run that is added; 0: not given */
    const char *json, *junit, *html;
    bool image, github, quiet;
};
static const struct options defaults = {.golden = {.threads = 1}};

static const struct cs_arg rows[] = {
    {"add", 0, "SCENE",
     "add a run of that scene to the golden tables, which are made if missing",
     CS_ARG_INTO(struct options, golden.add.scene)},
    {"frames", 'n', "N", "frames of the run that is added",
     CS_ARG_INTO(struct options, golden.add.frames), .min = 1, .max = UINT32_MAX},
    {"time", 't', "SECONDS", "its simulated time, instead of -n",
     CS_ARG_INTO(struct options, seconds)},
    {"integrator", 'i', "NAME[:KEY=VALUE,...]",
     "its integrator and options (default: the scene's)",
     CS_ARG_INTO(struct options, golden.add.integrator), .methods = true},
    {"set", 's', "PATH=VALUE", "override a scene value in it; may be repeated",
     CS_ARG_LIST(struct options, sets, n_sets)},
    {"image", 0, NULL, "add a picture of its last frame too",
     CS_ARG_INTO(struct options, image)},
    {"keep", 0, "N",
     "store positions of N of its frames too (default: 4); with --accept of rows that have "
     "none",
     CS_ARG_INTO(struct options, golden.states), .max = CS_GOLDEN_STATES_MAX},
    {"tolerance", 0, "METRES",
     "judge it by these positions, instead of by bits (bits: by bits again)",
     CS_ARG_INTO(struct options, golden.add_tolerance)},
    {"accept", 0, NULL, "replace the golden files with the new results: look at them first",
     CS_ARG_INTO(struct options, golden.accept_all)},
    {"hashes", 0, NULL, "state hashes only", CS_ARG_INTO(struct options, golden.hashes)},
    {"images", 0, NULL, "images only", CS_ARG_INTO(struct options, golden.images)},
    {"only", 0, "TEXT", "only rows whose scene or integrator contains TEXT",
     CS_ARG_INTO(struct options, golden.only_rows)},
    {"folder", 0, "DIR", "the golden folder (default: golden here, else the installed one)",
     CS_ARG_INTO(struct options, golden.folder)},
    CS_ARG_PLUGIN(struct options, golden),
    {"renderer", 0, "NAME", "cpu, osmesa or auto (default: auto); may be repeated",
     CS_ARG_INTO(struct options, golden.renderers), .names = cs_renderer_names,
     .repeatable = true},
    {"threads", 0, "N", "threads that step each scene, 1 to 64 (default: 1)",
     CS_ARG_INTO(struct options, golden.threads), .min = 1, .max = CS_POOL_THREADS_MAX},
    {"jobs", 'j', "N", "rows in parallel, each in a process (default: one per processor)",
     CS_ARG_INTO(struct options, golden.jobs), .min = 1, .max = CS_PROCESS_POOL_MAX},
    {"json", 0, "FILE", "write the rows as JSON too; -: to standard output",
     CS_ARG_INTO(struct options, json)},
    {"junit", 0, "FILE", "write the rows as a JUnit report too",
     CS_ARG_INTO(struct options, junit)},
    {"html", 0, "FILE", "write one page with the rows, and pictures of what differs",
     CS_ARG_INTO(struct options, html)},
    {"github", 0, NULL, "print rows that differ as annotations of GitHub",
     CS_ARG_INTO(struct options, github)},
    CS_ARG_QUIET(struct options, quiet),
};

/* Destination of the rows. */
struct sink {
    const struct options *options;
    struct cs_golden_report report;
};

static void print_row(void *ctx, const struct cs_golden_row *row) {
    struct sink *sink = ctx;
    const struct options *options = sink->options;
    const char *verdict = cs_golden_verdict(&options->golden, row);
    const bool is_quiet =
        options->quiet && (!strcmp(verdict, "ok") || !strcmp(verdict, "skip"));
    struct cs_text name = {0}, line = {0};
    cs_golden_add_name(row, &name);
    cs_golden_report_add(&sink->report, &options->golden, row);
    if (!cs_print_is_stdout(options->json) && !is_quiet)
        cs_text_add(&line, "%-8s   %s%s%s\n", verdict, cs_text_get(&name),
                    row->message.length ? ": " : "", cs_text_get(&row->message));
    if (options->github && cs_golden_is_failure(&options->golden, row))
        cs_text_add(&line, "::error file=%s,title=clothsim golden::%s: %s\n", row->run.scene,
                    cs_text_get(&name), cs_text_get(&row->message));
    struct cs_error unseen = {0}; /* the end of the output reports a closed one */
    cs_print_out(stdout, &line, &unseen);
    cs_text_finish(&name);
}

/* Writes the reports that were asked for. */
static enum cs_status write_reports(const struct cs_golden *golden, const struct sink *sink,
                                    struct cs_error *error) {
    const struct {
        const char *path;
        void (*print)(const struct cs_golden_report *report, const struct cs_golden *golden,
                      struct cs_text *out);
    } all[] = {{sink->options->json, cs_golden_report_print_json},
               {sink->options->junit, cs_golden_report_print_junit},
               {sink->options->html, cs_golden_report_print_html}};
    for (size_t k = 0; k < sizeof all / sizeof *all && !error->status; k++) {
        struct cs_text out = {0};
        if (!all[k].path)
            continue;
        all[k].print(&sink->report, golden, &out);
        cs_print_file(all[k].path, &out, error);
    }
    return error->status;
}

/* Frames of the run to be added, as given or by the time. */
static enum cs_status take_frames(struct cs_args *args, struct cs_error *error) {
    struct options *options = args->options;
    struct cs_golden_run *run = &options->golden.add;
    const struct cs_session_settings session = {
        .scene = run->scene, .overrides = options->sets, .n_overrides = options->n_sets};
    if (cs_args_refuse_both(args, "frames", "time", error) || !run->scene ||
        !(options->seconds > 0))
        return error->status;
    return cs_session_fit_frames(&session, &run->frames, &options->seconds, error);
}

/* Sets how many states are kept, and checks how they are to be judged. */
static enum cs_status take_states(struct cs_args *args, struct cs_error *error) {
    struct options *options = args->options;
    struct cs_golden *golden = &options->golden;
    const char *tolerance = golden->add_tolerance, *method = golden->add.integrator;
    const bool is_given = cs_args_is_given(args, "keep");
    double m = 0;
    if (golden->add.scene && !is_given)
        golden->states = CS_GOLDEN_STATES;
    if (is_given && !golden->accept_all && !golden->add.scene)
        cs_fail(error, CS_ERR_USAGE, "--keep is for --add SCENE or --accept");
    else if (tolerance && strcmp(tolerance, "bits") != 0 &&
             !(cs_parse_real(tolerance, &m) && m > 0))
        cs_fail(error, CS_ERR_USAGE,
                "--tolerance: found \"%.60s\", expected bits or METRES > 0", tolerance);
    // a distance is measured from something that is kept
    else if (m > 0 && !golden->states)
        cs_fail(error, CS_ERR_USAGE, "--tolerance needs states, found --keep 0");
    else if (method && cs_names_program(method))
        cs_fail(error, CS_ERR_USAGE,
                "no table starts a program; expected --program NAME=COMMAND -i NAME, here and "
                "at each check");
    return error->status;
}

/* Fills the run to be added from the options: overrides joined by semicolons, "-" for none. */
static enum cs_status take_run(struct cs_args *args, struct cs_error *error) {
    struct options *options = args->options;
    struct cs_golden_run *run = &options->golden.add;
    const bool asked = run->frames || options->seconds > 0 || run->integrator ||
                       options->n_sets || options->image || options->golden.add_tolerance;
    if (take_frames(args, error))
        return error->status;
    struct cs_text sets = {0};
    bool has_semicolon = false;
    // a semicolon stands between the overrides of a row, so none may hold one
    for (uint32_t k = 0; k < options->n_sets; k++) {
        const struct cs_override *set = options->sets + k;
        cs_text_add(&sets, "%s%s=%s", k ? ";" : "", set->path, set->value);
        has_semicolon |= strchr(set->value, ';') != NULL;
    }
    if (!run->scene && asked)
        cs_fail(
            error, CS_ERR_USAGE,
            "-n, -t, -i, -s, --tolerance and --image are for --add SCENE, which is missing");
    else if (run->scene && !run->frames)
        cs_fail(error, CS_ERR_USAGE,
                "--add: the number of frames is missing, expected -n N or -t SECONDS");
    else if (options->n_sets > CS_GOLDEN_SETS_MAX || sets.length >= CS_GOLDEN_SETS_BYTES)
        cs_fail(error, CS_ERR_USAGE,
                "--set: found %u of them, %zu bytes, expected at most %d, %d", options->n_sets,
                sets.length, CS_GOLDEN_SETS_MAX, CS_GOLDEN_SETS_BYTES - 1);
    else if (run->scene && (strpbrk(run->scene, "\t\n") ||
                            (run->integrator && strpbrk(run->integrator, "\t\n"))))
        cs_fail(error, CS_ERR_USAGE,
                "--add: found a tab or a new line in a name, which no row can hold");
    else if (has_semicolon || strpbrk(cs_text_get(&sets), "\t\n"))
        cs_fail(error, CS_ERR_USAGE,
                "--set: found a tab, a new line or a semicolon, which no row can hold");
    else if (run->scene) {
        run->integrator = run->integrator ? run->integrator : "-";
        run->overrides =
            options->n_sets ? cs_arena_copy_text(&args->arena, cs_text_get(&sets), error) : "-";
        options->golden.accept_all = options->golden.hashes = true;
        options->golden.images = options->image;
        options->golden.renderers = 1u << CS_RENDERER_CPU;
    }
    cs_text_finish(&sets);
    return error->status;
}

static enum cs_status report(const struct cs_golden *golden, struct sink *sink,
                             struct cs_error *error) {
    if (write_reports(golden, sink, error))
        return error->status;
    if (!cs_print_is_stdout(sink->options->json))
        printf("%u agree, %u differ, %u accepted, %u skipped\n", golden->passed, golden->failed,
               golden->accepted, golden->skipped);
    /* a misspelt --only must not look like success */
    if (golden->passed + golden->failed + golden->accepted + golden->skipped == 0)
        return cs_fail(error, CS_ERR_USAGE, "no golden row matches");
    if (golden->broken > 0)
        return cs_fail(error, CS_ERR_CHECK,
                       "%u golden row%s differ%s, of which %u cannot be run", golden->failed,
                       golden->failed == 1 ? "" : "s", golden->failed == 1 ? "s" : "",
                       golden->broken);
    if (golden->failed > 0)
        return cs_fail(error, CS_ERR_CHECK,
                       "%u golden row%s differ%s; if the change is intended, look at it, then "
                       "use --accept",
                       golden->failed, golden->failed == 1 ? "" : "s",
                       golden->failed == 1 ? "s" : "");
    return CS_OK;
}

/* Refuses reports that would replace a golden table. */
static enum cs_status check_reports(const struct options *options, struct cs_error *error) {
    static const char *const tables[] = {"hash.tsv", "image.tsv"};
    static const char *const names[] = {"--json", "--junit", "--html"};
    const char *const reports[] = {cs_print_is_stdout(options->json) ? NULL : options->json,
                                   options->junit, options->html};
    for (int k = 0; k < 6 && !error->status; k++) {
        char path[CS_DATA_PATH_MAX + 16];
        snprintf(path, sizeof path, "%.*s/%s", CS_DATA_PATH_MAX - 1, options->golden.folder,
                 tables[k / 3]);
        cs_file_conflicts_pair(reports[k % 3], names[k % 3], path, "a golden table", error);
    }
    return error->status;
}

static enum cs_status golden(struct cs_args *args, struct cs_error *error) {
    struct options *options = args->options;
    struct cs_golden *check = &options->golden;
    char installed[CS_DATA_PATH_MAX];
    struct sink sink = {.options = options};
    if (take_states(args, error) || take_run(args, error))
        return error->status;
    /* installed tables are for comparison only and never written */
    if (!check->folder)
        check->folder =
            check->accept_all ? "golden" : cs_data_find("golden", installed, sizeof installed);
    /* without a flag both are checked, as with both flags; one of the tables may be missing */
    check->any_table = !check->add.scene && !check->hashes && !check->images;
    if (!check->hashes && !check->images)
        check->hashes = check->images = true;
    if (!check->renderers)
        check->renderers = 1u << CS_RENDERER_AUTO;
    if (!check->jobs)
        check->jobs = cs_pool_processors(CS_PROCESS_POOL_MAX);
    check->stop = cs_interrupt_catch();
    check->report = print_row;
    check->ctx = &sink;
    if (!check_reports(options, error) && !cs_golden_check(check, error))
        report(check, &sink, error);
    cs_golden_report_finish(&sink.report);
    return error->status;
}

const struct cs_command cs_command_golden = {
    .name = "golden",
    .operands = "",
    .summary = "recompute golden state hashes and images, and compare",
    .notes = "Images must match pixel for pixel if the same renderer made the golden image,\n"
             "else within a tolerance that is tight enough to reveal defects. A picture that\n"
             "differs is written next to its golden image as *.actual.png, with 16 times the\n"
             "difference as *.difference.png.\n\n"
             "Example: clothsim golden --hashes --only free_fall\n",
    CS_COMMAND_OPTIONS(rows, defaults),
    .operands_min = 0,
    .operands_max = 0,
    .main = golden,
};

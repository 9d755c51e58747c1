/* clothsim sweep: runs a scene with every combination of values and methods.
 *
 *   -s PATH=V1,V2,... and -i METHOD -> axes -> cs_parameter_sweep_run: a row per cell */
#include "cli/commands.h"
#include "cli/line/print.h"
#include "cli/manifest.h"
#include "cli/run_folder.h"
#include "session/process_pool.h"
#include "session/recorded_run.h"
#include "session/session.h"
#include "sweep/parameter_sweep.h"

#include <stdio.h>
#include <string.h>

struct options {
    struct cs_parameter_sweep sweep;
    const char *const *keys; /* (n_keys) as they were typed */
    uint32_t n_keys;
    double seconds; /* 0: not given */
    double cell_megabytes;
    bool status, strict, quiet;
};
static const struct options defaults = {.sweep = {.frames = 60, .folder = "sweep", .jobs = 1}};

/* s for one call into a module from outside, where cells have no limit. */
enum { PATIENCE_SECONDS = 600 };

static const struct cs_arg rows[] = {
    {"integrators", 'i', "LIST",
     "methods, NAME:KEY=VALUE,...,NAME...; all: every method; may be repeated (default: the "
     "scene's own)",
     CS_ARG_LIST(struct options, sweep.methods, sweep.n_methods), .methods = true},
    {"set", 's', "PATH=VALUE,VALUE,...",
     "values of a key of the scene; repeated: every combination is run",
     CS_ARG_LIST(struct options, keys, n_keys)},
    {"frames", 'n', "N", "simulate frames 1 to N (default: 60)",
     CS_ARG_INTO(struct options, sweep.frames), .min = 1, .max = 10000000},
    {"time", 't', "SECONDS", "simulated time, instead of -n",
     CS_ARG_INTO(struct options, seconds)},
    CS_ARG_PLUGIN(struct options, sweep.session),
    {"out", 'o', "DIR", "folder of sweep.csv (default: sweep)",
     CS_ARG_INTO(struct options, sweep.folder)},
    {"overwrite", 'y', NULL, "replace an existing sweep.csv",
     CS_ARG_INTO(struct options, sweep.overwrite)},
    {"shard", 0, "K/N", "run shard K of N of the cells; see: clothsim merge",
     CS_ARG_INTO(struct options, sweep.shard)},
    {"jobs", 'j', "N", "run N cells at a time, each by one thread (default: 1)",
     CS_ARG_INTO(struct options, sweep.jobs), .min = 1, .max = CS_PROCESS_POOL_MAX},
    {"cell-seconds", 0, "SECONDS", "end a cell after this time; its row says failed",
     CS_ARG_INTO(struct options, sweep.cell_seconds)},
    {"cell-memory", 0, "MB", "address space of a cell; a row that needs more says failed",
     CS_ARG_INTO(struct options, cell_megabytes)},
    {"retry-failed", 0, NULL, "run failed cells again",
     CS_ARG_INTO(struct options, sweep.retry_failed)},
    {"status", 0, NULL, "count the finished cells, and run none",
     CS_ARG_INTO(struct options, status)},
    {"strict", 0, NULL, "exit with 8 if a cell blew up, was refused or failed",
     CS_ARG_INTO(struct options, strict)},
    CS_ARG_QUIET(struct options, quiet),
};

/* Cuts the next value off at a comma outside of brackets and quotes: values may be JSON lists.
 */
static char *cut_value(char **rest) {
    char *value = *rest, *c = value;
    int depth = 0;
    bool quoted = false;
    for (; *c && (*c != ',' || depth > 0 || quoted); c++) {
        quoted ^= *c == '"';
        depth += quoted ? 0 : (*c == '[' || *c == '{') - (*c == ']' || *c == '}');
    }
    *rest = *c ? c + 1 : NULL;
    *c = 0;
    return value;
}

/* Reads "PATH=VALUE,VALUE". The text is a copy in the arena, and is cut into values. */
static enum cs_status read_key(struct cs_args *args, char *text, struct cs_parameter_axis *key,
                               struct cs_error *error) {
    char *equals = strchr(text, '=');
    if (!equals || equals == text || !equals[1])
        return cs_fail(error, CS_ERR_USAGE,
                       "--set: expected PATH=VALUE,VALUE,..., found \"%.60s\"", text);
    *equals = 0;
    uint32_t commas = 1;
    for (const char *c = equals + 1; *c; c++)
        commas += *c == ',';
    *key = (struct cs_parameter_axis){.path = text};
    key->values = cs_arena_alloc_array(&args->arena, commas, sizeof *key->values, error);
    for (char *rest = equals + 1; key->values && rest;)
        key->values[key->n++] = cut_value(&rest);
    return error->status;
}

static enum cs_status read_keys(struct cs_args *args, const struct options *options,
                                struct cs_parameter_sweep *sweep, struct cs_error *error) {
    sweep->n_keys = options->n_keys;
    if (sweep->n_keys > CS_PARAMETER_AXES_MAX)
        return cs_fail(error, CS_ERR_USAGE, "--set: found %u keys, expected at most %d",
                       sweep->n_keys, CS_PARAMETER_AXES_MAX);
    for (uint32_t k = 0; k < sweep->n_keys && !error->status; k++) {
        char *copy = cs_arena_copy_text(&args->arena, options->keys[k], error);
        if (copy)
            read_key(args, copy, sweep->keys + k, error);
        for (uint32_t other = 0; other < k && !error->status; other++)
            if (!strcmp(sweep->keys[other].path, sweep->keys[k].path))
                cs_fail(error, CS_ERR_USAGE, "--set: %.60s is given twice",
                        sweep->keys[k].path);
    }
    return error->status;
}

/* Puts the names of all methods in place of "all". */
static enum cs_status name_methods(struct cs_args *args, struct cs_parameter_sweep *sweep,
                                   struct cs_error *error) {
    const struct cs_session_settings *session = &sweep->session;
    struct cs_registry registry = {0};
    uint32_t n = 0;
    if (sweep->n_methods != 1 || strcmp(sweep->methods[0], "all") != 0)
        return CS_OK;
    cs_registry_add_files(&registry, session->plugins, session->n_plugins, error);
    const char *const *names =
        error->status ? NULL : cs_registry_names(&registry, true, &n, error);
    const char **methods =
        names ? cs_arena_alloc_array(&args->arena, n, sizeof *methods, error) : NULL;
    for (uint32_t k = 0; methods && k < n; k++)
        methods[k] = cs_arena_copy_text(&args->arena, names[k], error);
    sweep->methods = methods;
    sweep->n_methods = n;
    cs_registry_finish(&registry);
    return error->status;
}

/* Frames as given, or those of the time, which cells of other frame rates would not share. */
static enum cs_status count_frames(struct cs_args *args, struct options *options,
                                   struct cs_error *error) {
    struct cs_parameter_sweep *sweep = &options->sweep;
    if (cs_args_refuse_both(args, "frames", "time", error) || !(options->seconds > 0))
        return error->status;
    for (uint32_t k = 0; k < sweep->n_keys; k++)
        if (!strcmp(sweep->keys[k].path, "time.fps"))
            return cs_fail(error, CS_ERR_USAGE,
                           "--time: cells of other time.fps have other frames; use --frames");
    sweep->frames = 0;
    return cs_session_fit_frames(&sweep->session, &sweep->frames, &options->seconds, error);
}

/* Prints the counts, the first refusal and the failed cells; these also if quiet. */
static enum cs_status print_counts(const struct options *options, struct cs_error *error) {
    const struct cs_parameter_sweep *sweep = &options->sweep;
    const struct cs_parameter_sweep_counts *counts = &sweep->counts;
    struct cs_text out = {.failed = sweep->failed.failed};
    if (options->status)
        cs_text_add(&out, "%u of %u cells are in %s/sweep.csv, %u are being run\n",
                    counts->done, counts->cells, sweep->folder, counts->running);
    else if (!options->quiet)
        cs_text_add(&out, "%u of %u cells are in %s/sweep.csv, %u of them from earlier runs\n",
                    counts->done, counts->cells, sweep->folder, counts->reused);
    if (counts->refused && counts->refused < counts->cells && !options->quiet)
        cs_text_add(&out, "warning: %u of them were refused; the first message: %s\n",
                    counts->refused, counts->first_refusal);
    cs_text_add(&out, "%s", cs_text_get(&sweep->failed));
    return cs_print_out(stdout, &out, error);
}

static enum cs_status run_sweep(struct cs_args *args, struct cs_error *error) {
    struct cs_progress progress;
    struct options *options = args->options;
    struct cs_parameter_sweep *sweep = &options->sweep;
    const struct cs_parameter_sweep_counts *counts = &sweep->counts;
    struct cs_error unseen = {0};
    sweep->session.scene = args->operands[0];
    sweep->session.run.stop = cs_interrupt_catch();
    sweep->progress = cs_progress_show;
    sweep->ctx = &progress;
    sweep->cell_bytes = 1e6 * options->cell_megabytes;
    if (cs_external_modules_requested(args, sweep->methods, sweep->n_methods))
        sweep->call_seconds = PATIENCE_SECONDS;
    if (read_keys(args, options, sweep, error) || name_methods(args, sweep, error) ||
        count_frames(args, options, error) ||
        cs_study_folder_check(&sweep->session, sweep->folder, error))
        return error->status;
    cs_progress_begin(&progress, "cell", options->quiet);
    if (options->status)
        cs_parameter_sweep_count(sweep, error);
    else {
        cs_parameter_sweep_run(sweep, error);
        cs_manifest_write_study(sweep->folder, error);
    }
    cs_progress_end(&progress);
    if (counts->done || (options->status && !error->status))
        print_counts(options, error->status ? &unseen : error);
    cs_text_finish(&sweep->failed);
    if (counts->refused && counts->refused == counts->cells)
        cs_fail(error, CS_ERR_SCENE, "all %u cells were refused; the first message: %.800s",
                counts->cells, counts->first_refusal);
    const uint32_t bad = counts->refused + counts->failed + counts->blown_up;
    if (options->strict && bad)
        cs_fail(error, CS_ERR_UNSTABLE, "%u of %u cells blew up, were refused or failed", bad,
                counts->cells);
    const struct cs_error *failure = &sweep->cell_failure;
    return failure->status ? cs_fail(error, failure->status, "%s", failure->message)
                           : error->status;
}

const struct cs_command cs_command_sweep = {
    .name = "sweep",
    .operands = "SCENE",
    .summary = "run a scene with every combination of values and methods",
    .notes =
        "Each row is written as it finishes: the same command continues an interrupted\n"
        "sweep, and any number of processes can fill one folder. A cell that crashes, hangs\n"
        "or reaches its limit is a row that says failed.\n"
        "\n"
        "Example: clothsim sweep scenes/hang.json -s bodies[0].springs.stretch=50,100,200 "
        "\\\n             -i rk4 -i newmark:dt=0.005 -n 30 -o sweep\n",
    CS_COMMAND_OPTIONS(rows, defaults),
    .operands_min = 1,
    .operands_max = 1,
    .main = run_sweep,
};

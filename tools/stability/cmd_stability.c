/* clothsim stability: maps the stable time steps of a method, as text, CSV, JSON and a picture.
 *
 *   options -> axis and ranges -> per method: cs_stability_run -> table, NAME.csv,
 *   NAME_border.csv, NAME.json, NAME.png, NAME.svg, NAME.pdf
 *
 * With --extreme the catalogue of extreme scenes is run instead (extreme.h). An
 * interrupted map resumes from its journal when the command is repeated. */
#include "base/install_paths.h"
#include "base/json_writer.h"
#include "base/pool.h"
#include "cli/commands.h"
#include "cli/line/print.h"
#include "cli/run_folder.h"
#include "session/process_pool.h"
#include "session/recorded_run.h"
#include "stability/extreme.h"
#include "stability/stability_map.h"

#include <stdio.h>
#include <string.h>

static const struct cs_stability_options defaults = {
    .map = {.folder = "stability", .columns = 9, .rows = 15, .seconds = 0.5, .budget = 5},
    .axis = CS_AXES};

static const struct cs_arg rows[] = {
    {"integrators", 'i', "LIST",
     "methods, NAME:KEY=VALUE,...,NAME...; all: every method; may be repeated (default: the "
     "scene's own)",
     CS_ARG_LIST(struct cs_stability_options, methods, n_methods), .methods = true},
    {"axis", 0, "NAME", "stiffness, damping, mass, resolution or young (default: stiffness)",
     CS_ARG_INTO(struct cs_stability_options, axis), .names = cs_axis_names},
    {"stiffness", 0, "LOW..HIGH",
     "vary the stiffness, in N/m of the stiffest kind of spring, others in proportion",
     CS_ARG_INTO(struct cs_stability_options, values[CS_AXIS_STIFFNESS])},
    {"damping", 0, "LOW..HIGH", "vary the damping, in N s/m",
     CS_ARG_INTO(struct cs_stability_options, values[CS_AXIS_DAMPING])},
    {"mass", 0, "LOW..HIGH", "vary the mass, in kg of the first particle",
     CS_ARG_INTO(struct cs_stability_options, values[CS_AXIS_MASS])},
    {"resolution", 0, "LOW..HIGH", "vary the resolution, in columns of the grid",
     CS_ARG_INTO(struct cs_stability_options, values[CS_AXIS_RESOLUTION])},
    {"young", 0, "LOW..HIGH",
     "vary the moduli of elastic membranes, in N/m of Young's modulus or of the warp, others "
     "in "
     "proportion",
     CS_ARG_INTO(struct cs_stability_options, values[CS_AXIS_YOUNG])},
    {"dt", 0, "LOW..HIGH", "steps in s (default: around the expected border)",
     CS_ARG_INTO(struct cs_stability_options, dt)},
    {"columns", 0, "N", "values on the axis (default: 9)",
     CS_ARG_INTO(struct cs_stability_options, map.columns), .min = 1, .max = CS_MAP_CELLS_MAX},
    {"rows", 0, "N", "values of dt (default: 15)",
     CS_ARG_INTO(struct cs_stability_options, map.rows), .min = 1, .max = CS_MAP_CELLS_MAX},
    {"time", 't', "SECONDS", "simulated time of a cell (default: 0.5)",
     CS_ARG_INTO(struct cs_stability_options, map.seconds)},
    {"frames", 'n', "N", "simulated frames of a cell (default: by the time)",
     CS_ARG_INTO(struct cs_stability_options, frames), .min = 1, .max = 1000000},
    {"budget", 0, "SECONDS", "maximum work of one cell in nominal seconds (default: 5)",
     CS_ARG_INTO(struct cs_stability_options, map.budget)},
    {"jobs", 'j', "N", "cells run in parallel (default: one per processor)",
     CS_ARG_INTO(struct cs_stability_options, map.workers), .min = 1,
     .max = CS_PROCESS_POOL_MAX},
    CS_ARG_SET(struct cs_stability_options, map.session),
    CS_ARG_PLUGIN(struct cs_stability_options, map.session),
    {"out", 'o', "DIR",
     "folder for NAME.csv, NAME_border.csv, NAME.json, NAME.png, NAME.svg and NAME.pdf "
     "(default: stability)",
     CS_ARG_INTO(struct cs_stability_options, map.folder)},
    {"overwrite", 'y', NULL, "replace the files of an earlier map",
     CS_ARG_INTO(struct cs_stability_options, overwrite)},
    {"extreme", 0, NULL,
     "run the catalogue of extreme scenes instead, with every method; SCENE is then part of a "
     "name",
     CS_ARG_INTO(struct cs_stability_options, extreme)},
    {"folder", 0, "DIR", "the catalogue's folder (default: scenes/extreme)",
     CS_ARG_INTO(struct cs_stability_options, catalogue)},
    {"shard", 0, "K/N", "run shard K of N of the columns; see: clothsim merge",
     CS_ARG_INTO(struct cs_stability_options, map.shard)},
    {"json", 0, "FILE", "with --extreme: write the rows as JSON too; -: to standard output",
     CS_ARG_INTO(struct cs_stability_options, json)},
    {"show", 0, NULL, "draw the map in the terminal, in colour, in place of its table",
     CS_ARG_INTO(struct cs_stability_options, show)},
    {"strict", 0, NULL, "exit with 8 if a cell is unstable or its method failed",
     CS_ARG_INTO(struct cs_stability_options, strict)},
    CS_ARG_QUIET(struct cs_stability_options, quiet),
};

static enum cs_status read_range(const char *option, const char *text, struct cs_range *range,
                                 struct cs_error *error) {
    if (!text || (cs_parse_range(text, &range->from, &range->to) && range->to <= 1e15))
        return CS_OK;
    return cs_fail(error, CS_ERR_USAGE,
                   "--%s: expected LOW..HIGH, both above 0, found \"%.60s\"", option, text);
}

/* Reads the axis from --axis, or from the option that has its values and its name. */
static enum cs_status read_axis(struct cs_stability_options *options, struct cs_error *error) {
    enum cs_axis axis = CS_AXES;
    for (uint32_t k = 0; k < CS_AXES; k++) {
        if (!options->values[k])
            continue;
        if (axis != CS_AXES)
            return cs_fail(error, CS_ERR_USAGE, "--%s and --%s: a map has one axis",
                           cs_axis_names[axis], cs_axis_names[k]);
        axis = (enum cs_axis)k;
        if (read_range(cs_axis_names[k], options->values[k], &options->map.values, error))
            return error->status;
    }
    /* --axis may repeat what the option of the values says already */
    if (axis != CS_AXES && options->axis != CS_AXES && axis != options->axis)
        return cs_fail(error, CS_ERR_USAGE, "--axis %s and --%s: a map has one axis",
                       cs_axis_names[options->axis], cs_axis_names[axis]);
    axis = axis != CS_AXES ? axis : options->axis;
    options->map.axis = axis != CS_AXES ? axis : CS_AXIS_STIFFNESS;
    return read_range("dt", options->dt, &options->map.dt, error);
}

/* Where the rows of the catalogue go. */
struct sink {
    const struct cs_stability_options *options;
    struct cs_text json;
};

static void add_json(const struct cs_extreme_row *row, struct cs_text *out) {
    cs_json_write(out,
                  ",\n    {'scene': %s, 'method': %s, 'expected': %s, 'verdict': %s, "
                  "'message': %s, 'met': %d, 'seconds': ",
                  row->scene, row->method, row->expected, cs_stability_word(row->verdict),
                  row->message, row->as_expected);
    cs_text_add(out, "%.3g}", row->seconds);
}

static void print_extreme(void *ctx, const struct cs_extreme_row *row) {
    struct sink *sink = ctx;
    add_json(row, &sink->json);
    if ((row->as_expected && sink->options->quiet) || cs_print_is_stdout(sink->options->json))
        return;
    struct cs_text line = {0};
    struct cs_error unseen = {0}; /* the end of the output reports a closed one */
    cs_text_add(&line, "%-6s %-16s %-20s %-18s expected %-24s %6.2f s%s%s\n",
                row->as_expected ? "ok" : "MISSED", row->scene, row->method,
                cs_stability_word(row->verdict), row->expected, row->seconds,
                *row->message ? "  " : "", row->message);
    cs_print_out(stdout, &line, &unseen);
}

/* Writes the rows of the catalogue. Missed expectations are an error already, which stays. */
static void write_json(const struct cs_extreme *extreme, struct sink *sink,
                       struct cs_error *error) {
    const char *path = sink->options->json;
    struct cs_text out = {0};
    struct cs_error failure = {0};
    if (path) {
        cs_json_write(&out, "{\n  'met': %u, 'missed': %u,\n  'rows': [", extreme->n_met,
                      extreme->n_missed);
        cs_text_add(&out, "%s\n  ]\n}\n", cs_text_get(&sink->json));
        out.failed |= sink->json.failed;
        if (cs_print_file(path, &out, &failure))
            *error = failure;
    }
}

/* Runs the catalogue. A missed expectation is CS_ERR_CHECK, with valid counts and rows. */
static enum cs_status run_extreme(const struct cs_stability_options *options,
                                  struct cs_error *error) {
    const struct cs_stability_settings *settings = &options->map;
    char installed[CS_DATA_PATH_MAX];
    const bool all = options->n_methods == 1 && !strcmp(options->methods[0], "all");
    struct sink sink = {.options = options};
    struct cs_extreme extreme = {
        .folder = options->catalogue
                      ? options->catalogue
                      : cs_data_find("scenes/extreme", installed, sizeof installed),
        .only_scene = settings->session.scene,
        .methods = options->methods,
        /* 0: every available method */
        .n_methods = all ? 0 : options->n_methods,
        .plugins = settings->session.plugins,
        .n_plugins = settings->session.n_plugins,
        .budget = settings->budget,
        .n_workers = settings->workers,
        .stop = settings->session.run.stop,
        .report = print_extreme,
        .ctx = &sink,
    };
    cs_extreme_run(&extreme, error);
    /* CS_ERR_CHECK says that an expectation was missed: the counts are valid */
    if (!error->status || error->status == CS_ERR_CHECK)
        write_json(&extreme, &sink, error);
    cs_text_finish(&sink.json);
    if ((!error->status || error->status == CS_ERR_CHECK) && !cs_print_is_stdout(options->json))
        printf("%u as expected, %u not\n", extreme.n_met, extreme.n_missed);
    return error->status;
}

/* Refuses two maps with one name: they would be one file. */
static enum cs_status check_apart(const char *const *methods, uint32_t n,
                                  struct cs_error *error) {
    for (uint32_t k = 0; k < n; k++)
        for (uint32_t i = 0; i < k; i++) {
            char names[2][CS_SERIES_BYTES];
            const char *of[] = {methods[i], methods[k]};
            if (cs_series_parse_name(of, names[0], error) ||
                cs_series_parse_name(of + 1, names[1], error))
                return error->status;
            if (*names[0] && !strcmp(names[0], names[1]) && strcmp(of[0], of[1]) != 0)
                return cs_fail(error, CS_ERR_USAGE,
                               "series \"%s\" is %.60s and %.60s: give one of them another "
                               "name",
                               names[0], of[0], of[1]);
        }
    return CS_OK;
}

/* One map, or those of all methods. */
static enum cs_status map(struct cs_stability_options *options, const char *method,
                          struct cs_error *error) {
    char series[CS_SERIES_BYTES];
    if (cs_series_parse_name(&method, series, error))
        return error->status;
    options->map.session.integrator = method;
    options->map.series = series;
    return strcmp(method, "all") != 0 ? cs_stability_map_one(options, error)
                                      : cs_stability_map_all(options, error);
}

static enum cs_status stability(struct cs_args *args, struct cs_error *error) {
    struct cs_stability_options *options = args->options;
    struct cs_stability_settings *settings = &options->map;
    settings->session.scene = args->n_operands ? args->operands[0] : NULL;
    settings->session.run.stop = cs_interrupt_catch();
    if (!settings->workers)
        settings->workers = cs_pool_processors(CS_PROCESS_POOL_MAX);
    if (read_axis(options, error) || cs_args_refuse_both(args, "frames", "time", error))
        return error->status;
    /* before the operand is checked: here it is only part of a name, and may be absent */
    if (options->extreme && options->show)
        return cs_fail(error, CS_ERR_USAGE, "--extreme makes no map for --show");
    if (options->extreme)
        return run_extreme(options, error);
    if (!settings->session.scene)
        return cs_fail(error, CS_ERR_USAGE,
                       "expected SCENE or --extreme (see: clothsim stability --help)");
    if (cs_study_folder_check(&settings->session, settings->folder, error))
        return error->status;
    if (options->frames &&
        cs_session_fit_frames(&settings->session, &options->frames, &settings->seconds, error))
        return error->status;
    /* no method named: the scene's own */
    if (!options->n_methods)
        return cs_stability_map_one(options, error);
    check_apart(options->methods, options->n_methods, error);
    for (uint32_t k = 0; k < options->n_methods && !error->status; k++)
        map(options, options->methods[k], error);
    return error->status;
}

const struct cs_command cs_command_stability = {
    .name = "stability",
    .operands = "[SCENE]",
    .summary = "map the stable steps of a method against linear theory",
    .notes = "An unstable cell is a result: the exit code is 0.\n\n"
             "Example: clothsim stability scenes/hang.json -i symplectic-euler\n",
    CS_COMMAND_OPTIONS(rows, defaults),
    .operands_min = 0,
    .operands_max = 1,
    .main = stability,
};

/* cmd_stability.c - clothsim stability: which steps a method survives, as a map and a picture.
 */
#include "base/file.h"
#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/print.h"
#include "cli/progress.h"
#include "cli/run_output.h"
#include "io/gnuplot.h"
#include "study/extreme.h"
#include "study/stability.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    STABILITY_INTEGRATORS,
    STABILITY_AXIS,
    STABILITY_STIFFNESS,
    STABILITY_DAMPING,
    STABILITY_MASS,
    STABILITY_RESOLUTION,
    STABILITY_DT,
    STABILITY_COLUMNS,
    STABILITY_STEPS,
    STABILITY_TIME,
    STABILITY_BUDGET,
    STABILITY_JOBS,
    STABILITY_SET,
    STABILITY_PLUGIN,
    STABILITY_OUT,
    STABILITY_OVERWRITE,
    STABILITY_EXTREME,
    STABILITY_FOLDER,
    STABILITY_QUIET,
    STABILITY_ROWS
};

static const struct cs_arg rows[STABILITY_ROWS] = {
    [STABILITY_INTEGRATORS] = {"integrators", 'i', "LIST",
                               "NAME[:KEY=VALUE,...]; all: every method; may be repeated "
                               "(default: the scene's own)",
                               true},
    [STABILITY_AXIS] = {"axis", 0, "NAME",
                        "stiffness, damping, mass or resolution (default: stiffness)", false},
    [STABILITY_STIFFNESS] = {"stiffness", 0, "LOW..HIGH",
                             "that axis and its values in N/m: the stiffest kind of spring, "
                             "others in proportion",
                             false},
    [STABILITY_DAMPING] = {"damping", 0, "LOW..HIGH", "that axis, in N s/m", false},
    [STABILITY_MASS] = {"mass", 0, "LOW..HIGH", "that axis, in kg of the first particle",
                        false},
    [STABILITY_RESOLUTION] = {"resolution", 0, "LOW..HIGH", "that axis, in columns of the grid",
                              false},
    [STABILITY_DT] = {"dt", 0, "LOW..HIGH", "steps in s (default: round the expected border)",
                      false},
    [STABILITY_COLUMNS] = {"columns", 0, "N", "values on the axis (default: 9)", false},
    [STABILITY_STEPS] = {"rows", 0, "N", "values of dt (default: 15)", false},
    [STABILITY_TIME] = {"time", 't', "SECONDS", "simulated by a cell (default: 0.5)", false},
    [STABILITY_BUDGET] = {"budget", 0, "SECONDS",
                          "processor time that one cell may take (default: 5)", false},
    [STABILITY_JOBS] = {"jobs", 'j', "N", "cells at a time (default: one a processor)", false},
    [STABILITY_SET] = {"set", 's', "PATH=VALUE",
                       "another value for a key of the scene; may be repeated", true},
    [STABILITY_PLUGIN] = {"plugin", 'p', "FILE", "load an integrator module; may be repeated",
                          true},
    [STABILITY_OUT] = {"out", 'o', "DIR",
                       "folder for NAME.csv, NAME_border.csv, NAME.json, NAME.gp and, with "
                       "gnuplot, NAME.png (default: stability)",
                       false},
    [STABILITY_OVERWRITE] = {"overwrite", 'y', NULL, "replace the files of an earlier map",
                             false},
    [STABILITY_EXTREME] = {"extreme", 0, NULL,
                           "run the catalogue of extreme scenes instead, with every method; "
                           "SCENE is then part of "
                           "a name",
                           false},
    [STABILITY_FOLDER] = {"folder", 0, "DIR",
                          "the catalogue's folder (default: scenes/extreme)", false},
    [STABILITY_QUIET] = {"quiet", 'q', NULL, "no progress and no tables", false},
};

struct screen {
    struct cs_progress progress;
};

static void show_progress(void *ctx, uint32_t done, uint32_t total) {
    cs_progress_show(&((struct screen *)ctx)->progress, done, total);
}

static enum cs_status read_real(const struct cs_args *args, uint32_t row, double *value,
                                struct cs_error *error) {
    const char *text = cs_args_get(args, row);
    if (text && (!cs_parse_real(text, value) || !(*value > 0 && *value <= 1e9)))
        return cs_fail(error, CS_ERR_USAGE,
                       "--%s: expected a number above 0 and up to 1e9, found \"%.60s\"",
                       rows[row].name, text);
    return CS_OK;
}

static enum cs_status read_range(const struct cs_args *args, uint32_t row,
                                 struct cs_range *range, struct cs_error *error) {
    const char *text = cs_args_get(args, row);
    const char *dots = text ? strstr(text, "..") : NULL;
    char low[64] = "";
    if (!text)
        return CS_OK;
    if (dots && dots - text < (ptrdiff_t)sizeof low)
        memcpy(low, text, (size_t)(dots - text));
    if (!dots || !cs_parse_real(low, &range->from) || !cs_parse_real(dots + 2, &range->to) ||
        !(range->from > 0 && range->from <= range->to && range->to <= 1e15))
        return cs_fail(error, CS_ERR_USAGE,
                       "--%s: expected LOW..HIGH, both above 0, found \"%.60s\"",
                       rows[row].name, text);
    return CS_OK;
}

/* The axis by its name, or by the option that holds its values. */
static enum cs_status read_axis(const struct cs_args *args,
                                struct cs_stability_settings *settings,
                                struct cs_error *error) {
    int axis = -1, named = -1;
    for (uint32_t row = STABILITY_STIFFNESS; row <= STABILITY_RESOLUTION; row++) {
        if (!cs_args_get(args, row))
            continue;
        if (axis >= 0)
            return cs_fail(error, CS_ERR_USAGE, "--%s and --%s: a map has one axis",
                           cs_axis_names[axis], rows[row].name);
        axis = (int)(row - STABILITY_STIFFNESS);
        if (read_range(args, row, &settings->values, error))
            return error->status;
    }
    if (cs_args_choice(args, STABILITY_AXIS, cs_axis_names, &named, error))
        return error->status;
    if (axis >= 0 && named >= 0 && axis != named)
        return cs_fail(error, CS_ERR_USAGE, "--axis %s and --%s: a map has one axis",
                       cs_axis_names[named], cs_axis_names[axis]);
    settings->axis = (enum cs_axis)(axis >= 0 ? axis : named >= 0 ? named : 0);
    return CS_OK;
}

static uint32_t processors(void) {
    const long n = sysconf(_SC_NPROCESSORS_ONLN);
    return n < 1 ? 1 : n > 16 ? 16 : (uint32_t)n;
}

static enum cs_status read_settings(struct cs_args *args,
                                    struct cs_stability_settings *settings,
                                    struct cs_error *error) {
    *settings = (struct cs_stability_settings){
        .columns = 9, .rows = 15, .seconds = 0.5, .budget = 5, .workers = processors()};
    settings->session.stop = cs_interrupt_catch();
    settings->session.scene = args->n_operands ? args->operands[0] : NULL;
    if (cs_args_whole(args, STABILITY_COLUMNS, 1, CS_MAP_MOST, &settings->columns, error) ||
        cs_args_whole(args, STABILITY_STEPS, 1, CS_MAP_MOST, &settings->rows, error) ||
        cs_args_whole(args, STABILITY_JOBS, 1, 16, &settings->workers, error) ||
        read_real(args, STABILITY_TIME, &settings->seconds, error) ||
        read_real(args, STABILITY_BUDGET, &settings->budget, error) ||
        read_axis(args, settings, error) ||
        read_range(args, STABILITY_DT, &settings->dt, error) ||
        cs_args_overrides(args, STABILITY_SET, &settings->session.overrides,
                          &settings->session.n_overrides, error))
        return error->status;
    return cs_args_all(args, STABILITY_PLUGIN, &settings->session.plugins,
                       &settings->session.n_plugins, error);
}

/* One file of a map; print fills it. */
static enum cs_status write_file(const struct cs_args *args, const char *folder,
                                 const char *name, const char *ending, struct cs_text *text,
                                 struct cs_error *error) {
    struct cs_text path = {0};
    cs_text_add(&path, "%s/%s%s", folder, name, ending);
    if (text->failed || path.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the files of a map");
    else if (cs_args_get(args, STABILITY_OVERWRITE) ||
             !cs_output_check_file(cs_text_get(&path), error))
        cs_file_write(cs_text_get(&path), text->bytes, text->length, error);
    cs_text_finish(&path);
    cs_text_finish(text);
    return error->status;
}

static enum cs_status write_files(const struct cs_args *args, const struct cs_stability *map,
                                  const char *folder, struct cs_error *error) {
    const char *name = map->integrator->name;
    struct cs_text cells = {0}, borders = {0}, json = {0}, plot = {0};
    cs_stability_print_csv(map, &cells);
    cs_stability_print_borders_csv(map, &borders);
    cs_stability_print_json(map, &json);
    cs_stability_print_plot(map, name, &plot);
    write_file(args, folder, name, ".csv", &cells, error);
    if (!error->status)
        write_file(args, folder, name, "_border.csv", &borders, error);
    if (!error->status)
        write_file(args, folder, name, ".json", &json, error);
    if (!error->status)
        write_file(args, folder, name, ".gp", &plot, error);
    cs_text_finish(&borders);
    cs_text_finish(&json);
    cs_text_finish(&plot);
    return error->status;
}

/* true where gnuplot made NAME.png of NAME.gp */
static bool draw(const char *folder, const char *name) {
    char script[128];
    bool drawn = false;
    struct cs_error ignored = {0};
    snprintf(script, sizeof script, "%s.gp", name);
    return !cs_gnuplot_run(folder, script, &drawn, &ignored) && drawn;
}

/* One method: its map, printed and written. */
static enum cs_status map_one(const struct cs_args *args,
                              const struct cs_stability_settings *settings, const char *folder,
                              struct cs_error *error) {
    struct screen screen;
    struct cs_stability map;
    struct cs_stability_settings asked = *settings;
    const bool quiet = cs_args_get(args, STABILITY_QUIET);
    asked.progress = show_progress;
    asked.ctx = &screen;
    cs_progress_begin(&screen.progress, quiet);
    screen.progress.what = "cell";
    cs_stability_run(&map, &asked, error);
    cs_progress_end(&screen.progress);
    if (!error->status && !cs_folder_make(folder, error) &&
        !write_files(args, &map, folder, error) && !quiet) {
        struct cs_text out = {0};
        cs_stability_print_table(&map, &out);
        cs_text_add(&out, "  %.3g s; %s/%s.csv, _border.csv, .json, .gp%s\n\n", map.wall,
                    folder, map.integrator->name,
                    draw(folder, map.integrator->name) ? ", .png" : "; no gnuplot: no picture");
        cs_print_out(stdout, &out, error);
    }
    cs_stability_finish(&map);
    return error->status;
}

/* Every method with a fixed step; the others are named. */
static enum cs_status map_all(const struct cs_args *args,
                              struct cs_stability_settings *settings, const char *folder,
                              struct cs_error *error) {
    struct cs_registry registry = {0};
    for (uint32_t k = 0; k < settings->session.n_plugins; k++)
        if (cs_registry_add_file(&registry, settings->session.plugins[k], error))
            goto done;
    if (cs_registry_open_all(&registry, error))
        goto done;
    for (uint32_t k = 0; k < registry.n && !error->status; k++) {
        const struct cs_integrator *integrator = registry.entries[k].integrator;
        if (!integrator)
            continue;
        if (cs_trial_takes_dt(integrator)) {
            settings->session.integrator = integrator->name;
            map_one(args, settings, folder, error);
        } else if (!cs_args_get(args, STABILITY_QUIET))
            printf("%s: not applicable, it %s\n\n", integrator->name,
                   integrator->traits & CS_ADAPTIVE ? "chooses its own steps"
                                                    : "has no option dt");
    }
done:
    cs_registry_finish(&registry);
    return error->status;
}

static void print_extreme(void *ctx, const struct cs_extreme_row *row) {
    const struct cs_args *args = ctx;
    if (row->met && cs_args_get(args, STABILITY_QUIET))
        return;
    printf("%-6s %-16s %-20s %-18s expected %-24s %6.2f s%s%s\n", row->met ? "ok" : "MISSED",
           row->scene, row->method, cs_fate_word(row->verdict), row->expected, row->seconds,
           *row->message ? "  " : "", row->message);
    fflush(stdout);
}

static enum cs_status run_extreme(struct cs_args *args,
                                  const struct cs_stability_settings *settings,
                                  const char *const *methods, uint32_t n_methods,
                                  struct cs_error *error) {
    const char *folder = cs_args_get(args, STABILITY_FOLDER);
    const bool all = n_methods == 1 && !strcmp(methods[0], "all");
    struct cs_extreme extreme = {
        .folder = folder ? folder : "scenes/extreme",
        .only_scene = args->n_operands ? args->operands[0] : NULL,
        .methods = methods,
        .n_methods = all ? 0 : n_methods,
        .plugins = settings->session.plugins,
        .n_plugins = settings->session.n_plugins,
        .budget = settings->budget,
        .n_workers = settings->workers,
        .stop = settings->session.stop,
        .report = print_extreme,
        .ctx = args,
    };
    cs_extreme_run(&extreme, error);
    if (!error->status || error->status == CS_ERR_CHECK)
        printf("%u as expected, %u not\n", extreme.met, extreme.missed);
    return error->status;
}

static enum cs_status stability(struct cs_args *args, struct cs_error *error) {
    struct cs_stability_settings settings;
    const char *folder = cs_args_get(args, STABILITY_OUT);
    const char *const *methods;
    uint32_t n_methods;
    if (read_settings(args, &settings, error) ||
        cs_args_all(args, STABILITY_INTEGRATORS, &methods, &n_methods, error))
        return error->status;
    if (cs_args_get(args, STABILITY_EXTREME))
        return run_extreme(args, &settings, methods, n_methods, error);
    if (!settings.session.scene)
        return cs_fail(error, CS_ERR_USAGE,
                       "expected SCENE or --extreme (see: clothsim "
                       "stability --help)");
    folder = folder ? folder : "stability";
    if (!n_methods)
        return map_one(args, &settings, folder, error);
    for (uint32_t k = 0; k < n_methods && !error->status; k++) {
        settings.session.integrator = methods[k];
        if (!strcmp(methods[k], "all"))
            map_all(args, &settings, folder, error);
        else
            map_one(args, &settings, folder, error);
    }
    return error->status;
}

const struct cs_command cs_command_stability = {
    .name = "stability",
    .operands = "[SCENE]",
    .summary = "map which steps a method survives, beside linear theory",
    .notes = "An unstable cell is a result: the exit code is 0.\n\n"
             "Example: clothsim stability scenes/hang.json -i symplectic-euler\n",
    .rows = rows,
    .n_rows = STABILITY_ROWS,
    .least = 0,
    .most = 1,
    .main = stability,
};
